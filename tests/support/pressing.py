"""Half-spaces pressed together in a plane, in one window."""

import numpy as np

from railhead.theory.bem.pressure_solver import PatchSolution, solve_developed

flat = np.zeros_like


def solve(
    gap, contact_modulus: float, *, centre=(0.0, 0.0), half_size=(10.0, 10.0), **keys
) -> PatchSolution:
    window = [(centre, half_size)]
    return solve_developed(gap, contact_modulus, window, flat, split=False, **keys).windows[0]
