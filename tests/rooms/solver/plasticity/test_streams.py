"""Gauss points in columns and lines, and the plastic state that flows along them."""

import numpy as np
import pytest
from one_line import refusal

from railhead.solver.material import Hardening, History, radial_return
from railhead.solver.plasticity.rolling_block import Streams, follow

MU = 80e3


def test_points_are_sorted_from_the_largest_x_down():
    places = np.array([[0.0, -1.0], [0.5, -1.0], [0.0, -2.0]])
    points = np.array([[x, *yz] for yz in places for x in (0.3, -2.0, 5.0)])
    mixed = np.random.default_rng(1).permutation(len(points))
    found = Streams.of(points[mixed])
    assert found.x == pytest.approx([5.0, 0.3, -2.0])
    gathered = found.gathered(points[mixed])
    assert (gathered[:, :, 0] == found.x[:, None]).all()
    assert (gathered[:, :, 1:] == found.places).all()
    assert found.scattered(gathered) == pytest.approx(points[mixed])


@pytest.mark.parametrize("shift", [1e-3, 0.7])
def test_points_that_do_not_line_up_are_refused(shift):
    points = np.array([[x, 0.0, z] for x in (0.0, 1.0) for z in (-1.0, -2.0)])
    points[3, 2] += shift
    assert "do not line up" in refusal(lambda: Streams.of(points), ValueError)
    assert "columns of different sizes" in refusal(lambda: Streams.of(points[:3]), ValueError)


@pytest.mark.parametrize("hardening", [Hardening.linear(480.0), Hardening.linear(480.0, 6e3, 1.0)])
def test_following_skips_elastic_columns_but_changes_nothing(hardening):
    rng = np.random.default_rng(2)
    wave = np.zeros(30)
    wave[[4, 5, 11, 12, 13, 25]] = 1.0  # columns that yield, with elastic ones between
    strain = wave[:, None, None] * rng.normal(0.0, 6e-3, (30, 7, 4))
    mu = np.full(7, MU)
    plastic, after = follow(strain, mu, History.virgin(7, 4), hardening)
    state, growing = History.virgin(7, 4), 0
    for column, each in enumerate(strain):
        step, _ = radial_return(each, mu, state, hardening)
        assert plastic[column] == pytest.approx(step.plastic, abs=1e-15)
        growing += bool((step.equivalent > state.equivalent).any())
        state = step
    assert after.equivalent == pytest.approx(state.equivalent)
    assert growing >= 6
