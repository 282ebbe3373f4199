"""Words for pictures: names of the case, the load, the bodies and the directions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


def _rail_and_wheel() -> Mapping[str, str]:
    """Default names of the bodies in pictures: 'rail' and 'wheel' as they are."""
    return {"rail": "rail", "wheel": "wheel"}


@dataclass(frozen=True)
class Subject:
    """Words for titles, axis labels and legends of pictures.

    title: case, load and pair of profiles; stands above every picture.
    names: name in pictures of each body, by its name in the results ('rail' or 'wheel').
    along: where x runs, for example 'along the rail'.
    across: where s runs, for example 'across the rail'.
    gauge: whether negative s is the gauge side and positive s the field side.
    rolls: whether the wheel rolls, towards positive x.
    rubs: whether the solution has friction.
    revolved: whether the model is a meridian section of bodies of revolution.
    """

    title: str = ""
    names: Mapping[str, str] = field(default_factory=_rail_and_wheel)
    along: str = "along the rail"
    across: str = "across the rail"
    gauge: bool = False
    rolls: bool = False
    rubs: bool = False
    revolved: bool = False

    @property
    def y(self) -> str:
        """Label, with its unit, of the scene's axis y, on which s is projected."""
        return "y, mm" if self.revolved else f"y, {self.across}, mm"

    def label(self, axis: int) -> str:
        """Label, with its unit and direction, of the picture's axis for x (axis 0) or s (axis 1);
        of a meridian section for the radius.
        """
        if self.revolved:
            return "r, from the axis, mm"
        if axis == 0:
            return f"x, {self.along}, mm" + (" (rolls towards +x)" if self.rolls else "")
        return f"s, {self.across}, mm" + ("\n(gauge side < 0 < field side)" if self.gauge else "")
