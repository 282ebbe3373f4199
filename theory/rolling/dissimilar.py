"""Half-spaces of different materials: tractions change the pressure, and the other way round.

Pressure and tractions are solved in turn until neither changes (Panagiotopoulos 1975). Conventions
of `theory.rolling.rolling`; lengths in mm, forces in N.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from railhead.theory.bem.boundary_element import equilibrium
from railhead.theory.bem.influence import Influence
from railhead.theory.bem.patch import PatchSolution
from railhead.theory.rolling.rolling import HalfSpaceFriction, TangentialSolution
from railhead.theory.rolling.tangential import Pair, TractionInfluence

Array = NDArray[np.float64]
TURNS, TOLERANCE = 40, 1e-3  # of the tractions, over mu N
PRESSED = 1e-6  # of the displacement


def solve_dissimilar(
    patch: PatchSolution,
    pair: Pair,
    friction: float,
    shear: Callable[[HalfSpaceFriction], TangentialSolution],
    *,
    rolling: bool,
    modes: Array | None = None,
) -> TangentialSolution:
    """Tractions of a patch of different materials whose pressure depends on the tractions.

    patch: the same contact without friction.
    pair: materials.
    friction: coefficient.
    shear: solves for the tractions at a fixed pressure, e.g. `HalfSpaceFriction.solve`.
    rolling: steady rolling; else one shift that begins from the pressed patch.
    modes: rigid slip (4, 2, nx, ny) of unit creepages, unit spin and the fixed mode; None: a plane.
    The contact modulus is G/(1 - nu) of the pair. ValueError: no convergence in 40 turns.
    """
    modulus = pair.shear_modulus / (1 - pair.poisson)
    influence = TractionInfluence(patch.x, patch.s, pair, rolling=False)
    pressed = Influence([patch], modulus)(patch.pressure.ravel()).reshape(patch.pressure.shape)
    undeformed = patch.gap - pressed + patch.approach * patch.normals[0]
    now, before = patch, np.zeros((2, *patch.pressure.shape))
    for _ in range(TURNS):
        body = HalfSpaceFriction(
            now.x, now.s, now.pressure, friction, pair,
            rolling=rolling, modes=modes, settled=None if rolling else patch.pressure,
        )  # fmt: skip
        found = shear(body)
        changed = np.linalg.norm(found.traction - before, axis=0).sum() * found.cell
        if not pair.mismatch or changed <= TOLERANCE * found.limit:
            return found
        gap, before = undeformed + influence.opening(found.traction), found.traction
        (now,) = equilibrium([patch], [gap], modulus, patch.load, None, PRESSED, None)
    raise ValueError(f"pressure and tractions still change after {TURNS} turns")
