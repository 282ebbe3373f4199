"""Half-space boundary elements: exact contacts, convergence, complementarity, invariance, input."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from pressing import displacement, flat, solve
from scipy.special import elliprd

from railhead.theory.bem.pressure_solver import PatchSolution, solve_developed, under_load
from railhead.theory.elastic.hertz import Ellipse, point_contact

Array = NDArray[np.float64]
MODULUS, LOAD, RADIUS = 1.13e5, 25e3, 420.0
LIMITS = {
    "approach": 3e-5, "p0": 4e-5, "a": 1e-4, "b": 1e-4, "area": 2e-3, "along": 4e-3, "across": 4e-3,
}  # fmt: skip


def paraboloid(ratio: float = 1.4, x0: float = 0.0, s0: float = 0.0, turn: float = 0.0):
    """Gap with the curvatures 1/RADIUS and ratio/RADIUS about (x0, s0), turned by an angle."""

    def gap(x: Array, s: Array) -> Array:
        along = (x - x0) * math.cos(turn) + (s - s0) * math.sin(turn)
        across = (s - s0) * math.cos(turn) - (x - x0) * math.sin(turn)
        return (along**2 + ratio * across**2) / (2 * RADIUS)

    return gap


def lopsided(x: Array, s: Array) -> Array:
    """A gap without any symmetry, whose patch is no ellipse."""
    height: Array = x**2 / 700 + s**2 / 500 + np.abs(x + 2 * s) ** 3 / 3e4 + s**3 / 2e4 + x**4 / 1e5
    return height


def relative_errors(patch: PatchSolution, exact: Ellipse) -> dict[str, float]:
    computed = (patch.approach, patch.max_pressure, *patch.semi_axes, patch.area)
    expected = (exact.approach, exact.p0, exact.a, exact.b, exact.area, exact.a, exact.b)
    ratio = np.divide((*computed, *patch.half_extents), expected)
    return dict(zip(LIMITS, np.abs(ratio - 1), strict=True))


@pytest.mark.parametrize("axis_ratio", [1.0, 1.5, 2.0, 3.0, 4.0, 5.0])
def test_a_paraboloid_presses_as_exact_hertz(axis_ratio: float) -> None:
    k2 = axis_ratio**-2  # Johnson, Contact Mechanics, 4.28
    ratio = elliprd(0, 1, k2) / elliprd(0, k2, 1)
    exact = point_contact(1 / RADIUS, ratio / RADIUS, MODULUS, LOAD)
    patch = solve(paraboloid(ratio, 0.3, -0.2), MODULUS, load=LOAD)
    errors = relative_errors(patch, exact)
    assert all(error < LIMITS[name] for name, error in errors.items()), errors
    assert patch.force / patch.area == pytest.approx(exact.p_mean, rel=2e-3)
    assert patch.centroid == pytest.approx((0.3, -0.2), abs=1e-4 * exact.b)
    error = patch.pressure - exact.pressure(patch.x[:, None] - 0.3, patch.s + 0.2)
    assert np.sqrt(np.sum(error**2) / np.sum(patch.pressure**2)) < 1e-2


def test_a_blunt_cone_presses_as_johnson_says() -> None:
    """Blunt cone of slope t: a = sqrt(2F/(pi E* t)), approach pi a t/2 (Johnson, 5.2)."""
    slope = 0.01
    a = math.sqrt(2 * LOAD / (math.pi * MODULUS * slope))
    patch = solve(lambda x, s: slope * np.hypot(x, s), MODULUS, load=LOAD)
    assert patch.approach == pytest.approx(math.pi * a * slope / 2, rel=5e-4)
    assert patch.area == pytest.approx(math.pi * a * a, rel=5e-3)
    r = np.hypot(patch.x[:, None], patch.s)
    away = (r > 0.1 * a) & (r < 0.9 * a)
    exact = MODULUS * slope / 2 * np.arccosh(a / r[away])
    np.testing.assert_allclose(patch.pressure[away], exact, rtol=2e-2)


def test_a_flat_circular_punch_presses_as_johnson_says() -> None:
    """Approach F/(2 E* R), with a gap that is infinite outside R (Johnson, 3.36)."""
    patch = solve(
        lambda x, s: np.where(np.hypot(x, s) < 3, 0, np.inf), MODULUS, load=LOAD, cells=256
    )
    assert (patch.approach, patch.area) == pytest.approx(
        (LOAD / (6 * MODULUS), 9 * math.pi), rel=0.005
    )
    assert patch.pressure[128, 128] == pytest.approx(LOAD / (18 * math.pi), rel=5e-3)
    outside = np.hypot(patch.x[:, None], patch.s) >= 3
    assert np.all(patch.pressure[outside] == 0) and np.all(np.isinf(patch.gap[outside]))


def test_another_load_on_the_same_grids_is_that_load() -> None:
    """Without a gap; two windows press each other, and the coarser solution is pressed, too."""

    def gap(x: Array, s: Array) -> Array:
        return np.minimum(paraboloid()(x, s + 12), paraboloid()(x, s - 12))

    def press(load: float):
        windows = [((0.0, -12.0), (5.0, 5.0)), ((0.0, 12.0), (5.0, 5.0))]
        return solve_developed(gap, 1e5, windows, flat, load=load, tolerance=1e-9)

    first, direct = press(1e4), press(1.1e4)
    again = under_load(first, 1.1e4, 1e-9)
    for one, other in ((again, direct), (again.coarse, direct.coarse)):
        assert len(one.windows) == len(other.windows) == 2
        assert one.load == pytest.approx(1.1e4, rel=1e-12)
        assert one.approach == pytest.approx(other.approach, rel=1e-4)
        assert one.max_pressure == pytest.approx(other.max_pressure, rel=3e-4)
    assert again.windows[0].x is first.windows[0].x
    back = under_load(again, 1e4, 1e-9)
    assert np.allclose(
        back.windows[1].pressure, first.windows[1].pressure, atol=1e-6 * first.max_pressure
    )


def test_a_known_search_is_not_repeated() -> None:
    places = []

    def gap(x: Array, s: Array) -> Array:
        places.append(len(x))
        return paraboloid()(x, s)

    keys = {"load": 1e4, "tolerance": 1e-9}
    whole = solve_developed(gap, 1e5, [((1.0, 0.0), (20.0, 20.0))], flat, **keys)
    searched = solve_developed(gap, 1e5, [((1.0, 0.0), (20.0, 20.0))], flat, cells=64, **keys)
    places.clear()
    known = solve_developed(gap, 1e5, [((0.0, 0.0), (1.0, 1.0))], flat, known=searched, **keys)
    assert places == [128**2]
    assert np.allclose(known.windows[0].pressure, whole.windows[0].pressure, rtol=1e-9)


@pytest.mark.parametrize("gap", [paraboloid(5.0, 0.1, 0.7, 0.3), lopsided])
def test_a_gap_that_is_mirrored_shifted_or_exchanged_takes_its_pressure_along(gap) -> None:
    patch = solve(gap, MODULUS, load=LOAD)
    mirrored = solve(lambda x, s: gap(x, -s), MODULUS, load=LOAD)
    shifted = solve(lambda x, s: gap(x - 64, s + 32), MODULUS, load=LOAD, centre=(64, -32))
    exchanged = solve(lambda x, s: gap(s, x), MODULUS, load=LOAD)
    tiny = 1e-6 * patch.max_pressure
    np.testing.assert_allclose(mirrored.pressure[:, ::-1], patch.pressure, atol=tiny)
    np.testing.assert_allclose(mirrored.s[::-1], -patch.s, atol=1e-9)
    np.testing.assert_allclose(shifted.pressure, patch.pressure, atol=tiny)
    np.testing.assert_allclose(shifted.x - 64, patch.x, atol=1e-9)
    np.testing.assert_allclose(shifted.s + 32, patch.s, atol=1e-9)
    np.testing.assert_allclose(exchanged.pressure.T, patch.pressure, atol=tiny)
    assert exchanged.semi_axes == pytest.approx(patch.semi_axes[::-1], rel=1e-6)


@pytest.mark.parametrize(
    ("gap", "control"), [(paraboloid(2.0, turn=0.4), "approach"), (lopsided, "load")]
)
def test_signorini_conditions_and_equilibrium(gap, control: str) -> None:
    goal = {control: LOAD if control == "load" else 0.04}
    patch = solve(gap, MODULUS, cells=32, **goal)
    x, s = np.meshgrid(patch.x, patch.s, indexing="ij")
    u = displacement([patch], patch, MODULUS)
    opened = gap(x, s) + u - patch.approach
    scale = 1e-7 * patch.approach
    np.testing.assert_allclose(patch.gap, opened, atol=scale)
    assert patch.pressure.min() == 0 and opened.min() > -scale
    assert np.max(patch.pressure * np.abs(opened)) < scale * patch.max_pressure
    assert patch.pressure.sum() * patch.cell == pytest.approx(patch.load, rel=1e-10)
    if control == "load":
        assert patch.load == pytest.approx(LOAD, rel=1e-10)


@pytest.mark.parametrize(
    ("control", "centre", "half_size"),
    [
        pytest.param("load", (0, 0), (1e-4, 1e-4), marks=pytest.mark.slow),
        ("load", (60, -25), (1, 3)),
        ("approach", (0.1, 0), (0.1, 0.1)),
        ("load", (0.1, 0), (1e5, 0.1)),
    ],
)
def test_domain_is_found_from_a_poor_guess(
    control: str, centre: tuple[float, float], half_size: tuple[float, float]
) -> None:
    exact = point_contact(1 / RADIUS, 1.4 / RADIUS, MODULUS, LOAD)
    goal = {control: LOAD if control == "load" else exact.approach}
    patch = solve(paraboloid(), MODULUS, centre=centre, half_size=half_size, **goal)
    assert patch.load == pytest.approx(LOAD, rel=1e-4)
    assert patch.approach == pytest.approx(exact.approach, rel=5e-5)
    assert patch.semi_axes == pytest.approx((exact.a, exact.b), rel=2e-4)
    for axis in (0, 1):
        assert 0.6 <= np.any(patch.pressure > 0, axis=axis).mean() <= 0.9


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"load": LOAD, "tolerance": 1e-19}, "no equilibrium to 1e-19"),
        ({"approach": -0.1}, "must fall below the approach"),
        ({"approach": 0.0}, "must fall below the approach"),
        ({"approach": 1e-3, "centre": (60.0, 0.0)}, "must fall below the approach"),
        ({"load": LOAD, "gap": lambda x, s: s**2 / 600}, "grow around the patch"),
        pytest.param(
            {"load": LOAD, "gap": lambda x, s: 0 * x},
            "grow around the patch",
            marks=pytest.mark.slow,
        ),
        ({"load": LOAD, "gap": lambda x, s: (s**2 - x**2) / 600}, "the gap has no minimum"),
        ({"load": LOAD, "gap": lambda x, s: x + math.inf}, "gap must be .* below .* somewhere"),
        ({"load": LOAD, "gap": lambda x, s: x * math.nan}, "gap must be"),
        ({"load": LOAD, "gap": lambda x, s: x - math.inf}, "gap must be above"),
    ],
)
def test_loads_grids_and_gaps_without_an_answer_are_refused(change, message: str) -> None:
    arguments = {
        "gap": paraboloid(),
        "contact_modulus": MODULUS,
        "cells": 16,
    } | change
    with pytest.raises(ValueError, match=message):
        solve(**arguments)


def test_the_gap_is_open_close_beside_a_narrow_patch() -> None:
    exact = point_contact(1e-4, 1.0, MODULUS, 50.0)  # 240 times as long as wide
    shape = [((0.0, 0.0), (exact.a, exact.b))]
    gap = lambda x, s: 1e-4 * x**2 / 2 + s**2 / 2  # noqa: E731
    found = solve_developed(gap, MODULUS, shape, np.zeros_like, load=50.0, cells=48, tolerance=1e-5)
    s = np.ptp(found.windows[0].s) / 2 * np.array([1.05, 1.2, 2.0])
    assert (gap(0.0, s) + found.displacement(0 * s, s, 0 * s) > found.approach).all()
