"""FASTSIM: Kalker's simplified theory of rolling on an ellipse (Vehicle System Dynamics 11, 1982).

The surface is a bed of springs: a traction holds its own place back by L times itself. The three
flexibilities L make small creepages give the forces of the linear theory, and the traction's bound
is the parabola 2 mu N/(pi a b) (1 - x^2/a^2 - y^2/b^2). Conventions of `theory.rolling.rolling`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from railhead.theory.friction.kalker import Coefficients
from railhead.theory.rolling.rolling import Creepage

STRIPS = 80  # across the patch, and steps along each of them


class FastsimForces(NamedTuple):
    """Result of FASTSIM.

    along: force of the wheel on the rail along the rolling direction, N.
    across: force of the wheel on the rail across, N.
    moment: about the normal, N mm.
    stick_share: share of the patch's area that sticks, 0 to 1.
    """

    along: float
    across: float
    moment: float
    stick_share: float


def fastsim(
    a: float,
    b: float,
    limit: float,
    shear_modulus: float,
    linear: Coefficients,
    creepage: Creepage,
    strips: int = STRIPS,
) -> FastsimForces:
    """Forces of a rolling ellipse at a creepage by Kalker's simplified theory.

    a, b: semi-axes along and across, mm.
    limit: friction coefficient times load, N.
    shear_modulus: G of the pair, MPa.
    linear: Kalker's linear coefficients of the ellipse.
    creepage: creepages and spin (1/mm).
    strips: number of strips across, and of steps along each.

    Each strip is followed from its leading edge. A step adds the rigid slip over the flexibility L
    to the traction, which is scaled back to its bound where it exceeds that. L_1 = 8 a/(3 G C11),
    L_2 = 8 a/(3 G C22), L_3 = pi a sqrt(a/b)/(4 G C23). As in the paper the steps are of first
    order: the result of 80 strips is within 1 % of mu N of that of many. Where the flexibilities
    differ, full slip is not quite along the rigid slip.
    """
    L1, L2 = (8 * a / (3 * shear_modulus * c) for c in (linear.c11, linear.c22))
    L3 = math.pi * a * math.sqrt(a / b) / (4 * shear_modulus * linear.c23)
    y = b * ((2 * np.arange(strips) + 1) / strips - 1)
    half = a * np.sqrt(1 - (y / b) ** 2)
    step = 2 * half / strips
    traction, forces, stuck = np.zeros((2, strips)), np.zeros(3), 0.0
    for k in range(strips):
        x = half - (k + 0.5) * step
        slip_x = creepage.along / L1 - creepage.spin * y / L3
        slip_y = creepage.across / L2 + creepage.spin * x / L3
        bound = 2 * limit / (math.pi * a * b) * (1 - (x / a) ** 2 - (y / b) ** 2)
        traction = traction + step * np.array([slip_x, slip_y])
        scale = np.minimum(1, bound / np.maximum(np.hypot(*traction), 1e-300))
        traction *= scale
        cell = step * 2 * b / strips
        along, across = traction
        forces += [along @ cell, across @ cell, (x * across - y * along) @ cell]
        stuck += float(cell[scale == 1].sum())
    area = float(2 * half.sum() * 2 * b / strips)
    return FastsimForces(float(forces[0]), float(forces[1]), float(forces[2]), stuck / area)
