"""The contact problem, Newton's method, linear solvers and preconditioners."""
