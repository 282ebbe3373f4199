"""Boundary elements of half-spaces under normal pressure."""
