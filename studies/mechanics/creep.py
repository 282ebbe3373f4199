"""Creep curves beside other methods, what friction costs and changes, stresses under full slip."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from railhead.cli import study
from studies import tables
from studies.mechanics import creep_curves as curves
from studies.mechanics import creep_page as page
from studies.mechanics import friction_axes
from studies.mechanics import friction_changes as changes
from studies.mechanics.creep_curves import Cost, Point
from studies.mechanics.friction_changes import Slid


def main(out: Path, *, quick: bool) -> None:
    """Write creep.csv, creep_costs.csv, creep_left_out.csv, creep_sliding.csv, creep.png,
    creep_sliding.png, friction_axes.png and page.md; quick: two points of a coarse mesh, and
    sections."""
    points: list[Point] = []
    costs: list[Cost] = []
    for curve in curves.QUICK if quick else curves.CURVES:
        print(f"{curve.case}: {len(curve.motions)} motions", file=sys.stderr)
        found, cost = curves.rolled(curve)
        points += found
        costs.append(cost)
    left = list(_left(changes.SCENES[:1] if quick else changes.SCENES))
    slid = list(_slid(quick))
    tables.write_csv(out / "creep.csv", points, {"spin": "per_mm"})
    seconds = dict.fromkeys(("built", "pressed", "condensed", "point"), "s")
    tables.write_csv(out / "creep_costs.csv", costs, seconds)
    tables.write_csv(out / "creep_left_out.csv", left, page.UNITS)
    tables.write_csv(out / "creep_sliding.csv", slid)
    page.draw_curves(points, out / "creep.png")
    friction_axes.draw(out / "friction_axes.png")
    page.draw_sliding(slid, out / "creep_sliding.png")
    (out / study.PAGE).write_text(page.page(points, costs, left, slid), encoding="utf-8")


def _left(scenes: Iterable[tuple]) -> Iterable[dict[str, Any]]:
    for name, given, creepage in scenes:
        print(f"{name} at a creepage of {creepage:g}, with and without friction", file=sys.stderr)
        yield changes.left_out(name, given, creepage)


def _slid(quick: bool) -> Iterable[Slid]:
    strip: Sequence[float] = changes.STRIP[2:3] if quick else changes.STRIP
    print("full sliding", file=sys.stderr)
    yield from changes.slid("long_roller", strip, changes.HALF_SPACE)
    if not quick:
        yield from changes.slid("hertz_ellipse", changes.SLIDING, changes.COARSE)
