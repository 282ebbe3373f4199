"""What answers cost in time and memory: over accuracy, size, processes and what is asked."""
