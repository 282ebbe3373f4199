"""The strip integral: exact for a constant flux; Ertz and Knothe's ellipse; energy; bulk warmth."""

import math

import numpy as np
import pytest

from railhead.theory.friction.laws import Heat

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
        assert found.max() == pytest.approx(150.3, rel=limit)
        assert (found[0] == found[1]).all()


def test_the_field_holds_the_heat_that_the_bodies_took() -> None:
    """Abel: what a line took up to S is e sqrt(V/pi) int_0^S T(s)/sqrt(S - s) ds, here at S one
    patch length behind the patch; no factor of the field is used."""
    count = 256
    x, y, pressure = ellipse(count)
    width, room = x[1] - x[0], count // 2
    x = np.concatenate([x[0] - width * np.arange(room, 0, -1), x])
    flux = np.concatenate([np.zeros((room, count)), 0.3 * pressure])
    end = x[0] - width / 2
    for body in STEEL.temperatures(x, flux):
        weight = 2 * (np.sqrt(x - end + width / 2) - np.sqrt(x - end - width / 2))
        line = EFFUSIVITY * math.sqrt(SPEED / math.pi) * math.sqrt(1e-3) * (weight @ body)  # W/m
        power = line.sum() * (y[1] - y[0]) * 1e-3
        assert 2 * power == pytest.approx(0.3 * LOAD * 1.0, rel=3e-3)


def test_bodies_of_unlike_warmth_share_their_mean() -> None:
    warm = Heat(speed=SPEED, bulk_wheel=150.0)
    x, _, pressure = ellipse(16)
    assert (warm.temperatures(x, 0 * pressure) == 75.0).all()
    added = warm.temperatures(x, pressure) - STEEL.temperatures(x, pressure)
    np.testing.assert_allclose(added, 75.0)


def test_heat_follows_the_constants_and_not_the_direction_across() -> None:
    """Rises fall with the root of V lambda rho c; lines across do not heat each other."""
    x, _, pressure = ellipse(16)
    other = Heat(speed=4 * SPEED, conductivity=100.0, density=3925.0, specific_heat=450.0)
    once, slower = other.temperatures(x, pressure), STEEL.temperatures(x, pressure)
    np.testing.assert_allclose(once, slower / 2)
    single = np.where(np.arange(16) == 5, pressure, 0)
    np.testing.assert_allclose(STEEL.temperatures(x, single)[0][:, 5], slower[0][:, 5])
    assert not STEEL.temperatures(x, single)[0][:, 6].any()
