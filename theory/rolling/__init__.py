"""Boundary elements of rolling half-spaces under tangential traction."""
