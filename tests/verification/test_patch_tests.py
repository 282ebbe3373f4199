"""The solver alone on blocks, solids and sections: constant stress states, balance, invariance."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from railhead.geometry import outlines, profiles
from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing import mesh
from railhead.meshing.bodies import RAIL, SYMMETRY_X, WHEEL, Body, Options
from railhead.meshing.grading import Grading
from railhead.postprocess.stress import gauss_points
from railhead.solver.contact import ContactModel
from railhead.solver.material import Hardening, Material
from railhead.solver.space.contact_interface import ContactLaw
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.system.fields import gather
from railhead.solver.system.setup import LoadPath, Setup
from studies.hard import block_cases
from studies.hard.block_pairs import STEEL, contact_model, press, side, two_blocks
from studies.hard.hard_cases import CASES

SOFT = Material(1000.0, 0.0)
FLAT = {"gap": ParabolicGap(0.0, 0.0, 1), "materials": (SOFT, SOFT), "load_control": False}


@pytest.mark.parametrize(
    ("degree", "tolerance", "theta", "cut"),
    [
        (1, 1e-9, 1, True), (1, 1e-9, -1, True), (2, 1e-9, 0, True), (3, 1e-9, 1, True),
        (1, 0.03, 1, False), (2, 0.01, 1, False), (3, 0.01, 1, False),
    ],
)  # fmt: skip
def test_contact_patch_test_of_nitsche_on_non_matching_meshes(
    degree: int, tolerance: float, theta: int, cut: bool
) -> None:
    """Two blocks pressed flat together, approach 1 %: pressure E * approach / height everywhere.

    The force is exact and the mean pressure too. On whole facets the master's share of the traction
    is integrated across the master's element edges, so the pressure wavers: 3 % on P1 and 1 % on
    P2 tetrahedra. On pieces it is exact, and so is the linear solver here.
    """
    law = ContactLaw("nitsche", theta)
    model = contact_model(degree=degree, law=law, cut=cut, linear="direct", **FLAT)
    solution = press(model, radius=1e9, approach=0.2)
    expected = 1000.0 * 0.2 / 20.0
    assert solution.newton.converged
    weights = model.interface.weights
    assert weights @ solution.pressure / weights.sum() == pytest.approx(expected, rel=1e-4)
    np.testing.assert_allclose(solution.pressure, expected, rtol=tolerance)


# Sections, the solver alone: patch tests, balance, and the linear solvers.

XZ = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
PLANE, RING = Kinematics(XZ, thickness=5.0), Kinematics(XZ, revolved=True)


@functools.lru_cache(maxsize=8)
def half_blocks_mesh(cell: str, tags: tuple[int, ...]) -> mesh.ContactMesh:
    """Two half blocks on each other, x >= 0, non-matching; the wheel's is 9 mm wide, the rail's
    10 mm, both 10 mm high."""
    bodies = []
    for tag, edge, outwards in ((RAIL, 10, 1), (WHEEL, 9, -1)):
        flat = profiles.single_radius(np.inf, edge)
        section = outlines.block_section(
            flat, 0.0, edge, -outwards * 10, outwards=outwards, half=True
        )
        if tag in tags:
            bodies.append(Body(tag, section, 0.0))
    grading = Grading(centre=(0.0, 0.0, 0.0), a=2.0, b=2.0, angle=0.0, size=1.0)
    return mesh.generate(bodies, grading, Options(cell, 1, True, "xz"), MPI.COMM_WORLD)


def two_half_blocks(
    cell: str = "tetrahedron",
    materials: tuple[Material, Material] = (SOFT, SOFT),
    **changes: object,
) -> tuple[mesh.ContactMesh, Setup]:
    """Mesh (shared: change no point of it) and set-up."""
    deform = zip((RAIL, WHEEL), materials, strict=True)
    made = half_blocks_mesh(cell, tuple(tag for tag, of in deform if of.young_modulus < math.inf))
    setup = Setup(
        fixed=side(RAIL, materials[0]), moving=side(WHEEL, materials[1]), slave=WHEEL,
        gap=ParabolicGap(0.0, 0.0, -1), degree=2, planes=((SYMMETRY_X, (1.0, 0.0, 0.0)),),
        kinematics=PLANE,
    )  # fmt: skip
    return made, replace(setup, **changes)


def pressed(made: mesh.ContactMesh, setup: Setup, **control: float):
    model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
    return model, model.solve(active=np.ones(len(model.interface.points), bool), **control)


def test_first_yield_of_flat_blocks_grows_with_the_load() -> None:
    """Stresses of blocks that lie flat grow with the load itself, not with its square root: twice
    the load is twice as far over first yield, which is where it was told to be."""
    steel = replace(SOFT, hardening=Hardening.linear(3.0, 100.0))
    path = LoadPath(steps=4, unload=False, near=lambda x: np.ones(len(x), bool))
    made, setup = two_half_blocks(materials=(SOFT, steel), load_path=path)
    over = []
    for load in (400.0, 800.0):
        solution = pressed(made, setup, load=load)[1]
        assert solution.newton.converged and solution.plasticity
        over.append(solution.plasticity.load_over_first_yield)
    assert over[1] / over[0] == pytest.approx(2.0, rel=1e-3)
    least = 400.0 / over[0]
    assert pressed(made, setup, load=0.98 * least)[1].plasticity is None
    assert pressed(made, setup, load=1.02 * least)[1].plasticity is not None


GRADIENT = np.array([[1e-3, 2e-4, 0], [2e-4, -5e-4, 1e-4], [0, 1e-4, 7e-4]])


@pytest.mark.parametrize(
    "blocks, cell, degree, kinematics",
    [
        (two_blocks, "tetrahedron", 1, SOLID),
        (two_blocks, "tetrahedron", 2, SOLID),
        (two_blocks, "hexahedron", 1, SOLID),
        (two_half_blocks, "tetrahedron", 1, PLANE),
        (two_half_blocks, "hexahedron", 2, PLANE),
        (two_half_blocks, "tetrahedron", 2, RING),
        (two_half_blocks, "hexahedron", 1, RING),
    ],
)
def test_constant_stress_is_read_of_a_linear_displacement(blocks, cell, degree, kinematics) -> None:
    """Out of the plane of a section too; a ring takes u_r = e r, u_z = f z."""
    made, setup = blocks(cell=cell, materials=(STEEL, STEEL), degree=degree, kinematics=kinematics)
    model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
    axes, dim = kinematics.axes, kinematics.dim
    points = model.bulk.space.tabulate_dof_coordinates()[:, :dim]
    gradient = np.diag([1e-3, 7e-4]) if kinematics.revolved else GRADIENT[:dim, :dim]
    solution = model.solve(load=1000.0, active=np.ones(len(model.interface.points), bool))
    fields = replace(gather(model, solution), displacement=points @ gradient @ axes)
    strain = axes.T @ gradient @ axes + np.diag([0.0, 1e-3 if kinematics.revolved else 0.0, 0.0])
    lam, mu = STEEL.lame
    sigma = lam * np.trace(strain) * np.eye(3) + 2 * mu * strain
    found = gauss_points.nodal_stress(fields)
    expected = np.tile(sigma[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]], (len(found), 1))
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-8 if dim == 3 else 1e-7)


@pytest.mark.parametrize(
    "kinematics, cell, law",
    [
        (PLANE, "tetrahedron", ContactLaw("nitsche", 0)),
        (PLANE, "tetrahedron", ContactLaw("penalty")),
        (PLANE, "hexahedron", ContactLaw()),
        (RING, "tetrahedron", ContactLaw()),
        (RING, "hexahedron", ContactLaw("nitsche", -1)),
        (RING, "hexahedron", ContactLaw("penalty")),
    ],
)
def test_contact_patch_test_and_balance(kinematics: Kinematics, cell: str, law: ContactLaw) -> None:
    """Blocks pressed flat together: the whole load arrives. Against a rigid rail the pressure is
    even; springs of unequal facets (penalty) make it waver by a sixth."""
    area = 81 * np.pi if kinematics.revolved else 2 * 9 * 5.0
    _, both = pressed(*two_half_blocks(cell, law=law, kinematics=kinematics), load=2.0 * area)
    assert both.newton.converged
    assert (both.load, both.reaction) == pytest.approx((2.0 * area, both.load), rel=1e-08)
    rigid = Material(math.inf, 0.0)
    made, setup = two_half_blocks(cell, (rigid, SOFT), law=law, kinematics=kinematics)
    model, alone = pressed(made, setup, load=2.0 * area)
    np.testing.assert_allclose(alone.pressure, 2.0, rtol=1e-6 if law.sigma else 0.2)
    weights, tau = model.interface.weights, model.problem.tau
    springs = 0.0 if law.sigma else 2.0 * float(weights @ (1 / tau) / weights.sum())
    assert alone.approach - 0.02 == pytest.approx(springs, rel=0.05, abs=1e-8)


# What must hold whatever the mesh: balance, action and reaction, frame invariance.


@pytest.mark.parametrize("how", block_cases.TRANSFORMS)
def test_frames_and_units_change_nothing(how: str) -> None:
    """The blocks rotated, mirrored, in other units: the same pressure and approach to 1e-8."""
    found = block_cases.transformed(how)
    assert CASES[f"invariance: {how}"].fault(found) == "", found
