"""Frictionless linear-elastic contact on dolfinx: knows nothing of scenes, files or pictures."""
