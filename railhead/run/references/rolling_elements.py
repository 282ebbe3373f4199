"""Boundary elements at the motion, or under the forces, that finite elements found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from railhead.run.references.rolling_patches import Patch
from railhead.theory.rolling import dissimilar
from railhead.theory.rolling.prescribed_forces import solve_for_forces
from railhead.theory.rolling.rolling import Creepage, HalfSpaceFriction, TangentialSolution
from railhead.theory.rolling.tangential import Pair

if TYPE_CHECKING:
    from railhead.solver.solution import FrictionSolution

Array = NDArray[np.float64]
LIKE = 1e-9  # |K/G| that is rounding
SEVERAL = "how several patches share a force depends on the compliance of the bodies"

Opinion = dict[str, float]


@dataclass(frozen=True)
class Asked:
    """What was found, and its coefficient, materials and kind; shifts: whether the shift is one of
    half-spaces (other bodies shift with all that holds them)."""

    found: FrictionSolution
    friction: float
    pair: Pair
    rolling: bool
    shifts: bool

    @property
    def like(self) -> bool:
        """Whether tractions leave the pressure alone."""
        return abs(self.pair.mismatch) < LIKE


def opinion(
    asked: Asked, patches: Callable[[int], Sequence[Patch]], cells: tuple[int, int]
) -> Opinion:
    """Of patches on the finer grid; of unlike bodies, whose error is of first order, extrapolated
    from both, with what that changes ("grid_error", over mu N or the shift). ValueError: not known.
    """
    coarse, fine = cells
    found = _on_grid(asked, patches(fine))
    if asked.like:
        return found
    other = _on_grid(asked, patches(coarse))
    better = {name: 2 * value - other[name] for name, value in found.items()}
    better["stick_share"] = min(max(better["stick_share"], 0.0), 1.0)
    ways = ("shift_along_mm", "shift_across_mm")
    size = float(np.linalg.norm([better.get(way, 0.0) for way in ways]))
    if asked.rolling:
        ways, size = ("force_along_N", "force_across_N"), asked.found.friction_limit
    changes = [abs(better[way] - found[way]) for way in ways if way in found]
    return {**better, "grid_error": max(changes, default=0.0) / (size or 1.0)}


def named(forces: Array, stick: float) -> Opinion:
    """Forces and moment (3,) by the names of "friction" in summary.json."""
    along, across, moment = forces
    return {
        "force_along_N": float(along), "force_across_N": float(across),
        "moment_Nmm": float(moment), "stick_share": float(stick),
    }  # fmt: skip


def _on_grid(asked: Asked, patches: Sequence[Patch]) -> Opinion:
    if len(patches) > 1 and not asked.rolling:
        raise ValueError(SEVERAL)
    found, limit = asked.found, asked.friction * sum(each.pressed.force for each in patches)
    scale = found.friction_limit / limit  # the normal forces differ by what the finite bodies do
    along, across = (force / scale for force in found.force)

    def shear(body: HalfSpaceFriction) -> TangentialSolution:
        if asked.rolling:
            return body.solve(Creepage(*found.rigid_motion))
        return solve_for_forces([body], Creepage(), along=along, across=across)[0]

    sheared = [
        dissimilar.solve_dissimilar(
            each.pressed, asked.pair, asked.friction, shear,
            rolling=asked.rolling, modes=each.modes,
        )
        for each in patches
    ]  # fmt: skip
    forces = scale * np.sum([each.forces for each in sheared], axis=0)
    sticks, touches = np.sum([each.areas for each in sheared], axis=0)
    largest = max(float(np.linalg.norm(each.traction, axis=0).max()) for each in sheared)
    out = named(forces, sticks / touches) | {"traction_max_MPa": largest}
    if asked.rolling and asked.like:
        out["t_gamma_N"] = scale * sum(each.t_gamma for each in sheared)
    elif asked.shifts:
        shift = sheared[0].creepage
        out |= {"shift_along_mm": scale * shift.along, "shift_across_mm": scale * shift.across}
    return out
