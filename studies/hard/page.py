"""The page of the hard cases: what fails, a table by group, maps."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter

from railhead.postprocess.plots.diagrams import new_figure
from studies.hard.case import Outcome
from studies.tables import percent, render

LAWS = ("default", "Nitsche, theta 1", "Nitsche, theta 0", "Nitsche, theta -1", "penalty")
FACTORS = [10.0**power for power in range(-3, 7)]
POISSON = (0.0, 0.3, 0.45, 0.49, 0.499, 0.4999)
STIFFNESS = [10.0**power for power in (-4, -2, 0, 2, 4)]
LOW, HIGH = 1e-3, 1.0  # errors at the ends of the colours
DARK = 0.52  # of green: letters on it are white


MAPS = (
    (
        "Contact laws on the thesis ellipse, four elements per semi-axis",
        "factor",
        LAWS,
        FACTORS,
        ("solver.gamma_factor", ""),
    ),
    (
        "Rail of any stiffness under a steel wheel, quadratic tetrahedra",
        "nu x E ratio",
        [f"{value:g}" for value in POISSON],
        STIFFNESS,
        ("E of the rail over E of the wheel", "Poisson's ratio of the rail"),
    ),
)
"""Title, group of the cases, their rows and columns, labels of the columns and of the rows."""


def cell(outcome: Outcome | None) -> tuple[float, bool, str]:
    """A point of a map: relative error (nan: no result), whether it converged, a short note."""
    if outcome is None or outcome.measured is None:
        return math.nan, False, "no end" if outcome and "back" in outcome.fault else "x"
    worst = outcome.measured.worst
    error = worst[1].value if worst else math.nan
    if outcome.measured.failed:
        return error, False, outcome.measured.failed[0].replace("_", "\n", 1)
    if worst is None:
        return error, False, "x"
    return error, True, f"{error:.1%}" + ("\nWRONG" if outcome.fault else "")


def _row(outcome: Outcome) -> list[str]:
    case, found = outcome.case, outcome.measured
    worst = found.worst if found else None
    none = ("-",) * 3
    nearest = (worst[0], f"{worst[1].value:.1e}", f"{worst[1].allowed:.1e}") if worst else none
    steps = (str(found.newton), str(found.krylov), percent(found.noise)) if found else none
    reason = case.reason + (f" ({found.remark})" if found and found.remark else "")
    seconds = f"{outcome.seconds:.1f}"
    return [case.name, reason, case.reference, *nearest, *steps, seconds, outcome.result]


def page(outcomes: Sequence[Outcome]) -> str:
    """The whole page."""
    groups: dict[str, list[list[str]]] = {}
    for outcome in outcomes:
        groups.setdefault(outcome.case.group, []).append(_row(outcome))
    return render(
        "hard_cases",
        count=len(outcomes),
        failing=[outcome for outcome in outcomes if outcome.fault],
        refused=sum(outcome.refused for outcome in outcomes),
        groups=groups,
    )


def draw(outcomes: Sequence[Outcome], path: Path) -> None:
    """The two failure maps of a whole run, one panel below the other; colour is the error, a grey
    cell with a cross did not converge."""
    found = {outcome.case.key: outcome for outcome in outcomes}
    heights = [len(rows) for _, _, rows, _, _ in MAPS]
    width = 3.0 + 1.05 * max(len(columns) for _, _, _, columns, _ in MAPS)
    with new_figure(path, width, 0.62 * sum(heights) + 1.5 * len(MAPS)) as figure:
        panels = figure.subplots(len(MAPS), 1, squeeze=False, height_ratios=heights)[:, 0]
        for axes, (title, group, rows, columns, labels) in zip(panels, MAPS, strict=True):
            cells = [[cell(found.get(f"{group}: {r}, {c:g}")) for c in columns] for r in rows]
            values = [[error if right else math.nan for error, right, _ in row] for row in cells]
            image = axes.imshow(values, norm=LogNorm(LOW, HIGH), cmap="RdYlGn_r", aspect="auto")
            for y, x in np.ndindex(len(rows), len(columns)):
                _, right, note = cells[y][x]
                if not right:
                    box = Rectangle((x - 0.5, y - 0.5), 1, 1, fc="#c9c9c9", ec="white")
                    axes.add_patch(box)
                dark = right and image.to_rgba(values[y][x])[1] < DARK
                colour = "white" if dark else "black"
                axes.text(x, y, note, ha="center", va="center", fontsize=8, color=colour)
            axes.set_xticks(range(len(columns)), [f"{each:g}" for each in columns])
            axes.set_yticks(range(len(rows)), rows)
            axes.set(xlabel=labels[0], ylabel=labels[1], title=title)
            axes.grid(visible=False)
        shares = FuncFormatter(lambda value, _: f"{100 * value:g}%")
        bar = figure.colorbar(image, ax=list(panels), shrink=0.6, extend="both", format=shares)
        bar.set_label("error of the quantity nearest to what is allowed")
