"""Loads from 1 to 150 kN on one mesh, against Hertz's power laws."""
