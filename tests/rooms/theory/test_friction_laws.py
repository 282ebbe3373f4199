"""Laws of the coefficient at their known places, and the memory along the rail; heat: the strip
integral, Ertz and Knothe's ellipse, energy, bulk warmth.
"""

import math

import numpy as np
import pytest

from railhead.theory.friction_laws import ByTemperature, Falling, Heat, Interface, followed

ONE = np.ones((1, 1))


@pytest.mark.parametrize(
    ("linear", "slip", "expected"),
    [
        (False, 0.0, 0.33), (False, 1250.0, 0.235), (False, 2500.0, 0.1875), (False, 1e6, 0.14),
        (True, 0.0, 0.33), (True, 1250.0, 0.235), (True, 2500.0, 0.14), (True, 1e6, 0.14),
    ],
)  # fmt: skip
def test_half_of_the_difference_is_gone_at_half(linear, slip, expected) -> None:
    law = Falling(0.14, 1250.0, linear)
    assert law(0.33 * ONE, slip * ONE, 0 * ONE) == pytest.approx(expected)


def test_a_table_is_linear_between_its_pairs_and_constant_beyond() -> None:
    law = ByTemperature(((0.0, 0.3), (400.0, 0.12)))
    found = [float(law(ONE, ONE, t * ONE)[0, 0]) for t in (-50.0, 0.0, 100.0, 400.0, 900.0)]
    assert found == pytest.approx([0.3, 0.3, 0.255, 0.12, 0.12])


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (Falling(0.14, 1250.0), 0.33), (Falling(0.5, 1250.0), 0.5),
        (ByTemperature(((-50.0, 0.6), (50.0, 0.4), (400.0, 0.12))), 0.45),
        (ByTemperature(((0.0, 0.3), (100.0, 0.5), (400.0, 0.12))), 0.5),
    ],
)  # fmt: skip
def test_the_largest_coefficient_from_rest_and_the_bulk_on(law, expected) -> None:
    warm = Interface(heat=Heat(speed=10.0, bulk_rail=50.0), law=law)
    assert warm.largest(0.33 * ONE) == pytest.approx(expected)
    assert warm.largest(0.33 * ONE).shape == ONE.shape


def test_a_coefficient_follows_exponentially_from_the_leading_edge() -> None:
    """mu - aim = (mu_0 - aim) exp(-s/d_c) at the end of each cell, each line from its own edge."""
    aim, start = np.full((6, 2), 0.1), np.full((6, 2), 0.3)
    inside = np.array([[1, 1], [1, 1], [1, 1], [1, 1], [1, 0], [0, 0]], dtype=bool)
    found = followed(aim, start, inside, 0.25)
    for line, cells in ((0, 5), (1, 4)):
        s = 0.25 * np.arange(1, cells + 1)
        np.testing.assert_allclose(found[:cells, line][::-1], 0.1 + 0.2 * np.exp(-s))
    assert (found[~inside] == 0.3).all()
    np.testing.assert_allclose(followed(aim, start, inside, 1e3)[inside], 0.1)


def test_a_law_without_a_speed_is_refused() -> None:
    with pytest.raises(ValueError, match="needs a speed"):
        Interface(law=Falling(0.1, 1.0)).coefficient(
            ONE[0], ONE, ONE > 0, np.zeros((2, 1, 1)), None
        )


def test_memory_is_a_cell_where_the_law_falls_with_slip() -> None:
    """A law of the temperature follows at once: the temperature itself remembers."""
    x, inside, slip = np.array([0.0, 0.5]), np.ones((2, 1), dtype=bool), np.full((2, 2, 1), 0.1)
    static, none = np.full((2, 1), 0.3), np.zeros((2, 2, 1))

    def found(law, memory) -> np.ndarray:
        surfaces = Interface(heat=Heat(speed=10.0, bulk_rail=80.0), law=law, memory=memory)
        return surfaces.coefficient(x, static, inside, slip, surfaces.rise(x, none, slip))

    falling, table = Falling(0.1, 1.0), ByTemperature(((0.0, 0.3), (80.0, 0.1)))
    np.testing.assert_array_equal(found(falling, None), found(falling, 0.5))
    assert found(falling, None)[1, 0] == pytest.approx(0.1 + 0.2 / np.e)
    np.testing.assert_allclose(found(table, None), 0.2)
    np.testing.assert_allclose(found(falling, 0.0), 0.1, atol=1e-12)


