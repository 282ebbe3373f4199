"""What all effects share: the decision before the solve and the finding after it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from railhead.contact.dimension import Dimension
from railhead.contact.solid import Contact
from railhead.geometry.profiles import Profile
from railhead.planning.references import boundary_elements, closed_forms
from railhead.scene.scene import Scene, SceneError
from railhead.theory.bem import grid_stress
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.elastic import contacts
from railhead.theory.elastic.contacts import Hertz
from railhead.theory.elastic.line import LineContact

if TYPE_CHECKING:
    from railhead.planning.plan import Plan
    from railhead.postprocess.findings import Findings
    from railhead.solver.setup import Setup

DEFAULT_ACCURACY = 0.01  # that a scene without an asked accuracy is held to


@dataclass(frozen=True)
class Effect:
    """A physical effect or a simplification: called for by the scene, on, and why.

    override: a person chose the state. refused: by state ("on", "off"), why it cannot be chosen.
    error: relative error that the state adds to the answer, as far as it is known.
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
    """What effects are decided by: the scene, its dimension, first contact and exact Hertz;
    decided: the effects before it in the list."""

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
        return closed_forms.parabolic(contact, hertz)

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
        """What indicators are weighed against."""
        asked = self.scene.accuracy
        return asked if asked is not None else DEFAULT_ACCURACY


@dataclass(frozen=True)
class Feature:
    """An effect: how it is decided, how the same indicator is weighed on the solution (None where
    it does not apply), and what it changes in what is solved where it is on; alike: the exact
    answer is the same without it; beyond: half-spaces beside the result do not have it either."""

    decide: Callable[[Context], Effect]
    check: Callable[[Context, Effect, Findings], After | None] = lambda *_: None
    apply: Callable[[Setup, Plan], Setup] = lambda setup, _: setup
    alike: bool = False
    beyond: bool = False


@dataclass(frozen=True)
class After:
    """The same indicator on the solution. needed: the effect is, but was left out; notable: it is
    said beside the result although nothing that the scene calls for was left out."""

    needed: bool
    why: str
    notable: bool = False


def touching(contact: Contact) -> list[tuple[str, Profile, float]]:
    """Body, profile and its offset across the track (mm); empty for half-spaces."""
    return [(body, *profile) for body, profile in contact.profiles.items()]
