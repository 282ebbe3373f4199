"""Facets of a contact surface: points on them, traces of the basis and stresses at these points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import basix
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from railhead.solver import compat
from railhead.solver.elasticity import Bulk, quadrature_degree
from railhead.solver.kinematics import Kinematics

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@lru_cache
def reference_facets(cell: str) -> Array:
    """(facets, vertices, d) vertices of the facets of the reference cell."""
    kind = getattr(basix.CellType, cell)
    return np.asarray(basix.geometry(kind))[np.asarray(basix.topology(kind)[-2])]


def middle(cell: str) -> Array:
    """(d,) centroid of the reference cell."""
    return np.asarray(basix.geometry(getattr(basix.CellType, cell))).mean(axis=0)


def facet_type(cell: str) -> str:
    """The facets of a cell: 'triangle', 'quadrilateral' or 'interval'."""
    return {"tetrahedron": "triangle", "hexahedron": "quadrilateral"}.get(cell, "interval")


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
    for vertices in topology[-2]:
        dofs: list[int] = []
        for entities, held in zip(topology[:-1], element.entity_dofs, strict=False):
            for ends, own in zip(entities, held, strict=True):
                dofs += own if set(ends) <= set(vertices) else []
        rows.append(dofs)
    return np.array(rows, dtype=np.int64)


def tabulate(cell: str, degree: int, points: Array, *, geometry: bool = False) -> Array:
    """(1 + c, n, dofs) values and reference derivatives of the Lagrange basis at n points."""
    equispaced = basix.LagrangeVariant.equispaced
    variant = equispaced if geometry else basix.LagrangeVariant.gll_warped
    return np.asarray(_element(cell, degree, variant).tabulate(1, points))[..., 0]


@dataclass(frozen=True)
class FacetSet:
    """m facets of the mesh with all that evaluates fields on them, without the mesh.

    c is the number of coordinates. local_facet: (m,) number of the facet in its cell. nodes:
    (m, k, c) geometry nodes of the cell, mm. dofs: (m, d) global block dofs of the cell. lame:
    (m, 2) lambda and mu, MPa.
    """

    cell: str
    geometry_degree: int
    degree: int
    local_facet: Index
    nodes: Array
    dofs: Index
    lame: Array
    kinematics: Kinematics

    @classmethod
    def of(cls, bulk: Bulk, facets: NDArray[np.int32]) -> FacetSet:
        """The given local exterior facets owned by this rank."""
        mesh = bulk.space.mesh
        topology = mesh.topology
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
        block_dofs = compat.cell_dofs(bulk.space)[cells]
        to_global = bulk.space.dofmap.index_map.local_to_global
        dofs = to_global(block_dofs.reshape(-1).astype(np.int32)).reshape(block_dofs.shape)
        return cls(
            compat.cell_type(mesh),
            compat.geometry_degree(mesh),
            bulk.degree,
            np.array(local, dtype=np.int64),
            compat.node_points(mesh)[compat.cell_nodes(mesh)[cells]],
            dofs.astype(np.int64),
            bulk.lame[cells],
            bulk.kinematics,
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
            self.kinematics,
        )

    @cached_property
    def vertices(self) -> Array:
        """(m, corners, c) corners of each facet, mm."""
        corners = reference_facets(self.cell)[self.local_facet]
        phi = tabulate(self.cell, 1, corners.reshape(-1, corners.shape[2]), geometry=True)[0]
        phi = phi.reshape(*corners.shape[:2], phi.shape[1])
        return np.einsum("fvk,fkd->fvd", phi, self.nodes[:, : phi.shape[2]])

    def reference(self, index: Index, xi: Array) -> Array:
        """(n, c) reference coordinates in the cell of facet coordinates xi (n, c - 1)."""
        corner, edges = self._edges(index)
        return corner + np.einsum("ncj,nj->nc", edges, xi)

    def _edges(self, index: Index) -> tuple[Array, Array]:
        """First corner (n, c) and edges from it (n, c, c - 1) in the reference cell."""
        corners = reference_facets(self.cell)[self.local_facet[index]]
        first = corners[:, 0]
        others = corners[:, 1 : self.kinematics.dim]
        return first, np.swapaxes(others - first[:, None], 1, 2)

    def tangents(self, index: Index, xi: Array) -> tuple[Array, Array]:
        """Position x (n, c) and its derivatives by xi (n, c, c - 1), mm."""
        x, jacobian = self._map(index, self.reference(index, xi))
        return x, jacobian @ self._edges(index)[1]

    def _map(self, index: Index, points: Array) -> tuple[Array, Array]:
        phi = tabulate(self.cell, self.geometry_degree, points, geometry=True)
        nodes = self.nodes[index]
        x = np.einsum("nk,nkd->nd", phi[0], nodes)
        return x, np.einsum("jnk,nkd->ndj", phi[1:], nodes)

    def basis(self, index: Index, points: Array) -> tuple[Array, Array]:
        """Basis (n, d) and its gradient (n, d, c) in 1/mm at reference points of the cells."""
        phi = tabulate(self.cell, self.degree, points)
        _, jacobian = self._map(index, points)
        return phi[0], np.einsum("jnd,njc->ndc", phi[1:], np.linalg.inv(jacobian))

    def divergence(self, index: Index, points: Array) -> Array:
        """tr eps (n, d, c) of the basis in 1/mm at reference points of the cells, or its mean over
        the cell where that is what counts."""
        if self.kinematics.averaged:
            return self._mean_divergence[index]
        if self.kinematics.mean_dilatation:
            points = np.broadcast_to(middle(self.cell), points.shape)
        value, gradient = self.basis(index, points)
        x = self._map(index, points)[0]
        return self.kinematics.divergence(value, gradient, x[:, None])

    @cached_property
    def _mean_divergence(self) -> Array:
        """(m, d, c) volume average of tr eps over each cell, 1/mm."""
        order = quadrature_degree(self.cell, self.degree, self.kinematics)
        _, traces, volumes = self.cell_strains(order)
        return np.asarray(
            np.einsum("pm,pmdc->mdc", volumes, traces) / volumes.sum(axis=0)[:, None, None]
        )

    def dof_points(self) -> Array:
        """(m, d, c) position of the cells' dofs, mm."""
        variant = basix.LagrangeVariant.gll_warped
        points = np.asarray(_element(self.cell, self.degree, variant).points)
        phi = tabulate(self.cell, self.geometry_degree, points, geometry=True)[0]
        return np.asarray(np.einsum("dk,fkc->fdc", phi, self.nodes))

    def cell_strains(self, degree: int) -> tuple[Array, Array, Array]:
        """Basis gradients and div + u_r/r (points, m, d, c) in 1/mm and weights (points, m) in mm3
        of the cells."""
        every = np.arange(len(self))
        rule = basix.make_quadrature(getattr(basix.CellType, self.cell), degree)
        gradients, traces, volumes = [], [], []
        for point, weight in zip(*rule, strict=True):
            points = np.tile(point, (len(self), 1))
            x, jacobian = self._map(every, points)
            value, gradient = self.basis(every, points)
            gradients.append(gradient)
            traces.append(self.kinematics.divergence(value, gradient, x[:, None]))
            size = self.kinematics.measure(x) * np.abs(np.linalg.det(jacobian))
            volumes.append(weight * size)
        return np.array(gradients), np.array(traces), np.array(volumes)

    def quadrature(self, degree: int) -> tuple[tuple[Index, Array], Array]:
        """Points ((facet (n,), xi (n, c - 1)) and weights (n,) in mm2 of a rule, facet by facet."""
        kind = getattr(basix.CellType, facet_type(self.cell))
        xi, weights = basix.make_quadrature(kind, degree)
        index = np.repeat(np.arange(len(self)), len(weights))
        points = np.tile(xi, (len(self), 1))
        x, tangent = self.tangents(index, points)
        area = np.sqrt(np.linalg.det(np.swapaxes(tangent, 1, 2) @ tangent))
        area = area * self.kinematics.measure(x)
        return (index, points), np.tile(weights, len(self)) * area