def test_a_line_of_uneven_places_has_the_coefficient_of_each() -> None:
    """Full slip without memory, in any order of the places."""
    x = np.random.default_rng(1).permutation(np.linspace(-1, 1, 41) ** 3)
    warm = Interface(heat=Heat(speed=10.0, bulk_rail=80.0), law=Falling(0.1, 1e3), memory=0.0)
    pressure, slip = np.where(x < 0.5, 100.0, 0.0), 0.1 * (1 + x**2)
    found, rise = warm.along_line(x, 0.3 * np.ones(41), pressure, 0 * x, slip)
    inside = x < 0.4
    np.testing.assert_allclose(found[inside], 0.1 + 0.2 * 0.5 ** (10 * slip[inside]), rtol=0.003)
    assert rise is not None
    np.testing.assert_allclose(rise, [[-40.0] * 41, [40.0] * 41])
    plain, none = Interface().along_line(x, 0.3 * np.ones(41), pressure, 0 * x, slip)
    assert none is None
    np.testing.assert_allclose(plain, 0.3)


A, B, LOAD, SPEED = 5.88, 10.54, 1e5, 30.0
STEEL = Heat(speed=SPEED)
EFFUSIVITY = math.sqrt(50 * 7850 * 450)


def cells(half: float, count: int) -> np.ndarray:
    return half * ((2 * np.arange(count) + 1) / count - 1)


def ellipse(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cell centres and Hertz's pressure on Ertz and Knothe's ellipse."""
    x, y = cells(A, count), cells(B, count)
    p = np.sqrt(np.maximum(1 - (x[:, None] / A) ** 2 - (y / B) ** 2, 0))
    return x, y, p * LOAD / (p.sum() * (x[1] - x[0]) * (y[1] - y[0]))


@pytest.mark.parametrize("share", [0.5, 0.2])
def test_a_constant_flux_heats_with_the_root_of_the_way(share: float) -> None:
    """T = (q/e) 2 sqrt(t/pi) of a half-space, t = s/V, at every cell on any grid."""
    x, flux = cells(A, 7), np.full((7, 2), 40.0)
    found = Heat(speed=SPEED, share=share).temperatures(x, flux)
    time = 1e-3 * (A - x) / SPEED
    for body, part in zip(found, (share, 1 - share), strict=True):
        exact = part * 40e6 / EFFUSIVITY * 2 * np.sqrt(time / math.pi)
        np.testing.assert_allclose(body, np.column_stack([exact, exact]), rtol=1e-12)


def test_an_ellipse_that_slips_everywhere_reaches_its_exact_temperature() -> None:
    """150.3 K at 1 m/s (the integral of the heat along the middle line); 0.5 % on 32 cells."""
    for count, limit in ((32, 5e-3), (128, 5e-4)):
        x, _, pressure = ellipse(count)
        found = STEEL.temperatures(x, 0.3 * pressure * 1.0)
        assert found.max() == pytest.approx(150.3, rel=limit) and (found[0] == found[1]).all()


def test_heat_follows_the_constants_and_not_the_direction_across() -> None:
    """Rises fall with the root of V lambda rho c; lines across do not heat each other."""
    x, _, pressure = ellipse(16)
    other = Heat(speed=4 * SPEED, conductivity=100.0, density=3925.0, specific_heat=450.0)
    once, slower = other.temperatures(x, pressure), STEEL.temperatures(x, pressure)
    np.testing.assert_allclose(once, slower / 2)
    single = np.where(np.arange(16) == 5, pressure, 0)
    np.testing.assert_allclose(STEEL.temperatures(x, single)[0][:, 5], slower[0][:, 5])
    assert not STEEL.temperatures(x, single)[0][:, 6].any()
