"""A load that rolls again and again over a body that yields: steady passes in the load's frame."""
