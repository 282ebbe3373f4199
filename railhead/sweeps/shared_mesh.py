"""Scenes that differ in their load alone: one mesh, stiffness, contact operators and
preconditioner for all of them.

The mesh is in each patch at least as fine as that load's own would be, so what is known of the
errors of that one holds. Newton's method starts from the patch that is forecast for the load: from
the one found under the load before it takes two to three times the steps.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace

from mpi4py import MPI

from railhead.meshing.mesh import ContactMesh, MeshError
from railhead.planning import plan as planning
from railhead.planning.cost import machine, price
from railhead.planning.plan import Plan
from railhead.results import pipeline
from railhead.results.result import Result
from railhead.run import build, refinement
from railhead.run.mesh_solution import solve_on_mesh
from railhead.run.progress import Progress
from railhead.run.refinement import Ending
from railhead.scene.scene import Scene, SceneError
from railhead.solver.contact import ContactModel

MOST = 30  # loads that share a mesh: gmsh weighs each at every point
SPAN = 8.0  # largest over smallest of them: where elements in a patch are more than about twice as
# long here as there, its reading suffers (S1002 on 60E1: 80 kN with 10 kN on one mesh a is 0.1 %
# off, with 1 kN 0.7 %, with 100 N, too, 2.7 %)


def groups(plans: Sequence[Plan]) -> list[list[int]]:
    """Indices of the plans that share a mesh, each by rising load; the others alone."""
    found: dict[str, list[int]] = {}
    for index, plan in enumerate(plans):
        found.setdefault(_alike(index, plan), []).append(index)
    load = [plan.scene.load or 0.0 for plan in plans]
    made: list[list[int]] = []
    for alike in found.values():
        group: list[int] = []
        for index in sorted(alike, key=load.__getitem__):
            if not group or len(group) == MOST or load[index] > SPAN * load[group[0]]:
                made.append(group := [])
            group.append(index)
    return made


def _alike(index: int, plan: Plan) -> str:
    """The same for plans that may share a mesh: elastic and frictionless under given loads, without
    an asked accuracy, and with the same effects."""
    scene = plan.scene
    if scene.load is None or scene.accuracy or scene.budget or not plan.plain:
        return str(index)
    on = {name: effect.on for name, effect in plan.effects.items()}
    return json.dumps([scene.model_dump(exclude={"load"}), on, plan.grading().stretch])


def run(
    scenes: Sequence[Scene],
    wanted: Sequence[int],
    progress: Progress,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
) -> Iterator[tuple[int, Result | MeshError | SceneError]]:
    """Solve those scenes of a group whose indices are wanted, or say what refuses them; what the
    mesh of the group does not suit (it yields, or its patch is not the forecast one) has one of its
    own, as in `refine.run`."""
    plans = [planning.make(scene) for scene in scenes]
    shared = _model(plans, progress, comm) if len(plans) > 1 else None
    try:
        for index in wanted:
            try:
                result = shared and _on(*shared, plans[index], progress, comm)
                yield index, result or pipeline.run(scenes[index], progress, comm)
            except (MeshError, SceneError) as error:
                yield index, error
    finally:
        if shared:
            shared[1].release()


def _model(
    plans: Sequence[Plan], progress: Progress, comm: MPI.Intracomm
) -> tuple[ContactMesh, ContactModel] | None:
    """Bodies as large as the largest load wants them; None where gmsh cannot mesh them, or where
    they do not fit into the memory."""
    largest = plans[-1]
    if not price.fits(largest, comm.bcast(machine.free_memory())):
        return None
    # The patches ask for the smallest elements, the bodies for the largest: those of a small load's
    # own block, throughout a large load's, would be most of the mesh.
    first, *others = (plan.grading() for plan in plans)
    shared = replace(first, coarsest=largest.coarsest, also=(*first.also, *others))
    progress.stage(f"meshing for {len(plans)} loads ({first.size:.3g} mm in the patch)")
    try:
        mesh = build.generate(largest, shared, comm)
    except MeshError:
        return None
    progress.stage("assembling")
    return mesh, build.model(largest, mesh)


def _on(
    mesh: ContactMesh, model: ContactModel, plan: Plan, progress: Progress, comm: MPI.Intracomm
) -> Result | None:
    solved = solve_on_mesh(mesh, model, plan, progress, comm)
    if solved is None or refinement.unplanned_yield(solved, comm):
        return None
    return pipeline.result([solved], Ending(refinement.ONE_MESH), comm)
