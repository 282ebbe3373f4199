"""The page and the pictures of the study creep."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from railhead.postprocess.plots.diagrams import FE, GREY, HERTZ, new_figure
from studies import tables
from studies.mechanics import friction_changes as changes
from studies.mechanics.creep_curves import COEFFICIENT, Cost, Point
from studies.mechanics.friction_changes import Slid

METHODS = ("boundary elements", "FASTSIM", "linear theory")
UNITS = {
    f"{plain}{name}": unit
    for plain in ("", "plain_")
    for name, unit in (
        ("pressure", "MPa"),
        ("area", "mm2"),
        ("tau", "MPa"),
        ("von_mises", "MPa"),
        ("depth", "mm"),
    )
}


def page(
    points: Sequence[Point],
    costs: Sequence[Cost],
    left: Sequence[Mapping[str, Any]],
    slid: Sequence[Slid],
) -> str:
    """All of it; differences over mu N are the largest of a case."""
    cases = list(dict.fromkeys(point.case for point in points))
    forces = {case: _forces([p for p in points if p.case == case]) for case in cases}
    off = [
        (case, *(tables.percent(worst[by]) for by in METHODS[:2]))
        for case, (_, worst) in forces.items()
    ]
    spent = [
        (
            c.case,
            c.model,
            c.unknowns,
            c.points,
            f"{c.condensed / c.pressed:.1f}",
            f"{c.point / c.pressed:.2f}",
            f"{1 + (c.condensed + c.point) / (c.built + c.pressed):.1f}",
        )
        for c in costs
    ]
    changed = [
        (
            each["case"],
            f"{each['creepage']:g}",
            f"{each['force']:.2f}",
            *(
                _change(each[f"plain_{name}"], each[name])
                for name in ("pressure", "area", "tau", "von_mises")
            ),
            f"{each['plain_depth']:.2f} -> {abs(each['depth']):.2f}",
        )
        for each in left
    ]
    shapes = list(dict.fromkeys(s.case for s in slid))
    return tables.render(
        "creep",
        coefficient=COEFFICIENT,
        slides=changes.SLIDES,
        off=off,
        costs=spent,
        left=changed,
        forces={case: rows for case, (rows, _) in forces.items()},
        slid={shape: _stresses([s for s in slid if s.case == shape]) for shape in shapes},
        crossover={
            shape: changes.crossover([s for s in slid if s.case == shape]) for shape in shapes
        },
    )


def _forces(points: Sequence[Point]) -> tuple[list[tuple], dict[str, float]]:
    """Of a case side by side, and the largest distances from each other method."""
    rows, worst = [], dict.fromkeys(METHODS, 0.0)
    for found in (p for p in points if p.by == "railhead"):
        motion = found.along, found.across, found.spin
        others = {p.by: p for p in points if (p.along, p.across, p.spin) == motion}
        for by in METHODS:
            gap = math.hypot(
                found.force_along - others[by].force_along,
                found.force_across - others[by].force_across,
            )
            worst[by] = max(worst[by], gap)
        each = [found, *(others[by] for by in METHODS)]
        rows.append(
            (
                *(f"{value:g}" for value in motion),
                *(
                    f"{p.force_along:.4f}, {p.force_across:.4f}".replace("-0.0000", "0.0000")
                    for p in each
                ),
                ", ".join(f"{p.stick:.2f}" for p in each[:2]),
                found.steps,
            )
        )
    return rows, worst


def _stresses(slid: Sequence[Slid]) -> list[tuple]:
    """Finite elements beside the exact field at the same coefficients."""
    rows = []
    for found in (s for s in slid if s.by == "railhead"):
        same = {s.by: s for s in slid if math.isclose(s.coefficient, found.coefficient)}
        exact = max(same["below"], same["surface"], key=lambda s: s.von_mises)
        rows.append(
            (
                f"{found.coefficient:g}",
                f"{found.von_mises:.4f}",
                f"{abs(found.depth):.3f}",
                f"{exact.von_mises:.4f}",
                f"{exact.depth:.3f}",
                _change(exact.von_mises, found.von_mises),
                f"{same['below'].von_mises:.4f}",
                f"{same['surface'].von_mises:.4f}",
            )
        )
    return rows


def _change(before: float, after: float) -> str:
    return f"{100 * (after / before - 1):+.2f} %"


LOOKS = {
    "railhead": (FE, "o"),
    "boundary elements": (HERTZ, "-"),
    "FASTSIM": (GREY, "--"),
    "linear theory": (GREY, ":"),
}
PANELS = (
    ("along", "force_along", "creepage along"),
    ("across", "force_across", "creepage across"),
    ("spin", "force_across", "spin, 1/mm"),
)
STRESSES = {"railhead": (FE, "o"), "below": (HERTZ, "-"), "surface": (GREY, "-")}


def draw_curves(points: Sequence[Point], path: Path) -> None:
    """A row a case; the motions that have one part only."""
    cases = list(dict.fromkeys(point.case for point in points))
    with new_figure(path, 11, 3.6 * len(cases)) as figure:
        rows = figure.subplots(len(cases), 3, squeeze=False, sharey="row")
        for case, row in zip(cases, rows, strict=True):
            for axes, (motion, force, label) in zip(row, PANELS, strict=True):
                rest = [name for name, _, _ in PANELS if name != motion]
                for by, (colour, look) in LOOKS.items():
                    own = [
                        p
                        for p in points
                        if p.case == case and p.by == by and not any(getattr(p, r) for r in rest)
                    ]
                    x, y = ([getattr(p, name) for p in own] for name in (motion, force))
                    axes.plot(x, y, look, color=colour, label=by)
                axes.set(xscale="log", ylim=(0, 1.1), xlabel=label)
                axes.set_title(case)
            row[0].set_ylabel("force over mu N")
        rows[0, 0].legend()


def draw_sliding(slid: Sequence[Slid], path: Path) -> None:
    """The largest von Mises stress, and its depth, with the exact largest below and at the
    surface."""
    cases = list(dict.fromkeys(each.case for each in slid))
    labels = {
        "railhead": "finite elements",
        "below": "exact, below the surface",
        "surface": "exact, at the surface",
    }
    with new_figure(path, 4.6 * len(cases), 3.8) as figure:
        panels = figure.subplots(1, len(cases), squeeze=False, sharey=True)[0]
        for case, axes in zip(cases, panels, strict=True):
            for by, (colour, look) in STRESSES.items():
                own = [each for each in slid if each.case == case and each.by == by]
                x, y = [each.coefficient for each in own], [each.von_mises for each in own]
                axes.plot(x, y, look, color=colour, label=labels[by])
            axes.set(xlabel="coefficient of friction")
            axes.set_title(case)
        panels[0].set_ylabel("largest von Mises stress over p0")
        panels[0].legend()
