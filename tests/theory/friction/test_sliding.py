"""What sliding does to steel: stresses, shakedown, wear regimes and flash temperatures."""

import math
from typing import Any

import numpy as np
import pytest
from finite_differences import Array, jacobian
from friction_data import ENTRIES, named

from railhead.theory.elastic import line, subsurface
from railhead.theory.elastic.hertz import Ellipse, contact_modulus, point_contact
from railhead.theory.friction import shakedown, sliding, wear

MODULUS = contact_modulus(207000, 0.3, 207000, 0.3)
SPHERE = point_contact(1 / 420, 1 / 420, MODULUS, 25000)
THESIS = point_contact(1 / 420, 1 / 300, MODULUS, 25000)
LONG = point_contact(1e-3 / 420, 1 / 300, MODULUS, 25000)


def numbers() -> list[Any]:
    return [entry for entry in named("mises") if "crossover" not in str(entry.id)]


@pytest.mark.parametrize("entry", numbers())
def test_reference_numbers(entry: dict[str, Any]) -> None:
    """Within the entries' own 0.1 % below and 1 % at the surface; places to 1 % of a half width."""
    contact = SPHERE if entry["shape"].startswith("sphere") else THESIS
    below = sliding.peak_below_surface(contact, entry["mu"], entry["nu"])
    surface = sliding.peak_at_surface(contact, entry["mu"], entry["nu"])
    p0 = contact.p0
    assert below.von_mises / p0 == pytest.approx(entry["subsurface_mises_over_p0"], rel=1e-3)
    assert (below.depth / contact.b, below.x / contact.a) == pytest.approx(
        (entry["subsurface_depth_over_b"], entry["subsurface_x_over_a"]), abs=0.01
    )
    assert surface.von_mises / p0 == pytest.approx(entry["surface_mises_over_p0"], rel=1e-2)
    assert surface.depth == 0
    if entry["mu"] > 0:
        assert surface.x / contact.a == pytest.approx(entry["surface_x_over_a"], abs=0.01)


def test_above_a_coefficient_the_surface_is_hardest() -> None:
    """The surface's stress grows by 1.5 p0 per 1 of the coefficient, so that 1 % of it is 0.005."""
    entry = next(each for name, each in ENTRIES.items() if "crossover" in name)
    for change in (-0.006, 0.006):
        mu = entry["mu"] + change
        surface = sliding.peak_at_surface(SPHERE, mu, entry["nu"])
        below = sliding.peak_below_surface(SPHERE, mu, entry["nu"])
        assert (surface.von_mises > below.von_mises) == (change > 0)


def scattered(contact: Ellipse, n: int, seed: int) -> Array:
    box = np.random.default_rng(seed).uniform((-2, -2, -2), (2, 2, -0.3), (n, 3))
    return np.asarray(box * (contact.a, contact.b, min(contact.a, contact.b)))


@pytest.mark.parametrize("contact", [SPHERE, THESIS, LONG], ids=["sphere", "thesis", "long"])
def test_without_friction_it_is_loves_field(contact: Ellipse) -> None:
    points = scattered(contact, 50, 1)
    expected = subsurface.stress(contact, 0.3, points)
    found = sliding.stress(contact, 0.0, 0.3, points)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * contact.p0)


def test_equilibrium_and_compatibility() -> None:
    """div s = 0, and the sum of the normal stresses is harmonic."""
    points = scattered(THESIS, 10, 2)

    def field(where: Array) -> Array:
        return sliding.stress(THESIS, 0.7, 0.3, where)

    d = jacobian(field, points, 1e-3)
    full = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])
    divergence = sum(d[:, full[:, k], k] for k in range(3))
    np.testing.assert_allclose(divergence, 0, atol=1e-8 * THESIS.p0)

    h = 1e-2 * np.eye(3)[:, None, None] * np.array([2, 1, -1, -2])[:, None, None]
    around = np.concatenate([points[None], (points + h).reshape(-1, *points.shape)])
    trace = field(around.reshape(-1, 3))[:, :3].sum(axis=1).reshape(13, -1)
    weights = np.concatenate([[-90.0], np.tile([-1, 16, 16, -1], 3)])
    np.testing.assert_allclose(weights @ trace / 12e-4, 0, atol=1e-5 * THESIS.p0)


