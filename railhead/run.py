"""From a scene to its result: one mesh at default settings, a sequence for an asked accuracy."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from mpi4py import MPI

from postprocess.findings import Findings
from railhead import accuracy, machine
from railhead import plan as planning
from railhead.level import Level, solve_level
from railhead.plan import Plan
from railhead.price import affordable
from railhead.progress import Progress
from railhead.scene import Scene, SceneError
from railhead.summary import summarise
from solver.gather import Fields
from theory.hertz import Ellipse
from theory.line import LineContact

MAX_LEVELS = 5
MEMORY_SHARE = 0.8  # of the free memory that a run may take


@dataclass(frozen=True)
class Estimate:
    """What is known of the error: bound by quantity; why the sequence of meshes ended; what the
    asked accuracy would have cost (unknowns, seconds) where it was not reached."""

    bound: dict[str, float]
    reason: str
    would_cost: tuple[int, float] | None = None


@dataclass(frozen=True)
class Result:
    """A solved scene. The summary is empty off rank 0."""

    level: Level
    summary: dict[str, Any] = field(default_factory=dict)

    @property
    def plan(self) -> Plan:
        """The plan of the finest mesh."""
        return self.level.plan

    @property
    def ellipse(self) -> Ellipse | LineContact:
        """Exact Hertz under the same load."""
        return self.level.ellipse

    @property
    def fields(self) -> Fields | None:
        """The solution as arrays (rank 0)."""
        return self.level.fields

    @property
    def findings(self) -> Findings | None:
        """What was read out of it (rank 0)."""
        return self.level.findings

    @property
    def passed(self) -> bool:
        """Whether all checks hold."""
        return bool(self.summary and self.summary["checks"]["passed"])


def run(
    scene: Scene, progress: Progress | None = None, comm: MPI.Intracomm = MPI.COMM_WORLD
) -> Result:
    """Solve a scene. Raises SceneError for a scene that makes no contact problem, MeshError."""
    progress = progress or Progress(quiet=True)
    plan = planning.make(scene)
    if scene.accuracy is None and scene.budget is None:
        _check_memory(plan, comm.bcast(machine.free_memory()))
        levels = [solve_level(plan, plan.grading(), progress, comm)]
        estimate = Estimate({}, "no accuracy asked")
    else:
        levels, estimate = _refine(plan, progress, comm)
    level = levels[-1]
    if level.fields is None:
        return Result(level)
    return Result(level, summarise(levels, estimate.bound, estimate.reason, estimate.would_cost))


def _refine(plan: Plan, progress: Progress, comm: MPI.Intracomm) -> tuple[list[Level], Estimate]:
    """Solve on a coarse and a fine mesh, and on finer ones until the bounds meet the accuracy."""
    scene = plan.scene
    n = affordable(plan, plan.resolution) if scene.budget is not None else plan.resolution
    target = scene.accuracy if scene.accuracy is not None else 0.0
    low = accuracy.RANGE[0] * (planning.LINEAR_REFINEMENT if plan.order == 1 else 1.0)
    level = solve_level(plan.at_resolution(max(n / accuracy.STEP, low)), None, progress, comm)
    n = max(n, level.resolution * 1.25)
    levels, spent = [level], sum(level.seconds.values())
    bound: dict[str, float] = {}
    while True:
        coarse = levels[-1]
        finer, grading = coarse.finer(n)
        cost = finer.unknowns, machine.seconds(finer.unknowns)
        stop = comm.bcast(_obstacle(coarse, cost, spent if len(levels) > 1 else 0.0))
        if stop or len(levels) == MAX_LEVELS:
            return levels, Estimate(bound, stop or "too many meshes", cost)
        level = solve_level(finer, grading, progress, comm)
        levels.append(level)
        spent += sum(level.seconds.values())
        bound = comm.bcast(_bound(_coarser(levels), level))
        if not bound:
            return levels, Estimate({}, "no solution to bound")
        worst = max(bound.values())
        if worst <= target or scene.accuracy is None:
            reason = "asked accuracy reached" if worst <= target else "budget spent"
            return levels, Estimate(bound, reason)
        n = accuracy.next_resolution(level.resolution, worst, target)


def _coarser(levels: list[Level]) -> Level:
    """The finest mesh that is coarser than the last one by a whole step, else the first: of two
    nearly equal meshes the difference is noise. A step may fall short by a twentieth."""
    *before, last = levels
    apart = [
        level for level in before if last.resolution >= 0.95 * accuracy.STEP * level.resolution
    ]
    return (apart or before[:1])[-1]


def _check_memory(plan: Plan, free: int) -> None:
    """Refuse a first mesh that would not fit into the free memory (bytes)."""
    need = machine.memory(plan.unknowns)
    if need > MEMORY_SHARE * free:
        raise SceneError(
            "mesh.patch_size",
            f"{plan.patch_size:.3g} mm makes about {plan.unknowns:.2g} unknowns, which need "
            f"{need / 1e9:.3g} GB of {free / 1e9:.3g} GB free; give a larger one",
        )


def _bound(coarse: Level, fine: Level) -> dict[str, float]:
    if coarse.result is None or fine.result is None:
        return {}
    found = accuracy.bounds(
        accuracy.flat(coarse.result),
        accuracy.flat(fine.result),
        fine.resolution / coarse.resolution,
        fine.resolution,
        fine.laws,
    )
    return {name: bound + fine.plan.left_out for name, bound in found.items()}


def _obstacle(done: Level, cost: tuple[int, float], spent: float) -> str:
    """Why the next mesh is not solved; empty if it is. The second mesh was priced beforehand and
    comes with `spent` 0: without it there is no bound at all."""
    scene = done.plan.scene
    if not done.solution.newton.converged:
        return "Newton's method did not converge"
    if machine.memory(cost[0]) > MEMORY_SHARE * machine.free_memory():
        return f"memory: the next mesh needs about {machine.memory(cost[0]) / 1e9:.1f} GB"
    if scene.budget is not None and spent and machine.START + spent + cost[1] > scene.budget:
        return f"budget: the next mesh needs about {cost[1]:.0f} s"
    return ""
