"""From a scene or a plan to its result."""

import os
from dataclasses import replace

from mpi4py import MPI

from railhead.planning import cost
from railhead.planning import simulation_plan as planning
from railhead.postprocess.pass_rows import Passes
from railhead.results.result import Result
from railhead.results.summary import summarise, summarise_half_spaces
from railhead.run import half_space_answer
from railhead.run.mesh_solution import MeshSolution
from railhead.run.progress import Progress
from railhead.run.refinement import refine, unplanned_yield
from railhead.scene.scene import Scene


def run(
    scene: Scene, progress: Progress | None = None, comm: MPI.Intracomm = MPI.COMM_WORLD
) -> Result:
    """Plan and solve a scene; collective. Raises SceneError for a scene that makes no contact
    problem or does not fit into the memory, MeshError where gmsh fails.

    progress: shows what is done; None: nothing is shown.
    """
    return solve(planning.make(scene), progress or Progress(quiet=True), comm)


def solve(plan: planning.Plan, progress: Progress, comm: MPI.Intracomm = MPI.COMM_WORLD) -> Result:
    """Solve a plan on all meshes that its scene asks for, and its passes over a rail that yields;
    collective. Where bodies yield that were planned as elastic, solve again with yield. Without
    finite bodies half-spaces are solved, on every rank. A solution that did not converge, or fails
    a check, is a result, too. The summary is the same on all ranks; fields, findings and passes are
    on rank 0 only. Raises SceneError for a mesh that does not fit into the memory, or with too many
    unknowns for friction, MeshError where gmsh fails.
    """
    if plan.by_half_spaces:
        solved = half_space_answer.solve(plan, progress)
        solved = replace(solved, passes=_passes(solved, progress))
        return Result(solved, summarise_half_spaces(solved))
    begun = sum(os.times()[:4])  # of the processor, by this process and those it started
    levels, ending = refine(plan, progress, comm)
    if comm.size == 1:
        _record_speed(levels, sum(os.times()[:4]) - begun)
    if why := unplanned_yield(levels[-1], comm):
        levels, ending = refine(plan.with_yield(why), progress, comm)
    levels[-1] = last = replace(levels[-1], passes=_passes(levels[-1], progress))
    return Result(last, comm.bcast(None if last.fields is None else summarise(levels, ending)))


def _passes(solved: half_space_answer.Solved, progress: Progress) -> Passes | None:
    """Passes of the wheel of a solved scene over its rail, on this process alone; None where the
    plan has none, nothing touches, or off rank 0.
    """
    if not solved.plan.effects["passes"].on or solved.findings is None:
        return None
    from railhead.run import passes_of_scene

    return passes_of_scene.solve_passes(solved, progress)


def _record_speed(levels: list[MeshSolution], taken: float) -> None:
    """Record the processor seconds of meshes for later predictions on this machine, if all are
    elastic and frictionless and have 20 000 unknowns or more.
    """
    elastic = all(level.plan.elastic_laws_hold for level in levels)
    if elastic and min(level.unknowns for level in levels) >= cost.LEAST_UNKNOWNS:
        times = [level.plan.price.cost_per_unknown.time(level.unknowns) for level in levels]
        cost.record(taken, sum(times))
