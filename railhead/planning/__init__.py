"""What will be simulated, how finely, and what it costs: decided before anything is built."""
