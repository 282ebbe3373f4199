"""One solved mesh: mesh, model, solution, findings."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
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
from solver.contact import ContactModel, Solution
from solver.gather import Fields, gather
from theory.hertz import Ellipse

OUTGROWN = 1.25  # patch over the finely meshed ellipse, either way, that calls for a new mesh
MAX_MESHES = 3


@dataclass(frozen=True)
class Level:
    """fields, findings and result ("result" of summary.json) are None off rank 0, the last two
    also where nothing touches. ellipse: exact Hertz under the load that was found."""

    plan: Plan
    grading: Grading
    mesh: ContactMesh
    unknowns: int
    ranks: int
    solution: Solution
    ellipse: Ellipse
    fields: Fields | None
    findings: Findings | None
    result: dict[str, Any] | None
    seconds: dict[str, float]

    @property
    def resolution(self) -> float:
        """Elements per smaller semi-axis of the patch that was meshed for."""
        return min(self.grading.a, self.grading.b) / self.grading.size

    def finer(self, n: float) -> tuple[Plan, Grading]:
        """Plan and grading of a mesh around the same patch with n elements per semi-axis."""
        plan = replace(self.plan, patch_size=min(self.grading.a, self.grading.b) / n)
        grading = plan.grading(self.grading.a, self.grading.b)
        return plan, replace(grading, centre=self.grading.centre)


def solve_level(
    plan: Plan, grading: Grading | None, progress: Progress, comm: MPI.Intracomm
) -> Level:
    """Mesh (as planned without a grading) and solve; where the patch is not the predicted one,
    mesh again around it."""
    grading = grading or plan.grading()
    clock = _Clock()
    frame = Frame(plan.contact.origin, plan.contact.touch.angle)
    for attempt in range(1, MAX_MESHES + 1):
        progress.stage(f"meshing ({grading.size:.3g} mm in the patch)")
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
    findings = result = None
    if fields is not None and np.any(fields.contact.pressure > 0):
        findings = read.findings(fields, frame)
        result = compare.from_findings(findings, solution.load, solution.approach)
    clock.lap("postprocess")
    ellipse = planning.estimate(plan.scene, plan.contact, solution.load or None)
    return Level(
        plan, grading, mesh, model.unknowns, comm.size, solution, ellipse, fields, findings,
        result, clock.seconds,
    )  # fmt: skip


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


class _Clock:
    """Seconds of each stage."""

    def __init__(self) -> None:
        self._last = time.perf_counter()
        self.seconds = dict.fromkeys(("mesh", "assemble", "solve", "postprocess"), 0.0)

    def lap(self, stage: str) -> None:
        now = time.perf_counter()
        self.seconds[stage] += now - self._last
        self._last = now
