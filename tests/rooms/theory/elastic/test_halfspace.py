"""Displacements of the half-space: contact condition, superposition, far field, elasticity."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import j0

from railhead.theory.elastic import halfspace
from railhead.theory.elastic.halfspace import cerruti_displacement, hertz_displacement
from railhead.theory.elastic.hertz import Ellipse, contact_modulus, point_contact, pressure_rise
from railhead.theory.elastic.subsurface import stress
from tests.rooms.theory.finite_differences import Array, jacobian

CURVATURE_RATIOS = [1e-3, 0.2, 1.0, 1 + 1e-9, 5.0]
WHEEL, RAIL = (210000.0, 0.28), (190000.0, 0.35)


def contact_of(curvature_ratio: float) -> Ellipse:
    return point_contact(curvature_ratio * 1e-3, 1e-3, contact_modulus(*WHEEL, *RAIL), 4e4)


def hooke(strain: Array, young: float, poisson: float) -> Array:
    """Stress (n, 6) of displacement gradients (n, 3, 3)."""
    e = (strain + np.swapaxes(strain, 1, 2)) / 2
    mu = young / (2 * (1 + poisson))
    pressure = 2 * mu * poisson / (1 - 2 * poisson) * np.trace(e, axis1=1, axis2=2)
    s = 2 * mu * e + pressure[:, None, None] * np.eye(3)
    return np.asarray(s[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])


@pytest.mark.parametrize("curvature_ratio", CURVATURE_RATIOS)
def test_gap_is_closed_inside_and_open_outside(curvature_ratio: float) -> None:
    c = contact_of(curvature_ratio)
    plane = np.random.default_rng(1).uniform(-1.5, 1.5, (400, 3)) * (c.a, c.b, 0)
    sunk = -hertz_displacement(c, plane, *WHEEL)[:, 2] - hertz_displacement(c, plane, *RAIL)[:, 2]
    x, y = plane[:, 0], plane[:, 1]
    gap = c.curvature_x * x**2 / 2 + c.curvature_y * y**2 / 2 + sunk - c.approach
    inside = c.pressure(x, y) > 0
    assert np.abs(gap[inside]).max() < 1e-12 * c.approach and gap[~inside].min() > 0
    assert 0 < inside.sum() < 400


@pytest.mark.parametrize("curvature_ratio", CURVATURE_RATIOS)
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
def test_strain_and_hooke_give_the_stress(curvature_ratio: float, poisson: float) -> None:
    c = contact_of(curvature_ratio)
    size = min(c.a, c.b)
    box = np.random.default_rng(2).uniform((-2, -2, -3), (2, 2, -0.15), (200, 3))
    points = box * (c.a, c.b, size)
    gradient = jacobian(lambda at: hertz_displacement(c, at, 2e5, poisson), points, 2e-3 * size)
    expected = stress(c, poisson, points)
    assert np.abs(hooke(gradient, 2e5, poisson) - expected).max() < 2e-8 * c.p0


def test_rigid_body_does_not_move(thesis_ellipse: Ellipse) -> None:
    assert np.all(hertz_displacement(thesis_ellipse, [[1, 2, -3]], math.inf, 0.3) == 0)
    assert np.all(cerruti_displacement([[1, 2, -3]], 1e3, math.inf, 0.3) == 0)


@pytest.mark.parametrize("wrong", [[[0, 0, 1.0]], [[0, 0, 0]], [0, 0, -1.0]])
def test_points_that_are_not_below_the_surface_are_refused(wrong, thesis_ellipse: Ellipse) -> None:
    """Below the point force; below a patch the surface is allowed."""
    with pytest.raises(ValueError, match="points must"):
        cerruti_displacement(wrong, 1e3, 2e5, 0.3)
    with pytest.raises(ValueError, match="z <= 0"):
        hertz_displacement(thesis_ellipse, [[0, 0, 1.0]], 2e5, 0.3)


# The curvature that finite bodies add, against integrals and Hertz.

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
    assert halfspace.held_below(depth, poisson) == pytest.approx(expected, rel=2e-3)


def test_an_edge_is_felt_as_its_image() -> None:
    step, distance, psi = 0.1, 6.0, halfspace.image_force(0.3)
    assert psi == pytest.approx(1.39)
    left, middle, right = (psi / (2 * distance + x) for x in (-step, 0, step))
    curvature = (left - 2 * middle + right) / step**2
    assert halfspace.free_edge(distance, 0.3) == pytest.approx(curvature, rel=1e-3)


@pytest.mark.parametrize("ratio", [0.2, 1.0, 30.0])
def test_own_curvatures_and_approach_are_hertz(ratio: float) -> None:
    exact = point_contact(1 / 400, ratio / 400, MODULUS, LOAD)
    unit = LOAD / (np.pi * MODULUS)
    curvatures = unit * np.array(halfspace.own_curvatures(exact.a, exact.b))
    assert curvatures == pytest.approx([exact.curvature_x, exact.curvature_y], rel=1e-9)
    assert unit * halfspace.own_approach(exact.a, exact.b) == pytest.approx(
        exact.approach, rel=1e-9
    )


@pytest.mark.parametrize(("along", "across"), [(0.3, 0.3), (-0.2, 0.4)])
def test_a_curvature_in_both_directions_changes_hertz_by_as_much(
    along: float, across: float
) -> None:
    exact = point_contact(1 / 400, 2 / 400, MODULUS, LOAD)
    more = point_contact((1 + along) / 400, (2 + across) / 400, MODULUS, LOAD)
    added = np.array([along, across]) / 400 / (LOAD / (np.pi * MODULUS))
    change = pressure_rise(*added, exact.a, exact.b)
    assert (change, change) == pytest.approx(
        (more.p0 / exact.p0 - 1, exact.area / more.area - 1), rel=1e-6
    )
