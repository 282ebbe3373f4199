"""The units in which a reader wants the numbers; files stay in mm, N and MPa."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from railhead.scene.sections import SceneError
from railhead.scene.units import to_reader

ALLOWED = {
    "mm": ("mm", "um", "m", "in"),
    "N": ("N", "kN", "lbf"),
    "MPa": ("MPa", "GPa", "Pa", "ksi", "psi"),
}
_FACTOR = re.compile(r"([A-Za-z]+)(\d?)")


@dataclass(frozen=True)
class Units:
    """Units of displayed numbers; files remain in mm, N and MPa.

    chosen: displayed unit by base unit ("mm", "N", "MPa"); others remain.
    """

    chosen: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def parse(cls, text: str | None) -> Units:
        """Units from a text as "um,kN,GPa", in any order, at most one of each kind; None: base
        units. Raises SceneError.
        """
        chosen: dict[str, str] = {}
        for name in (part.strip() for part in text.split(",")) if text is not None else ():
            base = next((base for base, names in ALLOWED.items() if name in names), None)
            if base is None or base in chosen:
                problem = "is given beside another of its kind" if base else "is not known"
                words = "; ".join(", ".join(names) for names in ALLOWED.values())
                raise SceneError("--units", f"{name!r} {problem}; give at most one each of {words}")
            chosen[base] = name
        return cls(chosen)

    def unit(self, unit: str) -> str:
        """Displayed unit for a product of powers of mm, N and MPa; other units remain."""
        return _FACTOR.sub(lambda each: self.chosen.get(each[1], each[1]) + each[2], unit)

    def value(self, value: float, unit: str) -> float:
        """Value in the displayed unit; unit: that of the argument, powers of mm, N and MPa, of
        which at most one is divided by ("N/mm2"). Other units have no effect.
        """
        over, _, under = unit.partition("/")
        for part, sign in ((over, 1), (under, -1)):
            for name, power in _FACTOR.findall(part):
                if name in self.chosen:
                    value *= to_reader(name, self.chosen[name]) ** (sign * int(power or 1))
        return value

    def text(self, value: float, unit: str) -> str:
        """Value with four digits and its displayed unit."""
        return f"{brief(self.value(value, unit))} {self.unit(unit)}"

    def place(self, point: Sequence[float]) -> str:
        """Text "(x, y, z) mm" of a point (3,), mm, in the displayed unit, four digits each."""
        inside = ", ".join(f"{self.value(each, 'mm'):.4g}" for each in point)
        return f"({inside}) {self.unit('mm')}"

    @property
    def others(self) -> str:
        """Displayed units that differ from the base units, as text; empty where none does."""
        return ", ".join(to for base, to in self.chosen.items() if base != to)


def brief(value: float) -> str:
    """Text of a number with four digits, without a power of ten up to 1e7."""
    rounded = float(f"{value:.4g}") + 0.0  # -0 is 0
    return f"{rounded:.0f}" if 1e4 <= abs(rounded) < 1e7 else f"{rounded:.4g}"
