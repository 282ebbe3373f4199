"""Half-spaces pressed together in a plane, in one window, and displacements by a direct sum."""

import math

import numpy as np

from railhead.theory.bem.pressure_solver import PatchSolution, solve_developed

flat = np.zeros_like


def solve(
    gap, contact_modulus: float, *, centre=(0.0, 0.0), half_size=(10.0, 10.0), **keys
) -> PatchSolution:
    window = [(centre, half_size)]
    return solve_developed(gap, contact_modulus, window, flat, split=False, **keys).windows[0]


def displacement(windows, here: PatchSolution, contact_modulus: float) -> np.ndarray:
    """Normal displacement (nx, ns) of the cells of `here` under the pressures of windows: a sum of
    Love's solution in its logarithmic form."""
    x, s = np.meshgrid(here.x, here.s, indexing="ij")
    u = np.zeros_like(x)
    for there in windows:
        dx, ds = there.x[1] - there.x[0], there.s[1] - there.s[0]
        for i, j in np.argwhere(there.pressure > 0):
            share = np.cos(here.angle - there.angle[j]) * there.pressure[i, j]
            for side, end in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
                p, q = x - there.x[i] + side * dx / 2, s - there.s[j] + end * ds / 2
                r = np.hypot(p, q)
                u += side * end * share * (p * np.log(q + r) + q * np.log(p + r))
    return u / (math.pi * contact_modulus)
