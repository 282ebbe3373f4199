"""Numbers that are read from the pressures of a grid's cells, and stresses below them."""

import numpy as np
import pressing
import pytest

from railhead.theory.bem import grid_stress
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.elastic import subsurface
from railhead.theory.elastic.hertz import Ellipse, point_contact
from railhead.theory.friction import sliding

MODULUS, LOAD = 1.1e5, 4e4


def pair(ratio: float) -> tuple[Ellipse, PatchSolution]:
    """Exact Hertz, and his contact by boundary elements on 64 cells an axis."""
    exact = point_contact(ratio * 1e-3, 1e-3, MODULUS, LOAD)
    found = pressing.solve(
        lambda x, s: (ratio * x**2 + s**2) * 1e-3 / 2,
        MODULUS,
        load=LOAD,
        half_size=(2 * exact.a, 2 * exact.b),
        cells=64,
        tolerance=1e-5,
    )
    return exact, found


@pytest.mark.parametrize("ratio", [1.0, 0.1, 5.0])
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_stress_below_a_hertzian_patch_is_that_of_the_closed_form(
    ratio: float, poisson: float
) -> None:
    exact, found = pair(ratio)
    box = np.random.default_rng(3).uniform((-2, -2, -2), (2, 2, -0.2), (30, 3))
    points = box * (exact.a, exact.b, min(exact.a, exact.b))
    error = grid_stress.stress(found, poisson, points) - subsurface.stress(exact, poisson, points)
    assert np.abs(error).max() < 0.01 * exact.p0


@pytest.mark.parametrize("ratio", [1.0, 0.02, 5.0])
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_the_largest_von_mises_stress_is_that_of_the_closed_form(
    ratio: float, poisson: float
) -> None:
    """Slender patches of a small Poisson's ratio have it at the surface."""
    exact, found = pair(ratio)
    expected = exact.axis_extrema(poisson).von_mises_max
    assert grid_stress.largest_von_mises(found, poisson) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("coefficient", [0.05, 0.2, 0.4])
def test_largest_stresses_below_a_strip_are_those_in_its_middle(coefficient: float) -> None:
    """Strips of a line contact are two cells long, which end far away with peaks of their own. The
    leading half sticks, so that the largest stress is beside the middle.
    """
    x, s = (2 * np.arange(64) + 1) / 64 - 1.0, np.array([-2500.0, 2500.0])
    pressure = np.repeat(400 * np.sqrt(1 - x**2)[:, None], 2, axis=1)
    strip = PatchSolution(x, s, 0 * s, pressure, 0 * pressure, 0.0)
    q = coefficient * pressure * np.minimum(1.0, 1 - x)[:, None]
    traction = np.stack([q, 0 * q])
    depths = np.append(grid_stress.SURFACE / 32, np.linspace(0.1, 1.2, 56))
    across, down = np.meshgrid(x, -depths)
    places = np.column_stack([across.ravel(), 0 * across.ravel(), down.ravel()])
    known = grid_stress.stress(strip, 0.3, places, traction)
    found = grid_stress.peaks(strip, 0.3, traction)
    for (_, value), invariant in zip(
        found, (subsurface.max_shear, subsurface.von_mises), strict=True
    ):
        assert value == pytest.approx(invariant(known).max(), rel=1e-3)


@pytest.mark.parametrize("across", [False, True])
def test_stress_below_tractions_is_that_of_a_sliding_ellipse(across: bool) -> None:
    """`theory.friction.sliding` sums plane waves."""
    slides = point_contact(1 / 300, 1 / 500, 115e3, 50e3)  # along its own x
    a, b = (slides.b, slides.a) if across else (slides.a, slides.b)
    ticks = 1.02 * ((2 * np.arange(64) + 1) / 64 - 1)
    x, s = a * ticks, b * ticks
    pressure = slides.p0 * np.sqrt(np.maximum(1 - (x[:, None] / a) ** 2 - (s / b) ** 2, 0))
    patch = PatchSolution(x, s, 0 * s, pressure, 0 * pressure, 0.0)
    traction = 0.4 * np.array([0 * pressure, pressure] if across else [pressure, 0 * pressure])
    points = np.array([[0.3 * a, 0.2 * b, -0.3 * a], [0, 0, -0.5 * b], [-0.5 * a, -0.4 * b, -1.0]])
    found = grid_stress.stress(patch, 0.3, points, traction)
    turn, columns = ([1, 0, 2], [1, 0, 2, 3, 5, 4]) if across else ([0, 1, 2], [0, 1, 2, 3, 4, 5])
    exact = sliding.stress(slides, 0.4, 0.3, points[:, turn])[:, columns]
    assert found == pytest.approx(exact, abs=1e-3 * slides.p0)


def patch(pressure: np.ndarray) -> PatchSolution:
    """With cells 0.5 mm along and 0.25 mm across."""
    nx, ns = pressure.shape
    return PatchSolution(
        x=0.5 * np.arange(nx),
        s=0.25 * np.arange(ns),
        angle=np.zeros(ns),
        pressure=pressure,
        gap=np.zeros_like(pressure),
        approach=0.01,
    )


@pytest.mark.parametrize("place", [(0, 0), (2, 1), (3, 4)])
def test_the_largest_pressure_of_one_cell_is_its_own(place: tuple[int, int]) -> None:
    """No parabola runs through cells without pressure, at the edge of the grid or inside."""
    pressure = np.zeros((4, 5))
    pressure[place] = 700.0
    assert patch(pressure).max_pressure == pytest.approx(700.0, rel=1e-14)


def test_the_largest_pressure_between_cells_is_that_of_hertz_s_ellipsoid() -> None:
    x, s = np.meshgrid(0.5 * np.arange(9) - 2.1, 0.25 * np.arange(13) - 1.42, indexing="ij")
    pressure = 800.0 * np.sqrt(np.maximum(1 - (x / 2.0) ** 2 - (s / 1.3) ** 2, 0.0))
    assert patch(pressure).max_pressure == pytest.approx(800.0, rel=1e-12)


def test_chords_along_and_across_differ_where_a_patch_is_a_few_cells_thin() -> None:
    """Crescents (x/9)^2 + (d/b)^2 < 1 around the arc s = x^2/20, of which d is the distance."""
    x, s = np.meshgrid(0.5 * np.arange(41) - 10.1, 0.25 * np.arange(81) - 6.05, indexing="ij")
    square = {b: 1 - (x / 9.0) ** 2 - ((s - x**2 / 20) / b) ** 2 for b in (4.0, 0.6)}
    wide, thin = (patch(np.sqrt(np.maximum(each, 0.0))) for each in square.values())
    assert wide.area == pytest.approx(np.pi * 9 * 4, rel=0.01)
    assert wide.area_spread < 0.004 * wide.area and thin.area_spread > 0.01 * thin.area
