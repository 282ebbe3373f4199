"""Gauss points in columns and lines, and the plastic state that flows along them."""

import numpy as np
import pytest
from one_line import refusal

from railhead.solver.plasticity.rolling_block import Streams

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
