"""Sections, the solver alone: patch tests, balance, and the linear solvers."""

import math
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from railhead.geometry import outlines, profiles
from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing import mesh
from railhead.meshing.bodies import CONTACT, RAIL, SUPPORT, SYMMETRY_X, WHEEL, Body, Options
from railhead.meshing.sizing import Grading
from railhead.postprocess.stress import gauss_points
from railhead.solver import compat
from railhead.solver.contact import ContactModel
from railhead.solver.fields import gather
from railhead.solver.material.elasticity import Material, assemble
from railhead.solver.setup import ContactBody, Setup
from railhead.solver.space.interface import ContactLaw
from railhead.solver.space.kinematics import Kinematics

XZ = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
PLANE, RING = Kinematics(XZ, thickness=5.0), Kinematics(XZ, revolved=True)
SOFT = Material(1000.0, 0.0)


def side(tag: int, material: Material) -> ContactBody:
    return ContactBody(tag, CONTACT + tag, SUPPORT + tag, material)


def two_blocks(
    cell: str = "tetrahedron",
    materials: tuple[Material, Material] = (SOFT, SOFT),
    **changes: object,
) -> tuple[mesh.ContactMesh, Setup]:
    """Mesh and set-up of two half blocks on each other, x >= 0, non-matching; the wheel's is 9 mm
    wide, the rail's 10 mm, both 10 mm high."""
    bodies = []
    for tag, edge, outwards, material in (
        (RAIL, 10, 1, materials[0]),
        (WHEEL, 9, -1, materials[1]),
    ):
        flat = profiles.single_radius(np.inf, edge)
        section = outlines.block_section(
            flat, 0.0, edge, -outwards * 10, outwards=outwards, half=True
        )
        if math.isfinite(material.young_modulus):
            bodies.append(Body(tag, section, 0.0))
    grading = Grading((0.0, 0.0, 0.0), 2.0, 2.0, 0.0, 1.0)
    made = mesh.generate(bodies, grading, Options(cell, 1, True, "xz"), MPI.COMM_WORLD)
    setup = Setup(
        fixed=side(RAIL, materials[0]), moving=side(WHEEL, materials[1]), slave=WHEEL,
        gap=ParabolicGap(0.0, 0.0, -1), degree=2, planes=((SYMMETRY_X, (1.0, 0.0, 0.0)),),
        kinematics=PLANE,
    )  # fmt: skip
    return made, replace(setup, **changes)


def solve(made: mesh.ContactMesh, setup: Setup, **control: float):
    model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
    return model, model.solve(active=np.ones(len(model.interface.points), bool), **control)


