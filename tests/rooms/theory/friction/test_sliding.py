"""Stresses under full sliding: reference numbers, closed forms, equilibrium, what acts on top."""

from dataclasses import replace

import numpy as np
import pytest
from friction_data import ENTRIES, named

from railhead.theory.elastic import line, subsurface
from railhead.theory.elastic.hertz import Ellipse, contact_modulus, point_contact
from railhead.theory.friction import sliding
from tests.rooms.theory.finite_differences import Array, jacobian

MODULUS = contact_modulus(207000, 0.3, 207000, 0.3)
SPHERE = point_contact(1 / 420, 1 / 420, MODULUS, 25000)
THESIS = point_contact(1 / 420, 1 / 300, MODULUS, 25000)
LONG = point_contact(1e-3 / 420, 1 / 300, MODULUS, 25000)


def numbers():
    """Every third one runs by default."""
    known = [entry for entry in named("mises") if "crossover" not in str(entry.id)]
    more = [pytest.param(*each.values, id=each.id, marks=pytest.mark.slow) for each in known]
    return [known[i] if i % 3 == 0 else more[i] for i in range(len(known))]


@pytest.mark.parametrize("entry", numbers())
def test_the_hardest_places_under_sliding_are_those_of_the_references(
    entry,
) -> None:
    """Within the entries' own 0.1 % below and 1 % at the surface; places to 1 % of a half width."""
    contact = SPHERE if entry["shape"].startswith("sphere") else THESIS
    below, surface = sliding.peaks(contact, entry["mu"], entry["nu"]).values()
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
        below, surface = sliding.peaks(SPHERE, entry["mu"] + change, entry["nu"]).values()
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


@pytest.mark.parametrize("across", [False, True])
def test_a_strip_that_slides_has_johnson_s_stresses(across: bool) -> None:
    """Under the traction s_xx = -2 mu p0 x/w on the patch and -2 mu p0 (x/w - sqrt(x^2/w^2 - 1))
    beside it (Johnson, 7.1); along the strip it shears only.
    """
    found = line.contact(1 / 420, (207000, 207000), (0.3, 0.3), length=70, across=across, load=1e5)
    w, t = found.half_width, np.array([-1.7, -0.9, -0.2, 0.4, 1.3])
    side = 1 if across else 0
    points = np.zeros((10, 3))
    points[:, side], points[5:, 2] = np.tile(t * w, 2), -0.4 * w
    s = sliding.stress(found, 0.0, 0.3, points)
    turned = sliding.stress(replace(found, across=not across), 0.0, 0.3, points[:, [1, 0, 2]])
    np.testing.assert_allclose(turned[:, [1, 0, 2, 3, 5, 4]], s, atol=1e-12 * found.p0)
    dragged = sliding.stress(found, 0.4, 0.3, points) - s
    outside = np.sign(t) * np.sqrt(np.maximum(t**2 - 1, 0))
    pulled = 0 * t if across else -2 * 0.4 * found.p0 * (t - outside)
    np.testing.assert_allclose(dragged[:5, 0], pulled, atol=1e-6 * found.p0)
    np.testing.assert_allclose(dragged[:5, 4], 0.4 * found.pressure_across(t * w), atol=1e-6)


def test_points_that_are_not_in_the_body_are_refused() -> None:
    for points in ([[0.0, 0.0, 1.0]], [[0.0, 0.0]], [0.0, 0.0, -1.0]):
        with pytest.raises(ValueError):
            sliding.stress(SPHERE, 0.3, 0.3, points)
