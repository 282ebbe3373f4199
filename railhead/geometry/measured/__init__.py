"""Measured profiles: from a file of points to a smooth profile in the axes of the project."""
