"""Relative differences between a result and a reference."""

import math

import numpy as np
import pytest

from railhead.postprocess.patch import compare
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.bem.pressure_solver import BoundaryElementSolution


def test_a_difference_is_relative_and_none_where_there_is_nothing_to_divide_by() -> None:
    result = {"a": 2.0, "b": 1.0, "c": "rail", "d": [3.0, None], "e": 5.0}
    exact = {"a": 1.0, "b": 0.0, "c": "rail", "d": [4.0, 1.0]}
    assert compare.difference(result, exact) == {
        "a": 1.0, "b": None, "c": None, "d": [pytest.approx(-0.25), None],
    }  # fmt: skip


@pytest.mark.parametrize("first, share", [(0.01, math.cos(0.01)), (0.5, 1.0), (-0.5, 1.0)])
def test_half_spaces_have_the_area_of_the_patch_that_lies_on_another_plane(
    first: float, share: float
) -> None:
    """A flat ellipse of half lengths 3 and 2 mm. From 0.02 rad on the plane of the first contact,
    on which area and width were cos 0.5 times their own, is not that of the patch."""
    t = np.linspace(-1.1, 1.1, 111)
    x, s = np.meshgrid(t, t, indexing="ij")
    pressure = np.sqrt(np.maximum(1 - x**2 - s**2, 0))
    patch = PatchSolution(3 * t, 2 * t, 0 * t, pressure, 0 * x, 0.0)
    found = compare.from_half_space(
        BoundaryElementSolution((patch,), 1e5), lambda x, s: np.column_stack([x, s, 0 * x]), first
    )
    assert found["patch"]["b_mm"] == pytest.approx(2 * share, rel=1e-6)
    assert found["patch"]["area_mm2"] == pytest.approx(math.pi * 6 * share, rel=1e-3)
    (one,) = found["patches"]
    assert found["patch"]["area_mm2"] == pytest.approx(one["area_mm2"] * share, rel=1e-9)
