"""Potentials of the semi-ellipsoidal pressure: harmonic, consistent, exact in hard corners."""

import numpy as np
import pytest
from finite_differences import Array, jacobian

from railhead.theory.elastic.potential import EllipsoidPotential

SEMI_AXES = [(2.0, 1.0), (1.0, 2.0), (1.0, 1.0), (1.0, 1 + 1e-10), (20.0, 1.0)]


def potential(a: float, b: float, points: Array) -> EllipsoidPotential:
    x, y, z = points.T
    return EllipsoidPotential(a, b, 1.0, x, y, z)


def points_below(a: float, b: float) -> Array:
    box = np.random.default_rng(1).uniform((-2, -2, 0.2), (2, 2, 3), (100, 3))
    return np.asarray(box * (a, b, min(a, b)))


@pytest.mark.parametrize(("a", "b"), SEMI_AXES)
def test_derivatives_agree_with_their_potentials(a: float, b: float) -> None:
    at = points_below(a, b)
    p, step = potential(a, b, at), 2e-3
    by_psi = jacobian(lambda q: potential(a, b, q).psi[:, None], at, step)[:, 0]
    np.testing.assert_allclose(by_psi.T, p.gradient, atol=2e-9)
    hessian = jacobian(lambda q: np.column_stack(potential(a, b, q).gradient), at, step)
    xx, yy, zz, xy, xz, yz = p.depth_times_hessian
    expected = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    np.testing.assert_allclose(np.moveaxis(hessian, 0, -1) * at[:, 2], expected, atol=2e-8)
    of_log = jacobian(lambda q: np.column_stack(potential(a, b, q).log_gradient), at, step)
    log_xx, log_yy, log_xy = p.log_hessian
    psi_x, psi_y, psi_z = p.gradient
    expected = np.array([[log_xx, log_xy, psi_x], [log_xy, log_yy, psi_y]])
    np.testing.assert_allclose(np.moveaxis(of_log, 0, -1), expected, atol=2e-8)
    np.testing.assert_allclose(log_xx + log_yy + psi_z, 0, atol=1e-13)


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
