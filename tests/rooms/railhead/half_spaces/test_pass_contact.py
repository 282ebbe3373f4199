"""What rolls over the block of a rail: pressure, tractions, and the stress below them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from railhead.half_spaces import pass_contact
from railhead.run import passes_of_scene
from railhead.solver.material import Hardening, Material
from railhead.theory.elastic import hertz
from railhead.theory.friction import sliding

STEEL = Material(207e3, 0.3, Hardening.linear(1e6))  # nothing yields
ELLIPSE = hertz.point_contact(1 / 300, 1 / 250, 207e3 / (2 * (1 - 0.3**2)), 30e3)
HALF = ELLIPSE.a, ELLIPSE.b


def solid(ellipse, friction: float = 0.0) -> pass_contact.RollingContact:
    """An ellipse under its own pressure, with tractions friction * p along the rail."""
    found = pass_contact.ellipse_contact(ellipse, keeps=True)
    (patch,) = found.patches
    along = friction * patch.pressure
    rubs = replace(patch, traction=np.stack([along, np.zeros_like(along)]))
    return replace(found, patches=(rubs,))


def test_the_pressure_of_a_gap_is_hertz_s():
    (found,) = solid(ELLIPSE).patches
    x, s = np.meshgrid(found.grid.x, found.grid.s, indexing="ij")
    assert found.pressure == pytest.approx(ELLIPSE.pressure(x, s), abs=0.05 * ELLIPSE.p0)
    assert found.pressure.sum() * found.grid.cell == pytest.approx(ELLIPSE.load)


@pytest.mark.parametrize("half", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_the_stress_of_the_block_is_that_of_a_sliding_ellipse(half):
    block = passes_of_scene.rolling_block(STEEL, HALF, line=False, half=half, per_length=2, reach=6)
    contact = solid(ELLIPSE, 0.3)
    found = pass_contact.Below(block, contact).stress(contact.patches[0].pressure)
    places = block.points
    near = np.abs(places[..., 0]) < 1.2 * HALF[0]
    near &= (np.abs(places[..., 1]) < HALF[1]) & (places[..., 2] > -1.5 * HALF[1])
    near &= places[..., 2] < -0.25 * HALF[1]
    exact = sliding.stress(ELLIPSE, 0.3, 0.3, places[near])[:, [0, 1, 2, 5, 4, 3]]
    exact[:, 3:] *= math.sqrt(2)
    off = np.sqrt(((found[near] - exact) ** 2).mean(axis=0)) / ELLIPSE.p0
    assert off.max() < 0.025  # two elements on a half length; a wrong sign is above 0.1
    assert np.abs(exact[:, 4]).max() > 0.2 * ELLIPSE.p0


def test_carter_s_tractions_carry_their_force():
    share, friction = 0.6, 0.3
    found = pass_contact.line_contact(
        2.0, 500.0, 1e-3, 1e5, keeps=True, slips=-friction, sticks=math.sqrt(1 - share)
    ).patches[0]
    x, _ = found.grid.edges
    traction = found.traction[0, :, 0]
    force = (traction * np.diff(x)).sum()
    assert force == pytest.approx(-share * friction * 500.0) and (traction <= 1e-9).all()
    assert (np.abs(traction) <= friction * found.pressure[:, 0] + 1e-9).all()
    slips = np.abs(traction) > 0.999 * friction * found.pressure[:, 0]
    assert found.grid.x[slips & (found.pressure[:, 0] > 0)].max() < 2.0 * (1 - 2 * 0.6)  # behind


def test_means_of_a_parabola_are_exact():
    ends = np.array([-2.0, -0.5, 0.1, 3.0])
    nodes = np.sort(np.concatenate([ends, (ends[1:] + ends[:-1]) / 2]))
    edges = np.array([-2.0, -1.9, 0.0, 0.05, 2.0, 3.0])
    found = pass_contact.cell_means(nodes, edges) @ (1 + 2 * nodes - 3 * nodes**2)
    assert found == pytest.approx(np.diff(edges + edges**2 - edges**3) / np.diff(edges))
