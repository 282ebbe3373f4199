"""What leaving friction out changes, and the hardest places under full sliding."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import railhead as rh
from railhead.theory.elastic.contacts import Hertz, half_lengths
from railhead.theory.friction import sliding

COEFFICIENT, POISSON = 0.3, 0.3
SLIDES = 0.5  # creepage under which all slips
COARSE: dict[str, Any] = {"mesh": {"patch_size": 0.87}}  # four elements a semi-axis
HALF_SPACE: dict[str, Any] = {"rail": {"extent": "half-space", "width": 70.0}}
RIGID: dict[str, Any] = {"young_modulus": math.inf}
SCENES: tuple[tuple[str, dict[str, Any], float], ...] = (
    ("long_roller", {}, 4e-4),
    ("long_roller", {}, 1.5e-3),
    ("long_roller", {}, 1e-2),
    ("hertz_ellipse", COARSE, 1e-3),
    ("hertz_ellipse", COARSE, 1e-2),
    ("hertz_ellipse", {**COARSE, "wheel": RIGID}, 1e-3),
)
STRIP, SLIDING = (0.1, 0.2, 0.3, 0.4, 0.5), (0.1, 0.3, 0.5)  # coefficients of sections and solids
EXACT = tuple(float(mu) for mu in np.linspace(0, 0.6, 13))


JUDGED = {
    "pressure": ("pressure", "max_MPa"),
    "area": ("patch", "area_mm2"),
    "tau": ("stress", "tau_max_MPa"),
    "von_mises": ("stress", "von_mises_max_MPa"),
    "depth": ("stress", "von_mises_max_depth_mm"),
}
"""Columns with friction and (plain_*) without, and where a summary has them."""


@dataclass(frozen=True)
class Slid:
    """The largest von Mises stress over Hertz's p0, its depth over the smaller half width."""

    case: str
    coefficient: float
    by: str
    von_mises: float
    depth: float


def left_out(name: str, changes: dict[str, Any], creepage: float) -> dict[str, Any]:
    """The columns of JUDGED with friction and without, of one run, which holds both; force: over
    mu N."""
    found = rh.solve(_rolling(name, COEFFICIENT, creepage).replace(**changes), quiet=True).as_dict()
    forces = found["result"]["friction"]
    row = {
        "case": f"{name}, rigid wheel" if "wheel" in changes else name,
        "creepage": creepage,
        "force": forces["force_along_N"] / forces["limit_N"],
    }
    for column, (table, key) in JUDGED.items():
        row[f"plain_{column}"] = found["frictionless"][table][key]
        row[column] = found["result"][table][key]
    return row


def slid(name: str, coefficients: Sequence[float], given: dict[str, Any]) -> Iterator[Slid]:
    """Finite elements that slide, and the exact field below Hertz's pressure."""
    ellipse: Hertz | None = None
    for mu in coefficients:
        result = rh.solve(_rolling(name, mu, SLIDES).replace(**given), quiet=True)
        ellipse, stress = result.ellipse, result.as_dict()["result"]["stress"]
        width = min(half_lengths(ellipse))
        yield Slid(
            name,
            mu,
            "railhead",
            stress["von_mises_max_MPa"] / ellipse.p0,
            stress["von_mises_max_depth_mm"] / width,
        )
    assert ellipse is not None
    width = min(half_lengths(ellipse))
    for mu in EXACT:
        for by, find in (
            ("below", sliding.peak_below_surface),
            ("surface", sliding.peak_at_surface),
        ):
            place = find(ellipse, mu, POISSON)
            yield Slid(name, mu, by, place.von_mises / ellipse.p0, place.depth / width)


def crossover(exact: Sequence[Slid]) -> float:
    """The coefficient above which the surface is hardest, between two of a case's own."""
    below, surface = ([s for s in exact if s.by == by] for by in ("below", "surface"))
    ahead = [t.von_mises - s.von_mises for s, t in zip(below, surface, strict=True)]
    return float(np.interp(0.0, ahead, [s.coefficient for s in below]))


def _rolling(name: str, friction: float, creepage: float) -> rh.Scene:
    return rh.find(name).replace(
        friction={"coefficient": friction}, rolling={"creepage_along": creepage}
    )
