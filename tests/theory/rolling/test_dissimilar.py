"""Rolling of unlike half-spaces: pressure and tractions that change each other."""

import numpy as np
import pytest
from numpy.typing import NDArray

from railhead.theory.bem import boundary_element
from railhead.theory.rolling.dissimilar import solve_dissimilar
from railhead.theory.rolling.prescribed_forces import solve_for_forces
from railhead.theory.rolling.rolling import Creepage, HalfSpaceFriction, TangentialSolution
from railhead.theory.rolling.tangential import Pair, TractionInfluence, pair

Array = NDArray[np.float64]
SOFT, HARD = (3000.0, 0.3), (207000.0, 0.3)


def ball(x: Array, s: Array) -> Array:
    return np.asarray((x**2 + s**2) / 840)


def rolling(
    wheel: tuple[float, float], rail: tuple[float, float], creepage: Creepage
) -> TangentialSolution:
    materials = pair(*wheel, *rail)
    return solve_dissimilar(
        pressed(materials), materials, 0.3, lambda body: body.solve(creepage), rolling=True
    )


def pressed(materials: Pair) -> boundary_element.PatchSolution:
    modulus = materials.shear_modulus / (1 - materials.poisson)
    return boundary_element.solve(ball, modulus, load=500.0, cells=32)


def test_like_bodies_take_one_turn() -> None:
    materials, creepage = pair(*HARD, *HARD), Creepage(1e-4, 1e-4)
    patch = boundary_element.solve(ball, 207000 / 1.82, load=500.0, cells=32)
    body = HalfSpaceFriction(patch.x, patch.s, patch.pressure, 0.3, materials, rolling=True)
    found = rolling(HARD, HARD, creepage)
    np.testing.assert_allclose(found.traction, body.solve(creepage).traction, rtol=1e-6, atol=1e-9)


def test_exchanged_bodies_turn_the_tractions_round() -> None:
    """A hard wheel is held back on a soft rail; the pressure is the same."""
    hard, soft = rolling(HARD, SOFT, Creepage()), rolling(SOFT, HARD, Creepage())
    np.testing.assert_allclose(hard.traction, -soft.traction, atol=1e-6 * hard.bound.max())
    np.testing.assert_allclose(hard.bound, soft.bound, atol=1e-6 * hard.bound.max())
    assert hard.forces[0] < -0.1 * hard.limit


def test_the_gap_closes_under_pressure_and_tractions_together() -> None:
    """Where they touch, gap and displacements by both add up to one approach, to 0.5 % of it;
    without the part of the tractions they do not."""
    materials = pair(*HARD, *SOFT)
    found = rolling(HARD, SOFT, Creepage())
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


def test_a_shift_begins_from_what_pressing_left() -> None:
    """Without a force nothing has a traction; exchanged bodies shift alike."""
    shifts = []
    for materials in (pair(*HARD, *SOFT), pair(*SOFT, *HARD)):
        patch = pressed(materials)
        for force in (0.0, 75.0):
            found = solve_dissimilar(
                patch, materials, 0.3,
                lambda body, force=force: solve_for_forces([body], Creepage(), along=force)[0],
                rolling=False,
            )  # fmt: skip
            assert found.forces[0] == pytest.approx(force, abs=1e-3)
            if not force:
                assert np.abs(found.traction).max() < 1e-6 * found.bound.max()
        shifts.append(found.creepage.along)
    assert shifts[0] == pytest.approx(shifts[1], rel=1e-6)
    assert shifts[0] > 0


def test_patches_meet_forces_together() -> None:
    """At one creepage, whose forces add up to it."""
    materials = pair(*HARD, *HARD)
    patch = boundary_element.solve(ball, 207000 / 1.82, load=500.0, cells=32)
    bodies = [
        HalfSpaceFriction(patch.x, patch.s, share * patch.pressure, 0.3, materials, rolling=True)
        for share in (1.0, 0.5)
    ]
    found = solve_for_forces(bodies, Creepage(), along=100.0)
    assert found[0].creepage == found[1].creepage
    assert sum(each.forces[0] for each in found) == pytest.approx(100.0, abs=1e-3)
    assert found[0].forces[0] > found[1].forces[0] > 0
    for body, each in zip(bodies, found, strict=True):
        assert body.solve(found[0].creepage).forces[0] == pytest.approx(each.forces[0], abs=1e-3)
    with pytest.raises(ValueError, match="below mu N"):
        solve_for_forces(bodies, Creepage(), along=300.0)
