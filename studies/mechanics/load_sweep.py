"""Loads from 1 to 150 kN on one mesh, against Hertz's power laws."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.run.progress import Progress
from railhead.scene import catalogue
from studies import tables

if TYPE_CHECKING:
    from railhead.meshing.sizing import Grading
    from railhead.planning.plan import Plan
    from railhead.postprocess.findings import Frame
    from railhead.solver.contact import ContactModel
    from railhead.solver.solution import Solution
    from railhead.theory.elastic.hertz import Ellipse

CASES = {"hertz_ellipse": "half-spaces", "uic54_thesis": "wheel on UIC54"}
LOWEST, HIGHEST, COUNT = 1e3, 150e3, 10
ELEMENTS_PER_SEMI_AXIS = 5.0  # across the smallest patch
GROWTH = 0.2  # finer than usual: the largest patch reaches far into the growing zone
UNITS = {"load": "N", "a": "mm", "b": "mm", "p_max": "MPa", "approach": "mm", "tau_max": "MPa"}


QUANTITIES = ("a", "b", "p_max", "approach", "tau_max")
Row = dict[str, Any]
"""One load. Differences are relative to exact Hertz. seconds: of the solve (first load of a case:
with mesh and assembly)."""


def main(out: Path, *, quick: bool) -> None:
    """Sweep every case (quick: half-spaces and four loads), and write CSV, picture and page."""
    import numpy as np

    from studies.mechanics import load_sweep_page as sweep_page

    names = list(CASES)[: 1 if quick else None]
    loads = [float(load) for load in np.geomspace(LOWEST, HIGHEST, 4 if quick else COUNT)]
    with Progress(quiet=False) as progress:
        rows = [row for name in names for row in sweep(name, loads, progress)]
    tables.write_csv(out / "load_sweep.csv", rows, UNITS)
    series = {CASES[name]: [row for row in rows if row["case"] == name] for name in names}
    sweep_page.draw(series, out / "load_sweep.png")
    (out / "page.md").write_text(sweep_page.page(rows, CASES), encoding="utf-8")


def around_smallest(plan: Plan, lowest: float) -> Grading:
    """Fine enough for the patch of the lowest load, growing outwards over the larger ones."""
    from railhead.meshing.sizing import Grading
    from railhead.planning.references import closed_forms

    small = closed_forms.hertz_contact(plan.scene, plan.contact, lowest)
    size = min(small.a, small.b) / ELEMENTS_PER_SEMI_AXIS
    angle, coarsest = plan.contact.touch.angle, plan.sizing.coarsest
    return Grading(plan.contact.origin, small.a, small.b, angle, size, GROWTH, coarsest=coarsest)


def sweep(name: str, loads: Sequence[float], progress: Progress) -> list[Row]:
    """Solve a shipped case for all loads (N) with one mesh, stiffness and contact operators."""
    from mpi4py import MPI

    from railhead.planning import plan as planning
    from railhead.planning.references import closed_forms
    from railhead.postprocess.findings import Frame
    from railhead.run import build

    start = time.perf_counter()
    progress.stage(f"{name}: meshing and assembling")
    plan = planning.make(catalogue.find(name).replace([f"load={max(loads)!r}"]))
    mesh = build.generate(plan, around_smallest(plan, min(loads)), MPI.COMM_WORLD)
    model = build.model(plan, mesh)
    frame = Frame(plan.contact.origin, plan.contact.touch.angle)
    local = frame.local(model.interface.points)
    points: list[Row] = []
    for load in loads:
        progress.stage(f"{name}: {load:.0f} N, {model.unknowns} unknowns")
        ellipse = closed_forms.ellipse(plan.scene, plan.contact, load)
        inside = (local[:, 0] / ellipse.a) ** 2 + (local[:, 1] / ellipse.b) ** 2 < 1
        solution = model.solve(load=load, active=inside)
        points.append(_point(plan, ellipse, model, frame, solution, time.perf_counter() - start))
        start = time.perf_counter()
    return points


def _point(
    plan: Plan,
    ellipse: Ellipse,
    model: ContactModel,
    frame: Frame,
    solution: Solution,
    seconds: float,
) -> Row:
    from railhead.postprocess import compare, read
    from railhead.solver.fields import gather

    fields = gather(model, solution)
    assert fields is not None  # one process
    values = compare.from_findings(
        read.findings(fields, frame, parabolic=plan.contact.half_space),
        solution.load,
        solution.approach,
    )
    reference = compare.from_hertz(ellipse, plan.poisson_ratios, frame.angle, frame.origin)
    difference = tables.columns(compare.difference(values, reference), QUANTITIES)
    history = solution.newton.history
    return {
        "case": plan.scene.name,
        "load": solution.load,
        **tables.columns(values, QUANTITIES),
        **{f"difference_{name}": value for name, value in difference.items()},
        "unknowns": model.unknowns,
        "newton_iterations": len(history),
        "linear_iterations": sum(step.linear_iterations for step in history),
        "converged": solution.newton.converged,
        "seconds": seconds,
    }
