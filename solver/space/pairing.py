"""Pairing of two surfaces: the point of one that a normal of the other meets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from railhead.solver.space.cells import Array, Index
from railhead.solver.space.facets import FacetSet

CANDIDATES = (8, 64)  # nearest facets that are tried first, and where these fail
OUTSIDE = 0.05  # how far a point may lie outside its facet, in reference units


def pair(points: Array, normals: Array, master: FacetSet) -> tuple[Index, Array]:
    """Follow a normal from each point to a surface: X(xi) = x + t n, with t of either sign.

    points: x (n, c), mm. normals: n (n, c). master: facets of the surface.
    Returns the facet that is met (n,), -1 where there is none, and the coordinates xi in the
    reference facet (n, c - 1). Newton's method is used on the nearest facets.
    """
    facet = np.full(len(points), -1, dtype=np.int64)
    inner = points.shape[1] - 1
    xi = np.zeros((len(points), inner))
    if not len(master) or not len(points):
        return facet, xi
    tree = cKDTree(master.vertices.mean(axis=1))
    missing = np.arange(len(points))
    for count in CANDIDATES:
        count = min(count, len(master))
        _, near = tree.query(points[missing], k=count)
        near = np.asarray(near).reshape(len(missing), count)
        repeated = np.repeat(missing, count)
        guess = _project_on_corners(points[repeated], normals[repeated], master, near.ravel())
        outside = _outside(guess, master).reshape(near.shape)
        best = outside.argmin(axis=1)
        each = np.arange(len(missing))
        found = outside[each, best] < OUTSIDE
        facet[missing[found]] = near[each, best][found]
        xi[missing[found]] = guess.reshape(*near.shape, inner)[each, best][found]
        missing = missing[~found]
        if not len(missing):
            break
    hit = np.flatnonzero(facet >= 0)
    xi[hit] = _project(points[hit], normals[hit], master, facet[hit], xi[hit])
    return facet, xi


def _outside(xi: Array, master: FacetSet) -> Array:
    """Distance (n,) of facet coordinates xi (n, c - 1) from the reference facet, in its units: 0
    inside, infinite for coordinates that are not finite.
    """
    high = xi.sum(axis=1) if master.cell == "tetrahedron" else xi.max(axis=1)
    result: NDArray[np.float64] = np.maximum(np.maximum(-xi.min(axis=1), high - 1.0), 0.0)
    result[~np.isfinite(result)] = np.inf
    return result


def _project_on_corners(points: Array, normals: Array, master: FacetSet, facet: Index) -> Array:
    """Coordinates xi (n, c - 1) at which the normals from points meet facets that are drawn
    straight between their corners. One step is exact for flat triangles.

    points, normals: (n, c). facet: facet of `master` for each point (n,).
    """
    corners = master.vertices[facet]
    flat = master.cell != "hexahedron"
    inner = points.shape[1] - 1
    xi = np.full((len(points), inner), 1 / (inner + 1) if flat else 0.5)
    twist = (
        np.zeros_like(points)
        if flat
        else corners[:, 3] - corners[:, 1] - corners[:, 2] + corners[:, 0]
    )
    edges = np.swapaxes(corners[:, 1 : inner + 1] - corners[:, :1], 1, 2)
    for _ in range(1 if flat else 4):
        x = corners[:, 0] + np.einsum("ncj,nj->nc", edges, xi) + xi.prod(axis=1)[:, None] * twist
        tangent = edges if flat else edges + twist[:, :, None] * xi[:, None, ::-1]
        xi += _step(points, normals, x, tangent)
    return xi


def _project(points: Array, normals: Array, master: FacetSet, facet: Index, xi: Array) -> Array:
    """Coordinates xi (n, c - 1) at which normals from points meet curved facets, by two steps of
    Newton's method.

    points, normals: (n, c). facet: facet of `master` for each point (n,). xi: first guess (n, c -
        1).
    """
    for _ in range(2):
        x, tangent = master.tangents(facet, xi)
        xi = xi + _step(points, normals, x, tangent)
    return xi


def _step(points: Array, normals: Array, x: Array, tangent: Array) -> Array:
    """Newton's step (n, c - 1) for xi in the equation x(xi) - point - t normal = 0; t is eliminated
    by Cramer's rule.

    points, normals: (n, c). x: position on the facet (n, c). tangent: its derivatives by xi (n, c,
        c - 1), mm. The step is zero where the normal lies in the facet.
    """
    rhs = points - x
    if tangent.shape[2] == 1:
        det = np.cross(tangent[..., 0], normals)
        return np.asarray(np.cross(rhs, normals) / np.where(np.abs(det) > 1e-14, det, np.inf))[
            :, None
        ]
    a, b = tangent[..., 0], tangent[..., 1]
    det = np.einsum("nd,nd->n", np.cross(a, b), normals)
    det = np.where(np.abs(det) > 1e-14, det, np.inf)
    first = np.einsum("nd,nd->n", np.cross(rhs, b), normals) / det
    second = np.einsum("nd,nd->n", np.cross(a, rhs), normals) / det
    return np.column_stack([first, second])
