"""Findings of exact Hertz and of half-spaces."""

import numpy as np
import pytest

from railhead.postprocess.findings import Frame
from railhead.postprocess.patch import half_space
from railhead.theory.bem.grid_patch import PatchSolution


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
