"""Stresses below strips: those of a Hertz strip that slides."""

import numpy as np
import pytest

from railhead.theory.elastic import line
from railhead.theory.elastic.line import Strips
from railhead.theory.friction import sliding

STRIP = line.contact(0.01, (207e3, 207e3), (0.3, 0.3), length=1.0, across=False, load=500.0)


@pytest.mark.parametrize("friction", [0.0, 0.3, -0.3])
def test_many_strips_are_a_hertz_strip(friction):
    width, rng = STRIP.half_width, np.random.default_rng(4)
    points = np.column_stack([
        rng.uniform(-2, 2, 100), np.zeros(100), -rng.uniform(0.05, 3, 100)
    ]) * width  # fmt: skip
    edges = np.linspace(-width, width, 801)
    pressure = STRIP.pressure((edges[1:] + edges[:-1]) / 2, 0.0)
    strips = Strips(edges, points[:, 0], -points[:, 2], 0.3)
    found = strips.stress(pressure, friction * pressure)
    exact = sliding.stress(STRIP, friction, 0.3, points)[:, [0, 1, 2, 4]]
    assert found == pytest.approx(exact, abs=1e-4 * STRIP.p0)