def test_what_acts_on_the_surface() -> None:
    """p down and mu p along +x on the patch; nothing beside it, to 0.5 % of p0."""
    x, y = np.random.default_rng(3).uniform(-1.5, 1.5, (2, 200)) * [[THESIS.a], [THESIS.b]]
    s = sliding.stress(THESIS, 0.4, 0.3, np.column_stack([x, y, 0 * x]))
    p = THESIS.pressure(x, y)
    inside = p > 0.2 * THESIS.p0
    expected = np.column_stack([-p, 0.4 * p, 0 * p])
    found = s[:, [2, 4, 5]]
    np.testing.assert_allclose(found[inside], expected[inside], atol=1e-9 * THESIS.p0)
    np.testing.assert_allclose(found, expected, atol=5e-3 * THESIS.p0)


def test_the_trailing_edge_of_a_sphere() -> None:
    """s_xx = p0 ((1 - 2 nu)/3 + (4 + nu) pi mu/8) (Hamilton 1983; Johnson, 7.12)."""
    for mu, nu in ((0.0, 0.3), (0.3, 0.3), (0.5, 0.1)):
        s = sliding.stress(SPHERE, mu, nu, [[-SPHERE.a, 0.0, 0.0]])[0, 0]
        expected = (1 - 2 * nu) / 3 + (4 + nu) * math.pi * mu / 8
        assert s / SPHERE.p0 == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("across", [False, True])
def test_a_strip(across: bool) -> None:
    """Pressure as in `theory.elastic.line`; under the traction s_xx = -2 mu p0 x/w on the patch and
    -2 mu p0 (x/w - sqrt(x^2/w^2 - 1)) beside it (Johnson, 7.1); along the strip it shears only."""
    found = line.contact(1 / 420, (207000, 207000), (0.3, 0.3), length=70, across=across, load=1e5)
    w, t = found.half_width, np.array([-1.7, -0.9, -0.2, 0.4, 1.3])
    side = 1 if across else 0
    points = np.zeros((10, 3))
    points[:, side], points[5:, 2] = np.tile(t * w, 2), -0.4 * w
    s = sliding.stress(found, 0.0, 0.3, points)
    tt, nn, tn, out = line.stress(found.strip, 0.3, points[:, side], -points[:, 2]).T
    np.testing.assert_allclose(s[:, side], tt, atol=1e-9 * found.p0)
    np.testing.assert_allclose(s[:, 2], nn, atol=1e-9 * found.p0)
    np.testing.assert_allclose(s[:, 4 + side], tn, atol=1e-9 * found.p0)
    np.testing.assert_allclose(s[:, 1 - side], out, atol=1e-9 * found.p0)
    dragged = sliding.stress(found, 0.4, 0.3, points) - s
    outside = np.sign(t) * np.sqrt(np.maximum(t**2 - 1, 0))
    pulled = 0 * t if across else -2 * 0.4 * found.p0 * (t - outside)
    np.testing.assert_allclose(dragged[:5, 0], pulled, atol=1e-6 * found.p0)
    np.testing.assert_allclose(dragged[:5, 4], 0.4 * found.strip.pressure(t * w), atol=1e-6)


def test_points_out_of_range() -> None:
    for points in ([[0.0, 0.0, 1.0]], [[0.0, 0.0]], [0.0, 0.0, -1.0]):
        with pytest.raises(ValueError):
            sliding.stress(SPHERE, 0.3, 0.3, points)


# Limits of repeated rolling against printed values, and the wear regimes.


def test_a_line_shakes_down_below_four_without_friction() -> None:
    """Johnson, Contact Mechanics, 9.2: 4.0, then p0 over the largest shear stress xz."""
    known = {0.0: 4.0, 0.05: 3.772, 0.1: 3.564, 0.15: 3.375, 0.2: 3.202, 0.25: 3.044, 0.3: 2.900}
    for friction, limit in known.items():
        assert shakedown.shakedown_limit(friction, 0.3) == pytest.approx(limit, rel=1e-3)


