"""Facets of a contact surface, with their cells: points on them, and quadrature."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import basix
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from railhead.solver.space.cells import (
    Array,
    Bulk,
    CellSet,
    Index,
    cell_data,
    lagrange_element,
    tabulate,
)


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
        return cls(**cell_data(bulk, cells), local_facet=np.array(local, dtype=np.int64))

    def gathered(self, comm: MPI.Intracomm) -> FacetSet:
        """Set of the facets of all ranks, on every rank (collective). It is small, because a
        contact surface is.
        """
        every: dict[str, Any] = {
            name: np.concatenate(comm.allgather(getattr(self, name)))
            for name in ("local_facet", "nodes", "dofs", "lame")
        }
        return replace(self, **every)

    @cached_property
    def vertices(self) -> Array:
        """Position of the corners of each facet (m, corners, c), mm."""
        corners = reference_facets(self.cell)[self.local_facet]
        phi = tabulate(self.cell, 1, corners.reshape(-1, corners.shape[2]), geometry=True)[0]
        phi = phi.reshape(*corners.shape[:2], phi.shape[1])
        return np.einsum("fvk,fkd->fvd", phi, self.nodes[:, : phi.shape[2]])

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

    def quadrature(self, degree: int) -> tuple[tuple[Index, Array], Array]:
        """Quadrature points of all facets, facet by facet: (facet number (n,), coordinates xi (n, c
        - 1) in the reference facet), and weights (n,) in mm2; degree: degree of the quadrature.
        """
        kind = getattr(basix.CellType, facet_type(self.cell))
        xi, weights = basix.make_quadrature(kind, degree)
        index = np.repeat(np.arange(len(self)), len(weights))
        points = np.tile(xi, (len(self), 1))
        x, tangent = self.tangents(index, points)
        area = np.sqrt(np.linalg.det(np.swapaxes(tangent, 1, 2) @ tangent))
        area = area * self.kinematics.measure(x)
        return (index, points), np.tile(weights, len(self)) * area
