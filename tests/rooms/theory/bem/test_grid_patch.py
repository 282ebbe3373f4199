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
