"""Wear regimes; flash temperatures against CONTACT and the heat equation along the middle line."""

import math

import numpy as np
import pytest

from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction import wear

A, B, FORCE, FRICTION, SLIP, SPEED = 5.88, 10.54, 1e5, 0.3, 1 / 30, 30.0  # mm, N, 1, 1, m/s
EFFUSIVITY = math.sqrt(50.0 * 7850.0 * 450.0)


@pytest.mark.parametrize(
    "value, limits, regime",
    [
        (10.3, wear.TWIN_DISC, "mild"), (10.4, wear.TWIN_DISC, "severe"),
        (77.2, wear.TWIN_DISC, "catastrophic"), (20.0, (5.0, 15.0), "catastrophic"),
    ],
)  # fmt: skip
def test_limits_of_wear_belong_to_the_regime_above_them(value, limits, regime) -> None:
    assert wear.regime(value, limits) == regime


def along_the_middle(flux: np.ndarray, t: np.ndarray) -> float:
    """Largest of int q(s) ds/(2 sqrt(pi k rho c v (x - s))) in K; q in W/m2 over t = x/a."""
    best = 0.0
    for x in np.linspace(-0.9, 1.0, 96):
        root = (np.arange(2000) + 0.5) * math.sqrt(x + 1) / 2000
        q = np.interp(x - root**2, t, flux)
        best = max(best, 2 * q.mean() * math.sqrt(x + 1))
    return best / 2 * math.sqrt(1e-3 * A / SPEED / math.pi) / EFFUSIVITY


def test_the_flash_temperature_of_an_ellipse_is_that_of_contact() -> None:
    """Ertz and Knothe's case: 166.8 K by CONTACT (examples/ertz_temperature.ref_out)."""
    area = math.pi * A * B
    rise = wear.flash_temperature(FRICTION * FORCE * SLIP, area, A, SPEED, Ellipse.middle_over_mean)
    assert rise == pytest.approx(166.8, rel=0.1)
    t = np.linspace(-1, 1, 2001)
    flux = FRICTION * 1.5 * FORCE / (1e-6 * area) * SLIP * SPEED * np.sqrt(1 - t**2)
    assert rise == pytest.approx(along_the_middle(flux, t), rel=0.02)


def test_the_flash_temperature_of_a_band_is_that_of_the_heat_equation() -> None:
    length = 70.0
    rise = wear.flash_temperature(1000.0, 2 * A * length, A, SPEED, LineContact.middle_over_mean)
    flux = np.full(3, 1000.0 * SPEED / (2e-6 * A * length))
    assert rise == pytest.approx(along_the_middle(flux, np.array([-1.0, 0.0, 1.0])), rel=0.003)
