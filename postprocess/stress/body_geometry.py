"""Geometry of a meshed body: points inside it, length of a line inside it, its sharp edges."""

import numpy as np
from numpy.typing import NDArray

from railhead.postprocess.findings import Array
from railhead.postprocess.symmetry import ON_PLANE
from railhead.solver.space.cells import inverse
from railhead.solver.system.fields import Fields
from railhead.theory.array_types import Index

SHARP = np.radians(75.0)  # between neighbouring facets; a fillet has six elements a turn at least
ROUNDING = 1e-6  # of a cell: points on its border are held
CORNERS = {"triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8}
_SIMPLICES = {
    "triangle": [[0, 1, 2]],
    "quadrilateral": [[0, 1, 3], [0, 3, 2]],
    "tetrahedron": [[0, 1, 2, 3]],
    "hexahedron": [
        [0, 1, 3, 7],
        [0, 3, 2, 7],
        [0, 2, 6, 7],
        [0, 6, 4, 7],
        [0, 4, 5, 7],
        [0, 5, 1, 7],
    ],
}


class Solid:
    """The modelled part of one body, its cells taken with straight edges between their corners.

    cells (m,): numbers of the body's cells in the fields.
    nodes (m, n): nodes of the cells, corners first, as numbers in the fields.
    corners (m, k): corner nodes of the cells.
    middles (m, 3): mean of the corners, mm.
    sizes (m,): distance of the farthest corner from that mean, mm.
    """

    def __init__(self, fields: Fields, cells: NDArray[np.int64]) -> None:
        """fields: the solution. cells (m,): numbers of all cells of the body."""
        self.cells, self.nodes = cells, fields.cells[cells]
        self.corners = self.nodes[:, : CORNERS[fields.cell]]
        at = fields.points[self.corners]
        self.middles = at.mean(axis=1)
        self.sizes = np.sqrt(((at - self.middles[:, None]) ** 2).sum(axis=2).max(axis=1))
        self._fields, self._axes = fields, fields.kinematics.axes
        self._simplices = np.array(_SIMPLICES[fields.cell])

    def near(self, point: Array, reach: float) -> NDArray[np.int64]:
        """Rows (0 to m - 1) of the cells that may have a point within `reach` (mm) of a point (3,);
        all cells that have one, up to rounding, are among them.
        """
        square = ((self.middles - point) ** 2).sum(axis=1)
        return np.flatnonzero(square < ((1 + ROUNDING) * (self.sizes + reach)) ** 2)

    def holds(self, point: Array) -> bool:
        """Whether a point (3,) in space, mm, lies in a cell of the modelled part, taken with
        straight edges, or on its border. In a section only the point's place in its plane counts.
        """
        found = self._barycentric(self.near(point, ROUNDING * self.sizes.max()), point[None])
        return bool(np.any(found.min(axis=2) > -ROUNDING))

    def extent(self, start: Array, direction: Array, reach: float) -> float:
        """Distance, mm, from start (3,) along a unit vector to where the line first leaves the
        body; at most `reach`.

        The line may enter the body beyond its start, as one from a tangent plane does. A line that
        does not meet the body within `reach` gives `reach`.
        """
        offset = self.middles - start
        along = np.clip(offset @ direction, 0.0, reach)
        aside = ((offset - along[:, None] * direction) ** 2).sum(axis=1)
        cells = np.flatnonzero(aside < self.sizes**2)
        at = self._barycentric(cells, np.array([start, start + reach * direction]))
        first, slope = at[:, 0] + 1e-9, at[:, 1] - at[:, 0]  # lines in faces are inside
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = -first / slope
        enter = np.where(slope > 0, crossing, np.where(first < 0, np.inf, -np.inf)).max(axis=1)
        leave = np.where(slope < 0, crossing, np.inf).min(axis=1)
        inside = (enter < leave) & (leave > 0) & (enter < 1)
        order = np.argsort(enter[inside])
        end = -1.0
        for one, other in zip(enter[inside][order], leave[inside][order], strict=True):
            if end >= 0 and one > end + 1e-6:
                break
            end = max(end, other)
        return reach * min(end, 1.0) if end > 0 else reach

    def _barycentric(self, cells: NDArray[np.int64], points: Array) -> Array:
        """Barycentric coordinates (s, n, d + 1) of points (n, 3) in each of the s simplices of the
        cells, which are given as rows (0 to m - 1).
        """
        nodes = self.corners[cells][:, self._simplices].reshape(-1, self._simplices.shape[1])
        corners = self._fields.points[nodes] @ self._axes.T
        sides, _ = inverse(corners[:, 1:] - corners[:, :1])
        inner = (points @ self._axes.T - corners[:, :1]) @ sides
        return np.concatenate([1 - inner.sum(axis=2, keepdims=True), inner], axis=2)

    def sharp_edges(self) -> Array:
        """Points (n, 3), mm, on the edges at which the outer facets turn by more than 75 degrees:
        free edges, borders of held faces and notches; in a section its corners. Cuts at symmetry
        planes are no facets.
        """
        facets, inner = self._boundary()
        at = self._fields.points[facets]
        if len(self._axes) == 2:
            along = at[:, 1] - at[:, 0]
            normal = np.cross(along, np.cross(*self._axes))
            edges, k = facets[:, :, None], 2
        else:
            normal = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
            ring = [0, 1, 2] if facets.shape[1] == 3 else [0, 1, 3, 2]
            k = len(ring)
            edges = np.stack([facets[:, [ring[i], ring[i - 1]]] for i in range(k)], axis=1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        outwards = np.einsum("fi,fi->f", normal, at.mean(axis=1) - inner)
        normal *= np.sign(outwards)[:, None]
        edges = np.sort(edges.reshape(len(facets) * k, -1), axis=1)
        owner = np.repeat(np.arange(len(facets)), k)
        order = np.lexsort(edges.T)
        same = np.flatnonzero(np.all(edges[order[1:]] == edges[order[:-1]], axis=1))
        one, other = owner[order[same]], owner[order[same + 1]]
        turned = np.einsum("ei,ei->e", normal[one], normal[other]) < np.cos(SHARP)
        ends = self._fields.points[edges[order[same[turned]]]]
        shares = np.linspace(0.0, 1.0, 5)[:, None, None]
        return np.concatenate(ends[:, 0] + shares * (ends[:, -1] - ends[:, 0])).reshape(-1, 3)

    def _boundary(self) -> tuple[Index, Array]:
        """Corner nodes (f, k) of the outer facets, which belong to one cell alone, and the middle
        (f, 3) of that cell, mm. Facets on symmetry planes are left out.
        """
        fields = self._fields
        pattern = _facets(fields.cell)
        facets = self.corners[:, pattern].reshape(-1, pattern.shape[1])
        keys = np.sort(facets, axis=1)
        count = np.int64(len(fields.points))
        key = keys[:, 0]
        for column in range(1, min(keys.shape[1], 3)):  # three nodes tell a facet
            key = key * count + keys[:, column]
        _, first, number = np.unique(key, return_index=True, return_counts=True)
        single = first[number == 1]
        on_cut = np.zeros(len(single), dtype=bool)
        for normal in fields.mirrors:
            height = fields.points @ np.array(normal)
            on_cut |= np.all(np.abs(height[facets[single]]) < ON_PLANE * np.ptp(height), axis=1)
        single = single[~on_cut]
        return facets[single], self.middles[single // len(pattern)]


def _facets(cell: str) -> Index:
    """(f, k) corner numbers of the facets of a cell of this type, in basix's order."""
    import basix

    return np.asarray(basix.topology(getattr(basix.CellType, cell))[-2])
