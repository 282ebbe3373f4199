"""The block below a moving load, its streams of points, and its section at the outflow."""

import numpy as np
import pytest

from railhead.solver.material import Hardening, Material
from railhead.solver.plasticity.block import Block, graded, mirrored
from railhead.solver.plasticity.rolling_block import RollingBlock, Streams

STEEL = Material(207e3, 0.3, Hardening.linear(480.0))


def test_a_graded_axis_ends_where_asked():
    axis = graded(1.0, 0.24, 9.0, 1.5)
    assert (axis[0], axis[5], axis[-1]) == pytest.approx((0.0, 1.0, 9.0))
    widths = np.diff(axis)
    assert widths[:5] == pytest.approx(0.2) and (widths[6:] / widths[5:-1]).max() < 1.5 + 1e-9
    assert (widths[5:] > 0.2).all() and mirrored(axis) == pytest.approx(-mirrored(axis)[::-1])


@pytest.fixture(scope="module")
def line() -> RollingBlock:
    """A small block in plane strain."""
    x, z = mirrored(graded(1.0, 0.5, 6.0, 1.5)), -graded(1.0, 0.25, 6.0, 1.5)[::-1]
    return RollingBlock(Block((x, z), STEEL, depth=2.0))


def test_the_section_answers_as_the_closed_form(line):
    """Plastic strain that depends on the depth alone: eps_zz = 2 mu e_zz/(lam + 2 mu) of the
    section's own, no stress on horizontal planes, and u_x = int 2 e_xz dz.
    """
    lam, mu = STEEL.lame
    z = line.streams.places[:, 1]
    fade = np.where(z > -0.9, 1e-3 * (z + 1.0), 0.0)  # ends within the fine cells
    z_zz, x_z = -0.6 * fade, 0.8 * fade
    change = np.column_stack([0.2 * fade, z_zz, 0.4 * fade, np.sqrt(2) * x_z])
    _, profile, stress = line.outgoing(change)
    assert np.abs(stress[:, [1, 3]]).max() < 0.02 * np.abs(stress[:, 0]).max()
    areas = np.asarray(line._areas)
    ends = line.block.axes[1]
    followed = (ends[1:] + ends[:-1]) / 2 > -2.0
    assert areas.sum() == pytest.approx(np.diff(ends)[followed].sum())
    assert (profile.along[0], profile.up[0]) == pytest.approx(
        (2 * (x_z * areas).sum(), 2 * mu / (lam + 2 * mu) * (z_zz * areas).sum()), rel=1e-06
    )


def test_points_outside_of_the_followed_depth_are_left_out(line):
    assert 1.5 < (-line.streams.places[:, 1]).max() < 3.0
    assert len(line.streams.x) == 3 * (len(line.block.axes[0]) - 1)


def test_a_uniform_plastic_strain_moves_the_outflow_as_the_section_says(line):
    """A state alike at all x below the load's way: the block answers as its section does."""
    z = line.streams.places[:, 1]
    fade = np.where(z > -0.9, 1e-3 * (z + 1.0), 0.0)
    change = np.column_stack([0.3 * fade, -0.5 * fade, 0.2 * fade, 0.0 * fade])
    pushed, profile, stress = line.outgoing(change)
    every = np.broadcast_to(change, (len(line.streams.x), *change.shape))
    moved = line.block.solve(line.block.plastic_force(line.streams.scattered(every)), pushed)
    strain = line.streams.gathered(line.block.strains(moved))
    assert line.stress(strain - change)[len(strain) // 2] == pytest.approx(
        stress, abs=1e-6 * np.abs(stress).max()
    )
    assert line.surface(moved)[:, 0, -1] == pytest.approx(profile.up[0])


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
