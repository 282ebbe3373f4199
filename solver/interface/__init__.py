"""The contact surfaces: gap and normal stress as matrices, contact laws, friction."""
