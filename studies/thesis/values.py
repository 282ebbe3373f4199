"""The numbers that the page of the study thesis quotes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from railhead.theory.elastic import subsurface
from studies.thesis.claims import Facts
from studies.thesis.hertz import PRINTED_LOAD, under
from studies.thesis.results import YIELD
from studies.thesis.runs import DEFAULT, HEXAHEDRA, WHEEL
from studies.thesis.stresses import P0, exact_stress, thesis_shear

CIRCLE_SHAKEDOWN = 4.7  # p0/k, circular patch
STRIP_SHAKEDOWN = 4.0  # p0/k, line contact


def findings(facts: Facts) -> dict[str, Any]:
    """Of the five most important ones."""
    c, wheel = facts.ellipse, under(facts.ellipse, WHEEL)
    return {
        "wheel": wheel,
        "wheel_mises": subsurface.axis_extrema(wheel, facts.poisson).von_mises_max,
        "extrema": subsurface.axis_extrema(c, facts.poisson),
        "surface_shear": (exact_stress(facts, 0.0).max() + c.p0) / 2,
        "printed_p0": P0,
        "printed_shear": thesis_shear(facts)[1],
    }


def touches(facts: Facts) -> list[tuple[str, ...]]:
    """Where the wheel touches the 54E1, by tread and inclination."""
    return [
        (tread, *(f"{facts.profiles[f'y {tread} {i}'] + 0.0:.2f}" for i in ("0", "1:40", "1:20")))
        for tread in ("cylinder", "cone40", "cone20")
    ]


def elements(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Linear hexahedra with a penalty beside the default, at 25 kN."""
    if not runs:
        return {"coarse": None}
    own = [r for r in runs if r["elements"] == HEXAHEDRA]
    best = next(r for r in runs if r["elements"] == DEFAULT and abs(r["load"] - PRINTED_LOAD) < 1)
    names = ("a", "b", "p0", "tau_max", "tau_depth", "tau_surface")
    lines = []
    for row in (*own, best):
        errors = [f"{row[f'error_{name}']:+.1%}" for name in names]
        cost = row["unknowns"], f"{row['seconds'] / best['seconds']:.2f}"
        size = f"b/{row['per_semi_axis']:.0f}"
        lines.append((row["elements"], size, *cost, *errors, f"{row['surface_ratio']:.3f}"))
    s_x, s_y, _ = exact_stress(facts, 0.0)
    return {"coarse": own[0], "elements": lines, "ratio": s_x / s_y}


def strength(facts: Facts, runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """25 kN and a real wheel against yield and shakedown."""
    c = facts.ellipse
    lines = []
    for load in (PRINTED_LOAD, WHEEL):
        contact = under(c, load)
        mises = subsurface.axis_extrema(contact, facts.poisson).von_mises_max
        fe = next((r for r in runs if r["elements"] == DEFAULT and abs(r["load"] - load) < 1), None)
        ours = ("-", "-") if fe is None else (f"{fe['p0']:.0f}", f"{fe['mises_max']:.0f}")
        lines.append((f"{load / 1e3:.1f}", f"{contact.p0:.0f}", ours[0], f"{mises:.0f}", ours[1]))
    share = subsurface.axis_extrema(c, facts.poisson).von_mises_max / c.p0
    strip, circle = (
        (factor, *(factor * sigma / math.sqrt(3) for sigma in YIELD))
        for factor in (STRIP_SHAKEDOWN, CIRCLE_SHAKEDOWN)
    )
    return {
        "loads": lines,
        "share": share,
        "yields": YIELD,
        "onset": tuple(c.load * (sigma / (share * c.p0)) ** 3 / 1e3 for sigma in YIELD),
        "overload": WHEEL / PRINTED_LOAD,
        "strip": strip,
        "circle": circle,
    }
