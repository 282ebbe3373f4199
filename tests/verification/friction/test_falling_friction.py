"""Friction that falls with slip or temperature, and an elastic layer, between half-spaces."""

import math
from dataclasses import replace

import numpy as np
import pytest

from railhead.theory.friction.heat import Heat
from railhead.theory.friction.kalker import coefficients
from railhead.theory.friction.laws import ByTemperature, Falling, Interface
from railhead.theory.friction.rolling import (
    Creepage,
    HalfSpaceFriction,
    TangentialSolution,
    grid_over,
    solve_for_forces,
)
from railhead.theory.friction.tangential import pair

A, B, LOAD = 5.88, 10.54, 1e5
STEEL = 209920.0  # G = 82 GPa with nu = 0.28


def ellipse(
    friction: float, interface: Interface | None, *, cells: int = 32, young: float = STEEL,
    rolling: bool = True,
) -> HalfSpaceFriction:  # fmt: skip
    """Ertz and Knothe's ellipse, a = 5.88, b = 10.54 mm, under 100 kN."""
    grid = grid_over((0.0, 0.0), (A, B), cells)
    u, v = grid.x / A, grid.s / B
    pressure = np.sqrt(np.maximum(1 - u[:, None] ** 2 - v**2, 0))
    pressure *= LOAD / (pressure.sum() * grid.cell)
    materials = pair(young, 0.28, young, 0.28)
    return HalfSpaceFriction(
        grid.x, grid.s, pressure, friction, materials, rolling=rolling, interface=interface
    )


def slips(law, *, young: float) -> tuple[float, float]:
    """Largest temperature and force (kN) at 30 m/s and a creepage of 1 m/s, extrapolated."""
    coarse, fine = (
        (found.rise.max(), 1e-3 * found.forces[0])
        for found in (
            ellipse(0.3, Interface(heat=Heat(speed=30.0), law=law), cells=n, young=young).solve(
                Creepage(1 / 30)
            )
            for n in (16, 32)
        )
    )
    return 2 * fine[0] - coarse[0], 2 * fine[1] - coarse[1]


@pytest.mark.parametrize(
    ("hot", "kelvin", "force"), [(0.3, 150.3, 30.0), (0.12, 126.9, 26.38), (0.48, 182.3, 34.66)]
)
def test_a_coefficient_of_the_temperature_where_all_slips_alike(hot, kelvin, force) -> None:
    """Integrals of the heat equation along each line, with a slip of 1 m/s everywhere: nearly rigid
    bodies. Steel's own slip is larger behind the middle, and its surface 1.5 % hotter."""
    law = ByTemperature(((0.0, 0.3), (400.0, hot)))
    rigid, carried = slips(law, young=1e4 * STEEL)
    assert rigid == pytest.approx(kelvin, rel=0.004)
    assert carried == pytest.approx(force, rel=0.001)
    steel, carried = slips(law, young=STEEL)
    assert steel == pytest.approx(1.015 * kelvin, rel=0.005)
    assert carried == pytest.approx(force, rel=0.005)


def test_contact_counts_the_heat_of_each_element_on_itself_twice() -> None:
    """So, on cells of 0.2 by 0.5 mm, its 166.8 K comes out (examples/ertz_temperature.ref_out)."""
    x, y = 0.2 * np.arange(60) - 5.9, 0.5 * np.arange(43) - 10.5
    pressure = np.sqrt(np.maximum(1 - (x[:, None] / A) ** 2 - (y / B) ** 2, 0))
    pressure *= LOAD / (pressure.sum() * 0.1)
    surfaces = Interface(heat=Heat(speed=30.0))
    found = HalfSpaceFriction(
        x, y, pressure, 0.3, pair(STEEL, 0.28, STEEL, 0.28), rolling=True, interface=surfaces
    ).solve(Creepage(0.03333))
    flux = 30.0 * (found.traction * found.slip).sum(axis=0)
    own = 1e6 * flux / math.sqrt(math.pi * 50 * 7850 * 450 * 30) * math.sqrt(1e-4)
    assert found.rise.max() == pytest.approx(152.6, rel=0.004)
    assert (found.rise + own).max() == pytest.approx(166.8, rel=0.001)


@pytest.mark.parametrize("creepage", [Creepage(0.001), Creepage(0.002, 0.001, 2e-4)])
def test_both_bodies_take_the_power_of_friction(creepage: Creepage) -> None:
    """Where a part sticks, too: on two grids, extrapolated."""
    shares = []
    for cells in (32, 64):
        found = ellipse(0.3, None, cells=cells).solve(creepage)
        heat = found.cell * (found.traction * found.slip).sum()
        shares.append(heat / found.t_gamma)
    assert 2 * shares[1] - shares[0] == pytest.approx(1, abs=0.003)


def exponential(**more) -> Interface:
    return Interface(heat=Heat(speed=10.0), law=Falling(0.14, 1250.0), **more)


@pytest.mark.parametrize(("creepage", "share"), [(0.05, 0.8606), (0.1, 0.7549), (0.25, 0.5682)])
def test_full_slip_has_the_coefficient_of_its_slip(creepage: float, share: float) -> None:
    coarse, fine = (
        ellipse(0.33, exponential(), cells=n).solve(Creepage(creepage)).forces[0] / (0.33 * LOAD)
        for n in (16, 32)
    )
    assert 2 * fine - coarse == pytest.approx(share, abs=0.003)


