"""Findings of exact Hertz and of half-spaces, and differences from a reference."""

import math

import numpy as np
import pytest

from railhead.postprocess.findings import Frame
from railhead.postprocess.patch import compare, half_space
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.bem.pressure_solver import BoundaryElementSolution


def test_pressures_of_exact_hertz_lie_on_both_axes(thesis_ellipse) -> None:
    """They reach a twentieth beyond the patch."""
    a, b = thesis_ellipse.a, thesis_ellipse.b
    frame = Frame((0.0, 0.0, 0.0), 0.0)
    found = half_space.of_hertz(thesis_ellipse, frame, {"rail": 0.3}, section=False)
    assert found.patch.centre == (0, 0)
    for line, half, axis in ((found.along, a, 0), (found.across, b, 1)):
        t, none = line.coordinate, np.zeros_like(line.coordinate)
        assert (t[0], t[-1]) == pytest.approx((-1.05 * half, 1.05 * half))
        expected = thesis_ellipse.pressure(*((t, none) if axis == 0 else (none, t)))
        assert line.pressure == pytest.approx(expected)


@pytest.mark.parametrize("higher, error", [(0.0, 0.0), (0.5, 13 / 405)])
def test_the_shape_error_is_that_of_the_moments(higher: float, error: float) -> None:
    """Of an ellipsoid none. With a pressure (1 - r^2)^0.5 (1 + r^2/2) the fourth moment is 392/405
    of that of an ellipsoid with the same second one."""
    t = np.linspace(-1, 1, 401)
    x, s = np.meshgrid(3 * t, 2 * t, indexing="ij")
    r2 = (x / 3) ** 2 + (s / 2) ** 2
    pressure = np.sqrt(np.maximum(1 - r2, 0)) * (1 + higher * r2)
    patch = PatchSolution(3 * t, 2 * t, 0 * t, pressure, 0 * x, 0.0)
    assert half_space._shape_error(patch) == pytest.approx(error, abs=1e-3)


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
    found = half_space.of_boundary_elements(
        BoundaryElementSolution((patch,), 1e5),
        lambda x, s: np.column_stack([x, s, 0 * x]),
        Frame((0.0, 0.0, 0.0), first),
        {},
    ).patch
    assert found.b == pytest.approx(2 * share, rel=1e-6)
    assert found.area == pytest.approx(math.pi * 6 * share, rel=1e-3)
    (one,) = found.each
    assert found.area == pytest.approx(one.area * share, rel=1e-9)
