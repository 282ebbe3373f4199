"""Domains of boundary elements: several windows of a developed surface, against one grid."""

import math

import numpy as np
import pytest
from pressing import displacement, flat, solve

from railhead.theory.bem.pressure_solver import (
    BoundaryElementSolution,
    solve_developed,
)
from railhead.theory.elastic.hertz import point_contact
from tests.rooms.theory.bem.test_pressure_solver import LOAD, MODULUS, RADIUS, paraboloid


def bumps(distance: float, lift: float = 0.0):
    """Radii RADIUS and 50 mm, the sharper one a lift (mm) further away."""
    one, other = paraboloid(1.0, s0=-distance / 2), paraboloid(RADIUS / 50, s0=distance / 2)
    return lambda x, s: np.minimum(one(x, s), other(x, s) + lift)


def at_angles(steep: float, distance: float):
    """A surface that is bent at s = 0, between the bumps."""
    return lambda s: np.where(s < 0, -steep, steep)


def both(gap, distance: float, angle=flat) -> BoundaryElementSolution:
    windows = [((0.0, side * distance / 2), (6.0, 3.0)) for side in (-1, 1)]
    return solve_developed(gap, MODULUS, windows, angle, load=2 * LOAD, tolerance=1e-6)


@pytest.mark.parametrize(
    ("distance", "lift"),
    [(7, 0), *(pytest.param(*far, marks=pytest.mark.slow) for far in ((40, 0), (10, 0.01)))],
)
def test_windows_are_one_problem_in_a_plane(distance: float, lift: float) -> None:
    """Far apart and near, against one fine grid over both patches."""
    gap = bumps(distance, lift)
    found = both(gap, distance)
    one = solve(
        gap, MODULUS, load=2 * LOAD, half_size=(20, distance), cells=384, tolerance=1e-5
    )  # fmt: skip
    assert found.approach == pytest.approx(one.approach, rel=2e-4)
    assert found.max_pressure == pytest.approx(one.max_pressure, rel=2e-3)
    assert found.area == pytest.approx(one.area, rel=5e-3)
    expected = sorted((patch.load for patch in one.separate()), reverse=True)
    assert [patch.load for patch in found.patches] == pytest.approx(expected, rel=1e-3)


def test_a_tilted_plane_carries_the_normal_load() -> None:
    """A vertical load F on a slope is the normal force F/cos, the vertical approach d/cos."""
    tilt, exact = 0.7, point_contact(1 / RADIUS, 1.4 / RADIUS, MODULUS, LOAD / math.cos(0.7))
    found = solve_developed(
        paraboloid(), MODULUS, [((0.0, 0.0), (10.0, 10.0))], lambda s: flat(s) + tilt, load=LOAD
    )
    assert (found.load, found.force) == pytest.approx((LOAD, exact.load), rel=1e-09)
    assert found.approach * math.cos(tilt) == pytest.approx(exact.approach, rel=5e-5)
    assert found.max_pressure == pytest.approx(exact.p0, rel=1e-4)
    assert found.area == pytest.approx(exact.area, rel=2e-3)
    assert found.patches[0].plane == pytest.approx(tilt)


def test_conditions_of_contact_hold_across_a_bend() -> None:
    gap, angle = bumps(14.0), at_angles(0.3, 14.0)
    windows = [((0.0, side * 7.0), (6.0, 3.0)) for side in (-1, 1)]
    found = solve_developed(gap, MODULUS, windows, angle, load=2 * LOAD, cells=28)
    assert len(found.windows) == 2
    for here in found.windows:
        x, s = np.meshgrid(here.x, here.s, indexing="ij")
        u = displacement(found.windows, here, MODULUS)
        opened = gap(x, s) + u - found.approach * np.cos(here.angle)
        touching = here.pressure > 0
        assert np.abs(opened[touching]).max() < 3e-4 * u.max()
        assert opened[~touching].min() > -3e-4 * u.max()
    assert found.load == pytest.approx(2 * LOAD, rel=1e-9)


def test_windows_that_overlap_count_a_point_once() -> None:
    windows = [((0.0, -1.0), (6.0, 6.0)), ((0.5, 1.0), (6.0, 6.0))]
    found = solve_developed(paraboloid(), MODULUS, windows, flat, load=LOAD)
    exact = point_contact(1 / RADIUS, 1.4 / RADIUS, MODULUS, LOAD)
    assert len(found.windows) == len(found.patches) == 1
    assert found.area == pytest.approx(exact.area, rel=2e-3)


def test_a_window_that_nothing_touches_is_left_out() -> None:
    found = both(bumps(14.0, lift=1.0), 14.0)
    (patch,) = found.patches
    assert patch.load == pytest.approx(2 * LOAD, rel=1e-9)
    assert patch.centroid == pytest.approx((0, -7), abs=1e-3) and len(found.windows) == 1
