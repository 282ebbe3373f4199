"""The page of the hard cases: what fails, a table by group, maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from railhead.postprocess.plots.diagrams import new_figure
from studies.hard.case import Outcome
from studies.tables import percent, render

FACTOR_MAP, MATERIAL_MAP = "factor", "nu x E ratio"  # groups of cases
LAWS = ("default", "Nitsche, theta 1", "Nitsche, theta 0", "Nitsche, theta -1", "penalty")
FACTORS = [10.0**power for power in range(-3, 7)]
POISSON = (0.0, 0.3, 0.45, 0.49, 0.499, 0.4999)
STIFFNESS = [10.0**power for power in (-4, -2, 0, 2, 4)]
LOW, HIGH = 1e-3, 1.0  # errors at the ends of the colours
DARK = 0.52  # of green: letters on it are white


@dataclass(frozen=True)
class Cell:
    """One point of a map: relative error (None: no result), whether it converged, a short note."""

    error: float | None
    converged: bool
    note: str


@dataclass(frozen=True)
class Map:
    """A table of cells, row by row, with the words around it; label: of the columns; across: of the
    rows."""

    title: str
    rows: Sequence[str]
    columns: Sequence[str]
    label: str
    across: str
    cells: Sequence[Sequence[Cell]]


def _cell(outcome: Outcome | None) -> Cell:
    if outcome is None or outcome.measured is None:
        return Cell(None, False, "no end" if outcome and "back" in outcome.fault else "x")
    worst = outcome.measured.worst
    error = worst[1].value if worst else None
    if outcome.measured.failed:
        return Cell(error, False, outcome.measured.failed[0].replace("_", "\n", 1))
    if error is None:
        return Cell(None, False, "x")
    return Cell(error, True, f"{error:.1%}" + ("\nWRONG" if outcome.fault else ""))


def maps(outcomes: Sequence[Outcome]) -> list[Map]:
    """The two failure maps of a whole run."""
    found = {outcome.case.key: outcome for outcome in outcomes}

    def cells(group: str, rows: Sequence[str], columns: Sequence[str]) -> list[list[Cell]]:
        return [
            [_cell(found.get(f"{group}: {row}, {column}")) for column in columns] for row in rows
        ]

    factors = [f"{factor:g}" for factor in FACTORS]
    ratios, laws = [f"{ratio:g}" for ratio in STIFFNESS], list(LAWS)
    poisson = [f"{value:g}" for value in POISSON]
    return [
        Map(
            "Contact laws on the thesis ellipse, four elements per semi-axis",
            laws,
            factors,
            "solver.gamma_factor",
            "",
            cells(FACTOR_MAP, laws, factors),
        ),
        Map(
            "Rail of any stiffness under a steel wheel, quadratic tetrahedra",
            poisson,
            ratios,
            "E of the rail over E of the wheel",
            "Poisson's ratio of the rail",
            cells(MATERIAL_MAP, poisson, ratios),
        ),
    ]


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
    failing = [outcome for outcome in outcomes if outcome.fault]
    refused = sum(outcome.refused for outcome in outcomes)
    return render(
        "hard_cases", count=len(outcomes), failing=failing, refused=refused, groups=groups
    )


def draw(maps: Sequence[Map], path: Path) -> None:
    """One panel below the other; colour is the error, a grey cell with a cross did not converge."""
    from matplotlib.colors import LogNorm
    from matplotlib.patches import Rectangle
    from matplotlib.ticker import FuncFormatter

    rows = [len(each.rows) for each in maps]
    width = 3.0 + 1.05 * max(len(each.columns) for each in maps)
    with new_figure(path, width, 0.62 * sum(rows) + 1.5 * len(maps)) as figure:
        panels = figure.subplots(len(maps), 1, squeeze=False, height_ratios=rows)[:, 0]
        for axes, each in zip(panels, maps, strict=True):
            values = [
                [
                    cell.error if cell.converged and cell.error is not None else float("nan")
                    for cell in row
                ]
                for row in each.cells
            ]
            image = axes.imshow(values, norm=LogNorm(LOW, HIGH), cmap="RdYlGn_r", aspect="auto")
            for y, row in enumerate(each.cells):
                for x, cell in enumerate(row):
                    if not cell.converged:
                        box = Rectangle((x - 0.5, y - 0.5), 1, 1, fc="#c9c9c9", ec="white")
                        axes.add_patch(box)
                    dark = cell.converged and image.to_rgba(values[y][x])[1] < DARK
                    axes.text(
                        x,
                        y,
                        cell.note,
                        ha="center",
                        va="center",
                        fontsize=8,
                        color="white" if dark else "black",
                    )
            axes.set_xticks(range(len(each.columns)), each.columns)
            axes.set_yticks(range(len(each.rows)), each.rows)
            axes.set(xlabel=each.label, ylabel=each.across, title=each.title)
            axes.grid(visible=False)
        shares = FuncFormatter(lambda value, _: f"{100 * value:g}%")
        bar = figure.colorbar(image, ax=list(panels), shrink=0.6, extend="both", format=shares)
        bar.set_label("error of the quantity nearest to what is allowed")
