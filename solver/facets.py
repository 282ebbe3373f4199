"""Facets of a contact surface: points on them, traces of the basis and stresses at these points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import basix
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from solver import compat
from solver.elasticity import Bulk

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@lru_cache
def reference_facets(cell: str) -> Array:
    """(facets, vertices, 3) vertices of the facets of the reference cell."""
    kind = getattr(basix.CellType, cell)
    return np.asarray(basix.geometry(kind))[np.asarray(basix.topology(kind)[2])]


@lru_cache
def _element(cell: str, degree: int, variant: basix.LagrangeVariant) -> Any:
    return basix.create_element(
        basix.ElementFamily.P, getattr(basix.CellType, cell), degree, variant
    )


@lru_cache
def facet_closure(cell: str, degree: int) -> Index:
    """(facets, k) dofs of the reference cell on each facet: vertices, edges, interior."""
    element = _element(cell, degree, basix.LagrangeVariant.gll_warped)
    topology = basix.topology(getattr(basix.CellType, cell))
    rows = []
    for number, vertices in enumerate(topology[2]):
        edges = [e for e, ends in enumerate(topology[1]) if set(ends) <= set(vertices)]
        dofs = [element.entity_dofs[0][v][0] for v in vertices]
        dofs += [dof for e in edges for dof in element.entity_dofs[1][e]]
        rows.append(dofs + list(element.entity_dofs[2][number]))
    return np.array(rows, dtype=np.int64)


def tabulate(cell: str, degree: int, points: Array, *, geometry: bool = False) -> Array:
    """(4, n, dofs) values and reference derivatives of the Lagrange basis at n reference points."""
    equispaced = basix.LagrangeVariant.equispaced
    variant = equispaced if geometry else basix.LagrangeVariant.gll_warped
    return np.asarray(_element(cell, degree, variant).tabulate(1, points))[..., 0]


@dataclass(frozen=True)
class FacetSet:
    """m facets of the mesh with all that evaluates fields on them, without the mesh.

    local_facet: (m,) number of the facet in its cell. nodes: (m, k, 3) geometry nodes of the cell,
    mm. dofs: (m, d) global block dofs of the cell. lame: (m, 2) lambda and mu, MPa.
    """

    cell: str
    geometry_degree: int
    degree: int
    local_facet: Index
    nodes: Array
    dofs: Index
    lame: Array

    @classmethod
    def of(cls, bulk: Bulk, facets: NDArray[np.int32]) -> FacetSet:
        """The given local exterior facets owned by this rank."""
        mesh = bulk.space.mesh
        topology = mesh.topology
        for d0, d1 in ((2, 3), (3, 2)):
            topology.create_connectivity(d0, d1)
        facet_cells, cell_facets = topology.connectivity(2, 3), topology.connectivity(3, 2)
        owned_cells = topology.index_map(3).size_local
        cells = np.array([facet_cells.links(f)[0] for f in facets], dtype=np.int64)
        keep = cells < owned_cells
        facets, cells = facets[keep], cells[keep]
        local = [
            int(np.flatnonzero(cell_facets.links(c) == f)[0])
            for f, c in zip(facets, cells, strict=True)
        ]
        block_dofs = compat.cell_dofs(bulk.space)[cells]
        to_global = bulk.space.dofmap.index_map.local_to_global
        dofs = to_global(block_dofs.reshape(-1).astype(np.int32)).reshape(block_dofs.shape)
        return cls(
            compat.cell_type(mesh),
            compat.geometry_degree(mesh),
            bulk.degree,
            np.array(local, dtype=np.int64),
            mesh.geometry.x[compat.cell_nodes(mesh)[cells]],
            dofs.astype(np.int64),
            bulk.lame[cells],
        )

    def __len__(self) -> int:
        return len(self.local_facet)

    def gathered(self, comm: MPI.Intracomm) -> FacetSet:
        """The union over all ranks, on every rank (a contact surface is small)."""

        def gather(array: NDArray[Any]) -> NDArray[Any]:
            return np.concatenate(comm.allgather(array))

        return FacetSet(
            self.cell,
            self.geometry_degree,
            self.degree,
            gather(self.local_facet),
            gather(self.nodes),
            gather(self.dofs),
            gather(self.lame),
        )

    @cached_property
    def vertices(self) -> Array:
        """(m, 3 or 4, 3) corners of each facet, mm."""
        corners = reference_facets(self.cell)[self.local_facet]
        phi = tabulate(self.cell, 1, corners.reshape(-1, 3), geometry=True)[0]
        phi = phi.reshape(*corners.shape[:2], phi.shape[1])
        return np.einsum("fvk,fkd->fvd", phi, self.nodes[:, : phi.shape[2]])

    def reference(self, index: Index, xi: Array) -> Array:
        """(n, 3) reference coordinates in the cell of facet coordinates xi (n, 2)."""
        corner = reference_facets(self.cell)[self.local_facet[index]]
        v0, v1, v2 = corner[:, 0], corner[:, 1], corner[:, 2]
        return v0 + xi[:, :1] * (v1 - v0) + xi[:, 1:] * (v2 - v0)

    def tangents(self, index: Index, xi: Array) -> tuple[Array, Array]:
        """Position x (n, 3) and its derivatives by xi (n, 3, 2), mm."""
        x, jacobian = self._map(index, self.reference(index, xi))
        corner = reference_facets(self.cell)[self.local_facet[index]]
        edges = np.stack([corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]], axis=2)
        return x, jacobian @ edges

    def _map(self, index: Index, points: Array) -> tuple[Array, Array]:
        phi = tabulate(self.cell, self.geometry_degree, points, geometry=True)
        nodes = self.nodes[index]
        x = np.einsum("nk,nkd->nd", phi[0], nodes)
        return x, np.einsum("jnk,nkd->ndj", phi[1:], nodes)

    def basis(self, index: Index, points: Array) -> tuple[Array, Array]:
        """Basis (n, d) and its gradient (n, d, 3) in 1/mm at reference points of the cells."""
        phi = tabulate(self.cell, self.degree, points)
        _, jacobian = self._map(index, points)
        return phi[0], np.einsum("jnd,njc->ndc", phi[1:], np.linalg.inv(jacobian))

    def dof_points(self) -> Array:
        """(m, d, 3) position of the cells' dofs, mm."""
        variant = basix.LagrangeVariant.gll_warped
        points = np.asarray(_element(self.cell, self.degree, variant).points)
        phi = tabulate(self.cell, self.geometry_degree, points, geometry=True)[0]
        return np.asarray(np.einsum("dk,fkc->fdc", phi, self.nodes))

    def cell_strains(self, degree: int) -> tuple[Array, Array]:
        """Basis gradients (points, m, d, 3) in 1/mm and weights (points, m) in mm3 of the cells."""
        every = np.arange(len(self))
        rule = basix.make_quadrature(getattr(basix.CellType, self.cell), degree)
        gradients, volumes = [], []
        for point, weight in zip(*rule, strict=True):
            points = np.tile(point, (len(self), 1))
            gradients.append(self.basis(every, points)[1])
            volumes.append(weight * np.abs(np.linalg.det(self._map(every, points)[1])))
        return np.array(gradients), np.array(volumes)

    def quadrature(self, degree: int) -> tuple[tuple[Index, Array], Array]:
        """Quadrature points ((facet (n,), xi (n, 2)) and weights (n,) in mm2, facet by facet."""
        facet_kind = "triangle" if self.cell == "tetrahedron" else "quadrilateral"
        xi, weights = basix.make_quadrature(getattr(basix.CellType, facet_kind), degree)
        index = np.repeat(np.arange(len(self)), len(weights))
        points = np.tile(xi, (len(self), 1))
        _, tangent = self.tangents(index, points)
        area = np.linalg.norm(np.cross(tangent[..., 0], tangent[..., 1]), axis=1)
        return (index, points), np.tile(weights, len(self)) * area
