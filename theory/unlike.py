"""Rolling of unlike half-spaces, whose tractions change the pressure and the other way round.

Pressure and tractions are found by turns until neither changes (Panagiotopoulos 1975). Conventions
of `theory.rolling`; lengths in mm, forces in N.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator

from railhead.theory.boundary_element import Gap, solve
from railhead.theory.rolling import Creepage, HalfSpaceFriction, Sheared
from railhead.theory.tangential import Pair, TractionInfluence

Array = NDArray[np.float64]
TURNS, TOLERANCE = 30, 1e-3  # of the forces, over mu N


def rolled(
    gap: Gap, pair: Pair, friction: float, load: float, creepage: Creepage, cells: int = 64
) -> Sheared:
    """Pressed by a load (N) and rolling at a creepage; `gap` as in `boundary_element.solve`, on
    whose grid the tractions are.

    The contact modulus is G/(1 - nu) of the pair. ValueError: no contact, or the turns do not end.
    """
    modulus = pair.shear_modulus / (1 - pair.poisson)
    deformed = gap
    before: Array = np.full(2, np.inf)
    for _ in range(TURNS):
        patch = solve(deformed, modulus, load=load, cells=cells)
        body = HalfSpaceFriction(patch.x, patch.s, patch.pressure, friction, pair, rolling=True)
        found = body.at(creepage)
        forces = np.array(found.forces[:2])
        if np.linalg.norm(forces - before) <= TOLERANCE * found.limit:
            return found
        deformed, before = _opened(gap, found, pair), forces
    raise ValueError(f"pressure and tractions still change after {TURNS} turns")


def _opened(gap: Gap, found: Sheared, pair: Pair) -> Gap:
    """The gap with what tractions add to it; beside their grid, what they add at its border."""
    influence = TractionInfluence(found.x, found.y, pair, rolling=False)
    added = RegularGridInterpolator((found.x, found.y), influence.opening(found.traction))

    def opened(x: Array, s: Array) -> Array:
        nearest = (np.clip(v, c[0], c[-1]) for v, c in ((x, found.x), (s, found.y)))
        return gap(x, s) + np.asarray(added(np.column_stack(tuple(nearest))))

    return opened
