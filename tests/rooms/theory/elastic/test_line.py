"""Line contacts against Johnson; stresses below strips are those of a Hertz strip that slides."""

import math

import numpy as np
import pytest

from railhead.theory.elastic import line
from railhead.theory.elastic.hertz import line_contact
from railhead.theory.friction import sliding

YOUNG, POISSON, RADIUS = 207000.0, 0.3, 420.0


def stress(contact: line.LineContact, t: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Stresses (n, 4) tt, nn, tn and out of plane, without friction."""
    points = np.column_stack(np.broadcast_arrays(t, 0.0, -np.asarray(depth)))
    return sliding.stress(contact, 0.0, POISSON, points)[:, [0, 2, 4, 1]]


@pytest.fixture(scope="module")
def contact() -> line.LineContact:
    return line.contact(
        1 / RADIUS, (YOUNG, YOUNG), (POISSON, POISSON), length=70, across=False, load=110e3
    )


def test_the_outline_is_the_rectangle_of_the_patch(contact) -> None:
    corners = np.abs(contact.outline) / (contact.a, contact.b)
    assert np.all(corners == 1) and len(np.unique(contact.outline, axis=0)) == 4


def test_surface_carries_the_pressure_and_nothing_else(contact) -> None:
    t = np.array([-1.7, -0.8, 0.0, 0.3, 0.99, 1.4]) * contact.half_width
    found = stress(contact, t, 0 * t)
    np.testing.assert_allclose(found[:, 1], -contact.pressure_across(t), atol=1e-9 * contact.p0)
    np.testing.assert_allclose(found[:, 2], 0.0, atol=1e-9 * contact.p0)
    np.testing.assert_allclose(found[:, 0], found[:, 1], atol=1e-9 * contact.p0)


def test_stresses_on_the_axis_are_johnsons(contact) -> None:
    depth = contact.half_width * np.array([0.1, 0.786, 2.5])
    found = stress(contact, 0 * depth, depth)
    exact = contact.axis_stress(POISSON, depth)
    np.testing.assert_allclose(found[:, [0, 3, 1]], exact, rtol=1e-12)
    turned = line.contact(
        1 / RADIUS, (YOUNG, YOUNG), (POISSON, POISSON), length=70, across=True, load=110e3
    )
    np.testing.assert_allclose(turned.axis_stress(POISSON, depth), exact[:, [1, 0, 2]])


@pytest.mark.parametrize("t, depth", [(0.3, 0.7), (1.9, 0.4), (-3.0, 2.0), (0.0, 5.0)])
def test_stress_is_hookes_law_of_the_displacement(contact, t: float, depth: float) -> None:
    t, depth = t * contact.half_width, depth * contact.half_width
    step = 1e-4
    lam = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    mu = YOUNG / (2 * (1 + POISSON))

    def at(dt: float, dd: float) -> np.ndarray:
        return line.displacement(contact, [t + dt], [depth + dd], YOUNG, POISSON, contact.datum)[0]

    by_t, by_d = (at(*e) - at(*(-np.array(e))) for e in ((step, 0.0), (0.0, step)))
    strain = np.array([by_t[0], by_d[1], (by_t[1] + by_d[0]) / 2]) / (2 * step)
    trace = strain[0] + strain[1]
    expected = [lam * trace + 2 * mu * strain[0], lam * trace + 2 * mu * strain[1]]
    expected += [-2 * mu * strain[2], lam * trace]  # the normal points up, the depth down
    np.testing.assert_allclose(stress(contact, t, depth)[0], expected, atol=1e-7 * contact.p0)


def test_surfaces_meet_inside_and_part_outside(contact) -> None:
    """w(0) - w(t) of both bodies is t^2 / 2R inside the strip and less outside."""
    t = np.array([0.25, 0.7, 1.0, 1.3]) * contact.half_width
    at = np.concatenate([[0.0], t])
    down = line.displacement(contact, at, 0 * at, YOUNG, POISSON, contact.datum)[:, 1]
    closed, parabola = 2 * (down[0] - down[1:]), t**2 / (2 * RADIUS)
    np.testing.assert_allclose(closed[:3], parabola[:3], rtol=1e-9)
    assert closed[3] < 0.9 * parabola[3]


def test_approach_is_johnsons_for_a_deep_datum(contact) -> None:
    """2 F'(1 - nu^2)/(pi E) (2 ln(2d/w) - nu/(1 - nu)) (Johnson 5.57) for d >> w."""
    scale = contact.load_per_length * (1 - POISSON**2) / (math.pi * YOUNG)
    bracket = 2 * math.log(2 * contact.datum / contact.half_width) - POISSON / (1 - POISSON)
    assert contact.approach == pytest.approx(2 * scale * bracket, rel=1e-5)


def test_load_and_approach_belong_together(contact) -> None:
    found = line.contact(
        1 / RADIUS, (YOUNG, YOUNG), (POISSON, POISSON),
        length=70, across=False, approach=contact.approach,
    )  # fmt: skip
    assert found.load == pytest.approx(110e3, rel=1e-9)
    assert (found.area, found.p_mean, found.pressure(0.0, 0.0)) == pytest.approx(
        (2 * found.a * 70, found.load / found.area, found.p0)
    )
    assert found.pressure(0.0, 36.0) == 0.0


def test_largest_shear_is_0300_p0_at_0786(contact) -> None:
    extrema = contact.axis_extrema(POISSON)
    assert (
        extrema.tau_max / contact.p0,
        extrema.tau_max_depth / contact.half_width,
    ) == pytest.approx((0.300, 0.786), abs=5e-4)
    assert extrema.von_mises_max / contact.p0 == pytest.approx(1 / 1.79, rel=3e-3)


def test_published_numbers_of_two_cylinders() -> None:
    """VM191: half width 1.1997 mm, p0 1698.06 MPa; Roark's approach 0.4174 is 4 % more."""
    strip = line_contact(1 / 10 + 1 / 13, 1 / (0.9375 / 30000 + 0.91 / 29120), 3200.0)
    assert (strip.half_width, strip.p0) == pytest.approx(
        (1.1997142442938187, 1698.0570842312509), rel=1e-9
    )
    johnson = line.cylinder_approach(strip, 10, 30000, 0.25)
    johnson += line.cylinder_approach(strip, 13, 29120, 0.3)
    assert johnson == pytest.approx(0.39954, rel=1e-4)
    assert line.cylinder_approach(strip, 10, math.inf, 0.3) == 0.0


STRIP = line.contact(0.01, (207e3, 207e3), (0.3, 0.3), length=1.0, across=False, load=500.0)


@pytest.mark.parametrize("friction", [0.0, 0.3, -0.3])
def test_many_strips_are_a_hertz_strip(friction):
    width, rng = STRIP.half_width, np.random.default_rng(4)
    points = np.column_stack([
        rng.uniform(-2, 2, 100), np.zeros(100), -rng.uniform(0.05, 3, 100)
    ]) * width  # fmt: skip
    edges = np.linspace(-width, width, 801)
    pressure = STRIP.pressure((edges[1:] + edges[:-1]) / 2, 0.0)
    strips = line.Strips(edges, points[:, 0], -points[:, 2], 0.3)
    found = strips.stress(pressure, friction * pressure)
    exact = sliding.stress(STRIP, friction, 0.3, points)[:, [0, 1, 2, 4]]
    assert found == pytest.approx(exact, abs=1e-4 * STRIP.p0)
