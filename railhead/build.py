"""From a plan to a meshed contact model."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mpi4py import MPI
from numpy.typing import NDArray

from meshing import mesh
from meshing.sizing import Grading
from meshing.tags import CONTACT, RAIL, SUPPORT, WHEEL
from railhead import geometry
from railhead import plan as planning
from railhead.plan import Plan
from railhead.scene import Scene
from solver.contact import ContactModel, Setup, Side
from solver.elasticity import Material
from solver.laws import Law
from theory.halfspace import hertz_displacement


def material(scene: Scene, body: int) -> Material:
    """Elastic constants of RAIL or WHEEL."""
    part = scene.rail if body == RAIL else scene.wheel
    return Material(part.young_modulus, part.poisson_ratio)


@dataclass(frozen=True)
class HertzFarField:
    """Displacement of both half-spaces under the Hertz pressure of a load (see `theory`)."""

    plan: Plan

    def __call__(self, load: float, body: int, points: NDArray) -> NDArray:
        """(load N, RAIL or WHEEL, points (n, 3) mm) -> (n, 3) mm; the wheel is the mirror image."""
        scene, contact = self.plan.scene, self.plan.contact
        ellipse = planning.estimate(scene, contact, load)
        part = material(scene, body)
        mirror = [1.0, 1.0, 1.0 if body == RAIL else -1.0]
        lower = points * mirror
        lower[:, 2] = lower[:, 2].clip(max=0.0)
        return hertz_displacement(ellipse, lower, part.young_modulus, part.poisson_ratio) * mirror


def generate(
    plan: Plan, grading: Grading, comm: MPI.Intracomm, save: Path | None = None
) -> mesh.ContactMesh:
    """Mesh the bodies of a plan."""
    parts = geometry.bodies(plan.contact, plan.reach, half=plan.half_y)
    return mesh.generate(parts, grading, plan.options, comm, save)


def model(plan: Plan, made: mesh.ContactMesh) -> ContactModel:
    """Assemble the contact model of a plan on its mesh."""
    scene = plan.scene

    def side(tag: int) -> Side:
        return Side(tag, CONTACT + tag, SUPPORT + tag, material(scene, tag))

    setup = Setup(
        fixed=side(RAIL),
        moving=side(WHEEL),
        slave=plan.slave,
        gap=plan.contact.gap(plan.slave),
        degree=plan.order,
        law=Law(scene.solver.method, scene.solver.theta, scene.solver.gamma_factor),
        planes=plan.planes,
        far_field=HertzFarField(plan) if plan.contact.half_space else None,
        load_control=scene.load is not None or plan.contact.half_space,
        linear=scene.solver.linear,
    )
    return ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
