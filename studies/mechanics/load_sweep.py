"""Loads from 1 to 150 kN on one mesh, against Hertz's power laws."""

import itertools
import math
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from mpi4py import MPI

from railhead.contact import closed_forms
from railhead.meshing.grading import Grading
from railhead.planning import simulation_plan as planning
from railhead.postprocess import read
from railhead.postprocess.findings import Array, Frame
from railhead.postprocess.patch import compare
from railhead.postprocess.pictures.diagrams import FE, HERTZ, new_figure
from railhead.run import mesh_solution
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.solver.contact import ContactModel
from railhead.solver.system.fields import gather
from railhead.solver.system.solution import Solution
from railhead.theory.elastic.hertz import Ellipse
from studies.tables import Row, columns, groups, log_axes, plain_ticks, power_law, publish, render

CASES = {"hertz_ellipse": "half-spaces", "uic54_thesis": "wheel on UIC54"}
LOWEST, HIGHEST, COUNT = 1e3, 150e3, 10
ELEMENTS_PER_SEMI_AXIS = 5.0  # across the smallest patch
GROWTH = 0.2  # finer than usual: the largest patch reaches far into the growing zone
UNITS = {"load": "N", "a": "mm", "b": "mm", "p_max": "MPa", "approach": "mm", "tau_max": "MPa"}
QUANTITIES = ("a", "b", "p_max", "approach", "tau_max")
LAWS = {
    ("a", "load"): 1 / 3,
    ("b", "load"): 1 / 3,
    ("p_max", "load"): 1 / 3,
    ("approach", "load"): 2 / 3,
    ("tau_max", "load"): 1 / 3,
    ("p_max", "a"): 1.0,
}
"""Hertz's exponents of one quantity in another."""
LABELS = {
    "load": ("load, kN", 1e-3),
    "a": ("semi-axis a along the rail, mm", 1.0),
    "p_max": ("largest pressure, MPa", 1.0),
    "approach": ("approach, µm", 1e3),
    "tau_max": ("largest shear stress, MPa", 1.0),
}
"""Label of an axis, and factor from the unit of the rows to that of the label."""
PANELS = (
    ("load", "p_max"),
    ("load", "a"),
    ("a", "p_max"),
    ("load", "approach"),
    ("load", "tau_max"),
)
DIFFERENCES = {
    "a": ("-", "a"),
    "b": ("--", "b"),
    "p_max": (":", "largest pressure"),
    "tau_max": ("-.", "largest shear stress"),
}
LOOKS: tuple[dict[str, Any], ...] = (
    {"marker": "o", "color": FE},
    {"marker": "s", "color": "#3b8f5a", "ms": 8, "mfc": "none", "mew": 1.4},
)


def main(out: Path, *, quick: bool) -> None:
    """Sweep every case (quick: half-spaces and four loads), and write CSV, picture and page."""
    names = list(CASES)[: 1 if quick else None]
    loads = [float(load) for load in np.geomspace(LOWEST, HIGHEST, 4 if quick else COUNT)]
    with Progress(quiet=False) as progress:
        rows = [row for name in names for row in sweep(name, loads, progress)]
    draw({CASES[name]: own for name, own in groups(rows, "case").items()}, out / "load_sweep.png")
    publish(out, page(rows), UNITS, load_sweep=rows)


def around_smallest(plan: planning.Plan, lowest: float) -> Grading:
    """Grading that is fine enough for the patch of the lowest load (N) and grows outwards over the
    larger patches."""
    small = closed_forms.hertz_contact(plan.scene, plan.contact, lowest)
    size = min(small.a, small.b) / ELEMENTS_PER_SEMI_AXIS
    return Grading(
        centre=plan.contact.origin,
        a=small.a,
        b=small.b,
        angle=plan.contact.touch.angle,
        size=size,
        growth=GROWTH,
        coarsest=plan.coarsest,
    )


def sweep(name: str, loads: Sequence[float], progress: Progress) -> list[Row]:
    """Solve a shipped case for all loads (N) with one mesh, stiffness and contact operators.

    Differences of a row are relative to exact Hertz; seconds: of the solve (first load of a case:
    with mesh and assembly).
    """
    start = time.perf_counter()
    progress.stage(f"{name}: meshing and assembling")
    plan = planning.make(catalogue.find(name).replace([f"load={max(loads)!r}"]))
    mesh = mesh_solution.generate(plan, around_smallest(plan, min(loads)), MPI.COMM_WORLD)
    model = mesh_solution.assemble(plan, mesh)
    frame = Frame(plan.contact.origin, plan.contact.touch.angle)
    x, y, _ = frame.local(model.interface.points).T
    rows: list[Row] = []
    for load in loads:
        progress.stage(f"{name}: {load:.0f} N, {model.unknowns} unknowns")
        ellipse = closed_forms.ellipse(plan.scene, plan.contact, load)
        inside = (x / ellipse.a) ** 2 + (y / ellipse.b) ** 2 < 1
        row = _row(plan, ellipse, model, frame, model.solve(load=load, active=inside))
        rows.append(row | {"seconds": time.perf_counter() - start})
        start = time.perf_counter()
    return rows


