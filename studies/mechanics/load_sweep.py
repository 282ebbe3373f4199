"""Loads from 1 to 150 kN on one mesh, against Hertz's power laws."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.run.progress import Progress
from railhead.scene import catalogue
from studies.tables import write_csv

if TYPE_CHECKING:
    from railhead.meshing.sizing import Grading
    from railhead.planning.plan import Plan
    from railhead.postprocess.findings import Frame
    from railhead.solver.contact import ContactModel
    from railhead.solver.solution import Solution
    from railhead.theory.elastic.hertz import Ellipse

STUDY = "loads from 1 to 150 kN on one mesh against Hertz's power laws (thesis, figures 6.8-6.10)"
CASES = {"hertz_ellipse": "half-spaces", "uic54_thesis": "wheel on UIC54"}
LOWEST, HIGHEST, COUNT = 1e3, 150e3, 10
ELEMENTS_PER_SEMI_AXIS = 5.0  # across the smallest patch
GROWTH = 0.2  # finer than usual: the largest patch reaches far into the growing zone
UNITS = {"load": "N", "a": "mm", "b": "mm", "p_max": "MPa", "approach": "mm", "tau_max": "MPa"}


@dataclass(frozen=True)
class Point:
    """One load. Differences are relative to exact Hertz. seconds: of the solve (first load of a
    case: with mesh and assembly)."""

    case: str
    load: float
    a: float
    b: float
    p_max: float
    approach: float
    tau_max: float
    difference_a: float
    difference_b: float
    difference_p_max: float
    difference_approach: float
    difference_tau_max: float
    unknowns: int
    newton_iterations: int
    linear_iterations: int
    converged: bool
    seconds: float


def main(out: Path, *, quick: bool) -> None:
    """Sweep every case (quick: half-spaces and four loads), and write CSV, picture and page."""
    import numpy as np

    from studies.mechanics import load_sweep_page as sweep_page

    names = list(CASES)[: 1 if quick else None]
    loads = [float(load) for load in np.geomspace(LOWEST, HIGHEST, 4 if quick else COUNT)]
    with Progress(quiet=False) as progress:
        points = [point for name in names for point in sweep(name, loads, progress)]
    write_csv(out / "load_sweep.csv", points, UNITS)
    rows = [vars(point) for point in points]
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
    return Grading(
        plan.contact.origin, small.a, small.b, angle, size, GROWTH, coarsest=coarsest
    )  # fmt: skip


def sweep(name: str, loads: Sequence[float], progress: Progress) -> list[Point]:
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
    points: list[Point] = []
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
) -> Point:
    from railhead.postprocess import compare, read
    from railhead.solver.fields import gather

    fields = gather(model, solution)
    assert fields is not None  # one process
    values = compare.from_findings(
        read.findings(fields, frame, parabolic=plan.contact.half_space),
        solution.load,
        solution.approach,
    )  # fmt: skip
    reference = compare.from_hertz(ellipse, plan.poisson_ratios, frame.angle, frame.origin)
    return Point(
        plan.scene.name,
        solution.load,
        *_quantities(values),
        *_quantities(compare.difference(values, reference)),
        model.unknowns,
        len(solution.newton.history),
        sum(step.linear_iterations for step in solution.newton.history),
        solution.newton.converged,
        seconds,
    )


def _quantities(values: dict[str, Any]) -> tuple[float, float, float, float, float]:
    patch, stress = values["patch"], values["stress"]
    return (
        patch["a_mm"],
        patch["b_mm"],
        values["pressure"]["max_MPa"],
        values["approach_mm"],
        stress["tau_max_MPa"],
    )
