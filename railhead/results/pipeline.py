"""From a scene or a plan to its result."""

from __future__ import annotations

from mpi4py import MPI

from railhead.planning import plan as planning
from railhead.planning.cost import machine
from railhead.planning.plan import Plan
from railhead.results.result import Result
from railhead.results.summary import summarise
from railhead.run.mesh_solution import MeshSolution
from railhead.run.progress import Progress
from railhead.run.refinement import Ending, refine, unplanned_yield
from railhead.scene.scene import Rail, Scene, Wheel


def run(
    scene: Scene, progress: Progress | None = None, comm: MPI.Intracomm = MPI.COMM_WORLD
) -> Result:
    """Solve a scene. Raises SceneError for a scene that makes no contact problem, MeshError."""
    return solve(planning.make(scene), progress or Progress(quiet=True), comm)


def solve(plan: Plan, progress: Progress, comm: MPI.Intracomm = MPI.COMM_WORLD) -> Result:
    """Solve what is planned. Raises SceneError for a mesh that does not fit, MeshError."""
    levels, ending = refine(plan, progress, comm)
    if why := unplanned_yield(levels[-1], comm):
        levels, ending = refine(plan.turned_on("plasticity", why), progress, comm)
    return result(levels, ending, comm)


def result(levels: list[MeshSolution], ending: Ending, comm: MPI.Intracomm) -> Result:
    """Of the last of some meshes, alike on all ranks."""
    solved = levels[-1]
    return Result(solved, comm.bcast(None if solved.fields is None else summarise(levels, ending)))


def measure_speed() -> float:
    """Solve a small case twice (the first time compiles) and keep the time of the second, over that
    of the reference machine."""
    case = Scene(
        name="speed",
        load=25e3,
        rail=Rail(profile="arc", crown_radius=300, extent="half-space"),
        wheel=Wheel(profile="cylinder", rolling_radius=420),
    )
    run(case)
    cost = run(case).summary["cost"]
    factor = float(cost["seconds"]["total"] / cost["dofs"] / machine.REFERENCE)
    machine.keep(factor)
    return factor
