"""From a plan to a meshed contact model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mpi4py import MPI

from railhead.meshing import mesh
from railhead.meshing.sizing import Grading
from railhead.meshing.tags import CONTACT, RAIL, SUPPORT, WHEEL
from railhead.planning.effects import EFFECTS
from railhead.planning.plan import Plan

if TYPE_CHECKING:
    from railhead.solver.contact import ContactModel


def generate(
    plan: Plan, grading: Grading, comm: MPI.Intracomm, save: Path | None = None
) -> mesh.ContactMesh:
    """Mesh the bodies of a plan."""
    return mesh.generate(plan.parts(), grading, plan.options, comm, save, _load_solver)


def _load_solver() -> None:
    """Importing it takes about as long as gmsh takes for a small mesh."""
    from railhead.postprocess import read  # noqa: F401
    from railhead.solver import fields  # noqa: F401


def model(plan: Plan, made: mesh.ContactMesh) -> ContactModel:
    """Assemble the contact model of a plan on its mesh."""
    from railhead.solver.contact import ContactModel
    from railhead.solver.interface.frictional_model import RubbingModel, YieldingRubbingModel
    from railhead.solver.interface.laws import ContactLaw
    from railhead.solver.material.yielding import YieldingModel
    from railhead.solver.setup import ContactBody, Setup

    scene = plan.scene

    def side(tag: int) -> ContactBody:
        return ContactBody(tag, CONTACT + tag, SUPPORT + tag, plan.material(tag))

    setup = Setup(
        fixed=side(RAIL),
        moving=side(WHEEL),
        slave=plan.slave,
        gap=plan.surfaces.gap(plan.slave),
        degree=plan.order,
        law=ContactLaw(scene.solver.method, scene.solver.theta, scene.solver.gamma_factor),
        planes=plan.planes,
        load_control=scene.load is not None,
        linear=scene.solver.linear,
        kinematics=plan.contact.kinematics,
    )
    for name, effect in plan.effects.items():
        if effect.on:
            setup = EFFECTS[name].apply(setup, plan)
    kind = ContactModel
    if setup.load_path is not None:
        kind = YieldingModel if setup.friction is None else YieldingRubbingModel
    elif setup.friction is not None:
        kind = RubbingModel
    return kind(made.mesh, made.cell_tags, made.facet_tags, setup)
