"""Decisions on effects: what they are made from, each one, and the verdict of the solution."""

from __future__ import annotations

import math
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from railhead.contact import wheelset_kinematics
from railhead.contact.plane_section import Dimension
from railhead.contact.solid import Contact
from railhead.contact.wheelset_kinematics import WheelsetCreepage
from railhead.half_spaces import allowance
from railhead.half_spaces.allowance import Allowance
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.meshing.bodies import BODY_NAMES
from railhead.scene.scene import Rail, Scene, SceneError, Wheel
from railhead.theory.elastic.line import Hertz
from railhead.theory.friction import tangential

STIFFEST = 1e5  # largest ratio of both moduli in a mesh; balance of forces failed at 7e6
DEFAULT_ACCURACY = 0.01  # accuracy of a scene that prescribes none


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
        cached, such as boundary elements, depends on no effect and is kept, but for errors.
        """
        other = copy(self)
        object.__setattr__(other, "decided", {**self.decided, name: effect})
        vars(other).pop("half_space_errors", None)
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
    def tangential_pair(self) -> tangential.MaterialPair:
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

    @cached_property
    def twist_change(self) -> float:
        """Relative change of the largest pressure or of the area, the larger one, as the load
        twists the rail, as of `allowance.moved`.
        """
        angle = allowance.twist(self.contact, self.hertz)
        return allowance.moved(self.half_spaces, angle, allowance.CENTRE * angle)

    @cached_property
    def sideways_change(self) -> float:
        """The same as the side force of the contact moves the rail head (`allowance.sideways`)."""
        return allowance.moved(self.half_spaces, 0.0, allowance.sideways(self.contact, self.hertz))

    @cached_property
    def half_space_errors(self) -> dict[str, Allowance]:
        """Differences between half-spaces and finite bodies by "max_MPa" and "area_mm2", relative,
        before anything is meshed, by boundary elements. For solids that end only. Raises ValueError
        where these find no closed patch, also after the twist of the rail.
        """
        decided = {tag: self.decided[f"deformable_{name}"] for tag, name in BODY_NAMES.items()}
        tags = [tag for tag, each in decided.items() if each.on]
        return allowance.allowance(self.half_spaces, tags, self.twist_change)

    @cached_property
    def wheelset(self) -> WheelsetCreepage:
        """Creepage of the wheel from its wheelset. Raises SceneError where there is none."""
        return wheelset_kinematics.wheelset_creepage(self.contact)

    @cached_property
    def von_mises(self) -> dict[str, float]:
        """Largest von Mises stress, MPa, of both bodies as half-spaces, elastic and frictionless,
        by 'rail' and 'wheel'.
        """
        bodies = self.scene.bodies.items()
        return {name: self.half_spaces.von_mises(part.poisson_ratio) for name, part in bodies}

    @property
    def yielding(self) -> dict[str, Rail | Wheel]:
        """Those of `stressed` that have a yield stress, whether or not they reach it."""
        return {name: part for name, part in self.stressed.items() if part.yields}

    @property
    def over_yield(self) -> float:
        """Largest ratio of the von Mises stress of half-spaces, elastic and frictionless, to the
        yield stress of a body; 1 where no body has one.
        """
        ratios = (self.von_mises[name] / part.first_yield for name, part in self.yielding.items())
        return max(ratios, default=1.0)

    @cached_property
    def overload(self) -> float:
        """Load over that of first yield of elastic half-spaces without friction; 1 where no body
        has a yield stress.
        """
        parts = self.yielding.values()
        return self.half_spaces.overload([(part.poisson_ratio, part.first_yield) for part in parts])

    @property
    def accuracy(self) -> float:
        """Relative error that effects may add before they are called for: the accuracy of the
        scene, or 0.01 (DEFAULT_ACCURACY).
        """
        return self.scene.accuracy or DEFAULT_ACCURACY


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