def _row(
    plan: planning.Plan, ellipse: Ellipse, model: ContactModel, frame: Frame, solution: Solution
) -> dict[str, Any]:
    """Row of one load, without seconds."""
    fields, newton = gather(model, solution), solution.newton
    assert fields is not None  # one process
    findings = read.findings(fields, frame, parabolic=plan.contact.half_space)
    values = compare.from_findings(findings, solution.load, solution.approach)
    reference = compare.from_exact(
        ellipse,
        plan.poisson_ratios,
        frame.angle,
        frame.origin,
        ellipse.approach / math.cos(frame.angle),
    )
    difference = columns(compare.difference(values, reference), QUANTITIES)
    return {
        "case": plan.scene.name,
        "load": solution.load,
        **columns(values, QUANTITIES),
        **{f"difference_{name}": value for name, value in difference.items()},
        "unknowns": model.unknowns,
        "newton_iterations": len(newton.history),
        "linear_iterations": sum(step.linear_iterations for step in newton.history),
        "converged": newton.converged,
    }


def page(rows: Sequence[Row]) -> str:
    """Text of docs/load-sweep.md."""
    return render("load_sweep", cases=[_case(own) for own in groups(rows, "case").values()])


def exponents(rows: Sequence[Row]) -> dict[tuple[str, str], float]:
    """Fitted exponents of one case, with the keys of LAWS."""
    return {
        (y, x): power_law([row[x] for row in rows], [row[y] for row in rows])[1] for y, x in LAWS
    }


def _case(rows: Sequence[Row]) -> dict[str, Any]:
    """Values of the page's template for the rows of one case."""
    fitted, further = exponents(rows), rows[1:]
    return {
        "name": rows[0]["case"],
        "text": CASES[rows[0]["case"]],
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
    """Cells of a table for one load: quantities with their differences from Hertz."""
    load = f"{row['load'] / 1000:.4g}" + ("" if row["converged"] else " (not converged)")
    return [load, *(f"{row[key]:.4g} ({row[f'difference_{key}']:+.2%})" for key in QUANTITIES)]


def draw(series: Mapping[str, Sequence[Row]], path: Path) -> None:
    """Draw five quantities with fitted exponents beside exact Hertz, and the differences from it.

    series: rows of one or two cases by the name of the case; Hertz is drawn for the first one.
    """
    with new_figure(path, 13.5, 8.2) as figure:
        panels = figure.subplots(2, 3).ravel()
        for axes, (x, y) in zip(panels, PANELS, strict=False):
            _panel(axes, series, x, y)
        _differences(panels[-1], series)
        handles, labels = panels[0].get_legend_handles_labels()
        names = [label.split(":")[0] for label in labels]
        figure.legend(handles, names, loc="outside upper center", ncols=len(names))


def _panel(axes: Axes, series: Mapping[str, Sequence[Row]], x: str, y: str) -> None:
    """Draw the points of each case and Hertz's curve, with exponents; x, y: keys of LABELS."""
    first, units = next(iter(series.values())), (LABELS[x][1], LABELS[y][1])

    def plot(label: str, values: Sequence[Array], **look: Any) -> None:
        scaled = (each * unit for each, unit in zip(values, units, strict=True))
        axes.plot(*scaled, label=f"{label}: {power_law(*map(list, values))[1]:.3f}", **look)

    plot("exact Hertz", [_exact(first, key) for key in (x, y)], color=HERTZ)
    for (name, rows), look in zip(series.items(), LOOKS, strict=False):
        values = [np.array([row[key] for row in rows]) for key in (x, y)]
        plot(f"finite elements, {name}", values, lw=0, **look)
    handles, labels = axes.get_legend_handles_labels()
    short = [label.removeprefix("finite elements, ") for label in labels]
    axes.legend(handles, short, title="exponent", loc="upper left", fontsize=9, title_fontsize=9)
    log_axes(axes, xlabel=LABELS[x][0], ylabel=LABELS[y][0])


def _exact(rows: Sequence[Row], key: str) -> Array:
    """Hertz's value from the finite elements' and the difference; the load itself is given."""
    return np.array([row[key] / (1 + row.get(f"difference_{key}", 0.0)) for row in rows])


def _differences(axes: Axes, series: Mapping[str, Sequence[Row]]) -> None:
    """Draw (FE - Hertz) / Hertz: the colour shows the case, the line style the quantity."""
    cases = zip(series.values(), LOOKS, strict=False)
    for (rows, look), (key, (style, _)) in itertools.product(cases, DIFFERENCES.items()):
        values = [100 * row[f"difference_{key}"] for row in rows]
        axes.plot([row["load"] * 1e-3 for row in rows], values, style, color=look["color"])
    for style, name in DIFFERENCES.values():
        axes.plot([], [], style, color="black", label=name)
    axes.axhline(0, color=HERTZ, lw=1, zorder=1)
    axes.set(xscale="log", xlabel="load, kN", ylabel="difference from Hertz, %")
    axes.legend(loc="upper left", fontsize=9, ncols=2)
    plain_ticks(axes.xaxis, (1, 2, 5))
