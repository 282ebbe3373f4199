"""Steels by name: the stress at which they begin to yield (data/steels.json, with sources).

EN 13674-1 fixes strength and hardness of rail steels, not their yield: R260's was measured.
EN 13262 fixes the least yield strength of wheels. No hardening: no flow curve with a source was at
hand.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from railhead.scene.units import show

# steels of the standards without yield data here:
WITHOUT_DATA = ("R200", "R220", "R320Cr", "R350HT", "ER6", "ER9")
STEEL_MODULI = (180e3, 230e3)  # MPa, least and largest Young's modulus of a steel


@dataclass(frozen=True)
class Steel:
    """A steel without hardening.

    yield_stress: MPa, at any plastic strain.
    kind: where the value comes from, in a few words.
    source: the publication.
    """

    yield_stress: float
    kind: str
    source: str


@cache
def by_name() -> dict[str, Steel]:
    """The steels of data/steels.json by name, read once."""
    text = (Path(__file__).parent / "data" / "steels.json").read_text(encoding="utf-8")
    return {name: Steel(**entry) for name, entry in json.loads(text).items()}


def is_steel(modulus: float) -> bool:
    """Whether a Young's modulus (MPa) lies in the range of steels, 180 to 230 GPa."""
    return STEEL_MODULI[0] <= modulus <= STEEL_MODULI[1]


def checked_name(value: object) -> str:
    """The argument, if it is the name of a steel in data/steels.json. Raises ValueError (one line)
    for anything else.
    """
    if isinstance(value, str) and value in by_name():
        return value
    allowed = f"give {', '.join(by_name())}"
    if value in WITHOUT_DATA:
        raise ValueError(f"no yield of {value} is known here; {allowed} or yield_stress")
    raise ValueError(f"{show(value)} is not allowed; {allowed}")
