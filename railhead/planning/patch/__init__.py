"""The contact patch that is expected, and ridges of its pressure."""
