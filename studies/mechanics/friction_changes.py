"""What leaving friction out changes, and the hardest places under full sliding."""

import math
from collections.abc import Iterator, Sequence
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


EXACTLY = {"below": sliding.peak_below_surface, "surface": sliding.peak_at_surface}
JUDGED = {
    "pressure": ("pressure", "max_MPa"),
    "area": ("patch", "area_mm2"),
    "tau": ("stress", "tau_max_MPa"),
    "von_mises": ("stress", "von_mises_max_MPa"),
    "depth": ("stress", "von_mises_max_depth_mm"),
}
"""Columns with friction and (plain_*) without, and where a summary has them."""


Slid = dict[str, Any]
"""The largest von Mises stress over Hertz's p0, its depth over the smaller half width, of a case
at a coefficient of friction, by finite elements or the exact field."""


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

    def row(mu: float, by: str, ellipse: Hertz, von_mises: float, depth: float) -> Slid:
        return {
            "case": name,
            "coefficient": mu,
            "by": by,
            "von_mises": von_mises / ellipse.p0,
            "depth": depth / min(half_lengths(ellipse)),
        }

    for mu in coefficients:
        result = rh.solve(_rolling(name, mu, SLIDES).replace(**given), quiet=True)
        stress = result.as_dict()["result"]["stress"]
        values = stress["von_mises_max_MPa"], stress["von_mises_max_depth_mm"]
        yield row(mu, "railhead", result.ellipse, *values)
    for mu in EXACT:
        for by, find in EXACTLY.items():
            place = find(result.ellipse, mu, POISSON)
            yield row(mu, by, result.ellipse, place.von_mises, place.depth)


def crossover(slid: Sequence[Slid]) -> float:
    """The coefficient above which the surface is hardest, between two of a case's own."""
    below, surface = ([s for s in slid if s["by"] == by] for by in EXACTLY)
    ahead = [t["von_mises"] - s["von_mises"] for s, t in zip(below, surface, strict=True)]
    return float(np.interp(0.0, ahead, [s["coefficient"] for s in below]))


def _rolling(name: str, friction: float, creepage: float) -> rh.Scene:
    return rh.find(name).replace(
        friction={"coefficient": friction}, rolling={"creepage_along": creepage}
    )
