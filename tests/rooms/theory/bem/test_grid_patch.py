"""Numbers of a patch that are read from the pressures of a grid's cells."""

import numpy as np
import pytest

from railhead.theory.bem.grid_patch import PatchSolution


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
