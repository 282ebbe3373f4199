"""The discrete space: kinematics, cells, facets, pairing of the surfaces, constraints."""
