"""Recovered stresses of fields whose stress is known; stresses at points of solutions."""

from dataclasses import replace

import numpy as np
import pytest
from painted import LAME
from solved import solved

from railhead.postprocess.stress.recovery import Recovery, stress_at


@pytest.mark.parametrize("cut", [True, False])
@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
def test_linear_stress_is_recovered_exactly(blocks, cell: str, cut: bool) -> None:
    """u = (x z, y z, z^2), symmetric about x = 0 and y = 0, inside, on a face and on the axis."""
    fields = blocks(cell, 2, cut=cut).fields
    x, y, z = fields.points.T
    fields = replace(fields, displacement=1e-4 * np.column_stack([x * z, y * z, z * z]))
    found = Recovery(fields, np.flatnonzero(fields.body == 1))
    points = np.array([[1.0, 2.0, -3.0], [2.0, 1.0, 0.0], [0.0, 0.0, -1.0]])
    x, y, z = points.T
    lam, mu = LAME
    zero = np.zeros(3)
    strain = np.column_stack([z, z, 2 * z, zero, x / 2, y / 2])
    exact = 1e-4 * (lam * 4 * z[:, None] * [1, 1, 1, 0, 0, 0] + 2 * mu * strain)
    assert found.at(points) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    for point, expected in zip(points, exact, strict=True):
        around = found.around(point)
        assert around(points) == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())
        assert around(point[None])[0] == pytest.approx(expected, abs=1e-9 * np.abs(exact).max())


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
            stress_at(fields, np.array(points), body)
