"""Stresses below a strip in plane strain, and the invariants of simple stress states."""

import math

import numpy as np
import pytest

from railhead.theory.elastic.hertz import Strip, line_contact
from railhead.theory.elastic.subsurface import line_axis_stress, max_shear, principal, von_mises


def test_strip_shear_peaks_at_the_root_of_the_golden_ratio() -> None:
    strip = Strip(b=2.0, p0=1000.0, load_per_length=1.0, contact_modulus=1.0, curvature=1.0)
    t2 = (math.sqrt(5) - 1) / 2
    depth = strip.b * math.sqrt(t2) * np.array([0.999, 1.0, 1.001])
    s = line_axis_stress(strip, 0.3, depth)
    tau = (s[:, 1] - s[:, 2]) / 2
    assert tau[1] > max(tau[0], tau[2])
    peak = math.sqrt(t2) - t2 / math.sqrt(1 + t2)
    assert tau[1] == pytest.approx(1000 * peak, rel=1e-13)
    np.testing.assert_allclose(s[:, 0], 0.3 * (s[:, 1] + s[:, 2]), rtol=1e-14)


def test_strip_surface_is_hydrostatic_across_the_line() -> None:
    strip = line_contact(1e-3, 1.1e5, 1e3)
    expected = [[-0.6 * strip.p0, -strip.p0, -strip.p0]]
    np.testing.assert_allclose(line_axis_stress(strip, 0.3, 0.0), expected, rtol=1e-15)


def test_invariants_of_simple_states() -> None:
    tension, hydrostatic, shear = (
        np.array([state], dtype=float)
        for state in ([7, 0, 0, 0, 0, 0], [-5, -5, -5, 0, 0, 0], [0, 0, 0, 0, 0, 3])
    )
    assert (von_mises(tension)[0], max_shear(tension)[0]) == (7, 3.5)
    assert (von_mises(hydrostatic)[0], max_shear(hydrostatic)[0]) == (0, 0)
    assert von_mises(shear)[0] == pytest.approx(3 * math.sqrt(3), rel=1e-15)
    np.testing.assert_allclose(principal(shear), [[3, 0, -3]], atol=1e-14)
