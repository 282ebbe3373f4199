"""Stresses in the bodies: recovered, their largest values, what yields, forces through them."""
