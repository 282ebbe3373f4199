"""Influence of tractions and pressure on the tangential displacement, against point forces."""

import math

import numpy as np
import pytest

from railhead.theory.friction.tangential import MaterialPair, TractionInfluence, pair

X, Y = 0.3 * np.arange(12), 0.2 * np.arange(9)
STEEL = MaterialPair(79615.0, 0.3)


def over_a_cell(kernel, x: float, y: float) -> float:
    """Integral over a cell around the origin, of what it does at (x, y)."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    xi, eta = np.meshgrid(0.15 * nodes, 0.1 * nodes, indexing="ij")
    return float(np.sum(np.outer(weights, weights) * kernel(x - xi, y - eta)) * 0.15 * 0.1)


@pytest.mark.parametrize("place", [(1, 0), (0, 1), (2, 3), (7, 5)])
def test_a_cell_under_a_traction_moves_as_cerruti_says(place: tuple[int, int]) -> None:
    """Cerruti's point force, integrated by Gauss."""
    influence = TractionInfluence(X, Y, STEEL, rolling=False)
    x, y = X[place[0]], Y[place[1]]
    for component in (0, 1):
        traction = np.zeros((2, 12, 9))
        traction[component, 0, 0] = 1.0
        moved = influence(traction)[:, place[0], place[1]]
        for k in (0, 1):

            def kernel(dx, dy, k: int = k, component: int = component):
                r = np.hypot(dx, dy)
                along = (dx, dy)[k] * (dx, dy)[component]
                return (0.7 * (k == component) / r + 0.3 * along / r**3) / (math.pi * 79615.0)

            assert moved[k] == pytest.approx(over_a_cell(kernel, x, y), rel=1e-6, abs=1e-16)


def test_like_and_incompressible_bodies_are_not_drawn_apart() -> None:
    assert pair(207000, 0.3, 207000, 0.3) == MaterialPair(pytest.approx(207000 / 2.6), 0.3, 0.0)
    assert pair(207000, 0.5, 3000, 0.5).mismatch == 0.0
    assert pair(3000, 0.3, 207000, 0.3).mismatch > 0 > pair(207000, 0.3, 3000, 0.3).mismatch


def test_dundurs_beta_of_a_body_on_a_rigid_one() -> None:
    """beta = (1 - 2 nu) / (2 (1 - nu)) (Johnson, Contact Mechanics, 5.3)."""
    rigid = math.inf
    assert (
        pair(rigid, 0.2, 1000, 0.3).dundurs_beta,
        pair(1000, 0.3, rigid, 0.2).dundurs_beta,
        pair(3000, 0.3, 207000, 0.25).dundurs_beta,
    ) == pytest.approx(
        (
            0.4 / 1.4,
            -0.4 / 1.4,
            (1.25 * 0.5 / 207000 - 1.3 * 0.4 / 3000) / (2 * (0.91 / 3000 + 0.9375 / 207000)),
        )
    )


def test_tractions_open_the_gap_as_pressure_draws_the_surfaces() -> None:
    """Reciprocity: the work of one on the displacement by the other is the same either way."""
    influence = TractionInfluence(X, Y, pair(3000, 0.3, 207000, 0.3), rolling=False)
    random = np.random.default_rng(4)
    traction, pressure = random.uniform(-1, 1, (2, 12, 9)), random.uniform(0, 1, (12, 9))
    work = np.sum(pressure * influence.opening(traction))
    assert work == pytest.approx(np.sum(traction * influence.of_pressure(pressure)), rel=1e-10)
    assert abs(work) > 0


def test_the_pressure_of_a_strip_draws_by_itself_alone() -> None:
    """Rolling, -du/dx = -2 K/G p of its own place (Johnson, 2.25), half a cell ahead of the cells,
    where it is the mean of two; two long cells make a strip."""
    unlike, x = pair(math.inf, 0.3, 207000, 0.3), (np.arange(32) - 15.5) / 13
    pressure = np.repeat(np.sqrt(np.maximum(1 - x**2, 0))[:, None], 2, axis=1)
    influence = TractionInfluence(x, np.array([-2.5e3, 2.5e3]), unlike, rolling=True)
    drawn = influence.of_pressure(pressure)[0]
    factor = -2 * unlike.mismatch / unlike.shear_modulus
    ahead = (pressure + np.vstack([pressure[1:], 0 * pressure[:1]])) / 2
    np.testing.assert_allclose(drawn, factor * ahead, atol=1e-3 * abs(factor))
