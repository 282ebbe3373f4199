"""The data that tables and pictures share."""

import numpy as np
import pytest
from solved import solved

from railhead.postprocess import read
from railhead.postprocess.findings import DepthAxis, Frame

DOWN = (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)


def test_parabola_finds_the_maximum_between_samples() -> None:
    depth = np.array([0.0, 1.0, 1.5, 2.5, 3.0])
    axis = DepthAxis("rail", depth, np.zeros((5, 6)), DOWN)
    assert axis.peak(7 - 2 * (depth - 1.7) ** 2) == pytest.approx((1.7, 7.0), abs=1e-12)
    assert axis.peak(-depth) == (0.0, 0.0) and axis.peak(depth) == (3.0, 3.0)
    for end, near in ((0.0, 0.2), (3.0, 2.8)):  # the largest sample is at an end: none is beyond it
        assert axis.peak(-((depth - near) ** 2)) == pytest.approx((end, -0.04))


def test_a_patch_that_is_turned_from_the_first_contact_is_read_in_its_own_plane() -> None:
    """With a first contact 10 mm aside on a plane turned by 40 degrees, as at the root of a flange,
    nothing changes. On that plane the area was cos 40 degrees times its own, and the axis began
    outside the rail, where extrapolated stresses were the largest ones.
    """
    result = solved("hertz_ellipse", "mesh.patch_size=1.2")
    usual, fields = result.findings, result.fields
    turned = read.findings(fields, Frame((0.0, 10.0, 0.0), 0.7), parabolic=True)
    assert turned.frame.angle == pytest.approx(0.0, abs=1e-9)
    assert turned.patch.centre == pytest.approx((0.0, 0.0), abs=1e-9)
    for name in ("a", "b", "area", "max_pressure"):
        assert getattr(turned.patch, name) == pytest.approx(getattr(usual.patch, name), rel=1e-3)
    for body, found in turned.largest.items():
        assert found.von_mises.value == pytest.approx(usual.largest[body].von_mises.value, rel=1e-3)
        assert found.tau.place == pytest.approx(usual.largest[body].tau.place, abs=0.02)
    assert turned.axis.stress[0, 2] == pytest.approx(usual.axis.stress[0, 2], rel=1e-3)
