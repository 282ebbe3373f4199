"""One contact by way of a plan with every optional effect off, and without any plan."""

import math
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI

from railhead.geometry import outlines, profiles
from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing import mesh
from railhead.meshing.bodies import Body, Options
from railhead.meshing.sizing import Grading
from railhead.meshing.tags import CONTACT, RAIL, SUPPORT, WHEEL
from railhead.planning import plan as planning
from railhead.run import build, mesh_solution
from railhead.scene import catalogue
from railhead.scene.scene import Scene
from railhead.solver import compat
from railhead.solver.contact import ContactModel
from railhead.solver.material.elasticity import Material
from railhead.solver.setup import ContactBody, Setup
from railhead.theory.elastic import hertz

CASE = "sphere_on_plane"
# Nothing else is on and could be left out.
OPTIONAL = ("axisymmetry", "symmetry", "far_field", "true_profile")


def compare(repeats: int, patch_size: float = 0.25) -> list[dict[str, Any]]:
    """The same contact by way of the plan with all optional effects off (route), and without a
    plan, in turn; median processor seconds of mesh, assembly and solve. patch_size: mm."""
    off = [f"effects.{name}=off" for name in OPTIONAL]
    same = f"solver.tolerance={Setup.tolerance}"
    scene = catalogue.find(CASE).replace([f"mesh.patch_size={patch_size}", same, *off])
    routes = {"plan, all optional effects off": _planned, "no plan": _unplanned}
    found: dict[str, list[dict[str, Any]]] = {name: [] for name in routes}
    for _ in range(1 + repeats):  # the first compiles
        for name, route in routes.items():
            with forms_compiled() as forms:
                start = time.process_time()
                unknowns, p_max = route(scene)
                seconds = time.process_time() - start
            row = {"route": name, "unknowns": unknowns, "forms": len(forms)}
            found[name].append({**row, "seconds": seconds, "p_max": p_max})
    return [
        runs[1] | {"seconds": statistics.median(run["seconds"] for run in runs[1:])}
        for runs in found.values()
    ]


@contextmanager
def forms_compiled() -> Iterator[list[Any]]:
    """The forms that are compiled (or found compiled) meanwhile."""
    real, forms = compat.form, []

    def counting(expression: Any, mesh: Any) -> Any:
        forms.append(expression)
        return real(expression, mesh)

    compat.form = counting
    try:
        yield forms
    finally:
        compat.form = real


def _planned(scene: Scene) -> tuple[int, float]:
    plan = planning.make(scene)
    model = build.model(plan, build.generate(plan, plan.grading(), MPI.COMM_WORLD))
    solution = mesh_solution.solve(plan, model)
    return model.unknowns, float(solution.pressure.max())


def _unplanned(scene: Scene) -> tuple[int, float]:
    """One elastic block under Hertz's gap against a rigid plane, by meshing and solver alone."""
    wheel, radius, load = scene.wheel, scene.wheel.rolling_radius, float(scene.load or 0.0)
    modulus = wheel.young_modulus / (1 - wheel.poisson_ratio**2)
    ellipse = hertz.point_contact(1 / radius, 1 / radius, modulus, load)
    size, edge = float(scene.mesh.patch_size or 0.0), 8 * ellipse.a
    section = outlines.block_section(
        profiles.single_radius(math.inf, edge), -edge, edge, edge, outwards=-1, half=False
    )
    section = [replace(c, role="support") if c.role == "free" else c for c in section]
    grading = Grading((0.0, 0.0, 0.0), ellipse.a, ellipse.b, 0.0, size, 0.3, coarsest=0.25 * edge)
    body = Body(WHEEL, section, edge, end_role="support")
    made = mesh.generate([body], grading, Options("tetrahedron", 1, False), MPI.COMM_WORLD)
    steel = Material(wheel.young_modulus, wheel.poisson_ratio)
    setup = Setup(
        fixed=ContactBody(RAIL, CONTACT + RAIL, SUPPORT + RAIL, Material(math.inf, 0.3)),
        moving=ContactBody(WHEEL, CONTACT + WHEEL, SUPPORT + WHEEL, steel),
        slave=WHEEL,
        gap=ParabolicGap(1 / radius, 1 / radius, -1),
        degree=2,
    )
    model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
    points = model.interface.points
    inside = (np.hypot(points[:, 0], points[:, 1]) < ellipse.a) & (np.abs(points[:, 2]) < ellipse.a)
    solution = model.solve(load=load, active=inside)
    return model.unknowns, float(solution.pressure.max())
