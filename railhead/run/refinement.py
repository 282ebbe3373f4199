"""From a plan to its solved meshes: one at default settings, a sequence for an asked accuracy."""

import math
from dataclasses import dataclass

from mpi4py import MPI

from railhead.planning import cost, error_envelopes
from railhead.planning.forecast import LINEAR_REFINEMENT
from railhead.planning.simulation_plan import Plan
from railhead.run import estimates, half_space_answer
from railhead.run.mesh_solution import MeshSolution, mesh_and_solve
from railhead.run.progress import Progress
from railhead.scene.scene import SceneError

LEAST_MESHES = 3  # that tell an error without laws
MAX_LEVELS = 5
ONE_MESH = "one mesh"
BUDGET_SHARE = 0.85  # largest predicted time over the budget
MARGIN = 1.1  # on the estimate of a mesh that was not fine enough
LEAST_STEP = 1.15  # least factor on the resolution from one mesh to the next


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

    Where error laws hold, the first mesh is the one that the plan chose, and mostly the only one.
    Without laws it is coarser by 1.6 squared (STEP), as three meshes tell an error. Finer ones
    follow until the estimates meet the accuracy, at most five (MAX_LEVELS); without an accuracy,
    until there are estimates.

    SceneError: no mesh meets the accuracy (`_refuse`), or the only mesh of a scene does not fit
        into the memory. In a sequence a finer mesh that does not fit ends it.
    MeshError: gmsh fails.
    """
    plan.price.check_memory(comm.bcast(cost.free_memory()))
    if plan.scene.one_mesh:
        return [mesh_and_solve(plan, progress, comm)], Ending(ONE_MESH)
    _refuse(plan, progress)
    scene = plan.scene
    meshes = [mesh_and_solve(_first(plan), progress, comm)]
    spent = sum(meshes[0].seconds.values())
    while True:
        done = meshes[-1]
        known, _ = estimates.estimate(meshes)
        worst = comm.bcast(estimates.largest_error(estimates.totals(known), done))
        if not done.solution.newton.converged:
            return meshes, Ending("Newton's method did not converge")
        if scene.accuracy is not None and worst <= scene.accuracy:
            return meshes, Ending("asked accuracy reached")
        # Without laws the grid of condensed friction is that of the mesh.
        told = plan.family or not plan.condenses or len(meshes) >= LEAST_MESHES
        fixed = comm.bcast(estimates.of_grids(done) if told else 0.0)
        if fixed >= (scene.accuracy or math.inf):
            return meshes, Ending(f"the grids of tractions leave {fixed:.1%} open")
        if scene.accuracy is None and math.isfinite(worst):
            limit = scene.budget or 0.0
            over = f"the least that gives an estimate took {spent:.1f} s, over the budget"
            return meshes, Ending("budget spent" if spent <= limit else over)
        n, covered = comm.bcast(_next(meshes, worst))
        finer = done.plan.at_resolution(n)
        would_cost = finer.unknowns, finer.price.mesh_seconds
        # What gives an estimate was priced beforehand.
        stop = comm.bcast(_obstacle(finer, spent if math.isfinite(worst) else 0.0))
        if not covered:
            stop = stop or "the error laws end at coarser meshes"
        if stop or len(meshes) == MAX_LEVELS:
            return meshes, Ending(stop or "too many meshes", would_cost)
        meshes.append(mesh_and_solve(finer, progress, comm))
        spent += sum(meshes[-1].seconds.values())


def _first(plan: Plan) -> Plan:
    """The plan of the first mesh for an accuracy or a budget."""
    n = plan.resolution if plan.scene.budget is None else _affordable(plan)
    if plan.family is not None:
        return plan.at_resolution(n)
    low = error_envelopes.RANGE[0] * (LINEAR_REFINEMENT if plan.order == 1 else 1.0)
    return plan.at_resolution(max(n / error_envelopes.STEP**2, low))


def _refuse(plan: Plan, progress: Progress) -> None:
    """Raise SceneError where no mesh meets the accuracy of a scene: measured profiles leave more
    open, or the grids of tractions, which half-spaces foresee, or load steps whose errors nobody
    measured.
    """
    wanted, fixed = plan.scene.accuracy or math.inf, {"the measured profile": plan.profile_error}
    if plan.scene.accuracy and plan.effects["friction"].on and not plan.condenses:
        foreseen = half_space_answer.solve(plan, progress)
        fixed["the grid of tractions"] = estimates.of_grids(foreseen)
    for what, error in fixed.items():
        if error >= wanted:
            raise SceneError("accuracy", f"{wanted:.3g}: {what} leaves {error:.2%} on any mesh")
    if plan.scene.accuracy and plan.effects["plasticity"].on and not plan.load_step_errors:
        over = f"{plan.context.overload:.3g} times the load of first yield"
        raise SceneError("accuracy", f"{wanted:.3g}: errors of load steps are not known at {over}")


def unplanned_yield(solved: MeshSolution, comm: MPI.Intracomm) -> str:
    """Reason why bodies yield that were planned as elastic, the same on all ranks (collective).
    Empty where bodies do not yield, where yield is already simulated or a person chose its state,
    and where friction excludes it.
    """
    effect, after = solved.plan.effects["plasticity"], solved.after.get("plasticity")
    kept = effect.on or effect.override or "on" in effect.refused
    return comm.bcast("" if after is None or not after.needed or kept else after.why)


def _affordable(plan: Plan) -> float:
    """Finest resolution (elements per smaller semi-axis) at which the predicted seconds of the
    meshes of a plan are within 0.85 (BUDGET_SHARE) of the budget of the scene. Where none is, it is
    the least of the error laws, or 7.7 without laws. The largest one is that of the plan where the
    scene has an accuracy, else the finest that the error laws cover, or 60 without laws.
    """
    known, budget = plan.family, BUDGET_SHARE * float(plan.scene.budget or 0.0)
    limit = plan.resolution
    if plan.scene.accuracy is None:
        limit = error_envelopes.STEP * known.resolution[1] if known else error_envelopes.RANGE[1]
    best = n = known.resolution[0] if known else error_envelopes.RANGE[0] * error_envelopes.STEP**2
    while n <= limit and plan.at_resolution(n).price.solving_seconds <= budget:
        best, n = n, 1.05 * n
    return best


def _next(meshes: list[MeshSolution], worst: float) -> tuple[float, bool]:
    """Elements per smaller semi-axis of the next mesh, and whether error estimates exist there.
    worst: largest relative error of the last mesh. Only what it gives on rank 0 counts.

    Without laws, or an estimate, the next mesh is finer by 1.6 (STEP); else by as much as second-
    order convergence wants, from 1.15 (LEAST_STEP) to 1.6.
    """
    solved = meshes[-1]
    n, asked, known = solved.resolution, solved.plan.scene.accuracy, solved.family
    if known is None or not math.isfinite(worst):
        return error_envelopes.STEP * n, True
    ratio = math.sqrt(MARGIN * worst / (asked or worst))
    n *= min(max(ratio, LEAST_STEP), error_envelopes.STEP)
    return n, known.covers(n)


def _obstacle(plan: Plan, spent: float) -> str:
    """Reason why the mesh of a plan is not solved (memory, or the budget after `spent` seconds;
    `spent` 0 leaves the budget out); empty if there is none.
    """
    if not plan.price.fits(cost.free_memory()):
        return f"memory: the next mesh needs about {plan.price.memory / 1e9:.1f} GB"
    limit = plan.scene.budget
    needed = cost.START + plan.price.seconds_of_one
    if limit is not None and spent and spent + needed > limit:
        return f"budget: the next mesh needs about {needed:.0f} s"
    return ""
