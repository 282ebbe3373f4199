"""Means of piecewise quadratic functions over the cells of another grid."""

from __future__ import annotations

import numpy as np

from railhead.solver.space.cells import Array


def cell_means(nodes: Array, edges: Array) -> Array:
    """Matrix (m, n) from values at n nodes to the means over m cells.

    nodes: ascending (n,): ends and middles of (n - 1)/2 elements, on which the function is
        quadratic, mm.
    edges: ends of the cells, ascending (m + 1,), between the first and the last node, mm.
    """
    total = np.zeros((len(edges), len(nodes)))  # integrals from the first node on
    for first in range(0, len(nodes) - 2, 2):
        left, right = nodes[first], nodes[first + 2]
        t = np.clip((edges - left) / (right - left), 0.0, 1.0)
        weights = (
            2 * t**3 / 3 - 3 * t**2 / 2 + t,
            2 * t**2 - 4 * t**3 / 3,
            2 * t**3 / 3 - t**2 / 2,
        )
        for node, weight in enumerate(weights, first):
            total[:, node] += (right - left) * weight
    return np.asarray(np.diff(total, axis=0) / np.diff(edges)[:, None])
