"""Creep curves beside other methods, what friction costs and changes, stresses under full slip;
the picture of the axes and signs of friction."""

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from railhead.geometry import profiles
from railhead.geometry.placement import ProfilePair
from railhead.geometry.wheelset import Track, WheelsetOnTrack
from railhead.postprocess.pictures.diagrams import FE, GREY, HERTZ, new_figure
from studies import tables
from studies.mechanics import creep_runs as runs
from studies.tables import Row, cells, groups

METHODS = ("boundary elements", "FASTSIM", "linear theory")
UNITS = {"spin": "per_mm"} | dict.fromkeys(("built", "pressed", "sampled", "point"), "s")
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


def main(out: Path, *, quick: bool) -> None:
    """Write creep.csv, creep_costs.csv, creep_left_out.csv, creep_sliding.csv, creep_speed.csv,
    creep.png, friction_axes.png and page.md; quick: two motions on a coarse mesh, one scene, one
    coefficient of a section and one speed."""
    curves = tables.told(runs.QUICK if quick else runs.CURVES, lambda curve: curve.case)
    found, costs = zip(*map(runs.rolled, curves), strict=True)
    points = [point for each in found for point in each]
    scenes = tables.told(runs.SCENES[: 1 if quick else None], "{0[0]} without friction".format)
    left = [runs.left_out(*each) for each in scenes]
    print("full sliding", file=sys.stderr)
    strip = runs.STRIP[2:3] if quick else runs.STRIP
    slid = list(runs.slid("long_roller", strip, runs.HALF_SPACE))
    slid += [] if quick else runs.slid("hertz_ellipse", runs.SLIDING, runs.FOUR)
    print("a law of friction over speed", file=sys.stderr)
    falling = runs.falling(quick=quick)
    draw_curves(points, out / "creep.png")
    draw_axes(out / "friction_axes.png")
    text = page(points, costs, left, slid, falling)
    tables.publish(out, text, UNITS, creep=points, creep_costs=costs, creep_left_out=left)
    tables.publish(out, text, {"speed": "m_s"}, creep_speed=falling)
    tables.publish(out, text, creep_sliding=slid)  # over p0 and half widths: without units


def page(
    points: Sequence[Row],
    costs: Sequence[Row],
    left: Sequence[Row],
    slid: Sequence[Row],
    falling: Sequence[Row],
) -> str:
    """Text of the page; differences of forces, over mu N, are the largest of a case."""
    forces = {case: _forces(own) for case, own in groups(points, "case").items()}
    sliding = groups(slid, "case")
    head, speeds, apart = runs.speed_table(falling)
    return tables.render(
        "creep",
        coefficient=runs.COEFFICIENT,
        slides=runs.SLIDES,
        law=runs.LAW,
        head=head,
        speeds=speeds,
        apart=f"{apart:.1g}",
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
        crossover={case: runs.crossover(own) for case, own in sliding.items()},
    )


def _forces(points: Sequence[Row]) -> tuple[list[tuple], dict[str, float]]:
    """Rows of the creep forces of all methods side by side, a row a motion, and largest distances
    of ours from each other method; both over mu N.
    """
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
    """Rows of a table: largest von Mises stress and its depth by finite elements beside the exact
    field, for each coefficient of friction.
    """
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
    """Relative change as text, in %."""
    return f"{100 * (after / before - 1):+.2f} %"


def draw_curves(points: Sequence[Row], path: Path) -> None:
    """Draw forces over creepage or spin: a row of panels for each case, with those motions alone
    that have one component."""
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


Point = tuple[float, float]
SHIFT = 4.0  # mm, for a contact angle that can be seen
STEEL = "#d9dde2"
ORIGIN = (0.0, 0.0)


def draw_axes(path: Path) -> None:
    """Draw the axes and signs of friction: the wheel from the front and the patch from above."""
    with new_figure(path, 12, 4.1) as figure:
        front, above = figure.subplots(1, 2, width_ratios=(1, 1.05))
        _front(front)
        _above(above)
        for axes in (front, above):
            axes.set_aspect("equal")
            axes.set_axis_off()


