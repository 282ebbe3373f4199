"""The contact surfaces: gap and normal traction as matrices, contact laws, friction."""
