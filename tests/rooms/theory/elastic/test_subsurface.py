"""Stresses below the contact: reference numbers, equilibrium, boundary conditions, limits."""

import math

import numpy as np
import pytest

from railhead.theory.elastic.hertz import Ellipse, point_contact
from railhead.theory.elastic.subsurface import (
    EllipsoidPotential,
    max_shear,
    principal,
    stress,
    von_mises,
)
from tests.rooms.theory.finite_differences import Array

CURVATURE_RATIOS = [1e-3, 0.1, 0.9, 1.0, 1 + 1e-9, 5.0]


def contact_of(curvature_ratio: float) -> Ellipse:
    return point_contact(curvature_ratio * 1e-3, 1e-3, 1.1e5, 4e4)


def test_stresses_on_the_axis_are_exact(reference, thesis_ellipse: Ellipse) -> None:
    rows = reference["axis_table"]
    depth = [row["z_mm"] for row in rows]
    expected = [[row["sigma_x"], row["sigma_y"], row["sigma_z"]] for row in rows]
    s = thesis_ellipse.axis_stress(0.3, depth)
    np.testing.assert_allclose(s, expected, rtol=1e-11)
    full = np.column_stack((s, np.zeros_like(s)))
    np.testing.assert_allclose(max_shear(full), [row["tau_max"] for row in rows], rtol=1e-11)
    np.testing.assert_allclose(von_mises(full), [row["von_mises"] for row in rows], rtol=1e-11)


def test_stresses_beside_the_axis_are_exact(reference, thesis_ellipse: Ellipse) -> None:
    rows = reference["off_axis_points"]
    points = [(row["x"], row["y"], -row["z"]) for row in rows]
    expected = [  # the reference counts depth, which turns the sign of the shears s_xz, s_yz
        (row["sxx"], row["syy"], row["szz"], row["sxy"], -row["sxz"], -row["syz"]) for row in rows
    ]
    np.testing.assert_allclose(stress(thesis_ellipse, 0.3, points), expected, rtol=0, atol=2e-12)


def test_largest_stresses_on_the_axis_and_their_depths_are_exact(
    reference, thesis_ellipse: Ellipse
) -> None:
    exact = reference["axis_extrema"]
    found = thesis_ellipse.axis_extrema(0.3)
    assert (found.tau_max, found.von_mises_max) == pytest.approx(
        (exact["tau_max_MPa"], exact["von_mises_max_MPa"]), rel=1e-12
    )
    assert (found.tau_max_depth, found.von_mises_max_depth) == pytest.approx(
        (exact["depth_mm"], exact["vm_depth_mm"]), rel=1e-7
    )


@pytest.mark.parametrize("curvature_ratio", [1e-6, 1e-2, 0.3, 1.0, 8.0])
@pytest.mark.parametrize("poisson", [0.0, 0.1, 0.2, 0.3, 0.5])
def test_extrema_are_not_exceeded_on_a_fine_sample(curvature_ratio: float, poisson: float) -> None:
    contact = contact_of(curvature_ratio)
    depth = np.concatenate(([0], np.geomspace(1e-5, 6, 3000))) * min(contact.a, contact.b)
    sample = stress(contact, poisson, np.outer(depth, (0, 0, -1)))
    found = contact.axis_extrema(poisson)
    assert found.tau_max >= max_shear(sample).max() * (1 - 2e-6)
    assert found.von_mises_max >= von_mises(sample).max() * (1 - 2e-6) and found.tau_max_depth > 0
    assert found.von_mises_max_depth > 0


