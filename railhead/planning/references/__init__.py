"""Hertz, boundary elements and the twist of a rail for a scene, before it is meshed."""