@pytest.mark.parametrize("law", [Falling(0.3, 100.0), ByTemperature(((0.0, 0.3), (9.0, 0.3)))])
def test_a_law_that_does_not_fall_has_coulombs_answer(law) -> None:
    creepage = Creepage(0.002, -0.001, 1e-4)
    plain = ellipse(0.3, None).solve(creepage)
    found = ellipse(0.3, Interface(heat=Heat(speed=20.0), law=law, memory=0.3)).solve(creepage)
    np.testing.assert_allclose(found.traction, plain.traction, atol=1e-8 * plain.bound.max())


CREEPAGES = [0.0005, 0.001, 0.002, 0.003, 0.004, 0.006, 0.01]


@pytest.mark.parametrize("memory", [None, 0.5, 2.0])
def test_a_falling_creep_curve_has_one_value_from_both_sides(memory) -> None:
    """A steep law: from 0.3 to 0.18, half at 100 mm/s, 45 m/s. Each point starts from the one
    before, upwards and downwards, and from the kinetic coefficient everywhere."""
    law = Falling(0.18, 100.0)
    body = ellipse(0.3, Interface(heat=Heat(speed=45.0), law=law, memory=memory), cells=16)

    def curve(values: list[float]) -> dict[float, float]:
        found: TangentialSolution | None = None
        out = {}
        for value in values:
            found = body.solve(Creepage(value), found)
            out[value] = found.forces[0] / (0.3 * LOAD)
        return out

    up, down = curve(CREEPAGES), curve(CREEPAGES[::-1])
    low = body.solve(Creepage(0.003))
    low = replace(low, bound=0.18 * low.pressure, traction=0.6 * low.traction)
    below = body.solve(Creepage(0.003), low).forces[0] / (0.3 * LOAD)
    for value in CREEPAGES:
        assert up[value] == pytest.approx(down[value], abs=3e-6)
    assert below == pytest.approx(up[0.003], abs=3e-6)
    top = max(up.values())
    assert top == up[0.003] and up[0.01] < 0.9 * top


def test_a_long_memory_keeps_the_static_coefficient() -> None:
    static = ellipse(0.33, None).solve(Creepage(0.05)).forces[0]
    memory = ellipse(0.33, exponential(memory=1e4)).solve(Creepage(0.05)).forces[0]
    assert memory == pytest.approx(static, rel=1e-3)


@pytest.mark.parametrize(
    ("law", "speed", "creepage", "why"),
    [
        (Falling(0.02, 1.0), 100.0, 0.002, "several steady states"),
        (Falling(0.1, 20.0), 80.0, 0.003, "do not settle"),
    ],
)
def test_a_law_too_steep_is_refused_and_not_answered(law, speed, creepage, why) -> None:
    steep = Interface(heat=Heat(speed=speed), law=law)
    with pytest.raises(ValueError, match=f"{why}.*longer friction.memory"):
        ellipse(0.6, steep, cells=16).solve(Creepage(creepage))


def test_a_given_force_is_met_on_the_rising_branch() -> None:
    body = ellipse(0.33, exponential())
    (found,) = solve_for_forces([body], Creepage(), along=0.9 * 0.33 * LOAD)
    assert found.forces[0] == pytest.approx(0.9 * 0.33 * LOAD, rel=2e-6)
    assert 0 < found.creepage.along < 0.003


def test_a_soft_layer_is_kalkers_simplified_theory() -> None:
    """Tractions xi s/L, s behind the leading edge, where all sticks: F = xi 8 a^2 b/(3 L)."""
    layer, creepage = 1.0, 1e-6
    coarse, fine = (
        ellipse(0.3, Interface(layer=layer), cells=n).solve(Creepage(creepage)) for n in (32, 64)
    )
    exact = creepage * 8 * A**2 * B / (3 * layer)
    force = 2 * fine.forces[0] - coarse.forces[0]
    assert force == pytest.approx(exact, rel=0.01)
    across = ellipse(0.3, Interface(layer=layer), cells=64).solve(Creepage(0, creepage))
    assert across.forces[1] == pytest.approx(fine.forces[0], rel=0.003)


def test_a_layer_flattens_the_slope_of_the_creep_curve() -> None:
    """Kalker's linear theory without a layer, both flexibilities about in series with one, and the
    same limit of the force."""
    linear = coefficients(A / B, 0.28).forces(A, B, 82000.0, Creepage(1e-6))[0]
    for layer in (0.0, 2e-5, 1e-3):
        body = ellipse(0.3, Interface(layer=layer), cells=64)
        slope = body.solve(Creepage(1e-6)).forces[0]
        brush = 1e-6 * 8 * A**2 * B / (3 * layer) if layer else math.inf
        assert slope == pytest.approx(1 / (1 / linear + 1 / brush), rel=0.06)
        slid = body.solve(Creepage(0.5)).forces[0]
        assert slid == pytest.approx(0.3 * LOAD, rel=0.01)


def test_a_layer_under_one_shift_adds_its_own() -> None:
    """A layer far softer than the bodies has the traction of the shift alone, everywhere."""
    found = ellipse(0.3, Interface(layer=1.0), rolling=False).solve(Creepage(1.0, 2.0))
    sticks = found.sticks
    np.testing.assert_allclose(found.traction[:, sticks].T, [[1.0, 2.0]] * sticks.sum(), rtol=1e-2)