def test_surface_centre_and_ends_of_the_axes(reference, thesis_ellipse: Ellipse) -> None:
    c = thesis_ellipse
    points = {
        "centre": (0, 0, 0),
        "end_of_major_axis": (c.a, 0, 0),
        "end_of_minor_axis": (0, c.b, 0),
    }
    for name, point in points.items():
        row = reference["surface"][name]
        s = stress(c, 0.3, [point])[0]
        expected = (row["sigma_x"], row["sigma_y"], row["sigma_z"], 0, 0, 0)
        np.testing.assert_allclose(s, expected, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("curvature_ratio", CURVATURE_RATIOS)
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_depth_zero_is_the_surface_formula(curvature_ratio: float, poisson: float) -> None:
    contact = contact_of(curvature_ratio)
    a, b, free = contact.a, contact.b, 1 - 2 * poisson  # Johnson, Contact Mechanics, 4.32
    s_x, s_y = (2 * poisson + free * side / (a + b) for side in (b, a))
    expected = -contact.p0 * np.array([s_x, s_y, 1.0])
    np.testing.assert_allclose(contact.axis_stress(poisson, 0.0)[0], expected, rtol=1e-12)


@pytest.mark.parametrize("curvature_ratio", CURVATURE_RATIOS)
def test_surface_traction_is_the_pressure(curvature_ratio: float) -> None:
    contact = contact_of(curvature_ratio)
    plane = np.random.default_rng(2).uniform(-2, 2, (500, 3)) * (contact.a, contact.b, 0)
    s = stress(contact, 0.3, plane)
    p = contact.pressure(plane[:, 0], plane[:, 1])
    np.testing.assert_allclose(s[:, 2], -p, rtol=0, atol=1e-13 * contact.p0)
    assert np.abs(s[:, 4:]).max() <= 1e-13 * contact.p0
    assert 0.1 < np.mean(p > 0) < 0.4  # the sample holds the patch and its surroundings


@pytest.mark.parametrize(
    ("of", "points", "words"),
    [
        (stress, [[0, 0, 0.1]], "z <= 0"),
        (stress, [0, 0, -1], r"must be \(n, 3\)"),
        (Ellipse.axis_stress, [1.0, -1.0], "depth must not be negative"),
    ],
)
def test_points_above_the_surface_are_refused(of, points, words: str, thesis_ellipse) -> None:
    with pytest.raises(ValueError, match=words):
        of(thesis_ellipse, 0.3, points)


def test_a_point_a_rounding_above_the_surface_is_on_it(thesis_ellipse) -> None:
    assert np.isfinite(stress(thesis_ellipse, 0.3, [[1, 1, 1e-12]])).all()


def test_invariants_of_simple_states() -> None:
    tension, hydrostatic, shear = (
        np.array([state], dtype=float)
        for state in ([7, 0, 0, 0, 0, 0], [-5, -5, -5, 0, 0, 0], [0, 0, 0, 0, 0, 3])
    )
    assert (von_mises(tension)[0], max_shear(tension)[0]) == (7, 3.5)
    assert (von_mises(hydrostatic)[0], max_shear(hydrostatic)[0]) == (0, 0)
    assert von_mises(shear)[0] == pytest.approx(3 * math.sqrt(3), rel=1e-15)
    np.testing.assert_allclose(principal(shear), [[3, 0, -3]], atol=1e-14)


# Potentials of the semi-ellipsoidal pressure: harmonic, consistent, exact in hard corners.


def potential(a: float, b: float, points: Array) -> EllipsoidPotential:
    x, y, z = points.T
    return EllipsoidPotential(a, b, 1.0, x, y, z)


@pytest.mark.parametrize(
    ("a", "b", "x", "y", "depth", "expected"),
    [  # integrals over w of 1/(AB sqrt q) and sqrt(q)/(A^2 B), by 40-digit quadrature
        (100.0, 1.0, 30.0, 0.4, 0.0, (2.1214554284081534e-06, 0.0001918313525406397)),
        (1.0, 1.00001, 0.3, 0.4, 1e-06, (0.5487119728239068, 0.9346118899991611)),
        (1.0, 1.0000000001, 0.7, 0.9, 0.0, (0.7889546351443344, 0.51282051284406)),
        (10000.0, 1.0, 20000.0, 0.1, 0.2, (1.1735829963871039e-17, 1.7604078338713045e-09)),
        (2.0, 1.0, 0.4, 0.1, 40.0, (1.9466937787266064e-07, 0.0006236506789167606)),
        (1.0, 2.0, 0.99, 0.01, 0.0001, (0.20542219922410118, 0.4792879179863664)),
    ],
)
def test_elementary_integrals_in_hard_corners(
    a: float, b: float, x: float, y: float, depth: float, expected: tuple[float, float]
) -> None:
    p = potential(a, b, np.array([[x, y, depth]]))
    N = -p.log_hessian[2][0] / (p.strength * x * y)
    K_x = (p.log_gradient[0][0] - depth * p.gradient[0][0]) / (p.strength * x)
    np.testing.assert_allclose((N, K_x), expected, rtol=1e-11)
