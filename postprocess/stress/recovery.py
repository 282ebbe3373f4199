"""Smooth stresses from those at the Gauss points of one body, by moving least squares; and at any
points of both bodies.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess import symmetry
from railhead.postprocess.findings import COLUMN, ROW, SYMMETRIC, Array
from railhead.postprocess.stress.gauss_points import stress_at_gauss_points
from railhead.solver.system.fields import Fields

NEIGHBOURS = 1200  # samples of one local fit: about three element sizes around
FLAT_NEIGHBOURS = {"triangle": 120, "quadrilateral": 60}  # the same in a section
MEAN = 4  # `misfit` compares the means of the nearest ones: of all of them over this number
DEGREE = 3
BLOCK = 16  # fits at a time, so that they stay in the cache
RIDGE = 1e-13  # of the trace: lets too few samples have a solution, and changes no other
OUTSIDE = 1.5  # radii of the nearest cell: a point farther from it lies outside the body


class Recovery:
    """The stresses of one body, in global axes, tension positive, as a polynomial of degree 3
    around any point. No point is refused: outside of the body the polynomial is extrapolated.

    Each polynomial is fitted to the stresses at the Gauss points of the cells around, the mirror
    images across symmetry planes included (moving least squares, Lancaster and Salkauskas 1981;
    Gauss points as in Zienkiewicz and Zhu 1992).

    points (m, g, 3): the g Gauss points of each of the m cells, mm.
    stress (m, g, 6): the stresses there, components xx, yy, zz, xy, xz, yz, MPa.
    """

    def __init__(self, fields: Fields, cells: NDArray[np.int64]) -> None:
        """fields: the solution. cells (m,): numbers of all cells of the body."""
        self.points, self.stress, _ = stress_at_gauss_points(fields, cells)
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
        """Relative difference of the mean stress (6,) at the Gauss points nearest to a point (3,)
        and the mean of the fitted polynomial at the same Gauss points, as norms of components.
        """
        fitted = self.around(point)
        nearest = self._tree.query(point @ self._axes.T, k=max(self._count // MEAN, 1))[1]
        own = self._values[np.atleast_1d(nearest)].mean(axis=0)
        smooth = fitted.at_samples(self._samples[np.atleast_1d(nearest)]).mean(axis=0)
        return float(np.linalg.norm(smooth - own) / np.linalg.norm(own))

    def around(self, point: Array) -> StressPolynomial:
        """The polynomial fitted to the stresses around a point (3,), mm."""
        coefficients, radius = self._fit(point[None])
        return StressPolynomial(point @ self._axes.T, float(radius[0]), coefficients[0], self._axes)

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


class StressPolynomial:
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
        """Stress (n, 6), components xx, yy, zz, xy, xz, yz in the axes of space, MPa, tension
        positive, at points (n, d) in the coordinates of the mesh, mm; extrapolated beyond the
        radius of the fit.
        """
        offset = np.asarray((points - self._centre) / self.radius)
        return np.asarray(monomials(offset[None])[0].T @ self._coefficients)


def monomials(x: Array) -> Array:
    """All m products (n, m, k) of at most three coordinates of points (n, k, d); first comes 1."""
    factors = [np.ones(x.shape[:2]), *np.moveaxis(x, -1, 0)]
    chosen = list(combinations_with_replacement(range(len(factors)), DEGREE))
    out = np.empty((len(x), len(chosen), x.shape[1]))
    for row, (i, j, k) in enumerate(chosen):
        np.multiply(factors[i] * factors[j] if i else factors[j], factors[k], out=out[:, row])
    return out


def stress_at(fields: Fields, points: Array, body: str | None = None) -> Array:
    """Smooth stress (n, 6), components xx, yy, zz, xy, xz, yz in global axes, MPa, at points (n, 3)
    of the undeformed bodies, mm. NaN outside, that is farther than 1.5 (OUTSIDE) radii of the
    nearest cell from its middle; nearer points beyond the surface have extrapolated stresses. Where
    a symmetry plane cut the model, the half that was left out is there as well. A plane section has
    the stress of its plane at every point. A meridian section has that at the point's distance from
    the axis z and height, turned into global axes.

    body: "rail" or "wheel"; None: for each point the body with the nearer cell.
    ValueError: points of another shape or not finite, or a body that is rigid or unknown.
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise ValueError(f"points must be a finite array (n, 3), got shape {points.shape}")
    tags = [int(tag) for tag in np.unique(fields.body) if body in (None, BODY_NAMES[tag])]
    if not tags:
        raise ValueError(f"body {body!r} is no deformable one; give rail or wheel, or None")
    turned = np.arctan2(points[:, 1], points[:, 0]) if fields.kinematics.revolved else None
    if turned is not None:  # into the meridian section
        radius = np.hypot(points[:, 0], points[:, 1])
        points = np.column_stack([radius, 0.0 * radius, points[:, 2]])
    least = np.full(len(points), OUTSIDE)
    owner = np.zeros(len(points), dtype=int)
    axes = fields.kinematics.axes
    for tag in tags:
        corners = fields.points[fields.cells[fields.body == tag]]
        centres = corners.mean(axis=1)
        radii = np.linalg.norm((corners - centres[:, None]) @ axes.T, axis=2).max(axis=1)
        radii = symmetry.repeated(radii, fields.mirrors)
        centres = symmetry.vectors(centres, fields.mirrors) @ axes.T
        distance, cell = cKDTree(centres).query(points @ axes.T)
        nearer = distance / radii[cell] < least
        least[nearer], owner[nearer] = (distance / radii[cell])[nearer], tag
    stress = np.full((len(points), 6), np.nan)
    for tag in np.unique(owner[owner > 0]):
        own = owner == tag
        stress[own] = Recovery(fields, np.flatnonzero(fields.body == tag)).at(points[own])
    return stress if turned is None else _turned(stress, turned)


def _turned(stress: Array, angle: Array) -> Array:
    """Stresses (n, 6), components xx, yy, zz, xy, xz, yz, turned with the material about the axis z
    by angles (n,), rad; the axes of the components stay.
    """
    cosine, sine, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    rows = (cosine, -sine, zero), (sine, cosine, zero), (zero, zero, zero + 1.0)
    turn = np.array(rows).transpose(2, 0, 1)
    tensor = np.take(stress, SYMMETRIC, axis=1)
    return np.asarray((turn @ tensor @ turn.transpose(0, 2, 1))[:, ROW, COLUMN])
