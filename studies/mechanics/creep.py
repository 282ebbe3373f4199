"""Creep curves beside other methods, what friction costs and changes, stresses under full slip."""

import math
import sys
from collections.abc import Sequence
from pathlib import Path

from railhead.postprocess.plots.diagrams import FE, GREY, HERTZ, new_figure
from studies import tables
from studies.mechanics import creep_curves as curves
from studies.mechanics import friction_axes
from studies.mechanics import friction_changes as changes
from studies.tables import Row, cells, groups

METHODS = ("boundary elements", "FASTSIM", "linear theory")
UNITS = {"spin": "per_mm"} | dict.fromkeys(("built", "pressed", "condensed", "point"), "s")
UNITS |= {
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
STRESSES = {
    "railhead": (FE, "o", "finite elements"),
    "below": (HERTZ, "-", "exact, below the surface"),
    "surface": (GREY, "-", "exact, at the surface"),
}


def main(out: Path, *, quick: bool) -> None:
    """Write creep.csv, creep_costs.csv, creep_left_out.csv, creep_sliding.csv, creep.png,
    creep_sliding.png, friction_axes.png and page.md; quick: two points of a coarse mesh, and
    sections."""
    points, costs, left = [], [], []
    for curve in curves.QUICK if quick else curves.CURVES:
        print(f"{curve.case}: {len(curve.motions)} motions", file=sys.stderr)
        found, cost = curves.rolled(curve)
        points += found
        costs.append(cost)
    for name, given, creepage in changes.SCENES[: 1 if quick else None]:
        print(f"{name} at a creepage of {creepage:g}, with and without friction", file=sys.stderr)
        left.append(changes.left_out(name, given, creepage))
    print("full sliding", file=sys.stderr)
    strip = changes.STRIP[2:3] if quick else changes.STRIP
    slid = list(changes.slid("long_roller", strip, changes.HALF_SPACE))
    slid += [] if quick else changes.slid("hertz_ellipse", changes.SLIDING, changes.COARSE)
    draw_curves(points, out / "creep.png")
    friction_axes.draw(out / "friction_axes.png")
    draw_sliding(slid, out / "creep_sliding.png")
    text = page(points, costs, left, slid)
    tables.publish(out, text, UNITS, creep=points, creep_costs=costs, creep_left_out=left)
    tables.publish(out, text, creep_sliding=slid)  # over p0 and half widths: without units


def page(
    points: Sequence[Row], costs: Sequence[Row], left: Sequence[Row], slid: Sequence[Row]
) -> str:
    """All of it; differences over mu N are the largest of a case."""
    forces = {case: _forces(own) for case, own in groups(points, "case").items()}
    sliding = groups(slid, "case")
    return tables.render(
        "creep",
        coefficient=curves.COEFFICIENT,
        slides=changes.SLIDES,
        off=[
            (case, *(tables.percent(worst[by]) for by in METHODS[:2]))
            for case, (_, worst) in forces.items()
        ],
        costs=cells(
            [
                {
                    **c,
                    "sampling": c["sampled"] / c["pressed"],
                    "each": c["point"] / c["pressed"],
                    "all": 1 + (c["sampled"] + c["point"]) / (c["built"] + c["pressed"]),
                }
                for c in costs
            ],
            *("{case}", "{model}", "{unknowns}"),
            *("{sampling:.1f}", "{each:.2f}", "{all:.1f}"),
        ),
        left=[
            (
                *cells([each], "{case}", "{creepage:g}", "{force:.2f}")[0],
                *(
                    _change(each[f"plain_{name}"], each[name])
                    for name in ("pressure", "area", "tau", "von_mises")
                ),
                f"{each['plain_depth']:.2f} -> {abs(each['depth']):.2f}",
            )
            for each in left
        ],
        forces={case: rows for case, (rows, _) in forces.items()},
        slid={case: _stresses(own) for case, own in sliding.items()},
        crossover={case: changes.crossover(own) for case, own in sliding.items()},
    )


def _forces(points: Sequence[Row]) -> tuple[list[tuple], dict[str, float]]:
    """Of a case side by side, and the largest distances from each other method."""
    rows, worst = [], dict.fromkeys(METHODS, 0.0)
    for motion, own in groups(points, "along", "across", "spin").items():
        each = {p["by"]: (p["force_along"], p["force_across"]) for p in own}
        worst = {by: max(worst[by], math.dist(each["railhead"], each[by])) for by in METHODS}
        forces = [f"{one:.4f}, {other:.4f}" for one, other in each.values()]
        rows.append(
            (
                *(f"{value:g}" for value in motion),
                *(text.replace("-0.0000", "0.0000") for text in forces),
                ", ".join(f"{p['stick']:.2f}" for p in own[:2]),
            )
        )
    return rows, worst


def _stresses(slid: Sequence[Row]) -> list[list[str]]:
    """Finite elements beside the exact field at the same coefficients."""
    rows = []
    for found in (s for s in slid if s["by"] == "railhead"):
        same = {s["by"]: s for s in slid if math.isclose(s["coefficient"], found["coefficient"])}
        exact = max(same["below"], same["surface"], key=lambda s: s["von_mises"])
        values = {
            **found,
            "depth": abs(found["depth"]),
            "off": _change(exact["von_mises"], found["von_mises"]),
        }
        rows += [
            cells([values], "{coefficient:g}", "{von_mises:.4f}", "{depth:.3f}")[0]
            + cells([exact], "{von_mises:.4f}", "{depth:.3f}")[0]
            + [values["off"], *(f"{same[by]['von_mises']:.4f}" for by in ("below", "surface"))]
        ]
    return rows


def _change(before: float, after: float) -> str:
    return f"{100 * (after / before - 1):+.2f} %"


def draw_curves(points: Sequence[Row], path: Path) -> None:
    """A row a case; the motions that have one part only."""
    cases = groups(points, "case")
    with new_figure(path, 11, 3.6 * len(cases)) as figure:
        rows = figure.subplots(len(cases), 3, squeeze=False, sharey="row")
        for (case, found), row in zip(cases.items(), rows, strict=True):
            for axes, (motion, force, label) in zip(row, PANELS, strict=True):
                rest = [name for name, _, _ in PANELS if name != motion]
                pure = [p for p in found if not any(p[name] for name in rest)]
                for by, (colour, look) in LOOKS.items():
                    x, y = ([p[name] for p in pure if p["by"] == by] for name in (motion, force))
                    axes.plot(x, y, look, color=colour, label=by)
                axes.set(xscale="log", ylim=(0, 1.1), xlabel=label, title=case)
            row[0].set_ylabel("force over mu N")
        rows[0, 0].legend()


def draw_sliding(slid: Sequence[Row], path: Path) -> None:
    """The largest von Mises stress, and its depth, with the exact largest below and at the
    surface."""
    cases = groups(slid, "case")
    with new_figure(path, 4.6 * len(cases), 3.8) as figure:
        panels = figure.subplots(1, len(cases), squeeze=False, sharey=True)[0]
        for (case, found), axes in zip(cases.items(), panels, strict=True):
            for by, own in groups(found, "by").items():
                colour, look, label = STRESSES[by]
                x, y = ([each[key] for each in own] for key in ("coefficient", "von_mises"))
                axes.plot(x, y, look, color=colour, label=label)
            axes.set(xlabel="coefficient of friction", title=case)
        panels[0].set_ylabel("largest von Mises stress over p0")
        panels[0].legend()
