"""Many scenes: grids of values, side by side in processes, records and tables."""
