"""Recovery of fields on the contact surface from values at quadrature points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import basix
import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.signal import savgol_filter
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from postprocess.findings import Array
from solver.facets import facet_type
from solver.gather import Fields

SMOOTHED_SAMPLES = 40
OUTLINE_WINDOW = 4.0  # in elements: an outline is jagged in steps of an element
OUTLINE_STEPS = 6  # points in an element
_TRIANGLES = {
    ("triangle", 1): [[0, 1]],
    ("triangle", 2): [[0, 2], [2, 1]],
    ("quadrilateral", 1): [[0, 1]],
    ("quadrilateral", 2): [[0, 2], [2, 1]],
    ("tetrahedron", 1): [[0, 1, 2]],
    ("tetrahedron", 2): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    ("tetrahedron", 3): [
        [0, 7, 5], [7, 9, 5], [7, 8, 9], [8, 3, 9], [8, 1, 3], [5, 9, 6], [9, 4, 6], [9, 3, 4],
        [6, 4, 2],
    ],
    ("hexahedron", 1): [[0, 1, 2], [1, 3, 2]],
    ("hexahedron", 2): [
        [0, 4, 5], [4, 8, 5], [4, 1, 8], [1, 6, 8], [5, 8, 2], [8, 7, 2], [8, 6, 7], [6, 3, 7],
    ],
}  # fmt: skip


@dataclass(frozen=True)
class SurfaceRecovery:
    """Consistent (L2) projection of point values to the nodes of the contact facets.

    Only facets all of whose quadrature points face the other body take part.
    """

    fields: Fields

    @cached_property
    def _members(self) -> NDArray[np.bool_]:
        contact = self.fields.contact
        count = np.bincount(contact.facet, minlength=len(contact.facet_nodes))
        return np.asarray(count[contact.facet] == count.max())

    @cached_property
    def _numbering(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        contact = self.fields.contact
        used = np.unique(contact.facet[self._members])
        nodes, local = np.unique(contact.facet_nodes[used], return_inverse=True)
        table = np.full(contact.facet_nodes.shape, -1, dtype=np.int64)
        table[used] = local.reshape(len(used), -1)
        return nodes, table

    @property
    def nodes(self) -> NDArray[np.int64]:
        """(n,) nodes of the surface, as numbers in `Fields.points`."""
        return self._numbering[0]

    @cached_property
    def triangles(self) -> NDArray[np.int64]:
        """(t, 3) flat triangles through all nodes of the facets; of a section, lines (t, 2)."""
        table = self._numbering[1]
        table = table[table[:, 0] >= 0]
        pattern = _TRIANGLES[self.fields.cell, self.fields.degree]
        return np.concatenate([table[:, corners] for corners in pattern])

    @cached_property
    def _basis(self) -> sp.csr_matrix:
        fields, contact = self.fields, self.fields.contact
        element = basix.create_element(
            basix.ElementFamily.P,
            getattr(basix.CellType, facet_type(fields.cell)),
            fields.degree,
            basix.LagrangeVariant.gll_warped,
        )
        phi = element.tabulate(0, contact.xi[self._members])[0][..., 0]
        columns = self._numbering[1][contact.facet[self._members]]
        rows = np.repeat(np.arange(len(phi)), phi.shape[1])
        shape = (len(phi), len(self.nodes))
        return sp.csr_matrix((phi.ravel(), (rows, columns.ravel())), shape=shape)

    @cached_property
    def _solver(self) -> tuple[sp.csr_matrix, object]:
        weighted = self._basis.T @ sp.diags(self.fields.contact.weights[self._members])
        return weighted.tocsr(), splu((weighted @ self._basis).tocsc())

    def project(self, values: Array) -> Array:
        """(q,) at all contact points -> (n,) at the nodes: M x = int phi values."""
        weighted, factor = self._solver
        solve = factor.solve  # type: ignore[attr-defined]
        return np.asarray(solve(weighted @ values[self._members]))

    def interpolate(self, nodal: Array) -> Array:
        """(n,) at the nodes -> (q,) at all contact points, 0 where the surface is left out."""
        values = np.zeros(len(self._members))
        values[self._members] = self._basis @ nodal
        return values


def smooth_square(
    sites: Array, values: Array, targets: Array, samples: int = SMOOTHED_SAMPLES, degree: int = 1
) -> Array:
    """Values at targets (n, 2) from noisy positive ones at sites (k, 2), smoothing their square.

    Moving least squares of degree 1 or 2 over that many nearest positive samples: a contact
    pressure falls to zero like a square root at the edge, its square like a straight line.
    """
    positive = values > 0
    sites, square = sites[positive], values[positive] ** 2
    count = min(samples, len(sites))
    distance, near = cKDTree(sites).query(targets, k=count)
    distance, near = distance.reshape(-1, count), near.reshape(-1, count)
    radius = distance[:, -1:] * (1 + 1e-9) + 1e-300
    offset = (sites[near] - targets[:, None]) / radius[..., None]
    basis = np.concatenate([np.ones((*near.shape, 1)), offset], axis=2)
    if degree == 2:
        u, v = offset[..., 0], offset[..., 1]
        basis = np.concatenate([basis, np.stack([u * u, u * v, v * v], axis=2)], axis=2)
    weighted = basis * (1 - (distance / radius) ** 2)[..., None]
    matrix = np.einsum("nki,nkj->nij", weighted, basis)
    trace = np.trace(matrix, axis1=1, axis2=2)[:, None, None]
    matrix += 1e-9 * trace * np.eye(basis.shape[2]) + 1e-300
    right = np.einsum("nki,nk->ni", weighted, square[near])
    fitted = np.linalg.solve(matrix, right[..., None])[:, 0, 0]
    return np.asarray(np.sqrt(np.maximum(fitted, 0.0)))


def contour(points: Array, triangles: NDArray[np.int64], values: Array) -> tuple[Array, float]:
    """Zero contour of a P1 field on triangles: segments (k, 2, 2), and the area where it is > 0.

    points (n, 2), values (n,). Segments run with the positive side to their left.
    """
    corners, v = points[triangles], values[triangles]
    area2 = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flip = area2 < 0
    corners[flip], v[flip] = corners[flip][:, ::-1], v[flip][:, ::-1]
    area = 0.5 * np.abs(area2)
    positive = v > 0
    count = positive.sum(axis=1)
    total = float(area[count == 3].sum())
    segments = []
    for odd, wanted in ((True, 1), (False, 2)):
        chosen = np.flatnonzero(count == wanted)
        lone = np.argmax(positive[chosen] == odd, axis=1)
        order = (lone[:, None] + np.arange(3)) % 3
        x = np.take_along_axis(corners[chosen], order[:, :, None], axis=1)
        w = np.take_along_axis(v[chosen], order, axis=1)
        t1 = w[:, 0] / (w[:, 0] - w[:, 1])
        t2 = w[:, 0] / (w[:, 0] - w[:, 2])
        one = x[:, 0] + t1[:, None] * (x[:, 1] - x[:, 0])
        two = x[:, 0] + t2[:, None] * (x[:, 2] - x[:, 0])
        part = t1 * t2 * area[chosen]
        total += float(np.sum(part if odd else area[chosen] - part))
        segments.append(np.stack([one, two] if odd else [two, one], axis=1))
    return np.concatenate(segments), total


def chains(segments: Array, tolerance: float) -> list[Array]:
    """Join segments (k, 2, 2) that share end points into polylines (m, 2)."""
    if not len(segments):
        return []
    keys = np.round(segments / tolerance).astype(np.int64)
    starts = {tuple(key[0]): index for index, key in enumerate(keys)}
    ends = {tuple(key[1]) for key in keys}
    heads = [i for i, key in enumerate(keys) if tuple(key[0]) not in ends]
    left = set(range(len(segments)))
    lines = []
    for head in [*heads, *range(len(segments))]:
        if head not in left:
            continue
        line, current = [segments[head, 0]], head
        while current in left:
            left.remove(current)
            line.append(segments[current, 1])
            current = starts.get(tuple(keys[current, 1]), -1)
        lines.append(np.array(line))
    return lines


def smooth_outline(line: Array, size: float) -> Array:
    """A polyline (m, 2), jagged in steps of the element size, as evenly spaced smooth points.

    Savitzky and Golay's filter of degree 2 over four elements, or an eighth of a short line.
    """
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    closed = bool(np.hypot(*(line[0] - line[-1])) < 1e-3 * size)
    count = max(int(OUTLINE_STEPS * length[-1] / size), 8 * OUTLINE_STEPS)
    at = np.linspace(0.0, length[-1], count, endpoint=not closed)
    points = np.column_stack([np.interp(at, length, line[:, axis]) for axis in (0, 1)])
    window = int(min(OUTLINE_WINDOW * OUTLINE_STEPS, count / 8)) | 1
    smooth = savgol_filter(points, window, 2, axis=0, mode="wrap" if closed else "interp")
    return np.concatenate([smooth, smooth[:1]]) if closed else smooth
