"""Limits of repeated rolling against printed values; wear regimes."""

import math

import numpy as np
import pytest

from railhead.theory import damage


def test_a_line_shakes_down_below_four_without_friction() -> None:
    """Johnson, Contact Mechanics, 9.2: 4.0, then p0 over the largest shear stress xz."""
    known = {0.0: 4.0, 0.05: 3.772, 0.1: 3.564, 0.15: 3.375, 0.2: 3.202, 0.25: 3.044, 0.3: 2.900}
    for friction, limit in known.items():
        assert damage.shakedown_limit(friction, 0.3) == pytest.approx(limit, rel=1e-3)


def test_a_surface_that_cannot_be_compressed_bears_a_traction_of_k() -> None:
    """With Poisson's ratio 1/2 rho_yy balances yy everywhere; otherwise less is borne."""
    for friction in (0.4, 0.5, 1.0):
        assert damage.surface_limit(friction, 0.5) == pytest.approx(1 / friction, rel=1e-4)
    for friction, limit in ((0.35, 2.669), (0.4, 2.359), (0.5, 1.913)):
        found = damage.shakedown_limit(friction, 0.3)
        assert limit * 0.975 < found < limit < 0.97 / friction  # those are of a grid in depth


@pytest.mark.parametrize("mu", [0.3, 0.4, 0.6])
def test_a_back_stress_leaves_the_smallest_ball_around_the_stresses_of_the_surface(mu) -> None:
    """Its radius by Badoiu and Clarkson's steps to the farthest stress, of closed forms."""
    x = np.linspace(-3.0, 3.0, 1201)
    p, beside = np.sqrt(np.maximum(1 - x**2, 0.0)), np.sqrt(np.maximum(x**2 - 1, 0.0))
    xx = -p - 2 * mu * (x - np.sign(x) * beside)
    half = (xx + p) / 2
    path = np.column_stack([half, (0.3 * (xx - p) + p - half) / math.sqrt(3), mu * p])
    centre = path.mean(axis=0)
    for step in range(1, 2_000):
        centre += (path[np.argmax(np.linalg.norm(path - centre, axis=1))] - centre) / (step + 1)
    radius = np.linalg.norm(path - centre, axis=1).max()
    found = damage.shakedown_limit(mu, 0.3, kinematic=True)
    assert found == pytest.approx(1 / radius, rel=1e-3)
    assert damage.shakedown_limit(mu, 0.3) < 0.99 * found


def test_below_the_surface_kinematic_hardening_bears_any_traction() -> None:
    for friction in (0.0, 0.1, 0.2):
        limit = damage.shakedown_limit(friction, 0.3, kinematic=True)
        assert limit == pytest.approx(4.0, rel=1e-3)


@pytest.mark.parametrize("share", [0.36, 0.84])
def test_partial_slip_lowers_the_limit_of_the_surface(share: float) -> None:
    """A grid of residual stresses, with Carter's stresses at the surface in closed form."""
    mu, nu, c = 0.4, 0.3, math.sqrt(1 - share)
    x = np.linspace(-1.0, 1.0, 401)
    p, away = np.sqrt(1 - x**2), x - 1 + c
    root = np.sqrt(np.maximum(away**2 - c**2, 0.0))
    q = mu * (p - np.sqrt(np.maximum(c**2 - away**2, 0.0)))
    xx = -p - 2 * mu * (x - away - root)  # in what sticks no more than -2 mu (1 - c)
    d, e = xx + p, nu * (xx - p) + p
    r, s = (np.linspace(*ends, 301)[:, None] for ends in ((-0.5, 1.5), (-0.6, 0.6)))
    squares = [((d + one) ** 2 - (d + one) * (e + s) + (e + s) ** 2) / 3 + q**2 for one in r]
    least = math.sqrt(min(float(each.max(axis=1).min()) for each in squares))
    found = damage.surface_limit(mu, nu, c)
    assert found == pytest.approx(1 / least, rel=0.005) and found < 0.95 / q.max()
    assert damage.shakedown_limit(mu, nu, share * mu) == pytest.approx(found, rel=1e-9)


def test_a_line_yields_below_its_shakedown_limit() -> None:
    """0.5575 p0 without friction (Poisson's ratio 0.3)."""
    assert damage.elastic_limit(0.0, 0.3) == pytest.approx(math.sqrt(3) / 0.5575, rel=1e-3)
    for friction in (0.0, 0.2, 0.4, 0.6):
        assert damage.elastic_limit(friction, 0.3) < damage.shakedown_limit(friction, 0.3)


def test_the_surface_fatigue_index_is_how_far_the_friction_is_beyond_the_limit() -> None:
    a, b, load, k = 7.1, 5.7, 110e3, 300.0
    pressure = 3 * load / (2 * math.pi * a * b)
    index = damage.surface_fatigue_index(0.3 * pressure, pressure, k)
    assert index == pytest.approx(0.3 - 2 * math.pi * a * b * k / (3 * load)) and index > 0
    assert damage.surface_fatigue_index(k, pressure, k) == 0


def test_an_ellipse_shakes_down_as_lines_and_circles_do():
    values = [damage.ellipse_limit(ratio) for ratio in (1e-6, 1.0, 1.25, 2.0)]
    assert values == pytest.approx([4.0, 4.675, 4.939, 5.777], abs=1e-3)


@pytest.mark.parametrize(
    "value, limits, regime",
    [
        (10.3, damage.TWIN_DISC, "mild"), (10.4, damage.TWIN_DISC, "severe"),
        (77.2, damage.TWIN_DISC, "catastrophic"), (20.0, (5.0, 15.0), "catastrophic"),
    ],
)  # fmt: skip
def test_limits_of_wear_belong_to_the_regime_above_them(value, limits, regime) -> None:
    assert damage.wear_regime(value, limits) == regime