def _front(axes: Axes) -> None:
    """Draw wheel and rail from the front, with y, normal and shift."""
    pair = ProfilePair(profiles.rail_head("60E1", 1 / 40), profiles.s1002(), 460.0)
    side = WheelsetOnTrack(right=pair, left=pair, track=Track(gauge=1435.0)).place(SHIFT).right
    touch, y = side.touches[0], np.linspace(*pair.rail.domain, 801)
    outline = pair.outline(side.pose, np.linspace(*pair.wheel.domain, 801)).points[:, 1:].T
    for steel, end, colour in (((y, pair.rail.height(y)), -30, STEEL), (outline, 40, "#eceff2")):
        axes.fill_between(*steel, end, color=colour, lw=0)
        axes.plot(*steel, color=GREY)
    at, c, s = (touch.y, touch.z), np.cos(touch.angle), np.sin(touch.angle)
    _arrow(axes, at, (at[0] + 26 * c, at[1] + 26 * s), FE, "y, s: field side")
    _arrow(axes, at, (at[0] - 26 * s, at[1] + 26 * c), FE, "normal, out of the rail")
    _out_of_the_page(axes, at)
    _note(axes, "x: to where the wheel rolls,\nout of the page", at, (at[0] + 12, at[1] - 20))
    _arrow(axes, (-62.0, 32.0), (-48.0, 32.0), HERTZ, "wheelset.shift")
    axes.text(-40, -37, "gauge side", color=GREY, ha="right")
    axes.text(42, -37, "field side", color=GREY)
    axes.set(xlim=(-75, 75), ylim=(-42, 42), title="From the front")


def _above(axes: Axes) -> None:
    """Draw the patch from above, with creepages, spin and forces."""
    turn, arc = np.linspace(0, 2 * np.pi, 181), np.radians(np.linspace(200, 340, 60))
    axes.fill(6 * np.cos(turn), 4.6 * np.sin(turn), color=STEEL, lw=0)
    x, y = 2.6 * np.cos(arc), 2.6 * np.sin(arc)
    axes.plot(x[:-2], y[:-2], color=HERTZ)
    for start, end, colour, name in (
        (ORIGIN, (9.0, 0.0), FE, "x"),
        (ORIGIN, (0.0, 6.2), FE, "y, s"),
        ((0.8, 0.9), (3.6, 0.9), HERTZ, ""),
        ((0.8, 1.5), (0.8, 3.8), HERTZ, ""),
        ((x[-6], y[-6]), (x[-1], y[-1]), HERTZ, ""),
    ):
        _arrow(axes, start, end, colour, name)
    _out_of_the_page(axes, ORIGIN)
    for text, at, where, colour in (
        ("normal, out of the page", ORIGIN, (-6.0, 6.2), FE),
        ("creepage along, force along", (3.2, 0.9), (10.4, 2.8), HERTZ),
        ("creepage across, force across", (0.8, 3.4), (8.0, 5.4), HERTZ),
        ("spin, moment", (2.0, -1.7), (7.5, -3.6), HERTZ),
    ):
        _note(axes, text, at, where, colour)
    axes.text(6.2, -0.9, "leading edge", color=GREY)
    axes.text(-6.2, 0, "trailing edge", color=GREY, ha="right")
    axes.set(xlim=(-11, 14), ylim=(-6, 8), title="The patch from above")


def _out_of_the_page(axes: Axes, at: Point) -> None:
    """Draw the point of an arrow towards the reader."""
    axes.plot(*at, "o", color=FE, ms=11, mfc="white", mew=2)
    axes.plot(*at, "o", color=FE, ms=4)


def _note(axes: Axes, text: str, at: Point, where: Point, colour: str = FE) -> None:
    line = {"arrowstyle": "-", "color": colour, "lw": 0.8}
    axes.annotate(text, at, where, color=colour, ha="center", arrowprops=line)


def _arrow(axes: Axes, start: Point, end: Point, colour: str, name: str = "") -> None:
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 2})
    x, y = (1.06 * stop - 0.06 * begin for begin, stop in zip(start, end, strict=True))
    axes.text(x, y, name, color=colour, va="center" if end[1] == start[1] else "bottom")
