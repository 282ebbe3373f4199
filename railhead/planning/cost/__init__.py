"""Unknowns, seconds and memory of a plan, and the speed of this machine."""
