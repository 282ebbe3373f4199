"""The page and the picture of the study load_sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from railhead.postprocess.findings import Array
from railhead.postprocess.plots.diagrams import FE, HERTZ, new_figure
from studies import tables
from studies.tables import power_law, render

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis


Row = Mapping[str, Any]
"""One load with the fields of the study's CSV, without units."""
LAWS = {
    ("a", "load"): 1 / 3,
    ("b", "load"): 1 / 3,
    ("p_max", "load"): 1 / 3,
    ("approach", "load"): 2 / 3,
    ("tau_max", "load"): 1 / 3,
    ("p_max", "a"): 1.0,
}
"""Hertz's exponents of one quantity in another."""
QUANTITIES = ("a", "b", "p_max", "approach", "tau_max")


def page(rows: Sequence[Row], cases: Mapping[str, str]) -> str:
    """The whole page; cases: name and description."""
    own = {name: [row for row in rows if row["case"] == name] for name in cases}
    return render("load_sweep", cases=[_case(cases[name], own[name]) for name in own if own[name]])


def exponents(rows: Sequence[Row]) -> dict[tuple[str, str], float]:
    """Fitted exponents of one case, with the keys of LAWS."""
    return {
        (y, x): power_law([row[x] for row in rows], [row[y] for row in rows])[1] for y, x in LAWS
    }


def _case(text: str, rows: Sequence[Row]) -> dict[str, Any]:
    fitted, further = exponents(rows), rows[1:]
    return {
        "name": rows[0]["case"],
        "text": text,
        "loads": [_load(row) for row in rows],
        "exponents": [
            (y, x, f"{fitted[y, x]:.4f}", f"{exact:.4f}") for (y, x), exact in LAWS.items()
        ],
        "worst": max(abs(row[f"difference_{key}"]) for row in rows for key in ("a", "b", "p_max")),
        "unknowns": rows[0]["unknowns"],
        "first": rows[0]["seconds"],
        "further": median(row["seconds"] for row in further),
        "krylov": median(row["linear_iterations"] for row in further),
    }


def _load(row: Row) -> list[str]:
    load = f"{row['load'] / 1000:.4g}" + ("" if row["converged"] else " (not converged)")
    return [load, *(f"{row[key]:.4g} ({row[f'difference_{key}']:+.2%})" for key in QUANTITIES)]


Series = Mapping[str, Sequence[Mapping[str, Any]]]
"""By the name of the case: one mapping for each load, with the keys of the panels."""

LOAD = ("load", "load, kN", 1e-3)
A = ("a", "semi-axis a along the rail, mm", 1.0)
P_MAX = ("p_max", "largest pressure, MPa", 1.0)
PANELS = (
    (LOAD, P_MAX),
    (LOAD, A),
    (A, P_MAX),
    (LOAD, ("approach", "approach, µm", 1e3)),
    (LOAD, ("tau_max", "largest shear stress, MPa", 1.0)),
)
DIFFERENCES = {"a": "-", "b": "--", "p_max": ":", "tau_max": "-."}
NAMES = {"a": "a", "b": "b", "p_max": "largest pressure", "tau_max": "largest shear stress"}
LOOKS: tuple[dict[str, Any], ...] = (
    {"marker": "o", "color": FE},
    {"marker": "s", "color": "#3b8f5a", "ms": 8, "mfc": "none", "mew": 1.4},
)


def draw(series: Series, path: Path) -> None:
    """Five quantities with fitted exponents beside exact Hertz, and the differences from it.

    Every mapping holds load (N), a, b, approach (mm), p_max, tau_max (MPa), and difference_<q>,
    (FE - Hertz) / Hertz. One or two cases; Hertz is drawn for the first one.
    """
    with new_figure(path, 13.5, 8.2) as figure:
        panels = figure.subplots(2, 3).ravel()
        for axes, (x, y) in zip(panels, PANELS, strict=False):
            _panel(axes, series, x, y)
        _differences(panels[-1], series)
        handles = {
            label: handle
            for handle, label in zip(*panels[0].get_legend_handles_labels(), strict=True)
        }
        names = [label.split(":")[0] for label in handles]
        figure.legend(handles.values(), names, loc="outside upper center", ncols=len(names))


def _panel(
    axes: Axes, series: Series, x: tuple[str, str, float], y: tuple[str, str, float]
) -> None:
    (of, x_label, x_unit), (what, y_label, y_unit) = x, y
    exact = _exact(next(iter(series.values())), of), _exact(next(iter(series.values())), what)
    slope = power_law(list(exact[0]), list(exact[1]))[1]
    axes.plot(exact[0] * x_unit, exact[1] * y_unit, color=HERTZ, label=f"exact Hertz: {slope:.3f}")
    for (name, points), look in zip(series.items(), LOOKS, strict=False):
        values = [[point[key] for point in points] for key in (of, what)]
        slope = power_law(*values)[1]
        axes.plot(
            np.array(values[0]) * x_unit,
            np.array(values[1]) * y_unit,
            lw=0,
            label=f"finite elements, {name}: {slope:.3f}",
            **look,
        )
    handles, labels = axes.get_legend_handles_labels()
    short = [label.removeprefix("finite elements, ") for label in labels]
    axes.legend(handles, short, title="exponent", loc="upper left", fontsize=9, title_fontsize=9)
    axes.set(xscale="log", yscale="log", xlabel=x_label, ylabel=y_label)
    _plain_ticks(axes.xaxis, *axes.get_xlim())
    _plain_ticks(axes.yaxis, *axes.get_ylim())


def _exact(points: Sequence[Mapping[str, Any]], key: str) -> Array:
    """Hertz's value from the finite elements' and the difference; the load itself is given."""
    return np.array([point[key] / (1 + point.get(f"difference_{key}", 0.0)) for point in points])


def _plain_ticks(axis: Axis, low: float, high: float) -> None:
    """1, 2, 5 and their decades; closer where the range is below a decade."""
    tables.plain_ticks(axis, (1, 2, 5) if high > 10 * low else (1, 1.5, 2, 3, 4, 6, 8))


def _differences(axes: Axes, series: Series) -> None:
    """(FE - Hertz) / Hertz: the colour names the case, the line the quantity."""
    for points, look in zip(series.values(), LOOKS, strict=False):
        load = [point["load"] * 1e-3 for point in points]
        for quantity, style in DIFFERENCES.items():
            values = [100 * point[f"difference_{quantity}"] for point in points]
            axes.plot(load, values, style, color=look["color"])
    for quantity, style in DIFFERENCES.items():
        axes.plot([], [], style, color="black", label=NAMES[quantity])
    axes.axhline(0, color=HERTZ, lw=1, zorder=1)
    axes.set(xscale="log", xlabel="load, kN", ylabel="difference from Hertz, %")
    axes.legend(loc="upper left", fontsize=9, ncols=2)
    _plain_ticks(axes.xaxis, *axes.get_xlim())
