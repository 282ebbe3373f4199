"""Contact system and contact problem, Newton's method, linear solvers, preconditioners."""
