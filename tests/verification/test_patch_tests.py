"""Patch tests: constant stress states are reproduced."""

from dataclasses import replace

import numpy as np
import pytest

from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing.bodies import RAIL, WHEEL
from railhead.postprocess.stress import gauss_points
from railhead.solver.contact import ContactModel
from railhead.solver.fields import gather
from railhead.solver.material.elasticity import Material, assemble
from railhead.solver.space.interface import ContactLaw

SOFT = Material(1000.0, 0.0)
FLAT = ParabolicGap(0.0, 0.0, 1)


@pytest.mark.parametrize(
    "cell, degree", [("tetrahedron", 1), ("tetrahedron", 2), ("hexahedron", 1)]
)
def test_bulk_constant_stress(two_blocks, cell: str, degree: int) -> None:
    """K u of a linear displacement vanishes at inner nodes and gives its constant stress."""
    made, setup = two_blocks(cell=cell, degree=degree)
    model = ContactModel(made.mesh, made.cell_tags, made.facet_tags, setup)
    points = model.bulk.space.tabulate_dof_coordinates()
    gradient = np.array([[1e-3, 2e-4, 0], [2e-4, -5e-4, 1e-4], [0, 1e-4, 7e-4]])
    materials = {side.tag: side.material for side in (setup.fixed, setup.moving)}
    _, stiffness = assemble(made.mesh, made.cell_tags, materials, degree)
    u = stiffness.createVecRight()
    u.array[:] = (points @ gradient).ravel()
    force = (stiffness * u).array.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    faces = (np.abs(points - low) < 1e-9) | (np.abs(points - high) < 1e-9)
    faces |= np.abs(points[:, [2, 2, 2]]) < 1e-9
    inner = ~faces.any(axis=1)
    assert inner.sum() > 5
    assert np.abs(force[inner]).max() < 1e-9 * np.abs(force).max()

    solution = model.solve(load=1000.0, active=np.ones(len(model.interface.points), bool))
    fields = replace(gather(model, solution), displacement=points @ gradient)
    lam, mu = setup.fixed.material.lame
    sigma = lam * np.trace(gradient) * np.eye(3) + 2 * mu * gradient
    expected = sigma[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    np.testing.assert_allclose(
        gauss_points.nodal_stress(fields), np.tile(expected, (len(points), 1)), rtol=1e-8, atol=1e-8
    )


@pytest.mark.parametrize("degree, tolerance", [(1, 0.03), (2, 0.01)])
@pytest.mark.parametrize("law", [ContactLaw("nitsche", theta) for theta in (1, 0, -1)])
def test_contact_patch_test_of_nitsche_on_non_matching_meshes(
    two_blocks, solve, degree: int, tolerance: float, law: ContactLaw
) -> None:
    """Two blocks pressed flat together, approach 1 %: pressure E * approach / height everywhere.

    The force is exact and the mean pressure too. Locally the master's share of the traction is
    integrated at the slave's points, across the master's element edges, so the pressure wavers:
    3 % on P1 and 1 % on P2 tetrahedra.
    """
    made, setup = two_blocks(
        materials=(SOFT, SOFT), degree=degree, law=law, gap=FLAT, load_control=False
    )
    model, solution = solve(made, setup, radius=1e9, approach=0.2)
    expected = 1000.0 * 0.2 / 20.0
    assert solution.newton.converged
    weights = model.interface.weights
    assert weights @ solution.pressure / weights.sum() == pytest.approx(expected, rel=1e-4)
    np.testing.assert_allclose(solution.pressure, expected, rtol=tolerance)


def test_contact_patch_test_of_penalty_is_off_by_its_own_compliance(two_blocks, solve) -> None:
    """Mean pressure 0.4 % low from the springs; locally it wavers by a third on P1."""
    made, setup = two_blocks(
        materials=(SOFT, SOFT), degree=1, law=ContactLaw("penalty"), gap=FLAT, load_control=False
    )
    model, solution = solve(made, setup, radius=1e9, approach=0.2)
    weights = model.interface.weights
    mean = weights @ solution.pressure / weights.sum()
    assert mean < 10.0
    assert mean == pytest.approx(10.0, rel=0.03)
    np.testing.assert_allclose(solution.pressure, mean, rtol=0.4)


def test_the_body_tags_are_kept_apart(two_blocks, solve) -> None:
    made, setup = two_blocks(materials=(SOFT, Material(4000.0, 0.2)))
    model, solution = solve(made, setup, load=500.0)
    fields = gather(model, solution)
    assert set(fields.body) == {RAIL, WHEEL}
    assert np.unique(fields.lame[fields.body == WHEEL, 1]) == pytest.approx(4000 / 2.4)
