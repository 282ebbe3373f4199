"""Smoothing of what the contact points say."""

import numpy as np
import pytest

from postprocess.surface import smooth_outline, smooth_square


def test_quadratic_fits_find_a_ridge_that_linear_ones_flatten() -> None:
    """p^2 is a ridge half as wide as what is averaged over, with five per cent of noise."""
    rng = np.random.default_rng(0)
    sites = rng.uniform(-1, 1, (20000, 2))
    pressure = np.sqrt(1 + np.exp(-((sites[:, 1] / 0.2) ** 2)))
    noisy = pressure * (1 + 0.05 * rng.standard_normal(len(sites)))
    targets = np.column_stack([np.linspace(-0.5, 0.5, 21), np.zeros(21)])
    linear = smooth_square(sites, noisy, targets, 400, degree=1)
    quadratic = smooth_square(sites, noisy, targets, 400, degree=2)
    assert quadratic == pytest.approx(np.sqrt(2), rel=0.015)
    assert np.abs(quadratic / np.sqrt(2) - 1).mean() < np.abs(linear / np.sqrt(2) - 1).mean()


@pytest.mark.parametrize("closed", [True, False])
def test_jagged_outline_gets_its_size_back(closed: bool) -> None:
    """An ellipse 5 x 3 whose points jump by a fifth of an element (0.5) in and out."""
    size = 0.5
    t = np.linspace(0, 2 * np.pi if closed else np.pi, 121)
    radius = 1 + 0.2 * size / 4 * (-1.0) ** np.arange(len(t))
    radius[-1] = radius[0]
    line = np.column_stack([5 * np.cos(t), 3 * np.sin(t)]) * radius[:, None]
    smooth = smooth_outline(line, size)
    extent = np.ptp(smooth, axis=0) / ([2, 2] if closed else [2, 1])
    assert np.ptp(line, axis=0)[0] / 2 > 5.1
    assert extent == pytest.approx([5, 3], rel=0.012)
    assert bool(np.allclose(smooth[0], smooth[-1])) is closed


def test_outline_of_a_few_elements_keeps_its_size() -> None:
    t = np.linspace(0, 2 * np.pi, 9)
    line = np.column_stack([np.cos(t), np.sin(t)])
    line[-1] = line[0]
    smooth = smooth_outline(line, 1.0)
    assert np.ptp(smooth, axis=0) / 2 == pytest.approx([1, 1], rel=0.05)
