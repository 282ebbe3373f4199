"""Half-spaces cut to blocks whose outer faces follow the exact displacement."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from numpy.typing import NDArray

from railhead.meshing.tags import RAIL
from railhead.planning import exact
from railhead.planning.effects.base import Context, Effect
from railhead.theory import contacts

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
        """(load N, RAIL or WHEEL, points (n, 3) mm) -> (n, 3) mm; the wheel is the mirror image."""
        hertz = exact.estimate(self.plan.scene, self.plan.contact, load)
        part = self.plan.material(body)
        mirror = [1.0, 1.0, 1.0 if body == RAIL else -1.0]
        lower = points * mirror
        lower[:, 2] = lower[:, 2].clip(max=0.0)
        constants = part.young_modulus, part.poisson_ratio
        return contacts.displacement(hertz, lower, *constants) * mirror
