"""Rolling of unlike half-spaces: pressure and tractions that change each other."""

import numpy as np
import pytest
from numpy.typing import NDArray

from railhead.theory import boundary_element
from railhead.theory.rolling import Creepage, HalfSpaceFriction, Sheared
from railhead.theory.tangential import Pair, TractionInfluence, pair
from railhead.theory.unlike import rubbed

Array = NDArray[np.float64]
SOFT, HARD = (3000.0, 0.3), (207000.0, 0.3)


def ball(x: Array, s: Array) -> Array:
    return np.asarray((x**2 + s**2) / 840)


def under(wheel: tuple[float, float], rail: tuple[float, float], creepage: Creepage) -> Sheared:
    materials = pair(*wheel, *rail)
    return rubbed(pressed(materials), materials, 0.3, lambda body: body.at(creepage), rolling=True)


def pressed(materials: Pair) -> boundary_element.PatchSolution:
    modulus = materials.shear_modulus / (1 - materials.poisson)
    return boundary_element.solve(ball, modulus, load=500.0, cells=32)


def test_like_bodies_take_one_turn() -> None:
    materials, creepage = pair(*HARD, *HARD), Creepage(1e-4, 1e-4)
    patch = boundary_element.solve(ball, 207000 / 1.82, load=500.0, cells=32)
    body = HalfSpaceFriction(patch.x, patch.s, patch.pressure, 0.3, materials, rolling=True)
    found = under(HARD, HARD, creepage)
    np.testing.assert_allclose(found.traction, body.at(creepage).traction, rtol=1e-6, atol=1e-9)


def test_exchanged_bodies_turn_the_tractions_round() -> None:
    """A hard wheel is held back on a soft rail; the pressure is the same."""
    hard, soft = under(HARD, SOFT, Creepage()), under(SOFT, HARD, Creepage())
    np.testing.assert_allclose(hard.traction, -soft.traction, atol=1e-6 * hard.bound.max())
    np.testing.assert_allclose(hard.bound, soft.bound, atol=1e-6 * hard.bound.max())
    assert hard.forces[0] < -0.1 * hard.limit


def test_the_gap_closes_under_pressure_and_tractions_together() -> None:
    """Where they touch, gap and displacements by both add up to one approach, to 0.5 % of it;
    without the part of the tractions they do not."""
    materials = pair(*HARD, *SOFT)
    found = under(HARD, SOFT, Creepage())
    influence = TractionInfluence(found.x, found.y, materials, rolling=False)
    opened = influence.opening(found.traction)
    x, y = np.meshgrid(found.x, found.y, indexing="ij")
    patch = boundary_element.PatchSolution(
        found.x, found.y, 0 * found.y, found.bound / 0.3, 0 * x, 0.0
    )
    modulus = materials.shear_modulus / (1 - materials.poisson)
    pressed = boundary_element.Influence([patch], modulus)(patch.pressure.ravel()).reshape(x.shape)
    touching = found.bound > 0
    rigid = (ball(x, y) + pressed)[touching]
    assert np.ptp(rigid + opened[touching]) < 5e-3 * rigid.mean()
    assert np.ptp(rigid) > 1e-2 * rigid.mean()
    assert patch.force == pytest.approx(500.0, rel=1e-6)
