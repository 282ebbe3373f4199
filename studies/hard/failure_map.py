"""Failure maps: error and noise over two parameters, and what failed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from railhead.postprocess.plots.diagrams import new_figure

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
                [cell.error if cell.converged and cell.error is not None else float("nan")
                 for cell in row] for row in each.cells
            ]  # fmt: skip
            image = axes.imshow(values, norm=LogNorm(LOW, HIGH), cmap="RdYlGn_r", aspect="auto")
            for y, row in enumerate(each.cells):
                for x, cell in enumerate(row):
                    if not cell.converged:
                        box = Rectangle((x - 0.5, y - 0.5), 1, 1, fc="#c9c9c9", ec="white")
                        axes.add_patch(box)
                    dark = cell.converged and image.to_rgba(values[y][x])[1] < DARK
                    axes.text(x, y, cell.note, ha="center", va="center", fontsize=8,
                              color="white" if dark else "black")  # fmt: skip
            axes.set_xticks(range(len(each.columns)), each.columns)
            axes.set_yticks(range(len(each.rows)), each.rows)
            axes.set(xlabel=each.label, ylabel=each.across, title=each.title)
            axes.grid(visible=False)
        shares = FuncFormatter(lambda value, _: f"{100 * value:g}%")
        bar = figure.colorbar(
            image, ax=list(panels), shrink=0.6, extend="both", format=shares
        )  # fmt: skip
        bar.set_label("error of the quantity nearest to what is allowed")
