"""Half-spaces cut to blocks whose outer faces follow the exact displacement."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from railhead.meshing.tags import RAIL
from railhead.planning.effects.base import Context, Effect
from railhead.planning.references import closed_forms
from railhead.theory.elastic import contacts, halfspace

if TYPE_CHECKING:
    from railhead.planning.plan import Plan
    from railhead.solver.setup import Setup


def decide(context: Context) -> Effect:
    """Called for by rail.extent = half-space."""
    if context.contact.half_space:
        return Effect(True, True, "rail.extent = half-space: what lies beyond the blocks deforms")
    why = "the bodies end where they really end"
    return Effect(False, False, why, {"on": f"rail.extent is {context.scene.rail.extent}"})


def apply(setup: Setup, plan: Plan) -> Setup:
    """The far field is that of a load, so the load is what is given."""
    return replace(setup, far_field=HertzFarField(plan), load_control=True)


@dataclass(frozen=True)
class HertzFarField:
    """Displacement of both half-spaces under the Hertz pressure of a load (see `theory`)."""

    plan: Plan

    def __call__(self, load: float, body: int, points: NDArray) -> NDArray:
        """(load N, RAIL or WHEEL, points (n, 3) mm) -> (n, 3) mm."""
        hertz = closed_forms.estimate(self.plan.scene, self.plan.contact, load)
        part, (lower, mirror) = self.plan.material(body), mirrored(body, points)
        constants = part.young_modulus, part.poisson_ratio
        return contacts.displacement(hertz, lower, *constants) * mirror


@dataclass(frozen=True)
class CerrutiFarField:
    """The same under a tangential point force of 1 N of the wheel on the rail, in the place of the
    tractions."""

    plan: Plan

    def __call__(self, way: int, body: int, points: NDArray) -> NDArray:
        """(0 along or 1 across, RAIL or WHEEL, points (n, 3) mm) -> (n, 3) mm."""
        part, (lower, mirror) = self.plan.material(body), mirrored(body, points)
        constants = part.young_modulus, part.poisson_ratio
        force = mirror[2]  # the rail's on the wheel is the opposite one
        moved = halfspace.cerruti_displacement(lower, force, *constants, across=way == 1)
        return moved * mirror


def mirrored(body: int, points: NDArray) -> tuple[NDArray, NDArray]:
    """Points (n, 3) of a body as those of the half-space z <= 0, mm, and the signs (3,) that turn
    back what is found there: the wheel is the mirror image."""
    mirror = np.array([1.0, 1.0, 1.0 if body == RAIL else -1.0])
    lower = points * mirror
    lower[:, 2] = lower[:, 2].clip(max=0.0)
    return lower, mirror
