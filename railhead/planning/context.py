"""Decisions on effects: what they are made from, each one, and the verdict of the solution."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from railhead.contact.dimension import Dimension
from railhead.contact.solid import Contact
from railhead.planning.references import boundary_elements, closed_forms
from railhead.scene.scene import Scene, SceneError
from railhead.theory.bem import grid_stress
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.elastic import contacts
from railhead.theory.elastic.contacts import Hertz
from railhead.theory.elastic.line import LineContact

DEFAULT_ACCURACY = 0.01  # of a scene without a prescribed one


@dataclass(frozen=True)
class Effect:
    """Decision on a physical effect or a simplification.

    called_for: the scene needs it.
    on: it is simulated.
    why: the indicator and its limit, as a sentence.
    refused: by state ("on", "off"), the reason why a person cannot choose that state.
    error: relative error that the state adds to every quantity, 0 where it is not known.
    override: a person chose the state.
    """

    called_for: bool
    on: bool
    why: str
    refused: Mapping[str, str] = field(default_factory=dict)
    error: float = 0.0
    override: bool = False

    def forced(self, name: str, state: str) -> Effect:
        """The effect in the state that a person chose; SceneError where it cannot be had."""
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

    def summary(self) -> dict[str, Any]:
        """As in summary.json."""
        keys = ("called_for", "on", "override", "why")
        return {key: getattr(self, key) for key in keys}


@dataclass(frozen=True)
class Context:
    """What effects are decided by.

    dimension: solid, or a section in two dimensions.
    contact: first contact of the undeformed bodies.
    hertz: exact Hertz contact with the curvatures there.
    decided: the effects that come earlier in `effects.EFFECTS`, by name.
    """

    scene: Scene
    dimension: Dimension
    contact: Contact
    hertz: Hertz
    decided: Mapping[str, Effect]

    @cached_property
    def boundary_elements(self) -> Solution:
        """Of the undeformed pair under the load or approach of the scene; ValueError where they
        find no closed patch."""
        return boundary_elements.solve(self.contact, self.hertz, self.scene.load)

    @cached_property
    def hertzian(self) -> bool:
        """Whether exact Hertz tells the patch: between half-spaces and in sections by definition,
        else where the exact gap over the patch is his."""
        contact, hertz = self.contact, self.hertz
        if contact.plane or contact.half_space or isinstance(hertz, LineContact):
            return True
        return closed_forms.gap_is_quadratic(contact, hertz)

    @cached_property
    def elastic(self) -> Solution | str:
        """Boundary elements where the patch is not Hertz's; else text, empty where it is his, or
        the reason why boundary elements find no closed patch."""
        if self.hertzian:
            return ""
        try:
            return self.boundary_elements
        except ValueError as error:
            return str(error)

    def von_mises(self, poisson: float) -> float:
        """Largest elastic von Mises stress (MPa) below the contact: from the pressure of the
        boundary elements, or exact Hertz's without them."""
        if isinstance(self.elastic, str):
            return contacts.axis_extrema(self.hertz, poisson).von_mises_max
        return max(grid_stress.largest_von_mises(each, poisson) for each in self.elastic.patches)

    @property
    def accuracy(self) -> float:
        """Relative error that effects may add before they are called for."""
        accuracy = self.scene.accuracy
        return DEFAULT_ACCURACY if accuracy is None else accuracy


@dataclass(frozen=True)
class PostSolveVerdict:
    """The indicator of an effect, evaluated on the solution.

    needed: the effect matters but was not simulated.
    why: the indicator and its limit, as a sentence.
    notable: shown beside the result although no effect that the scene calls for was left out.
    """

    needed: bool
    why: str
    notable: bool = False
