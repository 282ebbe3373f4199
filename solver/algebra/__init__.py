"""Contact problem in the free unknowns, Newton's method, linear solvers, preconditioners."""