@pytest.mark.parametrize("kinematics", [PLANE, RING], ids=["plane strain", "revolved"])
@pytest.mark.parametrize(
    "cell, degree",
    [("tetrahedron", 1), ("tetrahedron", 2), ("hexahedron", 1), ("hexahedron", 2)],
)
def test_bulk_constant_stress(cell: str, degree: int, kinematics: Kinematics) -> None:
    """K u of a linear displacement vanishes at inner nodes and gives its constant stress, out of
    the plane too; a ring takes u_r = e r, u_z = f z."""
    steel = Material(207000.0, 0.3)
    made, setup = two_blocks(cell, (steel, steel), degree=degree, kinematics=kinematics)
    model, solution = solve(made, setup, load=100.0)
    points = model.bulk.space.tabulate_dof_coordinates()[:, :2]
    gradient = np.diag([1e-3, 7e-4]) + (0 if kinematics.revolved else 2e-4)
    _, stiffness = assemble(
        made.mesh, made.cell_tags, dict.fromkeys((RAIL, WHEEL), steel), degree, kinematics
    )
    u = stiffness.createVecRight()
    u.array[:] = (points @ gradient).ravel()
    force = (stiffness * u).array.reshape(-1, 2)
    border = (points[:, 0] < 1e-9) | (points[:, 0] > 8.9) | (np.abs(points[:, 1]) > 9.9)
    inner = ~border & (np.abs(points[:, 1]) > 1e-9)
    assert inner.sum() > 5
    assert np.abs(force[inner]).max() < 1e-9 * np.abs(force).max()

    fields = replace(gather(model, solution), displacement=points @ gradient @ XZ)
    strain = XZ.T @ gradient @ XZ + np.diag([0.0, 1e-3 if kinematics.revolved else 0.0, 0.0])
    lam, mu = steel.lame
    sigma = lam * np.trace(strain) * np.eye(3) + 2 * mu * strain
    expected = sigma[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    found = gauss_points.nodal_stress(fields)
    np.testing.assert_allclose(found, np.tile(expected, (len(found), 1)), rtol=1e-8, atol=1e-7)


def test_mean_dilatation_of_a_ring_is_that_of_its_volume() -> None:
    """u_r = r^2 has tr eps = 3 r, whose mean over a triangle of corners r_i is 3 int r^2 / int r =
    3 (S + (sum r_i)^2) / (4 sum r_i), S the sum of their squares; its energy is lambda V mean^2."""
    ring = replace(RING, mean_dilatation=True)
    made, setup = two_blocks(degree=2, kinematics=ring)
    model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
    slave = model.interface.slave
    r = slave.nodes[:, :3, 0]
    total = r.sum(axis=1)
    mean = 3 * ((r**2).sum(axis=1) + total**2) / (4 * total)
    every = np.arange(len(slave))
    divergence = slave.divergence(every, np.full((len(slave), 2), 0.1))
    points = slave.dof_points()
    found = np.einsum("mdc,mdc->m", divergence, points[..., :1] ** 2 * [1.0, 0.0])
    np.testing.assert_allclose(found, mean, rtol=1e-12)

    soft = dict.fromkeys((RAIL, WHEEL), Material(1000.0, 0.4))
    none = dict.fromkeys((RAIL, WHEEL), Material(1000.0 / 1.4, 0.0))  # the same mu
    energies = []
    for materials in (soft, none):
        bulk, stiffness = assemble(made.mesh, made.cell_tags, materials, 2, ring)
        u = stiffness.createVecRight()
        u.array[:] = (bulk.space.tabulate_dof_coordinates()[:, :2] ** 2 * [1.0, 0.0]).ravel()
        energies.append(u.dot(stiffness * u))
    r = made.mesh.geometry.x[compat.cell_nodes(made.mesh)][:, :, 0]
    x = made.mesh.geometry.x[compat.cell_nodes(made.mesh)][:, :, :2]
    area = np.abs(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])) / 2
    total = r.sum(axis=1)
    mean = 3 * ((r**2).sum(axis=1) + total**2) / (4 * total)
    volume = 2 * np.pi * area * total / 3
    lam = soft[RAIL].lame[0]
    assert energies[0] - energies[1] == pytest.approx(lam * volume @ mean**2, rel=1e-10)


@pytest.mark.parametrize("kinematics", [PLANE, RING], ids=["plane strain", "revolved"])
@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
@pytest.mark.parametrize(
    "law",
    [ContactLaw(), ContactLaw("nitsche", 0), ContactLaw("nitsche", -1), ContactLaw("penalty")],
)
def test_contact_patch_test_and_balance(kinematics: Kinematics, cell: str, law: ContactLaw) -> None:
    """Blocks pressed flat together: the whole load arrives. Against a rigid rail the pressure is
    even; springs of unequal facets (penalty) make it waver by a sixth."""
    area = 81 * np.pi if kinematics.revolved else 2 * 9 * 5.0
    _, both = solve(*two_blocks(cell, law=law, kinematics=kinematics), load=2.0 * area)
    assert both.newton.converged
    assert both.load == pytest.approx(2.0 * area, rel=1e-8)
    assert both.reaction == pytest.approx(both.load, rel=1e-8)
    rigid = Material(math.inf, 0.0)
    made, setup = two_blocks(cell, (rigid, SOFT), law=law, kinematics=kinematics)
    model, alone = solve(made, setup, load=2.0 * area)
    np.testing.assert_allclose(alone.pressure, 2.0, rtol=1e-6 if law.sigma else 0.2)
    weights, tau = model.interface.weights, model.problem.tau
    springs = 0.0 if law.sigma else 2.0 * float(weights @ (1 / tau) / weights.sum())
    assert alone.approach - 0.02 == pytest.approx(springs, rel=0.05, abs=1e-8)


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
@pytest.mark.parametrize("which", [PLANE, RING], ids=["plane strain", "revolved"])
def test_direct_and_multigrid_agree_in_a_section(cell: str, which: Kinematics) -> None:
    gap = ParabolicGap(1 / 200, 0.0, -1)
    states = []
    for choice in ("direct", "multigrid"):
        made, setup = two_blocks(cell, kinematics=which, gap=gap, linear=choice)
        _, solution = solve(made, setup, load=300.0)
        assert solution.newton.converged
        states.append(solution)
    assert states[0].approach == pytest.approx(states[1].approach, rel=1e-8)
