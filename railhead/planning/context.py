"""Decisions on effects: what they are made from, each one, and the verdict of the solution."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from railhead.contact import closed_forms
from railhead.contact.plane_section import Dimension
from railhead.contact.solid import Contact
from railhead.half_spaces import allowance
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.scene.scene import Rail, Scene, SceneError, Wheel
from railhead.theory.bem import grid_stress
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic.line import Hertz
from railhead.theory.friction import tangential
from railhead.theory.friction.tangential import MaterialPair

STIFFEST = 1e5  # largest ratio of both moduli in a mesh; balance of forces failed at 7e6
DEFAULT_ACCURACY = 0.01  # accuracy of a scene that prescribes none
YIELD_FOUND = 3e-3  # relative error of the load of first yield at which its search ends
MOST_LOADS = 5  # of that search
MARGIN = 1.1  # factor on the patch in which radii are compared
HERTZ = 0.02  # largest deviation from Hertz's gap, over the approach, for exact Hertz as forecast
STRAIGHT = 1e-9  # 1/mm, change of a curvature by rounding


@dataclass(frozen=True)
class Effect:
    """Decision on a physical effect or a simplification.
    called_for: the scene needs the effect.
    on: the effect is simulated (a simplification: it is used).
    why: the indicator and its limit, as a sentence.
    refused: by state ('on', 'off'), the reason why a person cannot choose that state.
    error: relative error that the present state adds to every quantity; 0 also where it is not
        known.
    override: a person chose the state.
    """

    called_for: bool
    on: bool
    why: str
    refused: Mapping[str, str] = field(default_factory=dict)
    error: float = 0.0
    override: bool = False

    def forced(self, name: str, state: str) -> Effect:
        """The effect in the state 'on' or 'off' that a person chose; unchanged for 'auto'. Its
        error is then 0, unless the plan had chosen that state too. Raises SceneError for the
        effect's name where the state is refused.
        """
        if state == "auto":
            return self
        if state in self.refused:
            other = "off" if state == "on" else "on"
            raise SceneError(
                f"effects.{name}",
                f"{state!r} is not allowed: {self.refused[state]}; give auto or {other}",
            )
        on = state == "on"
        error = self.error if on == self.on else 0.0
        return replace(
            self, on=on, override=True, error=error, why=f"{self.why}; {state} by effects.{name}"
        )

    @classmethod
    def absent(cls, why: str) -> Effect:
        """An effect that a scene does not call for and that a person cannot switch on."""
        return cls(False, False, why, {"on": why})

    def summary(self) -> dict[str, Any]:
        """called_for, on, override and why, by name, as in summary.json."""
        return {key: getattr(self, key) for key in ("called_for", "on", "override", "why")}


@dataclass(frozen=True, kw_only=True)
class Context:
    """Data from which effects are decided.
    scene: the scene.
    dimension: solid, or a section in two dimensions.
    contact: first contact of the undeformed bodies.
    hertz: exact Hertz contact with the curvatures at first contact, under the load or approach of
        the scene; its load is the normal force.
    decided: the effects by name: while an effect is decided, those that come earlier in
        `effects.EFFECTS`, afterwards all.
    """

    scene: Scene
    dimension: Dimension
    contact: Contact
    hertz: Hertz
    decided: Mapping[str, Effect]

    def with_decision(self, name: str, effect: Effect) -> Context:
        """The context in which the named effect is decided otherwise, all others as here. What is
        cached, such as boundary elements, depends on no effect and is kept.
        """
        other = copy(self)
        object.__setattr__(other, "decided", {**self.decided, name: effect})
        return other

    @property
    def deformable(self) -> dict[str, Rail | Wheel]:
        """Tables of the scene of the bodies that deform, by 'rail' and 'wheel'."""
        return {
            name: part
            for name, part in self.scene.bodies.items()
            if self.decided[f"deformable_{name}"].on
        }

    @property
    def stressed(self) -> dict[str, Rail | Wheel]:
        """Tables of the scene of the bodies that have stresses, by 'rail' and 'wheel': those of a
        finite modulus, without one that a person made rigid.
        """
        bodies = self.scene.bodies.items()
        decided = {name: self.decided[f"deformable_{name}"] for name, _ in bodies}
        soft = {name: part for name, part in bodies if math.isfinite(part.young_modulus)}
        chosen = {name for name, each in decided.items() if each.called_for and not each.on}
        return {name: part for name, part in soft.items() if name not in chosen}

    @property
    def young_moduli(self) -> dict[str, float]:
        """Young's moduli as simulated, MPa, by 'rail' and 'wheel': infinite of a body that does not
        deform beside one that does, and at most 1e5 (STIFFEST) times that of the other body, as
        rounding of a larger one drowns the forces. Half-spaces in the place of finite bodies have
        those of the scene.
        """
        bodies, deform = self.scene.bodies, self.deformable
        moduli = {name: part.young_modulus for name, part in bodies.items()}
        if not (deform and self.decided["finite_bodies"].on):
            return moduli
        most = STIFFEST * min(moduli.values())
        return {name: min(moduli[name], most) if name in deform else math.inf for name in bodies}

    @property
    def tangential_pair(self) -> MaterialPair:
        """Shear modulus (MPa), Poisson's ratio and mismatch of both materials as simulated,
        combined for tangential contact.
        """
        rail, wheel, young = self.scene.rail, self.scene.wheel, self.young_moduli
        return tangential.pair(
            young["wheel"], wheel.poisson_ratio, young["rail"], rail.poisson_ratio
        )

    @cached_property
    def half_spaces(self) -> HalfSpacePair:
        """Both bodies as half-spaces, which remember what was solved."""
        return HalfSpacePair(self.contact, self.hertz)

    @property
    def boundary_elements(self) -> BoundaryElementSolution:
        """Boundary-element solution, elastic and frictionless, for the profiles of the scene under
        its load or, without one, at its approach.
        Raises ValueError where there is no closed patch, and for half-spaces.
        """
        return self.half_spaces.pressed(self.scene.load)

    @cached_property
    def twist_change(self) -> float:
        """Relative change of the largest pressure or of the area, the larger one, as the load
        twists the rail. It is 0 for a block, a rigid rail, a contact in the plane of symmetry and
        one radius each.
        Raises ValueError where boundary elements cannot tell.
        """
        angle = allowance.twist(self.contact, self.hertz)
        return self._moved(angle, allowance.CENTRE * angle)

    @cached_property
    def sideways_change(self) -> float:
        """The same as the side force of the contact moves the rail head (`allowance.sideways`)."""
        return self._moved(0.0, allowance.sideways(self.contact, self.hertz))

    def _moved(self, angle: float, aside: float) -> float:
        """The same where the rail head turns by `angle` (rad) and moves by -aside (mm)."""
        rail = self.scene.rail
        still = not (angle or aside) or rail.profile == "arc" or bool(rail.sections)
        if still or self.one_radius or self.contact.why_asymmetric_in_y() is None:
            return 0.0
        return allowance.change(self.half_spaces, self.boundary_elements, angle, aside)

    @property
    def one_radius(self) -> bool:
        """Whether each body has one radius across 1.1 (MARGIN) times Hertz's patch; also between
        half-spaces and in sections.
        """
        touch, reach = self.contact.touch, MARGIN * self.hertz.b
        y = touch.y + reach * math.cos(touch.angle) * np.array([-1.0, 0.0, 1.0])
        curvatures = [each.curvature(y - shift) for _, each, shift in self.contact.cross_profiles]
        return not self.contact.curved_solid or float(np.ptp(curvatures, axis=1).max()) < STRAIGHT

    @cached_property
    def gap_deviation(self) -> float:
        """Largest deviation of the gap over the patch from Hertz's parabola, over the approach
        (`closed_forms.gap_deviation`); 0 between half-spaces and in sections.
        """
        curved = self.contact.curved_solid
        return closed_forms.gap_deviation(self.contact, self.hertz) if curved else 0.0

    @cached_property
    def elastic(self) -> BoundaryElementSolution | str:
        """Boundary-element solution where the gap differs from Hertz's parabola by 2 % (HERTZ) or
        more; else text: empty, as exact Hertz gives the patch before anything is solved, or the
        reason why boundary elements find no closed patch.
        """
        if self.gap_deviation < HERTZ:
            return ""
        try:
            return self.boundary_elements
        except ValueError as error:
            return str(error)

    def von_mises(self, poisson: float) -> float:
        """Largest von Mises stress (MPa) in a half-space under the contact pressure, elastic and
        frictionless, for a Poisson's ratio.
        The stress follows from the pressure of the boundary elements, or from exact Hertz where
        these are not used.
        """
        if poisson not in self._largest:
            self._largest[poisson] = (
                self.hertz.axis_extrema(poisson).von_mises_max
                if isinstance(self.elastic, str)
                else _von_mises(self.elastic, poisson)
            )
        return self._largest[poisson]

    @cached_property
    def overload(self) -> float:
        """Load over that of first yield of elastic half-spaces without friction; 1 where no body
        has a yield stress. Hertz's stresses grow as the cube root of the load, in a line contact as
        the square root. Where the patch is not Hertz's, the load of first yield is found by
        boundary elements, to 0.3 % (YIELD_FOUND).
        """
        power, load, now = 1 / self.contact.load_power, self.scene.load, self.elastic
        over, share = math.log(self.over_yield), 0.0
        for _ in range(MOST_LOADS):
            if isinstance(now, str) or load is None or abs(over) < power * YIELD_FOUND:
                break
            last, share = (share, over), share - over / power
            now = self.half_spaces.pressed(load * math.exp(share))
            over = math.log(self._over_yield(partial(_von_mises, now)))
            power = (last[1] - over) / (last[0] - share)
        return math.exp(over / power - share)

    @property
    def over_yield(self) -> float:
        """Largest ratio of von Mises stress, as of `von_mises`, to the yield stress of a body; 1
        where no body has one.
        """
        return self._over_yield(self.von_mises)

    def _over_yield(self, stress: Callable[[float], float]) -> float:
        """`over_yield` of stresses: `stress` gives von Mises, MPa, by Poisson's ratio."""
        yields = (part for part in self.stressed.values() if part.yields)
        ratios = [stress(part.poisson_ratio) / part.first_yield for part in yields]
        return max(ratios, default=1.0)

    @cached_property
    def _largest(self) -> dict[float, float]:
        """Cache of `von_mises`, MPa, by Poisson's ratio; empty at first."""
        return {}

    @property
    def accuracy(self) -> float:
        """Relative error that effects may add before they are called for: the accuracy of the
        scene, or 0.01 (DEFAULT_ACCURACY).
        """
        return self.scene.accuracy or DEFAULT_ACCURACY


def _von_mises(pressed: BoundaryElementSolution, poisson: float) -> float:
    """Largest von Mises stress, MPa, in a half-space under a pressure, for a Poisson's ratio."""
    return max(grid_stress.largest_von_mises(each, poisson) for each in pressed.patches)


@dataclass(frozen=True)
class PostSolveVerdict:
    """Indicator of an effect or an assumption, evaluated on the solution.

    needed: of an effect, it matters but was not simulated; of an assumption, it does not hold.
    why: the indicator and its limit, as a sentence.
    notable: shown beside the result although `needed` is false.
    """

    needed: bool
    why: str
    notable: bool = False
