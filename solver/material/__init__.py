"""Materials: elastic constants, stiffness matrix, flow curves and radial return."""
