"""From a plan to its solved meshes: one at default settings, a sequence for an asked accuracy."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from mpi4py import MPI

from railhead.planning import cost, error_envelopes
from railhead.planning.forecast import LINEAR_REFINEMENT
from railhead.planning.simulation_plan import Plan
from railhead.run import estimates
from railhead.run.estimates import STEP_ORDER
from railhead.run.half_spaces import answer
from railhead.run.mesh_solution import MeshSolution, mesh_and_solve
from railhead.run.progress import Progress
from railhead.scene import quantities
from railhead.scene.scene import SceneError

MAX_LEVELS = 5
ONE_MESH = "one mesh"
BUDGET_SHARE = 0.85  # largest predicted time over the budget
ONE_MESH_SHARE = 0.9  # share of the accuracy that a single mesh is planned for
# Error over the change with twice the load steps: 1.3 to 1.9 from two steps on, 2.1 from one
# (pressure of a sphere at 2 to 10 times its first-yield load, beside 16 and 32 steps).
STEP_ERROR = 2.0
LOAD_STEP_SHARE = 0.4  # share of the accuracy that the error of load steps may take
MOST_STEPS = 16  # largest factor on the usual number of load steps
MARGIN = 1.1  # on the resolution of a mesh after two, and of the second one where bodies yield: a
# third one costs as much there as both


@dataclass(frozen=True)
class Ending:
    """Reason why a sequence of meshes ended.

    reason: in words.
    would_cost: unknowns and seconds that are predicted for the next mesh, which was not solved;
        None where none was planned.
    """

    reason: str
    would_cost: tuple[int, float] | None = None


def refine(
    plan: Plan, progress: Progress, comm: MPI.Intracomm
) -> tuple[list[MeshSolution], Ending]:
    """Solved meshes of a plan, coarsest first, and why the sequence ended (collective).

    A scene without accuracy and budget has one mesh. Others have a coarse and a fine one, and finer
    ones until the estimates meet the accuracy, at most five (MAX_LEVELS); without an accuracy,
    until there are estimates. Outside the calibrated families a third mesh, coarser still, is
    solved first. Where the error envelopes do not cover the coarse mesh, that mesh confirms nothing
    and is left out.

    SceneError: no mesh meets the accuracy (`_refuse`), or the only mesh of a scene does not fit
        into the memory. In a sequence a finer mesh that does not fit ends it.
    MeshError: gmsh fails.
    """
    plan.check_memory(comm.bcast(cost.free_memory()))
    if plan.scene.one_mesh:
        return [mesh_and_solve(plan, progress, comm)], Ending(ONE_MESH)
    _refuse(plan, progress)
    scene, known = plan.scene, plan.family
    wanted = plan.sizing.resolution
    if scene.budget is not None:
        wanted = _affordable(plan, wanted)
    low = error_envelopes.RANGE[0] * (LINEAR_REFINEMENT if plan.order == 1 else 1.0)
    coarse = max(wanted / error_envelopes.STEP ** (1 if known else 2), low)
    least = 2
    if known is not None and scene.budget is None and not known.covers(coarse):
        least, coarse = 1, known.finest(ONE_MESH_SHARE * plan.accuracy_of_meshes)
    meshes = [mesh_and_solve(plan.at_resolution(coarse), progress, comm)]
    if meshes[0].solution.plasticity is not None:
        meshes[0] = _with_load_step_errors(meshes[0], progress, comm)
    spent = sum(meshes[0].seconds.values())
    while True:
        done = meshes[-1]
        worst = comm.bcast(estimates.largest_error(estimates.estimate(meshes)[0], done))
        if not done.solution.newton.converged:
            return meshes, Ending("Newton's method did not converge")
        if len(meshes) >= least and scene.accuracy is not None and worst <= scene.accuracy:
            return meshes, Ending("asked accuracy reached")
        fixed = comm.bcast(estimates.of_grids(done.findings, done.result))
        if fixed >= (scene.accuracy or math.inf):
            return meshes, Ending(f"the grids of tractions leave {fixed:.1%} open on any mesh")
        if len(meshes) > 1 and scene.accuracy is None and math.isfinite(worst):
            limit = scene.budget or 0.0
            over = f"the least that gives an estimate took {spent:.1f} s, over the budget"
            return meshes, Ending("budget spent" if spent <= limit else over)
        n, covered = comm.bcast(_next(meshes, worst, wanted))
        finer = done.plan.at_resolution(n)
        would_cost = finer.unknowns, finer.mesh_seconds
        # The second mesh was priced beforehand.
        stop = comm.bcast(_obstacle(finer, spent if len(meshes) > 1 else 0.0))
        if not covered:
            stop = stop or "the error laws end at coarser meshes"
        if stop or len(meshes) == MAX_LEVELS:
            return meshes, Ending(stop or "too many meshes", would_cost)
        meshes.append(mesh_and_solve(finer, progress, comm))
        spent += sum(meshes[-1].seconds.values())


def _refuse(plan: Plan, progress: Progress) -> None:
    """Raise SceneError where no mesh meets the accuracy of a scene: measured profiles leave more
    open, or the grids of tractions, which half-spaces foresee.
    """
    wanted, fixed = plan.scene.accuracy or math.inf, {"the measured profile": plan.profile_error}
    if plan.scene.accuracy and plan.effects["friction"].on and not plan.condenses:
        foreseen = answer.solve(plan, progress)
        fixed["the grid of tractions"] = estimates.of_grids(foreseen.findings, foreseen.result)
    for what, error in fixed.items():
        if error >= wanted:
            raise SceneError("accuracy", f"{wanted:.3g}: {what} leaves {error:.2%} on any mesh")


def unplanned_yield(solved: MeshSolution, comm: MPI.Intracomm) -> str:
    """Reason why bodies yield that were planned as elastic, the same on all ranks (collective).
    Empty where bodies do not yield, where yield is already simulated or a person chose its state,
    and where friction excludes it.
    """
    effect, after = solved.plan.effects["plasticity"], solved.after.get("plasticity")
    kept = effect.on or effect.override or "on" in effect.refused
    if after is None or not after.needed or kept:
        return comm.bcast("")
    return comm.bcast(after.why)


def _affordable(plan: Plan, wanted: float) -> float:
    """Finest resolution (elements per smaller semi-axis) at which the predicted seconds of a coarse
    and a fine mesh are within 0.85 (BUDGET_SHARE) of the budget of the scene. Where none is, it is
    the least one, 4.8.

    wanted: largest resolution that is returned where the scene has an accuracy, unless it is below
        4.8. Without an accuracy the largest one is the finest that the error laws cover, or 60
        without laws.
    """
    budget = BUDGET_SHARE * float(plan.scene.budget or 0.0)
    best = n = error_envelopes.RANGE[0] * error_envelopes.STEP
    limit = wanted
    if plan.scene.accuracy is None:
        known = plan.family
        limit = error_envelopes.STEP * known.resolution[1] if known else error_envelopes.RANGE[1]
    while n <= limit and plan.at_resolution(n).seconds_of_two <= budget:
        best, n = n, 1.05 * n
    return best


def _with_load_step_errors(
    solved: MeshSolution, progress: Progress, comm: MPI.Intracomm
) -> MeshSolution:
    """The coarse solution with twice its load steps, which is solved here (collective). Its plan
    has as many steps as the accuracy needs, at most 16 times (MOST_STEPS) the usual number. Its
    `load_step_errors` are those of the usual number: twice (STEP_ERROR) the change.
    """
    plan = solved.plan
    twice = replace(plan, load_steps=2 * plan.load_steps)
    other = mesh_and_solve(twice, progress, comm)
    error: dict[str, float] = {}
    if solved.result is not None and other.result is not None:
        found = quantities.numeric_values(solved.result)
        better = quantities.numeric_values(other.result)
        error = {
            name: STEP_ERROR * abs(found[name] / better[name] - 1)
            for name in found
            if better.get(name)
        }
    shared = {name: value for name, value in error.items() if name not in error_envelopes.PLACES}
    more = max(shared.values(), default=0.0) / (LOAD_STEP_SHARE * (plan.scene.accuracy or 1.0))
    factor = min(max(1.0, comm.bcast(more) ** (1 / STEP_ORDER)), MOST_STEPS)
    steps = math.ceil(factor * plan.load_steps)
    return replace(other, plan=replace(plan, load_steps=steps), load_step_errors=error)


def _next(meshes: list[MeshSolution], worst: float, wanted: float) -> tuple[float, bool]:
    """Elements per smaller semi-axis of the next mesh, and whether error estimates exist there.
    worst: largest relative error of the last mesh; wanted: planned elements per smaller semi-axis.
    Only what it gives on rank 0 counts.
    """
    solved = meshes[-1]
    n, asked = solved.resolution, solved.plan.scene.accuracy
    known = solved.family
    if known is None or (len(meshes) > 1 and not math.isfinite(worst)):
        return error_envelopes.STEP * n, True
    if len(meshes) > 1:
        # By first-order convergence, from 1.25 n to STEP n.
        wanted = n * min(max(MARGIN * worst / (asked or worst), 1.25), error_envelopes.STEP)
    else:
        if asked is not None and solved.plan.scene.budget is None:
            found = estimates.reading_errors(solved.findings) if solved.findings is not None else {}
            limited = known.read_no_better(n, found, estimates.load_step_errors(meshes))
            wanted = limited.finest(solved.plan.accuracy_of_meshes)
            if solved.solution.plasticity is not None:
                wanted *= MARGIN
        wanted = max(wanted, 1.25 * n)
    return wanted, known.covers(wanted, [each.resolution for each in meshes])


def _obstacle(plan: Plan, spent: float) -> str:
    """Reason why the mesh of a plan is not solved (memory, or the budget after `spent` seconds;
    `spent` 0 leaves the budget out); empty if there is none.
    """
    if not plan.fits(cost.free_memory()):
        return f"memory: the next mesh needs about {plan.memory / 1e9:.1f} GB"
    limit = plan.scene.budget
    needed = cost.START + plan.seconds_of_one
    if limit is not None and spent and spent + needed > limit:
        return f"budget: the next mesh needs about {needed:.0f} s"
    return ""
