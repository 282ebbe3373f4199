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

from pydantic import BeforeValidator

from railhead.scene.units import show

UNKNOWN = ("R200", "R220", "R320Cr", "R350HT", "ER6", "ER9")  # known to exist, without data here


MODULI = (180e3, 230e3)  # MPa, of a body that is taken for steel where no yield stress is given


@dataclass(frozen=True)
class Steel:
    """yield_stress: MPa, constant from there on; kind: where it comes from, in a few words; source:
    the publication."""

    yield_stress: float
    kind: str
    source: str


@cache
def known() -> dict[str, Steel]:
    """All steels by name."""
    text = (Path(__file__).parent / "data" / "steels.json").read_text(encoding="utf-8")
    return {name: Steel(**entry) for name, entry in json.loads(text).items()}


def like(modulus: float) -> bool:
    """Whether Young's modulus (MPa) is that of a steel."""
    return MODULI[0] <= modulus <= MODULI[1]


def name() -> BeforeValidator:
    """Return a validator of the name of a steel."""

    def validate(value: object) -> str:
        if isinstance(value, str) and value in known():
            return value
        allowed = f"give {', '.join(known())}"
        if value in UNKNOWN:
            raise ValueError(f"no yield of {value} is known here; {allowed} or yield_stress")
        raise ValueError(f"{show(value)} is not allowed; {allowed}")

    return BeforeValidator(validate)
