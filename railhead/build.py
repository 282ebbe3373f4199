"""From a plan to a meshed contact model."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from mpi4py import MPI
from numpy.typing import NDArray

from railhead.geometry import bodies, flat
from railhead.meshing import mesh
from railhead.meshing.bodies import Body
from railhead.meshing.sizing import Grading
from railhead.meshing.tags import CONTACT, RAIL, SUPPORT, WHEEL
from railhead.planning import exact
from railhead.planning.plan import Plan
from railhead.solver.contact import ContactModel
from railhead.solver.laws import Law
from railhead.solver.setup import Setup, Side
from railhead.theory import contacts


@dataclass(frozen=True)
class HertzFarField:
    """Displacement of both half-spaces under the Hertz pressure of a load (see `theory`)."""

    plan: Plan

    def __call__(self, load: float, body: int, points: NDArray) -> NDArray:
        """(load N, RAIL or WHEEL, points (n, 3) mm) -> (n, 3) mm; the wheel is the mirror image."""
        scene, contact = self.plan.scene, self.plan.contact
        hertz = exact.estimate(scene, contact, load)
        part = self.plan.material(body)
        mirror = [1.0, 1.0, 1.0 if body == RAIL else -1.0]
        lower = points * mirror
        lower[:, 2] = lower[:, 2].clip(max=0.0)
        constants = part.young_modulus, part.poisson_ratio
        return contacts.displacement(hertz, lower, *constants) * mirror


def parts(plan: Plan) -> list[Body]:
    """Sections and sweeps of the deformable bodies of a plan."""
    contact = plan.contact
    half = contact.revolved or (plan.half_x if contact.plane == "xz" else plan.half_y)
    make = flat.bodies if contact.plane else bodies.bodies
    whole = plan.effects["rail_section"].on
    return make(contact, plan.reach, plan.deformable, whole_section=whole, half=half)


def generate(
    plan: Plan, grading: Grading, comm: MPI.Intracomm, save: Path | None = None
) -> mesh.ContactMesh:
    """Mesh the bodies of a plan."""
    return mesh.generate(parts(plan), grading, plan.options, comm, save)


def model(plan: Plan, made: mesh.ContactMesh) -> ContactModel:
    """Assemble the contact model of a plan on its mesh."""
    scene = plan.scene

    def side(tag: int) -> Side:
        return Side(tag, CONTACT + tag, SUPPORT + tag, plan.material(tag))

    setup = Setup(
        fixed=side(RAIL),
        moving=side(WHEEL),
        slave=plan.slave,
        gap=plan.surfaces.gap(plan.slave),
        degree=plan.order,
        law=Law(scene.solver.method, scene.solver.theta, scene.solver.gamma_factor),
        planes=plan.planes,
        far_field=HertzFarField(plan) if plan.far_field else None,
        load_control=scene.load is not None or plan.far_field,
        linear=scene.solver.linear,
        kinematics=replace(
            plan.contact.kinematics,
            mean_dilatation=plan.effects["mean_dilatation"].on,
        ),
    )
    return ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
