"""Stresses at points: against closed forms, across symmetry planes, outside."""

import numpy as np
import pytest
from solved import solved

from railhead.postprocess.stress import sampling


def test_on_the_axis_of_a_sphere_they_are_those_of_a_half_space() -> None:
    """sigma_zz = -p0/(1 + z^2/a^2) (K. L. Johnson, Contact Mechanics, 1985, eq. 3.45)."""
    result = solved("sphere_on_plane")
    a, p0 = result.hertz.patch.a, result.hertz.pressure.max
    z = a * np.array([0.3, 0.5, 1.0, 2.0])
    found = result.stress_at(np.column_stack([0 * z, 0 * z, z]))
    assert found[:, 2] == pytest.approx(-p0 / (1 + (z / a) ** 2), rel=1e-3)
    assert found[:, 0] == pytest.approx(found[:, 1], abs=1e-3 * p0)


def test_below_a_line_they_are_those_of_a_half_plane() -> None:
    """sigma_zz = -p0/sqrt(1 + z^2/a^2) (the same, eq. 4.46), on a head of finite depth."""
    result = solved("long_roller")
    a, p0 = result.hertz.patch.a, result.hertz.pressure.max
    z = a * np.array([0.2, 0.5, 1.0])
    found = result.stress_at(np.column_stack([0 * z, 0 * z, -z]), body="rail")
    assert found[:, 2] == pytest.approx(-p0 / np.sqrt(1 + (z / a) ** 2), rel=0.02)


def test_a_meridian_section_is_turned() -> None:
    """The point at y has the stress of the one at x, with both axes exchanged."""
    result = solved("sphere_on_plane")
    r = result.hertz.patch.a
    along, across = result.stress_at(np.array([[r, 0, r], [0, r, r]]))
    assert across == pytest.approx(along[[1, 0, 2, 3, 5, 4]], abs=1e-9)
    assert abs(along[4]) > 10 and abs(along[5]) < 1e-9


def test_the_half_that_was_left_out_mirrors_the_other() -> None:
    result = solved("hertz_ellipse", "mesh.patch_size=1.2")
    here, ahead, aside = result.stress_at(
        np.array([[1.0, 1.0, -1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]])
    )
    assert ahead == pytest.approx(here * [1, 1, 1, -1, -1, 1], rel=1e-9)
    assert aside == pytest.approx(here * [1, 1, 1, -1, 1, -1], rel=1e-9)
    assert here[2] < -300


def test_what_is_outside_or_no_point_is_said() -> None:
    result = solved("sphere_on_plane")
    assert np.isnan(result.stress_at(np.array([[0, 0, -1.0], [0, 0, 100.0]]))).all()
    assert result.stress_at(np.zeros((0, 3))).shape == (0, 6)
    fields = result.fields
    assert fields is not None
    for points, body in (([1.0, 2.0], None), ([[0, 0, np.nan]], None), ([[0, 0, 1.0]], "rail")):
        with pytest.raises(ValueError, match=r"\(n, 3\)|no deformable"):
            sampling.stress_at(fields, np.array(points), body)
