"""Smooth stresses in one body from those at its Gauss points: moving least squares."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from railhead.postprocess import symmetry
from railhead.postprocess.findings import Array
from railhead.postprocess.stress.gauss_points import stress_at_gauss_points
from railhead.solver.fields import Fields

NEIGHBOURS = 1200  # samples of one local fit: about three element sizes around
FLAT_NEIGHBOURS = {"triangle": 120, "quadrilateral": 60}  # the same in a section
MEAN = 4  # one in so many of them, the nearest ones, is asked whether the fit keeps their mean
DEGREE = 3
BLOCK = 16  # fits at a time, so that they stay in the cache
RIDGE = 1e-13  # of the trace: lets too few samples have a solution, and changes no other


class Recovery:
    """The stresses of one body, in global axes, as a polynomial of degree 3 around any point.

    Each polynomial is fitted to the stresses at the Gauss points of the cells around, the mirror
    images across symmetry planes included (moving least squares, Lancaster and Salkauskas 1981;
    Gauss points as in Zienkiewicz and Zhu 1992).

    points (m, g, 3): the g Gauss points of each of the m cells, mm.
    stress (m, g, 6): the stresses there, components xx, yy, zz, xy, xz, yz, MPa.
    """

    def __init__(self, fields: Fields, cells: NDArray[np.int64]) -> None:
        """fields: the solution. cells (m,): numbers of all cells of the body."""
        self.points, self.stress = stress_at_gauss_points(fields, cells)
        self._axes = fields.kinematics.axes  # a section has no more coordinates than these
        points = symmetry.vectors(self.points.reshape(-1, 3), fields.mirrors)
        self._samples = points @ self._axes.T
        self._values = symmetry.stresses(self.stress.reshape(-1, 6), fields.mirrors)
        self._tree = cKDTree(self._samples, balanced_tree=False, compact_nodes=False)
        self._count = min(FLAT_NEIGHBOURS.get(fields.cell, NEIGHBOURS), len(points))

    def at(self, points: Array) -> Array:
        """Stress (n, 6), components xx, yy, zz, xy, xz, yz, at points (n, 3) of the body, MPa."""
        blocks = range(0, len(points), BLOCK)
        return np.concatenate([self._fit(points[i : i + BLOCK])[0][:, 0] for i in blocks])

    def misfit(self, point: Array) -> float:
        """Relative difference of the mean stress at the Gauss points nearest to a point (3,) and
        the mean of the fitted polynomial at the same Gauss points.
        """
        fitted = self.around(point)
        nearest = self._tree.query(point @ self._axes.T, k=max(self._count // MEAN, 1))[1]
        own = self._values[np.atleast_1d(nearest)].mean(axis=0)
        smooth = fitted.at_samples(self._samples[np.atleast_1d(nearest)]).mean(axis=0)
        return float(np.linalg.norm(smooth - own) / np.linalg.norm(own))

    def around(self, point: Array) -> Polynomial:
        """The polynomial fitted to the stresses around a point (3,), mm."""
        coefficients, radius = self._fit(point[None])
        return Polynomial(point @ self._axes.T, float(radius[0]), coefficients[0], self._axes)

    def _fit(self, points: Array) -> tuple[Array, Array]:
        """Coefficients (n, k, 6) of the fits around points (n, 3), for k monomials of the offsets
        over the radii, and these radii (n,), mm: distances of the farthest sample of each fit.
        """
        centres = points @ self._axes.T
        distance, index = self._tree.query(centres, k=self._count)
        distance, index = distance.reshape(-1, self._count), index.reshape(-1, self._count)
        radius = distance[:, -1] * (1 + 1e-9)
        offset = (self._samples[index] - centres[:, None]) / radius[:, None, None]
        basis = monomials(offset)
        weighted = basis * (1 - (distance / radius[:, None]) ** 2)[:, None]
        matrix = weighted @ basis.transpose(0, 2, 1)
        k = matrix.shape[1]
        matrix += RIDGE * np.trace(matrix, axis1=1, axis2=2)[:, None, None] * np.eye(k)
        return np.linalg.solve(matrix, weighted @ self._values[index]), radius


class Polynomial:
    """Stresses around a point as a cubic polynomial.

    radius: distance of the farthest fitted sample from the centre, mm.
    """

    def __init__(self, centre: Array, radius: float, coefficients: Array, axes: Array) -> None:
        """centre (d,): in the axes of the mesh, mm. radius: by which offsets are divided, mm.
        coefficients (k, 6): of k monomials, MPa. axes (d, 3): unit vectors of the coordinates of
        the mesh.
        """
        self.radius = radius
        self._centre, self._coefficients, self._axes = centre, coefficients, axes

    def __call__(self, points: Array) -> Array:
        """Stress (n, 6), components xx, yy, zz, xy, xz, yz, at points (n, 3) in space, MPa."""
        return self.at_samples(points @ self._axes.T)

    def at_samples(self, points: Array) -> Array:
        """Stress (n, 6), components xx, yy, zz, xy, xz, yz, MPa, at points (n, d) in the
        coordinates of the mesh, mm.
        """
        offset = np.asarray((points - self._centre) / self.radius)
        return np.asarray(monomials(offset[None])[0].T @ self._coefficients)


def monomials(x: Array) -> Array:
    """All products (n, m, k) of at most three coordinates of points (n, k, d); the first is 1."""
    factors = [np.ones(x.shape[:2]), *np.moveaxis(x, -1, 0)]
    chosen = list(combinations_with_replacement(range(len(factors)), DEGREE))
    out = np.empty((len(x), len(chosen), x.shape[1]))
    for row, (i, j, k) in enumerate(chosen):
        np.multiply(factors[i] * factors[j] if i else factors[j], factors[k], out=out[:, row])
    return out
