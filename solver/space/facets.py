"""Facets of a contact surface: points on them, quadrature, and pairing with another surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import basix
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from railhead.solver.space.cells import Bulk, CellSet, lagrange_element, tabulate
from railhead.theory.array_types import Array, Index


@lru_cache
def reference_facets(cell: str) -> Array:
    """Coordinates (facets, vertices, d) of the vertices of each facet of the reference cell of a
    type.
    """
    kind = getattr(basix.CellType, cell)
    return np.asarray(basix.geometry(kind))[np.asarray(basix.topology(kind)[-2])]


def facet_type(cell: str) -> str:
    """Type of the facets of a cell type: 'triangle', 'quadrilateral' or 'interval'."""
    return {"tetrahedron": "triangle", "hexahedron": "quadrilateral"}.get(cell, "interval")


@lru_cache
def facet_closure(cell: str, degree: int) -> Index:
    """Numbers (facets, k) of the reference cell's dofs that lie on each facet: those on vertices,
    then on edges, then inside the facet; degree: polynomial degree.
    """
    element = lagrange_element(cell, degree, basix.LagrangeVariant.gll_warped)
    topology = basix.topology(getattr(basix.CellType, cell))
    rows = []
    for vertices in topology[-2]:
        dofs: list[int] = []
        for entities, held in zip(topology[:-1], element.entity_dofs, strict=False):
            for ends, own in zip(entities, held, strict=True):
                dofs += own if set(ends) <= set(vertices) else []
        rows.append(dofs)
    return np.array(rows, dtype=np.int64)


@dataclass(frozen=True)
class FacetSet(CellSet):
    """m facets of a mesh, with the cell that each belongs to. c is the number of coordinates of the
    mesh. The fields of `CellSet` hold one row for each facet, those of its cell.

    local_facet: number of each facet in its cell (m,), basix order.
    """

    local_facet: Index

    @classmethod
    def on(cls, bulk: Bulk, facets: NDArray[np.int32]) -> FacetSet:
        """Set of exterior facets, from their local numbers on this rank; facets of cells that
        another rank owns are left out.
        """
        topology = bulk.space.mesh.topology
        dim = topology.dim
        for d0, d1 in ((dim - 1, dim), (dim, dim - 1)):
            topology.create_connectivity(d0, d1)
        facet_cells = topology.connectivity(dim - 1, dim)
        cell_facets = topology.connectivity(dim, dim - 1)
        owned_cells = topology.index_map(dim).size_local
        cells = np.array([facet_cells.links(f)[0] for f in facets], dtype=np.int64)
        keep = cells < owned_cells
        facets, cells = facets[keep], cells[keep]
        local = [
            int(np.flatnonzero(cell_facets.links(c) == f)[0])
            for f, c in zip(facets, cells, strict=True)
        ]
        return cls.of(bulk, cells, local_facet=np.array(local, dtype=np.int64))

    def gathered(self, comm: MPI.Intracomm) -> FacetSet:
        """Set of the facets of all ranks, on every rank (collective). It is small, because a
        contact surface is.
        """
        return FacetSet.joined(comm.allgather(self))

    @classmethod
    def joined(cls, sets: Sequence[FacetSet]) -> FacetSet:
        """One set with the facets of several sets of a mesh, in their order."""
        every: dict[str, Any] = {
            name: np.concatenate([getattr(each, name) for each in sets])
            for name in ("local_facet", "nodes", "dofs", "numbers", "lame")
        }
        return replace(sets[0], **every)

    def moved(self, displacement: Array) -> FacetSet:
        """The facets at their displaced places, themselves where nothing is displaced;
        displacement: (dofs, c) of all block dofs, mm.
        """
        if not displacement.any():
            return self
        degree = max(self.degree, self.geometry_degree)
        element = lagrange_element(self.cell, degree, basix.LagrangeVariant.equispaced)
        points = np.asarray(element.points)
        old = tabulate(self.cell, self.geometry_degree, points, geometry=True)[0]
        more = tabulate(self.cell, self.degree, points)[0]
        nodes = np.einsum("qk,mkc->mqc", old, self.nodes)
        nodes += np.einsum("qd,mdc->mqc", more, displacement[self.dofs])
        return replace(self, geometry_degree=degree, nodes=nodes)

    def values(self, index: Index, xi: Array, displacement: Array) -> Array:
        """Displacement (n, c) at coordinates xi (n, c - 1) of the facets with these numbers (n,);
        displacement: (dofs, c) of all block dofs, mm.
        """
        phi = tabulate(self.cell, self.degree, self.reference(index, xi), derivatives=0)[0]
        return np.asarray(np.einsum("nd,ndc->nc", phi, displacement[self.dofs[index]]))

    def rows_at(self, index: Index, xi: Array, directions: Array) -> tuple[Index, Array]:
        """Matrix rows, see `rows`, of the displacement along k directions (n, k, c) at coordinates
        xi (n, c - 1) of the facets with these numbers (n,).
        """
        phi = tabulate(self.cell, self.degree, self.reference(index, xi), derivatives=0)[0]
        return self.rows(index, phi[:, None, :, None] * directions[:, :, None, :])

    def rows(self, index: Index, values: Array) -> tuple[Index, Array]:
        """Global dofs and coefficients of matrix rows, each (n k, nodes, c): k rows at each of n
        points.

        index: facet that each point lies on (n,).
        values: coefficients (n, k, nodes, c) of the nodes of the facets' cells.
        """
        size, dim = values.shape[1], values.shape[3]
        dofs = dim * self.dofs[index][:, :, None] + np.arange(dim)
        return np.repeat(dofs, size, axis=0), values.reshape(-1, *values.shape[2:])

    @cached_property
    def vertices(self) -> Array:
        """Position of the corners of each facet (m, corners, c), mm."""
        corners = reference_facets(self.cell)[self.local_facet]
        phi = tabulate(self.cell, 1, corners.reshape(-1, corners.shape[2]), geometry=True)[0]
        phi = phi.reshape(*corners.shape[:2], phi.shape[1])
        return np.einsum("fvk,fkd->fvd", phi, self.nodes[:, : phi.shape[2]])

    @property
    def lengths(self) -> Array:
        """Length of one side of each facet (m,), mm."""
        return np.asarray(np.linalg.norm(self.vertices[:, 1] - self.vertices[:, 0], axis=1))

    def reference(self, index: Index, xi: Array) -> Array:
        """Reference coordinates (n, c) in the cells of points with coordinates xi (n, c - 1) in the
        reference facet, on the facets with these numbers (n,).
        """
        corner, edges = self._edges(index)
        return corner + np.einsum("ncj,nj->nc", edges, xi)

    def _edges(self, index: Index) -> tuple[Array, Array]:
        """First corner (n, c) in the reference cell, and the edges from it (n, c, c - 1) as
        columns, of the facets with these numbers (n,).
        """
        corners = reference_facets(self.cell)[self.local_facet[index]]
        first = corners[:, 0]
        others = corners[:, 1 : self.kinematics.dim]
        return first, np.swapaxes(others - first[:, None], 1, 2)

    def tangents(self, index: Index, xi: Array) -> tuple[Array, Array]:
        """Position x (n, c) and its derivatives by xi (n, c, c - 1), mm, at coordinates xi (n, c -
        1) of the facets with these numbers (n,).
        """
        x, jacobian = self._map(index, self.reference(index, xi))
        return x, jacobian @ self._edges(index)[1]

    def normals(self, index: Index, tangent: Array) -> Array:
        """Outward unit normals (n, c) at points of the facets with these numbers (n,); tangent:
        derivatives of the position (n, c, c - 1), see `tangents`.
        """
        first = tangent[..., 0]
        if tangent.shape[2] == 1:
            normal = np.stack([first[:, 1], -first[:, 0]], axis=1)
        else:
            normal = np.cross(first, tangent[..., 1])
        outward = self.vertices[index].mean(axis=1) - self.nodes[index].mean(axis=1)
        normal *= np.sign(np.einsum("nc,nc->n", normal, outward))[:, None]
        return np.asarray(normal / np.linalg.norm(normal, axis=1)[:, None])

    @cached_property
    def flat_normals(self) -> Array:
        """Outward unit normal (m, c) of each facet, drawn straight between its corners, at its
        middle.
        """
        corners = self.vertices
        edges = corners[:, 1 : self.kinematics.dim] - corners[:, :1]
        if corners.shape[1] == 4:
            edges = edges + corners[:, 3:] - corners[:, [2, 1]]
        return self.normals(np.arange(len(self)), np.swapaxes(edges, 1, 2))

    def measure(self, index: Index, xi: Array) -> Array:
        """Area (n,) in mm2 per area of the reference facet, at coordinates xi (n, c - 1) of the
        facets with these numbers (n,): of a plane section times its thickness, of a meridian
        section of the whole turn.
        """
        x, tangent = self.tangents(index, xi)
        area = np.sqrt(np.linalg.det(np.swapaxes(tangent, 1, 2) @ tangent))
        return np.asarray(area * self.kinematics.measure(x))

    def quadrature(self, degree: int) -> tuple[tuple[Index, Array], Array]:
        """Quadrature points of all facets, facet by facet: (facet number (n,), coordinates xi (n, c
        - 1) in the reference facet), and weights (n,) in mm2, see `measure`. degree: degree of the
        quadrature.
        """
        kind = getattr(basix.CellType, facet_type(self.cell))
        xi, weights = basix.make_quadrature(kind, degree)
        index = np.repeat(np.arange(len(self)), len(weights))
        points = np.tile(xi, (len(self), 1))
        return (index, points), np.tile(weights, len(self)) * self.measure(index, points)


CANDIDATES = (8, 64)  # nearest facets that are tried first, and where these fail
OUTSIDE = 0.05  # how far a point may lie outside its facet, in reference units
ON_BORDER = 1e-9  # the same of a facet that is known to be met


def pair(
    points: Array, normals: Array, master: FacetSet, known: Index | None = None
) -> tuple[Index, Array]:
    """Follow a normal from each point to a surface: X(xi) = x + t n, with t of either sign.

    points: x (n, c), mm. normals: n (n, c). master: facets of the surface.
    known: facet that each normal meets, as far as is known, (n,), which is tried first; -1: none.
    Returns the facet that is met (n,), -1 where there is none, and the coordinates xi in the
    reference facet (n, c - 1), zero where there is none. A point may lie beyond the border of its
    facet, drawn straight between its corners, by up to 0.05 (OUTSIDE) of the reference facet. The 8
    and then the 64 (CANDIDATES) nearest facets of each point are tried, by Newton's method.
    """
    facet = np.full(len(points), -1, dtype=np.int64)
    inner = points.shape[1] - 1
    xi = np.zeros((len(points), inner))
    if not len(master) or not len(points):
        return facet, xi
    tree = cKDTree(master.vertices.mean(axis=1))
    missing = np.arange(len(points))
    for count in CANDIDATES if known is None else (0, *CANDIDATES):
        if count:
            ranks = np.arange(1, min(count, len(master)) + 1)
            near, border = tree.query(points[missing], k=ranks)[1], OUTSIDE
        else:  # the facets that are known
            near, border = np.asarray(known)[:, None], ON_BORDER
        repeated = np.repeat(missing, near.shape[1])
        guess = project_on_corners(points[repeated], normals[repeated], master, near.ravel())
        outside = _outside(guess, master).reshape(near.shape)
        outside[near < 0] = np.inf
        best = outside.argmin(axis=1)
        each = np.arange(len(missing))
        found = outside[each, best] < border
        facet[missing[found]] = near[each, best][found]
        xi[missing[found]] = guess.reshape(*near.shape, inner)[each, best][found]
        missing = missing[~found]
        if not len(missing):
            break
    hit = np.flatnonzero(facet >= 0)
    for _ in range(2):  # on curved facets
        x, tangent = master.tangents(facet[hit], xi[hit])
        xi[hit] += _step(points[hit], normals[hit], x, tangent)
    return facet, xi


def _outside(xi: Array, master: FacetSet) -> Array:
    """Largest amount (n,) by which coordinates xi (n, c - 1) lie outside of the reference facet: 0
    inside, infinite for coordinates that are not finite.
    """
    high = xi.sum(axis=1) if master.cell == "tetrahedron" else xi.max(axis=1)
    result: NDArray[np.float64] = np.maximum(np.maximum(-xi.min(axis=1), high - 1.0), 0.0)
    result[~np.isfinite(result)] = np.inf
    return result


def project_on_corners(points: Array, normals: Array, master: FacetSet, facet: Index) -> Array:
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


def _step(points: Array, normals: Array, x: Array, tangent: Array) -> Array:
    """Newton's step (n, c - 1) for xi in the equation x(xi) - point - t normal = 0; t is eliminated
    by Cramer's rule.

    points, normals: (n, c). x: position on the facet (n, c). tangent: its derivatives by xi (n, c,
        c - 1), mm. The step is zero where the normal lies in the facet, to 1e-14 of its size.
    """
    rhs, size = points - x, np.linalg.norm(tangent, axis=1).prod(axis=1)
    if tangent.shape[2] == 1:
        turned = normals[:, ::-1] * [1, -1]  # normal to the normals
        det = np.einsum("nd,nd->n", tangent[..., 0], turned)
        det = np.where(np.abs(det) > size * 1e-14, det, np.inf)
        return np.asarray(np.einsum("nd,nd->n", rhs, turned) / det)[:, None]
    a, b = tangent[..., 0], tangent[..., 1]
    det = np.einsum("nd,nd->n", np.cross(a, b), normals)
    det = np.where(np.abs(det) > size * 1e-14, det, np.inf)
    first = np.einsum("nd,nd->n", np.cross(rhs, b), normals) / det
    second = np.einsum("nd,nd->n", np.cross(a, rhs), normals) / det
    return np.column_stack([first, second])
