"""What measured profiles leave open: how much the answer changes with the length of smoothing.

Half-spaces are solved on profiles smoothed with one and with two lengths. What the noise hides is
of the size of what the second length takes away.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from railhead.geometry import solid
from railhead.planning import developed, exact
from railhead.planning.effects.base import Context
from railhead.scene.scene import SceneError
from railhead.theory.boundary_element import Solution

STRETCH = 2.0  # times the smoothing lengths


@dataclass(frozen=True)
class Uncertainty:
    """Relative, of the largest pressure, the half lengths and the area of the patch, the approach;
    infinite, with a reason, where half-spaces cannot tell."""

    max_pressure: float
    a: float
    b: float
    area: float
    approach: float
    reason: str = ""

    @property
    def largest(self) -> float:
        """Of all of them: no mesh makes the answer surer than that."""
        return max(self.max_pressure, self.a, self.b, self.area, self.approach)

    @property
    def parts(self) -> dict[str, float]:
        """By reported quantity: stresses below the patch are as uncertain as its pressure, the
        depth of the largest one as its width."""
        stresses = ("max_MPa", "tau_max_MPa", "von_mises_max_MPa")
        return {
            **dict.fromkeys(stresses, self.max_pressure),
            "a_mm": self.a, "b_mm": self.b, "tau_max_depth_mm": self.b,
            "area_mm2": self.area, "approach_mm": self.approach,
        }  # fmt: skip


def of_profiles(context: Context) -> Uncertainty | None:
    """None where no profile is measured, and in sections, whose contacts no half-space has."""
    scene, contact = context.scene, context.contact
    if contact.half_space or contact.plane or not solid.measured_bodies(scene):
        return None
    try:
        smoother = solid.locate(scene, STRETCH)
        ellipse = exact.ellipse(scene, smoother)
        other = developed.solve(smoother, ellipse, scene.load)
        found = zip(_values(context.boundary_elements), _values(other), strict=True)
    except (ValueError, SceneError) as error:
        return _unknown(str(error))
    return Uncertainty(*(abs(two / one - 1) for one, two in found))


def _values(solution: Solution) -> tuple[float, ...]:
    main = solution.patches[0]
    half = main.half_extents
    return solution.max_pressure, *half, solution.area, solution.approach


def _unknown(reason: str) -> Uncertainty:
    return Uncertainty(*[math.inf] * 5, reason)
