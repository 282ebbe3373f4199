"""All scenes of a sweep: planned first, then solved group by group.

Scenes that differ in their load alone share one mesh, stiffness, set of contact operators and
preconditioner. The mesh is in each patch at least as fine as that load's own would be, so the error
envelopes of that one hold. Newton's method starts from the patch that is forecast for each load:
from the solution of the load before it takes two to three times the steps.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import timedelta
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

from railhead.meshing.mesh import ContactMesh, MeshError
from railhead.planning import cost
from railhead.planning import simulation_plan as planning
from railhead.planning.simulation_plan import Plan
from railhead.results import pipeline
from railhead.results.result import Result
from railhead.run import mesh_solution, refinement
from railhead.run.mesh_solution import solve_on_mesh
from railhead.run.progress import Progress
from railhead.run.refinement import Ending
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps import worker_pool
from railhead.sweeps.grid import ParameterGrid

if TYPE_CHECKING:
    from railhead.solver.contact import ContactModel

MAX_GROUP = 30  # loads that share a mesh: gmsh evaluates the size field of each everywhere
# Largest over smallest load of a group. Where some elements in a patch are more than twice as long
# as others, its half lengths are read worse: S1002 on 60E1 under 80 kN has an error in a of 0.1 %
# on a mesh that 10 kN shares, 0.7 % with 1 kN, 2.7 % with 100 N.
MAX_LOAD_RATIO = 8.0
PLANNED = 5  # scenes that a process plans in one job


def plan_each(scenes: Sequence[Scene]) -> list[Plan | SceneError]:
    """Plan scenes one after the other in this process; an error in the place of a plan says why a
    scene makes no contact problem.
    """
    planned: list[Plan | SceneError] = []
    for scene in scenes:
        try:
            planned.append(planning.make(scene))
        except SceneError as error:
            planned.append(error)
    return planned


def plan_all(
    grid: ParameterGrid,
    progress: Progress,
    submit: worker_pool.Submit | None = None,
    refused: dict[int, SceneError] | None = None,
) -> dict[int, Plan]:
    """Plans of all scenes of a grid by number. Raises SceneError, with the values of the scene, for
    the first scene that makes no contact problem; where there is a table of the `refused`, it is
    put there instead. submit: as of `worker_pool.together`.

    The approach of a whole rail is to its foot, that of a head to its cut. So that one sweep has
    one datum, `effects.rail_section` is set to on in the grid's scenes that leave it to the plan,
    where the plan of another scene has it.
    """
    total = len(grid.scenes)
    progress.stage(f"planning {total} scenes")
    jobs = [(grid.scenes[first : first + PLANNED],) for first in range(0, total, PLANNED)]
    planned: list[Plan | SceneError] = []
    for part in worker_pool.together(submit, plan_each, jobs):
        planned += part
        progress.stage(f"planning: {len(planned)} of {total} scenes")
    plans = {}
    for number, (_, error) in grid.refused.items():
        planned[number] = error
    for number, plan in enumerate(planned):
        if not isinstance(plan, SceneError):
            plans[number] = plan
        elif refused is None:
            raise SceneError(plan.key, f"{plan.text} ({grid.label(number)})")
        else:
            refused[number] = plan
    sections = {number: plan.effects["rail_section"] for number, plan in plans.items()}
    if any(each.on for each in sections.values()) and "effects.rail_section" not in grid.keys:
        for number, each in sections.items():
            scene = grid.scenes[number]
            if not each.on and "on" not in each.refused and scene.effects.rail_section == "auto":
                grid.scenes[number] = scene.replace(["effects.rail_section=on"])
                plans[number] = planning.make(grid.scenes[number])
    return plans


def group_by_mesh(plans: Mapping[int, Plan]) -> list[list[int]]:
    """Groups of numbers of plans that share a mesh, each by rising load, of at most 30 loads
    (MAX_GROUP) whose largest is at most 8 times (MAX_LOAD_RATIO) the smallest. A plan that shares
    no mesh is a group of its own.
    """
    alike: dict[str, list[int]] = {}
    for number, plan in plans.items():
        alike.setdefault(_mesh_key(number, plan), []).append(number)
    load = {number: plan.scene.load or 0.0 for number, plan in plans.items()}
    groups: list[list[int]] = []
    for numbers in alike.values():
        group: list[int] = []
        for number in sorted(numbers, key=load.__getitem__):
            full = len(group) == MAX_GROUP
            if not group or full or load[number] > MAX_LOAD_RATIO * load[group[0]]:
                groups.append(group := [])
            group.append(number)
    return groups


def forecast(grid: ParameterGrid, workers: int, progress: Progress) -> dict[str, Any]:
    """What a sweep is predicted to take, as plain data: "combinations", "meshes", "unknowns" (of
    each combination), "seconds" of the whole sweep, "processes" (workers), and "effects", the
    number of combinations by name of the effects that are on. Unknowns and seconds count loads that
    share a mesh as if each had its own. Raises SceneError for a scene that makes no contact
    problem.
    """
    numbered = plan_all(grid, progress)
    plans = [*numbered.values()]
    seconds = [plan.solving_seconds - cost.START for plan in plans]
    on = Counter(name for plan in plans for name, effect in plan.effects.items() if effect.on)
    return {
        "combinations": len(plans),
        "meshes": len(group_by_mesh(numbered)),
        "unknowns": [plan.unknowns for plan in plans],
        "seconds": cost.START + max(sum(seconds) / workers, *seconds),
        "processes": workers,
        "effects": dict(on),
    }


def words(found: Mapping[str, Any]) -> list[str]:
    """Lines that say what `forecast` found."""
    count, sizes = found["combinations"], found["unknowns"]
    duration = timedelta(seconds=round(found["seconds"]))
    return [
        f"{count} combinations on {found['meshes']} meshes",
        f"predicted: {min(sizes)} to {max(sizes)} unknowns, {duration} on {found['processes']} "
        "cores",
        *(
            f"{name}: on in {'all' if number == count else number}"
            for name, number in found["effects"].items()
        ),
    ]


def _mesh_key(number: int, plan: Plan) -> str:
    """Text that is equal for plans that may share a mesh: with finite bodies, elastic and
    frictionless (`Plan.elastic_laws_hold`) under given loads, on one mesh, with the same scene but
    the load, the same effects and the same stretch of elements.
    number: place of the plan in the list of plans; the text of one that cannot share is the number.
    """
    scene, meshed = plan.scene, plan.elastic_laws_hold and not plan.by_half_spaces
    if scene.load is None or scene.accuracy or scene.budget or not meshed:
        return str(number)
    on = {name: effect.on for name, effect in plan.effects.items()}
    return json.dumps([scene.model_dump(exclude={"load"}), on, plan.grading.stretch])


def solve_group(
    group: Mapping[int, Plan],
    wanted: Iterable[int],
    progress: Progress,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
) -> Iterator[tuple[int, Result | MeshError | SceneError]]:
    """Solve the plans whose numbers are in `wanted`, of a group (collective), as they are asked
    for; yields number and result, or the error that refused the scene.

    group: plans by number, by rising load; the mesh is made for all of them. A scene for which the
        mesh is not suitable (yield, or a patch in another place) gets a mesh of its own.
    """
    shared = _assemble(list(group.values()), progress, comm) if len(group) > 1 else None
    try:
        for number in wanted:
            try:
                result = shared and _solve_on_shared(*shared, group[number], progress, comm)
                yield number, result or pipeline.solve(group[number], progress, comm)
            except (MeshError, SceneError) as error:
                yield number, error
    finally:
        if shared:
            shared[1].release()


def _assemble(
    plans: Sequence[Plan], progress: Progress, comm: MPI.Intracomm
) -> tuple[ContactMesh, ContactModel] | None:
    """Mesh and model for all plans of a group (collective), with bodies of the size for the largest
    load. None where gmsh cannot mesh them or where they do not fit into the memory.
    """
    largest = plans[-1]
    if not largest.fits(comm.bcast(cost.free_memory())):
        return None
    # The patches set the smallest elements, the bodies of the largest load the largest: those of a
    # small load's own block, throughout a large load's, would be most of the mesh.
    first, *others = (plan.grading for plan in plans)
    shared = replace(first, coarsest=largest.coarsest, also=(*first.also, *others))
    progress.stage(f"meshing for {len(plans)} loads ({first.size:.3g} mm in the patch)")
    try:
        mesh = mesh_solution.generate(largest, shared, comm)
    except MeshError:
        return None
    progress.stage("assembling")
    return mesh, mesh_solution.assemble(largest, mesh)


def _solve_on_shared(
    mesh: ContactMesh, model: ContactModel, plan: Plan, progress: Progress, comm: MPI.Intracomm
) -> Result | None:
    """Result of one load on the shared mesh (collective); None where that mesh is not suitable: no
    convergence, a patch where the mesh is coarse, or yield.
    """
    solved = solve_on_mesh(mesh, model, plan, progress, comm)
    if solved is None or refinement.unplanned_yield(solved, comm):
        return None
    return pipeline.result([solved], Ending(refinement.ONE_MESH), progress, comm)
