"""Gauss points of a block in columns and lines: the material flows along a line of points.

A column holds the points with one x, a line those with one (y, z). The plastic state of a point
follows from that of the point before it on its line, upstream.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railhead.solver.material.hardening import (
    Array,
    Hardening,
    History,
    deviator,
    radial_return,
    yield_radius,
)

ALIKE = 1e-6  # of the largest coordinate: points on one line


@dataclass(frozen=True)
class Streams:
    """Order of n = columns * lines points.

    order: number of the point of each column and line (columns, lines); the first column lies
        farthest upstream, at the largest x.
    x: coordinate of the columns (columns,), mm, descending.
    places: (y, z) of the lines (lines, 2), mm.
    """

    order: NDArray[np.int64]
    x: Array
    places: Array

    @classmethod
    def of(cls, points: Array) -> Streams:
        """Streams of points (n, 3), mm. Raises ValueError where they do not line up along x."""
        step = ALIKE * max(float(np.abs(points).max()), 1e-300)
        keys = np.round(points / step).astype(np.int64)
        order = np.lexsort((keys[:, 2], keys[:, 1], -keys[:, 0]))
        columns = len(np.unique(keys[:, 0]))
        if not len(points) or len(points) % columns:
            raise ValueError("the points do not line up along x: columns of different sizes")
        table = order.reshape(columns, -1)
        apart = np.abs(points[table] - points[table[:1]])[:, :, 1:].max()
        along = np.ptp(points[table][:, :, 0], axis=1).max()
        if max(apart, along) > 2 * step:
            raise ValueError("the points do not line up along x: their places across differ")
        return cls(table, points[table[:, 0], 0], points[table[0], 1:])

    def gathered(self, values: Array) -> Array:
        """Values (n, ...) of the points as (columns, lines, ...)."""
        return np.asarray(values[self.order])

    def scattered(self, values: Array) -> Array:
        """Values (columns, lines, ...) as those of the points (n, ...)."""
        out = np.empty((self.order.size, *values.shape[2:]))
        out[self.order.ravel()] = values.reshape(self.order.size, *values.shape[2:])
        return out


def follow(
    strain: Array, mu: Array, incoming: History, hardening: Hardening
) -> tuple[Array, History]:
    """Radial return from column to column.

    strain: (columns, lines, m) in Mandel's notation: the deviator of the elastic trial stress over
        2 mu, before any plastic strain of the material.
    mu: shear modulus (lines,), MPa.
    incoming: state of the lines upstream.
    hardening: flow curve.
    Returns the plastic strain (columns, lines, m) and the outgoing state.
    """
    plastic, state, column = np.empty_like(strain), incoming, 0
    while column < len(strain):
        elastic = _elastic_columns(strain[column:], mu, state, hardening)
        plastic[column : column + elastic] = state.plastic
        column += elastic
        while column < len(strain):
            after, _ = radial_return(strain[column], mu, state, hardening)
            plastic[column] = after.plastic
            grows = (after.equivalent != state.equivalent).any()
            state, column = after, column + 1
            if not grows:
                break
    return plastic, state


def _elastic_columns(strain: Array, mu: Array, state: History, hardening: Hardening) -> int:
    """Number of columns of strains (columns, lines, m) before the first one in which a point
    yields. mu: shear modulus (lines,), MPa. state: of the lines.
    """
    flat = deviator(strain.reshape(-1, strain.shape[2])).reshape(strain.shape)
    trial = 2 * mu[:, None] * (flat - state.plastic) - state.back
    size = np.sqrt(np.einsum("clm,clm->cl", trial, trial))
    yields = (size > yield_radius(state, hardening)).any(axis=1)
    return int(np.argmax(yields)) if yields.any() else len(strain)
