"""Materials: elasticity, hardening, plastic strain, and how bodies respond to a load case."""