def test_a_surface_that_cannot_be_compressed_bears_a_traction_of_k() -> None:
    """With Poisson's ratio 1/2 rho_yy balances yy everywhere; otherwise less is borne."""
    for friction in (0.4, 0.5, 1.0):
        assert shakedown.surface_limit(friction, 0.5) == pytest.approx(1 / friction, rel=1e-4)
    for friction, limit in ((0.35, 2.669), (0.4, 2.359), (0.5, 1.913)):
        found = shakedown.shakedown_limit(friction, 0.3)
        assert limit * 0.975 < found < limit < 0.97 / friction  # those are of a grid in depth


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
    found = shakedown.surface_limit(mu, nu, c)
    assert found == pytest.approx(1 / least, rel=0.005)
    assert found < 0.95 / q.max()
    assert shakedown.shakedown_limit(mu, nu, share * mu) == pytest.approx(found, rel=1e-9)


def test_a_line_yields_below_its_shakedown_limit() -> None:
    """0.5575 p0 without friction (Poisson's ratio 0.3)."""
    assert shakedown.elastic_limit(0.0, 0.3) == pytest.approx(math.sqrt(3) / 0.5575, rel=1e-3)
    for friction in (0.0, 0.2, 0.4, 0.6):
        assert shakedown.elastic_limit(friction, 0.3) < shakedown.shakedown_limit(friction, 0.3)


def test_the_surface_fatigue_index_is_how_far_the_friction_is_beyond_the_limit() -> None:
    a, b, load, k = 7.1, 5.7, 110e3, 300.0
    pressure = 3 * load / (2 * math.pi * a * b)
    index = shakedown.surface_fatigue_index(0.3 * pressure, pressure, k)
    assert index == pytest.approx(0.3 - 2 * math.pi * a * b * k / (3 * load))
    assert index > 0
    assert shakedown.surface_fatigue_index(k, pressure, k) == 0


@pytest.mark.parametrize(
    "value, limits, regime",
    [
        (10.3, wear.TWIN_DISC, "mild"), (10.4, wear.TWIN_DISC, "severe"),
        (77.3, wear.TWIN_DISC, "catastrophic"),
    ],
)  # fmt: skip
def test_wear_grows_with_what_is_dissipated(value, limits, regime) -> None:
    assert wear.regime(value, limits) == regime


# Flash temperatures against CONTACT and against the heat equation along the middle line.

A, B, FORCE, FRICTION, SLIP, SPEED = 5.88, 10.54, 1e5, 0.3, 1 / 30, 30.0  # mm, N, 1, 1, m/s
EFFUSIVITY = math.sqrt(50.0 * 7850.0 * 450.0)


def along_the_middle(flux: np.ndarray, t: np.ndarray) -> float:
    """Largest of int q(s) ds/(2 sqrt(pi k rho c v (x - s))) in K; q in W/m2 over t = x/a."""
    best = 0.0
    for x in np.linspace(-0.9, 1.0, 96):
        root = (np.arange(2000) + 0.5) * math.sqrt(x + 1) / 2000
        q = np.interp(x - root**2, t, flux)
        best = max(best, 2 * q.mean() * math.sqrt(x + 1))
    return best / 2 * math.sqrt(1e-3 * A / SPEED / math.pi) / EFFUSIVITY


def test_an_ellipse_that_slips_everywhere() -> None:
    """Ertz and Knothe's case: 166.8 K by CONTACT (examples/ertz_temperature.ref_out)."""
    area = math.pi * A * B
    rise = wear.flash_temperature(FRICTION * FORCE * SLIP, area, A, SPEED, line=False)
    assert rise == pytest.approx(166.8, rel=0.1)
    t = np.linspace(-1, 1, 2001)
    flux = FRICTION * 1.5 * FORCE / (1e-6 * area) * SLIP * SPEED * np.sqrt(1 - t**2)
    assert rise == pytest.approx(along_the_middle(flux, t), rel=0.02)


def test_a_band_of_even_heat() -> None:
    length = 70.0
    rise = wear.flash_temperature(1000.0, 2 * A * length, A, SPEED, line=True)
    flux = np.full(3, 1000.0 * SPEED / (2e-6 * A * length))
    assert rise == pytest.approx(along_the_middle(flux, np.array([-1.0, 0.0, 1.0])), rel=0.003)
