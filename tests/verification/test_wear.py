"""Wear of a cylinder on a crown in full slip by a closed form; steps of any length, laws."""

import numpy as np
import pytest

from railhead.scene.scene import Scene
from railhead.sweeps.wear import wear_run
from railhead.theory import wear
from railhead.theory.elastic import hertz

PLACES = np.linspace(-20.0, 20.0, 4001)
SPLINES = wear.Splines(PLACES.size, 80)


def test_one_passage_in_full_slip_takes_the_chords_of_hertz():
    """Rate times T-gamma: the chord of the pressure at a place times mu and the creepage."""
    rail, wheel = {"profile": "arc", "crown_radius": 300.0}, {"rolling_radius": 460.0}
    moves = {"friction": {"coefficient": 0.3}, "rolling": {"creepage_along": 0.05}}
    fast = {"effects": {"finite_bodies": "off"}, "wear": {"axles": 1.0}}
    scene = Scene(load=80e3, rail=rail, wheel=wheel, **moves, **fast)
    run = wear_run.Run.begun(wear_run.read(scene), (128, 15.0))
    (depth, wheels), _ = run.advance(run.stages[0].depth, 1e-3)
    ellipse = hertz.point_contact(
        1 / 460, 1 / 300, hertz.contact_modulus(207e3, 0.3, 207e3, 0.3), 80e3
    )
    y, energy = run.places["rail"].points[:, 0], 1e-3 * 0.3 * 0.05
    peak = 6.75e-7 * energy * ellipse.p0 * np.pi / 2 * ellipse.a
    known = peak * np.maximum(1 - (y / ellipse.b) ** 2, 0.0)
    inside = np.abs(y) < ellipse.b - 1.0  # splines round the kink at its end
    assert np.abs(depth - known)[inside].max() < 3e-3 * peak
    assert np.abs(depth - known).max() < 0.02 * peak and not wheels.any()
    assert run.places["rail"].step * depth.sum() == pytest.approx(6.75e-7 * energy * 80e3, rel=1e-3)


def test_chosen_steps_reach_the_change_that_is_asked_and_go_on_from_any_of_them():
    """The rate of a depth 1 - exp(-4 t) falls; backward Euler is of first order."""

    def advance(depth, share):
        after = (depth + 4 * share) / (1 + 4 * share)
        return after, float((1 - depth[0]) / (1 - after[0]) - 1)

    start = wear.Stage(0.0, np.zeros(1), 0.0, wear.FIRST)
    whole = list(wear.march_freely(advance, start, 0.3))
    again = list(wear.march_freely(advance, whole[1], 0.3))
    assert whole[-1].done == 1.0 and len(again) == len(whole) - 2
    assert np.array_equal(again[-1].depth, whole[-1].depth)
    assert max(stage.change for stage in whole) <= 0.6 and 8 < len(whole) < 30
    *_, same = wear.march(advance, start, [stage.done for stage in whole])
    assert same.depth == pytest.approx(whole[-1].depth)


def test_splines_keep_area_and_parabolas_and_their_matrix_is_symmetric():
    parabola = 1 + PLACES - PLACES**2
    assert np.abs(SPLINES.projected(parabola) - parabola).max() < 1e-8
    bump = np.where(np.abs(PLACES) < 3.3, 1.0, 0.0)
    assert SPLINES.projected(bump).sum() == pytest.approx(bump.sum(), rel=1e-9)
    knots = np.linspace(-8, 8, 60)  # of straight lines
    weights = np.maximum(1 - np.abs(PLACES[:, None] - knots) / (knots[1] - knots[0]), 0.0)
    matrix = SPLINES.between(weights)
    assert np.abs(matrix - matrix.T).max() < 1e-9 * matrix.max()
    assert matrix == pytest.approx(weights.T @ SPLINES.projected(weights))
    assert np.linalg.eigvalsh(matrix).min() > -1e-9 * matrix.max()


def test_averages_keep_a_parabola_but_for_its_curvature_and_the_area_of_a_spike():
    """Weights that fall to zero at a width w have the variance w^2/6."""
    s = np.arange(-10, 10, 0.1)
    middle = wear.averaged(100 - s**2, 0.1, 2.0)[np.abs(s) < 5]
    assert middle == pytest.approx((100 - s**2)[np.abs(s) < 5] - 4 / 6, abs=0.01)
    spike = np.where(np.arange(s.size) == 100, 80.0, 0.0)
    found = wear.averaged(spike, 0.1, 2.0)
    assert found.sum() == pytest.approx(80.0) and found.max() == pytest.approx(4.0, rel=0.02)


def test_steps_that_cannot_follow_the_rate_stop_the_march():
    """A rate that doubles in every step, however short."""
    start = wear.Stage(0.0, np.zeros(1), 0.0, wear.FIRST)
    stages = wear.march_freely(lambda depth, share: (depth + share, 2.0), start, 0.1)
    with pytest.raises(ValueError, match=r"changes by 200% in a step of 0\.\d%"):
        list(stages)


def test_laws_have_the_rates_of_their_sources():
    usfd, energy = wear.WearLaw(wear.USFD), wear.WearLaw.of_energy(6.75e-7)
    assert usfd.rate(0.0) == pytest.approx(6.75e-7, rel=1e-3) == usfd.rate(10.0)
    assert energy.rate(0.3) == energy.rate(300.0) == pytest.approx(6.75e-7)
    for density, mass in ((10.4, 55.0), (40.0, 55.0), (77.2, 55.0), (100.0, 55 + 61.9 * 22.8)):
        assert usfd.rate(density) * density == pytest.approx(wear.VOLUME * mass, rel=1e-9)


def test_damage_is_that_of_the_law_between_its_limits():
    found = [wear.damage(force) for force in (0.0, 15.0, 40.0, 65.0, 120.0, 175.0, 500.0)]
    assert found == pytest.approx([0.0, 0.0, 5e-6, 1e-5, 5e-6, 0.0, 0.0])
