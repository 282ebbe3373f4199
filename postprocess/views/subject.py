"""What a picture is of, in words: case, load, bodies and directions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


def _rail_and_wheel() -> Mapping[str, str]:
    return {"rail": "rail", "wheel": "wheel"}


@dataclass(frozen=True)
class Subject:
    """title: case, load and pair, above every picture; names: of the bodies by the scene's; along,
    across: where x and s run; gauge: negative s is the gauge side; rolls: towards positive x;
    rubs: with friction; revolved: a meridian section."""

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
        """Of the axis of the scene that s is projected on."""
        return "y, mm" if self.revolved else f"y, {self.across}, mm"

    def label(self, axis: int) -> str:
        """Of an axis of x (0) or s (1)."""
        if self.revolved:
            return "r, from the axis, mm"
        if axis == 0:
            return f"x, {self.along}, mm" + (" (rolls towards +x)" if self.rolls else "")
        return f"s, {self.across}, mm" + ("\n(gauge side < 0 < field side)" if self.gauge else "")
