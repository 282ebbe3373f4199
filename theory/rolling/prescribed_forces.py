"""Tangential forces are prescribed: the creepage or shift that several patches share follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from railhead.theory.rolling.rolling import Creepage, HalfSpaceFriction, TangentialSolution

Array = NDArray[np.float64]
STEPS, TOLERANCE = 40, 1e-6  # over mu N


def solve_for_forces(
    bodies: Sequence[HalfSpaceFriction],
    creepage: Creepage,
    *,
    along: float | None = None,
    across: float | None = None,
    start: Sequence[TangentialSolution] | None = None,
) -> list[TangentialSolution]:
    """Tractions of patches that share one rigid motion and together carry prescribed forces.

    along, across: prescribed force of all patches, N; None where the creepage is prescribed.
    creepage: prescribed motion; where a force is prescribed, its component is an unknown.
    start: solutions of similar patches with the same forces, at whose motion Newton's method
        begins; None: no motion, where all sticks.
    The forces are met to 1e-6 mu N. The force is concave in its
    creepage, and a step that does not reduce the residual is halved. ValueError: forces of mu N or
    more, or no convergence.
    """
    goals = {k: force for k, force in enumerate((along, across)) if force is not None}
    free, target = list(goals), np.array(list(goals.values()))
    values = np.array(astuple(creepage))
    values[free] = 0.0 if start is None else np.array(astuple(start[0].creepage))[free]
    begins: Sequence[TangentialSolution | None] = start or [None] * len(bodies)
    motion = Creepage(*values)
    now = [body.solve(motion, begin) for body, begin in zip(bodies, begins, strict=True)]
    limit = sum(each.limit for each in now)
    if not np.linalg.norm(target) < limit:
        raise ValueError(f"the force must be below mu N = {limit} N, got {target}")
    missing = target - _forces(now)[free]
    for _ in range(STEPS):
        if np.linalg.norm(missing) <= TOLERANCE * limit:
            return now
        pairs = zip(bodies, now, strict=True)
        stiffness = np.sum([body.stiffness(each) for body, each in pairs], axis=0)
        step = np.linalg.lstsq(stiffness[np.ix_(free, free)], missing, rcond=None)[0]
        share = 1.0
        while True:
            trial = values.copy()
            trial[free] += share * step
            motion = Creepage(*trial)
            then = [body.solve(motion, each) for body, each in zip(bodies, now, strict=True)]
            left = target - _forces(then)[free]
            if np.linalg.norm(left) < np.linalg.norm(missing) or share < 1e-6:
                break
            share /= 2
        values, now, missing = trial, then, left
    raise ValueError(f"no creepage found under the forces {target} N")


def _forces(found: Sequence[TangentialSolution]) -> Array:
    """Force along (N), force across (N) and moment (N mm) of all patches together, (3,)."""
    return np.sum([each.forces for each in found], axis=0)
