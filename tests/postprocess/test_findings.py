"""The data that tables and pictures share."""

import numpy as np
import pytest

from railhead.postprocess.findings import DepthAxis, Frame


def test_parabola_finds_the_maximum_between_samples() -> None:
    depth = np.array([0.0, 1.0, 1.5, 2.5, 3.0])
    axis = DepthAxis("rail", depth, np.zeros((5, 6)))
    assert axis.peak(7 - 2 * (depth - 1.7) ** 2) == pytest.approx((1.7, 7.0), abs=1e-12)
    assert axis.peak(-depth) == (0.0, 0.0)
    assert axis.peak(depth) == (3.0, 3.0)


def test_contact_frame_is_orthonormal_and_right_handed() -> None:
    frame = Frame((0.0, 7.0, -0.2), 0.05)
    np.testing.assert_allclose(frame.axes @ frame.axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(frame.axes) == pytest.approx(1.0)
    along = np.array([[3.0, 7.0 + 2 * np.cos(0.05), -0.2 + 2 * np.sin(0.05)]])
    np.testing.assert_allclose(frame.local(along), [[3.0, 2.0, 0.0]], atol=1e-14)
