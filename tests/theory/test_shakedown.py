"""Limits of repeated rolling against printed values, and the wear regimes."""

import math

import pytest

from railhead.theory import shakedown, wear


def test_a_line_shakes_down_below_four_and_its_surface_below_k() -> None:
    """Johnson, Contact Mechanics, 9.2: 4.0, and the surface from 0.367 on."""
    assert shakedown.shakedown_limit(0.0) == pytest.approx(4.0, rel=1e-3)
    for friction in (0.37, 0.5, 1.0):
        assert shakedown.shakedown_limit(friction) == pytest.approx(1 / friction, rel=1e-9)
    assert shakedown.shakedown_limit(0.363) < 1 / 0.363 - 0.01
    assert shakedown.shakedown_limit(0.367) == pytest.approx(1 / 0.367, rel=1e-3)


def test_a_line_yields_below_its_shakedown_limit() -> None:
    """0.5575 p0 without friction (Poisson's ratio 0.3)."""
    assert shakedown.elastic_limit(0.0, 0.3) == pytest.approx(math.sqrt(3) / 0.5575, rel=1e-3)
    for friction in (0.0, 0.2, 0.4, 0.6):
        assert shakedown.elastic_limit(friction, 0.3) < shakedown.shakedown_limit(friction)


def test_the_surface_fatigue_index_is_how_far_the_friction_is_beyond_the_limit() -> None:
    a, b, load, k = 7.1, 5.7, 110e3, 300.0
    pressure = 3 * load / (2 * math.pi * a * b)
    index = shakedown.surface_fatigue_index(0.3, pressure, k)
    assert index == pytest.approx(0.3 - 2 * math.pi * a * b * k / (3 * load))
    assert index > 0
    assert shakedown.surface_fatigue_index(k / pressure, pressure, k) == 0


@pytest.mark.parametrize(
    "value, limits, regime",
    [
        (10.3, wear.TWIN_DISC, "mild"), (10.4, wear.TWIN_DISC, "severe"),
        (77.3, wear.TWIN_DISC, "catastrophic"),
        (99.0, wear.BRITISH_RAIL, "mild"), (150.0, wear.BRITISH_RAIL, "severe"),
        (200.0, wear.BRITISH_RAIL, "catastrophic"),
    ],
)  # fmt: skip
def test_wear_grows_with_what_is_dissipated(value, limits, regime) -> None:
    assert wear.regime(value, limits) == regime
