"""The work-precision picture: error against seconds, one panel for each case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.postprocess.plots.diagrams import new_figure
from studies.trends import pareto

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Row = Mapping[str, Any]
COLOURS = {
    "tetrahedron 3": "#7b4fa3",
    "tetrahedron 2": "#1f4e79",
    "tetrahedron 1": "#3b8f5a",
    "hexahedron 1": "#c8502d",
}
MARKERS = {"tetrahedron 3": "D", "tetrahedron 2": "^", "tetrahedron 1": "v", "hexahedron 1": "s"}
LINES = {"nitsche": "-", "penalty": "--"}
STAR = "#e8a800"


def draw(rows: Sequence[Row], path: Path) -> None:
    """Rows hold case, method, element, asked, seconds (s), error (relative) and converged.

    One line for each method and element; runs that did not converge are crosses, the Pareto front
    of all runs is shaded (for what time which error can be had), runs with an asked accuracy are
    stars with what was asked.
    """
    cases = list(dict.fromkeys(row["case"] for row in rows))
    with new_figure(path, max(12.5, 1.5 + 4.7 * len(cases)), 5.8) as figure:
        panels = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
        for axes, case in zip(panels, cases, strict=True):
            own = [row for row in rows if row["case"] == case and row["error"] is not None]
            _panel(axes, own)
            axes.set(title=case, xscale="log", yscale="log", xlabel="seconds")
            _plain_ticks(axes)
        panels[0].set_ylabel("worst error of a, b and the largest pressure, %")
        named: dict[str, Any] = {}
        for axes in panels:
            handles, labels = axes.get_legend_handles_labels()
            named |= dict(zip(labels, handles, strict=True))
        figure.legend(named.values(), named.keys(), loc="outside upper center", ncols=4)


def _panel(axes: Axes, rows: Sequence[Row]) -> None:
    from matplotlib import patheffects

    solved = [row for row in rows if row["converged"] and row["asked"] is None]
    for element, colour in COLOURS.items():
        for method, style in LINES.items():
            line = [r for r in solved if (r["element"], r["method"]) == (element, method)]
            name = method.replace("nitsche", "Nitsche")
            if not line:
                continue
            label = f"{element[:-2]}, order {element[-1]}, {name}"
            axes.plot(
                *_curve(line), style, color=colour, marker=MARKERS[element], ms=6,
                mfc=colour if method == "nitsche" else "white", label=label, zorder=3,
            )  # fmt: skip
    failed = [row for row in rows if not row["converged"]]
    if failed:
        axes.plot(*_curve(failed), "x", color="black", ms=8, label="not converged", zorder=4)
    seconds, errors = _curve([row for row in rows if row["converged"]])
    if seconds:
        front = pareto(seconds, errors)
        axes.step(
            [seconds[i] for i in front], [errors[i] for i in front], color="#b8c7d6", lw=9,
            where="post", solid_capstyle="round", solid_joinstyle="round", label="Pareto front",
            zorder=1,
        )  # fmt: skip
    halo = [patheffects.withStroke(linewidth=3, foreground="white")]
    for number, row in enumerate(row for row in rows if row["asked"] is not None):
        at = (row["seconds"], 100 * row["error"])
        side = 1 if number % 2 == 0 else -1  # above and below by turns: neighbours may be close
        axes.plot(
            *at, "*", color=STAR, mec="black", ms=15, lw=0, label="asked accuracy", zorder=5
        )  # fmt: skip
        axes.annotate(
            f"{100 * row['asked']:g} %", at, xytext=(0, 15 * side), textcoords="offset points",
            ha="center", va="center", path_effects=halo, zorder=6,
        )  # fmt: skip


def _curve(rows: Sequence[Row]) -> tuple[list[float], list[float]]:
    """Seconds and errors in %."""
    return [row["seconds"] for row in rows], [100 * row["error"] for row in rows]


def _plain_ticks(axes: Axes) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis, subs in ((axes.xaxis, (1, 2, 5)), (axes.yaxis, (1,))):
        axis.set_major_locator(LogLocator(subs=subs))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
