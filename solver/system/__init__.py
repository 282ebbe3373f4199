"""The contact system that friction and yield act on: its setup, solution, and fields as arrays."""
