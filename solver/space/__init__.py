"""The discrete space: kinematics, cells, facets, supports, the contact interface."""
