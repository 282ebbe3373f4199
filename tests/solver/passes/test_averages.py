"""Means of quadratic functions over cells."""

import numpy as np
import pytest

from railhead.solver.passes.averages import cell_means


def test_means_of_a_parabola_are_exact():
    ends = np.array([-2.0, -0.5, 0.1, 3.0])
    nodes = np.sort(np.concatenate([ends, (ends[1:] + ends[:-1]) / 2]))
    edges = np.array([-2.0, -1.9, 0.0, 0.05, 2.0, 3.0])
    found = cell_means(nodes, edges) @ (1 + 2 * nodes - 3 * nodes**2)
    exact = np.diff(edges + edges**2 - edges**3) / np.diff(edges)
    assert found == pytest.approx(exact)
