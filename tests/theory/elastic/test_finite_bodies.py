"""The curvature that finite bodies add, against integrals and Hertz."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import j0

from railhead.theory.elastic import finite_bodies
from railhead.theory.elastic.hertz import point_contact

MODULUS, LOAD = 1.1e5, 25e3


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_curvature_of_a_bonded_layer_is_that_of_its_displacement(poisson: float) -> None:
    """Second difference of the layer's displacement less the half-space's."""
    depth, step, k = 7.0, 0.2, 3 - 4 * poisson

    def rest(r: float) -> float:
        def integrand(u: float) -> float:
            above = 2 * k * np.sinh(2 * u) - 4 * u
            below = 2 * k * np.cosh(2 * u) + 1 + k * k + 4 * u * u
            return float((above / below - 1) * j0(u * r / depth))

        return quad(integrand, 0, 30)[0] / depth

    expected = 2 * (rest(step) - rest(0.0)) / step**2
    assert finite_bodies.held_below(depth, poisson) == pytest.approx(expected, rel=2e-3)


def test_an_edge_is_felt_as_its_image() -> None:
    step, distance, psi = 0.1, 6.0, finite_bodies.image(0.3)
    assert psi == pytest.approx(1.39)
    left, middle, right = (psi / (2 * distance + x) for x in (-step, 0, step))
    curvature = (left - 2 * middle + right) / step**2
    assert finite_bodies.free_edge(distance, 0.3) == pytest.approx(curvature, rel=1e-3)


@pytest.mark.parametrize("ratio", [0.2, 1.0, 30.0])
def test_own_curvatures_and_approach_are_hertz(ratio: float) -> None:
    exact = point_contact(1 / 400, ratio / 400, MODULUS, LOAD)
    unit = LOAD / (np.pi * MODULUS)
    curvatures = unit * np.array(finite_bodies.own_curvatures(exact.a, exact.b))
    assert curvatures == pytest.approx([exact.curvature_x, exact.curvature_y], rel=1e-9)
    assert unit * finite_bodies.own_approach(exact.a, exact.b) == pytest.approx(
        exact.approach, rel=1e-9
    )


def test_a_curvature_in_both_directions_changes_hertz_by_as_much() -> None:
    exact = point_contact(1 / 400, 1 / 400, MODULUS, LOAD)
    more = point_contact(1.3 / 400, 1.3 / 400, MODULUS, LOAD)
    added = 0.3 / 400 / (LOAD / (np.pi * MODULUS))
    change = finite_bodies.change(added, exact.a, exact.b)
    assert change == pytest.approx(more.p0 / exact.p0 - 1, rel=1e-9)
    assert change == pytest.approx(exact.area / more.area - 1, rel=1e-9)
