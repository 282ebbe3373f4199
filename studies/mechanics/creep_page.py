"""The page of the study: tables of forces, costs, changes and stresses."""

from __future__ import annotations

import math
from collections.abc import Sequence

from studies import tables
from studies.mechanics import friction_changes as changes
from studies.mechanics.creep_curves import COEFFICIENT, Cost, Point
from studies.mechanics.friction_changes import Left, Slid

METHODS = ("boundary elements", "FASTSIM", "linear theory")
UNITS = {
    f"{plain}{name}": unit
    for plain in ("", "plain_")
    for name, unit in (("pressure", "MPa"), ("area", "mm2"), ("tau", "MPa"), ("von_mises", "MPa"),
                       ("depth", "mm"))
}  # fmt: skip


def page(
    points: Sequence[Point], costs: Sequence[Cost], left: Sequence[Left], slid: Sequence[Slid]
) -> str:
    """All of it; differences over mu N are the largest of a case."""
    cases = list(dict.fromkeys(point.case for point in points))
    forces = {case: _forces([p for p in points if p.case == case]) for case in cases}
    off = [
        (case, *(tables.percent(worst[by]) for by in METHODS[:2]))
        for case, (_, worst) in forces.items()
    ]
    spent = [
        (c.case, c.model, c.unknowns, c.points, f"{c.condensed / c.pressed:.1f}",
         f"{c.point / c.pressed:.2f}",
         f"{1 + (c.condensed + c.point) / (c.built + c.pressed):.1f}")
        for c in costs
    ]  # fmt: skip
    changed = [
        (each.case, f"{each.creepage:g}", f"{each.force:.2f}",
         *(_change(getattr(each, f"plain_{name}"), getattr(each, name))
           for name in ("pressure", "area", "tau", "von_mises")),
         f"{each.plain_depth:.2f} -> {abs(each.depth):.2f}")
        for each in left
    ]  # fmt: skip
    shapes = list(dict.fromkeys(s.case for s in slid))
    return tables.render(
        "creep", coefficient=COEFFICIENT, slides=changes.SLIDES, off=off, costs=spent, left=changed,
        forces={case: rows for case, (rows, _) in forces.items()},
        slid={shape: _stresses([s for s in slid if s.case == shape]) for shape in shapes},
        crossover={
            shape: changes.crossover([s for s in slid if s.case == shape]) for shape in shapes
        },
    )  # fmt: skip


def _forces(points: Sequence[Point]) -> tuple[list[tuple], dict[str, float]]:
    """Of a case side by side, and the largest distances from each other method."""
    rows, worst = [], dict.fromkeys(METHODS, 0.0)
    for found in (p for p in points if p.by == "railhead"):
        motion = found.along, found.across, found.spin
        others = {p.by: p for p in points if (p.along, p.across, p.spin) == motion}
        for by in METHODS:
            gap = math.hypot(found.force_along - others[by].force_along,
                             found.force_across - others[by].force_across)  # fmt: skip
            worst[by] = max(worst[by], gap)
        each = [found, *(others[by] for by in METHODS)]
        rows.append((
            *(f"{value:g}" for value in motion),
            *(f"{p.force_along:.4f}, {p.force_across:.4f}".replace("-0.0000", "0.0000")
              for p in each),
            ", ".join(f"{p.stick:.2f}" for p in each[:2]), found.steps,
        ))  # fmt: skip
    return rows, worst


def _stresses(slid: Sequence[Slid]) -> list[tuple]:
    """Finite elements beside the exact field at the same coefficients."""
    rows = []
    for found in (s for s in slid if s.by == "railhead"):
        same = {s.by: s for s in slid if math.isclose(s.coefficient, found.coefficient)}
        exact = max(same["below"], same["surface"], key=lambda s: s.von_mises)
        rows.append((
            f"{found.coefficient:g}", f"{found.von_mises:.4f}", f"{abs(found.depth):.3f}",
            f"{exact.von_mises:.4f}", f"{exact.depth:.3f}",
            _change(exact.von_mises, found.von_mises),
            f"{same['below'].von_mises:.4f}", f"{same['surface'].von_mises:.4f}",
        ))  # fmt: skip
    return rows


def _change(before: float, after: float) -> str:
    return f"{100 * (after / before - 1):+.2f} %"
