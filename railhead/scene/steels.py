"""Steels by name: at which stress they yield, and how they harden (data/steels.json, with sources).

EN 13674-1 fixes strength and hardness of rail steels, not their yield: only what was measured is
here. EN 13262 does fix the least yield strength of wheels.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from pydantic import BeforeValidator

from railhead.scene.units import show

UNKNOWN = ("R200", "R220", "R320Cr", "R350HT", "ER6", "ER9")  # known to exist, without data here


@dataclass(frozen=True)
class Steel:
    """curve: plastic strain and true stress (MPa), a point each, constant after the last; kind:
    'measured' or 'specified minimum'; source: of both."""

    curve: tuple[tuple[float, float], ...]
    kind: str
    source: str


@cache
def known() -> dict[str, Steel]:
    """All steels by name."""
    text = (Path(__file__).parent / "data" / "steels.json").read_text(encoding="utf-8")
    return {
        name: Steel(tuple(map(tuple, entry["curve"])), entry["kind"], entry["source"])
        for name, entry in json.loads(text).items()
    }


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
