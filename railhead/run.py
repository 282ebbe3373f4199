"""From a scene to its result: plan, mesh, solve, read."""

from __future__ import annotations

import math
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from meshing.mesh import ContactMesh
from meshing.sizing import Grading
from postprocess import compare, read
from postprocess.findings import Findings, Frame
from postprocess.patch import moments
from railhead import build
from railhead import plan as planning
from railhead.plan import Plan
from railhead.progress import Progress
from railhead.scene import Scene
from solver.contact import ContactModel, Solution
from solver.gather import Fields, gather
from theory.hertz import Ellipse

FORCE_BALANCE = 1e-6  # largest relative force imbalance that passes
OUTGROWN = 1.25  # patch over the finely meshed ellipse, either way, that calls for a new mesh
MAX_MESHES = 3


@dataclass
class Result:
    """A solved scene. findings, fields and summary exist on rank 0 (None and {} elsewhere)."""

    plan: Plan
    solution: Solution
    ellipse: Ellipse
    findings: Findings | None
    fields: Fields | None
    summary: dict[str, Any] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """Whether all checks hold."""
        return bool(self.summary and self.summary["checks"]["passed"])


def run(
    scene: Scene, progress: Progress | None = None, comm: MPI.Intracomm = MPI.COMM_WORLD
) -> Result:
    """Solve a scene. Raises SceneError for a scene that makes no contact problem, MeshError."""
    progress = progress or Progress(quiet=True)
    clock = _Clock()
    plan = planning.make(scene)
    frame = Frame(plan.contact.origin, plan.contact.touch.angle)
    grading = plan.grading()
    for attempt in range(1, MAX_MESHES + 1):
        progress.stage(f"meshing ({plan.patch_size:.3g} mm in the patch)")
        mesh = build.generate(plan, grading, comm)
        clock.lap("mesh")
        progress.stage("assembling")
        model = build.model(plan, mesh)
        clock.lap("assemble")
        progress.stage(f"solving {model.unknowns} unknowns")
        solution = solve(plan, model, frame, progress.newton)
        clock.lap("solve")
        fields = gather(model, solution)
        better = comm.bcast(None if fields is None else _regrade(plan, grading, fields, frame))
        if better is None or attempt == MAX_MESHES or not solution.newton.converged:
            break
        plan, grading = better
    progress.stage("reading the result")
    ellipse = planning.estimate(scene, plan.contact, solution.load or None)
    result = Result(plan, solution, ellipse, None, fields)
    if fields is not None:
        if np.any(fields.contact.pressure > 0):
            result.findings = read.findings(fields, frame)
        clock.lap("postprocess")
        result.summary = _summary(result, model, mesh, clock)
    return result


def solve(
    plan: Plan, model: ContactModel, frame: Frame, progress: Callable[[int, float], None]
) -> Solution:
    """Solve the plan's load or approach, starting from the Hertz ellipse."""
    scene = plan.scene

    def at(load: float, approach: float = 0.0) -> Solution:
        return model.solve(
            load=load,
            approach=approach,
            active=_hertz_set(model, frame, plan.estimate),
            max_steps=scene.solver.max_newton,
            progress=progress,
        )

    if scene.load is not None:
        return at(scene.load)
    target = float(scene.approach or 0.0)
    if not model.setup.load_control:
        return at(0.0, target)
    # Half-spaces: the far field needs the load. The approach grows about as load^(2/3).
    load = plan.estimate.load
    for _ in range(6):
        solution = at(load)
        ratio = target / solution.approach
        if abs(ratio - 1) < 1e-9 or not solution.newton.converged:
            break
        load *= ratio**1.5
    return solution


def _hertz_set(model: ContactModel, frame: Frame, ellipse: Ellipse) -> NDArray[np.bool_]:
    local = frame.local(model.interface.points)
    inside = (local[:, 0] / ellipse.a) ** 2 + (local[:, 1] / ellipse.b) ** 2 < 1.0
    return np.asarray(inside & (np.abs(local[:, 2]) < max(ellipse.a, ellipse.b)))


def _regrade(
    plan: Plan, grading: Grading, fields: Fields, frame: Frame
) -> tuple[Plan, Grading] | None:
    """A mesh around the patch that was found, where it is not the one that was predicted."""
    if not np.any(fields.contact.pressure > 0):
        return None
    found = moments(fields, frame)
    fits = all(
        1 / OUTGROWN < ratio < OUTGROWN for ratio in (found.a / grading.a, found.b / grading.b)
    )
    x, s = found.centre
    if fits and abs(x) < 0.2 * grading.a and abs(s) < 0.2 * grading.b:
        return None
    if plan.scene.mesh.patch_size is None:
        shrunk = min(found.a, found.b) / min(grading.a, grading.b)
        plan = replace(plan, patch_size=plan.patch_size * shrunk)
    centre = np.array(frame.origin) + np.array([x, s, 0.0]) @ frame.axes
    moved = replace(
        plan.grading(found.a, found.b),
        centre=(float(centre[0]), float(centre[1]), float(centre[2])),
    )
    return plan, moved


def _summary(
    result: Result, model: ContactModel, mesh: ContactMesh, clock: _Clock
) -> dict[str, Any]:
    plan, solution, found = result.plan, result.solution, result.findings
    scene, angle = plan.scene, plan.contact.touch.angle
    poisson = (
        scene.rail if not math.isinf(scene.rail.young_modulus) else scene.wheel
    ).poisson_ratio
    newton = solution.newton
    target = scene.load if scene.load is not None else solution.reaction
    balance = max(
        abs(solution.load - target) / target if target else math.inf,
        abs(solution.reaction - solution.load) / solution.load if solution.load else math.inf,
    )
    values = {
        "result": None
        if found is None
        else compare.from_findings(found, solution.load, solution.approach),
        "hertz": compare.from_hertz(result.ellipse, poisson, angle, plan.contact.origin),
        "thesis": compare.from_thesis(result.ellipse, poisson),
    }
    converged = newton.converged and found is not None
    return {
        "case": scene.name,
        "scene": scene.model_dump(exclude_none=True),
        "plan": plan.summary(),
        **values,
        "difference": None
        if found is None
        else compare.difference(values["result"], values["hertz"]),
        "accuracy": {"asked": scene.accuracy, "bound": {}, "reached": None},
        "checks": {
            "force_balance": balance,
            "max_penetration_mm": solution.penetration,
            "converged": converged,
            "hertzian": None if found is None else found.hertzian,
            "shape_error": None if found is None else found.shape_error,
            "passed": converged and balance < FORCE_BALANCE,
        },
        "newton": {
            "reason": newton.reason,
            "history": [vars(step) for step in newton.history],
        },
        "cost": {
            "dofs": model.unknowns,
            "cells": mesh.cells,
            "mesh_quality": mesh.quality,
            "ranks": model.comm.size,
            "newton_iterations": len(newton.history),
            "linear_iterations": sum(step.linear_iterations for step in newton.history),
            "peak_rss_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
            "seconds": clock.seconds,
        },
    }


class _Clock:
    """Seconds of each stage; total counts from the start of the run."""

    def __init__(self) -> None:
        self._start = self._last = time.perf_counter()
        self.seconds: dict[str, float] = {}

    def lap(self, stage: str) -> None:
        now = time.perf_counter()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self._last
        self.seconds["total"] = now - self._start
        self._last = now
