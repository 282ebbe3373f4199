"""Patches that share one motion, under given forces: the creepage or shift that makes them up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from railhead.theory.rolling.rolling import Creepage, HalfSpaceFriction, Sheared

Array = NDArray[np.float64]
STEPS, TOLERANCE = 40, 1e-6  # over mu N


def under(
    bodies: Sequence[HalfSpaceFriction],
    creepage: Creepage,
    *,
    along: float | None = None,
    across: float | None = None,
) -> list[Sheared]:
    """The tractions of patches that share a motion and together make up forces, N; each given one
    is met to 1e-6 mu N by its creepage in place of that of `creepage`.

    Newton's method from where all sticks; the force is concave in its creepage, and the steps
    are halved where they do not come nearer. ValueError: forces of mu N or more.
    """
    goals = {k: force for k, force in enumerate((along, across)) if force is not None}
    free, target = list(goals), np.array(list(goals.values()))
    values = np.array(astuple(creepage))
    values[free] = 0.0
    now = [body.at(Creepage(*values)) for body in bodies]
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
            then = [body.at(motion, each) for body, each in zip(bodies, now, strict=True)]
            left = target - _forces(then)[free]
            if np.linalg.norm(left) < np.linalg.norm(missing) or share < 1e-6:
                break
            share /= 2
        values, now, missing = trial, then, left
    raise ValueError(f"no creepage found under the forces {target} N")


def _forces(found: Sequence[Sheared]) -> Array:
    return np.sum([each.forces for each in found], axis=0)
