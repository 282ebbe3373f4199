"""Tabulation on facets, pairing of surfaces, and the trace constant."""

import numpy as np
import pytest

from railhead.geometry.surfaces import ParabolicGap
from railhead.meshing.bodies import CONTACT, RAIL, WHEEL
from railhead.solver.space import contact_interface
from railhead.solver.space.cells import inverse
from railhead.solver.space.contact_interface import ContactLaw
from railhead.solver.space.facets import FacetSet, pair
from studies.hard.block_pairs import contact_model


@pytest.fixture(scope="module", params=["tetrahedron", "hexahedron"])
def model(request):
    return contact_model(cell=request.param)


def test_only_nitsches_parameter_is_doubled_where_cells_lie_in_layers(model) -> None:
    """A penalty needs no coercivity; doubled it put p_max of `uic54_thesis` off by 2.7 %."""
    found = model.interface
    times = 2 if surface(model, RAIL).cell == "hexahedron" else 1
    for method, factor in (("nitsche", times), ("penalty", 1)):
        bound = found.stiffness_bound(ContactLaw(method))
        np.testing.assert_allclose(bound, factor * found.trace_bound)


def surface(model, tag: int) -> FacetSet:
    return FacetSet.on(model.bulk, model.facet_tags.find(CONTACT + tag))


def test_each_point_is_paired_with_the_one_straight_above(model) -> None:
    slave, master = surface(model, RAIL), surface(model, WHEEL)
    (facet, xi), _ = slave.quadrature(3)
    points, _ = slave.tangents(facet, xi)
    points = points - [0, 0, 0.1]
    partner, eta = pair(points, np.tile([0, 0, 1.0], (len(points), 1)), master)
    assert partner.min() >= 0
    hit, _ = master.tangents(partner, eta)
    np.testing.assert_allclose(hit[:, :2], points[:, :2], atol=1e-11)


def test_a_facet_that_is_known_is_tried_first(model) -> None:
    """A right guess, a wrong one and none lead to the same facets."""
    slave, master = surface(model, RAIL), surface(model, WHEEL)
    points, _ = slave.tangents(*slave.quadrature(3)[0])
    normals = np.tile([0, 0, 1.0], (len(points), 1))
    partner, eta = pair(points, normals, master)
    for known in (partner, (partner + 1) % len(master), np.full(len(points), -1)):
        again, there = pair(points, normals, master, known)
        np.testing.assert_array_equal(again, partner)
        np.testing.assert_allclose(there, eta, atol=1e-12)


def test_points_that_look_past_the_master_have_no_partner(model) -> None:
    points = np.array([[5.0, 5.0, 0.0], [25.0, 5.0, 0.0]])
    partner, _ = pair(points, np.tile([0, 0, 1.0], (2, 1)), surface(model, WHEEL))
    assert partner[0] >= 0 and partner[1] == -1


@pytest.mark.parametrize("degree", [1, 2])
def test_trace_bound_is_the_warburton_hesthaven_constant(degree) -> None:
    """(k+1)(k+3)/3 A/V (lambda + 2 mu), sharp on straight tetrahedra for stresses of degree k."""
    facets = surface(contact_model(degree=degree), RAIL)
    at, weights = facets.quadrature(2 * degree)
    normals = ParabolicGap(0, 0, 1)(facets.tangents(*at)[0])[1]
    bound = contact_interface.trace_bound(facets, at, weights, normals)
    _, _, volumes = facets.quadrature_points(1)
    _, weights = facets.quadrature(1)
    k = degree - 1
    lam, mu = facets.lame.T
    constant = (k + 1) * (k + 3) / 3 * weights / volumes * (lam + 2 * mu)
    _, cell, count = np.unique(facets.dofs, axis=0, return_inverse=True, return_counts=True)
    np.testing.assert_allclose(bound, constant * count[cell], rtol=1e-9)


def test_a_pull_and_a_wrong_start_are_refused(model) -> None:
    """A load of -5000 N was solved with nothing to hold the bodies."""
    every = np.ones(len(model.interface.points), dtype=bool)
    for load in (-5000.0, np.inf, np.nan):
        with pytest.raises(ValueError, match="load must be finite and not negative"):
            model.solve(load=load, active=every)
    for active in (every[1:], every[:, None], every.astype(float), np.flatnonzero(every), True):
        with pytest.raises(ValueError, match=f"active must be {len(every)} booleans"):
            model.solve(load=1.0, active=active)
    with pytest.raises(ValueError, match="approach is unknown under load control"):
        model.solve(approach=0.01, active=every)


@pytest.mark.parametrize("rows", [2, 3])
def test_inverses_and_determinants_are_those_of_lapack(rows: int) -> None:
    matrices = np.random.default_rng(3).normal(size=(50, rows, rows))
    matrices[0] = np.diag([1e-3, 1.0, 50.0][:rows])  # of a stretched cell
    inverses, determinants = inverse(matrices)
    assert inverses == pytest.approx(np.linalg.inv(matrices), rel=1e-10)
    assert determinants == pytest.approx(np.linalg.det(matrices), rel=1e-10)
