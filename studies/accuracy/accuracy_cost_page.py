"""The page and the picture of the study accuracy_cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.postprocess.plots.diagrams import new_figure
from studies.tables import pareto, percent, plain_ticks, power_law, render

if TYPE_CHECKING:
    from matplotlib.axes import Axes


Row = Mapping[str, Any]
"""One run with the fields of the study's CSV."""
Cells = tuple[Any, ...]
DEFAULT = ("nitsche", "tetrahedron 2")
ASYMPTOTIC = 0.02  # error below which a power law is expected
SOLID185 = ("penalty", "hexahedron 1")
CUBIC = ("nitsche", "tetrahedron 3")


def page(rows: Sequence[Row], max_unknowns: int) -> str:
    """The whole page; max_unknowns: above it, runs were left out."""
    worst, a = orders(rows), orders(rows, "error_a")
    return render(
        "accuracy_cost",
        max_unknowns=max_unknowns,
        asymptotic=ASYMPTOTIC,
        fronts={case: _factor_ten(own) for case, own in _by(rows, "case").items()},
        solid185=_rival(rows, SOLID185),
        cubic=_rival(rows, CUBIC, "error_all"),
        orders=[(*key, f"{a[key]:.2f}", f"{worst[key]:.2f}") for key in worst],
        asked=[_asked(row) for row in rows if row["asked"] is not None],
        failed=[(row, _size(row)) for row in rows if not row["converged"]],
        runs=[_run(row) for row in rows if row["seconds"] is not None],
    )


def orders(rows: Sequence[Row], quantity: str = "error") -> dict[tuple[str, str, str], float]:
    """Order of convergence of an error field by (case, method, element), from converged runs."""
    found = {}
    for key, own in _by(_fixed(rows), "case", "method", "element").items():
        sizes, errors = [row["patch_size_mm"] for row in own], [row[quantity] for row in own]
        if len(own) > 1:
            found[key] = power_law(sizes, errors)[1]
    return found


def _by(rows: Sequence[Row], *keys: str) -> dict[Any, list[Row]]:
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        key = tuple(row[k] for k in keys) if len(keys) > 1 else row[keys[0]]
        groups.setdefault(key, []).append(row)
    return groups


def _fixed(rows: Sequence[Row], *which: tuple[str, str]) -> list[Row]:
    """Converged runs on given meshes, of all or of some (method, element)."""
    return [
        row
        for row in rows
        if row["converged"] and row["asked"] is None
        if not which or (row["method"], row["element"]) in which
    ]


def _factor_ten(rows: Sequence[Row]) -> dict[str, Any] | None:
    """Ends of the default's front, and the factor in time for ten in accuracy; None: no front."""
    runs = _fixed(rows, DEFAULT)
    seconds, errors = [row["seconds"] for row in runs], [row["error"] for row in runs]
    front = [runs[i] for i in pareto(seconds, errors)] if runs else []
    fine = [row for row in front if row["error"] < ASYMPTOTIC]
    front = fine if len(fine) > 1 else front
    if len(front) < 2:
        return None
    slope = power_law([row["error"] for row in front], [row["seconds"] for row in front])[1]
    return {"first": front[0], "last": front[-1], "factor": 10**-slope}


def _rival(rows: Sequence[Row], which: tuple[str, str], quantity: str = "error") -> list[Cells]:
    lines = []
    for case, own in _by(rows, "case").items():
        rivals = _fixed(own, which)
        for run in _fixed(own, DEFAULT):
            quick = [row[quantity] for row in rivals if row["seconds"] <= run["seconds"]]
            best, error = min(quick, default=None), run[quantity]
            ratio = "none as quick" if best is None else f"{best / error:.1f}"
            lines.append((case, f"{run['seconds']:.2f}", percent(error), percent(best), ratio))
    return lines


def _asked(row: Row) -> Cells:
    return (
        row["case"],
        percent(row["asked"]),
        "yes" if row["reached"] else "no",
        percent(row["error"]),
        percent(row["error_all"]),
        "-" if row["seconds"] is None else f"{row['seconds']:.2f}",
    )


def _size(row: Row) -> str:
    n = row["elements_per_semi_axis"]
    return f"asked {percent(row['asked'])}" if n is None else f"b/{n:g}"


def _run(row: Row) -> Cells:
    return (
        row["case"],
        row["method"],
        row["element"],
        _size(row),
        row["unknowns"],
        f"{row['seconds']:.2f}",
        f"{row['seconds_solve']:.2f}",
        f"{row['newton_iterations']} / {row['linear_iterations']}",
        percent(row["error"]),
        percent(row["error_approach"]),
        percent(row["error_tau_max"]),
        percent(row["error_all"]),
    )


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
            plain_ticks(axes.xaxis, (1, 2, 5))
            plain_ticks(axes.yaxis, (1,))
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
                *_curve(line),
                style,
                color=colour,
                marker=MARKERS[element],
                ms=6,
                mfc=colour if method == "nitsche" else "white",
                label=label,
                zorder=3,
            )
    failed = [row for row in rows if not row["converged"]]
    if failed:
        axes.plot(*_curve(failed), "x", color="black", ms=8, label="not converged", zorder=4)
    seconds, errors = _curve([row for row in rows if row["converged"]])
    if seconds:
        front = pareto(seconds, errors)
        axes.step(
            [seconds[i] for i in front],
            [errors[i] for i in front],
            color="#b8c7d6",
            lw=9,
            where="post",
            solid_capstyle="round",
            solid_joinstyle="round",
            label="Pareto front",
            zorder=1,
        )
    halo = [patheffects.withStroke(linewidth=3, foreground="white")]
    for number, row in enumerate(row for row in rows if row["asked"] is not None):
        at = (row["seconds"], 100 * row["error"])
        side = 1 if number % 2 == 0 else -1  # above and below by turns: neighbours may be close
        axes.plot(*at, "*", color=STAR, mec="black", ms=15, lw=0, label="asked accuracy", zorder=5)
        axes.annotate(
            f"{100 * row['asked']:g} %",
            at,
            xytext=(0, 15 * side),
            textcoords="offset points",
            ha="center",
            va="center",
            path_effects=halo,
            zorder=6,
        )


def _curve(rows: Sequence[Row]) -> tuple[list[float], list[float]]:
    """Seconds and errors in %."""
    return [row["seconds"] for row in rows], [100 * row["error"] for row in rows]
