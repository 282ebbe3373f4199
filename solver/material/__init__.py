"""Materials: elasticity, hardening, and load steps of bodies that yield."""
