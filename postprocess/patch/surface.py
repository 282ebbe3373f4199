"""Recovery of fields on the contact surface from values at quadrature points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import basix
import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from railhead.postprocess.findings import Array, Frame, Surface
from railhead.solver.fields import Fields
from railhead.solver.space.facets import facet_type

_TRIANGLES = {
    ("triangle", 1): [[0, 1]],
    ("triangle", 2): [[0, 2], [2, 1]],
    ("quadrilateral", 1): [[0, 1]],
    ("quadrilateral", 2): [[0, 2], [2, 1]],
    ("tetrahedron", 1): [[0, 1, 2]],
    ("tetrahedron", 2): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    ("tetrahedron", 3): [
        [0, 7, 5],
        [7, 9, 5],
        [7, 8, 9],
        [8, 3, 9],
        [8, 1, 3],
        [5, 9, 6],
        [9, 4, 6],
        [9, 3, 4],
        [6, 4, 2],
    ],
    ("hexahedron", 1): [[0, 1, 2], [1, 3, 2]],
    ("hexahedron", 2): [
        [0, 4, 5],
        [4, 8, 5],
        [4, 1, 8],
        [1, 6, 8],
        [5, 8, 2],
        [8, 7, 2],
        [8, 6, 7],
        [6, 3, 7],
    ],
}


Surfaces = tuple[Surface, Surface | None]
"""Of the slave and the master."""


def _pieces(fields: Fields, facets: NDArray[np.int64]) -> NDArray[np.int64]:
    """(t, 3) flat triangles through all nodes of facets (f, k), as the same node numbers; of a
    section, lines (t, 2).
    """
    return np.concatenate([facets[:, each] for each in _TRIANGLES[fields.cell, fields.degree]])


@dataclass(frozen=True)
class SurfaceRecovery:
    """Consistent (L2) projection of values at quadrature points to the nodes of the slave's contact
    facets.

    Facets of which some quadrature points do not face the other body are left out.

    fields: the solution, with its contact points and facets.
    """

    fields: Fields

    @cached_property
    def _members(self) -> NDArray[np.bool_]:
        """(q,) whether each contact point lies on a facet all of whose quadrature points face the
        other body.
        """
        contact = self.fields.contact
        count = np.bincount(contact.facet, minlength=len(contact.facet_nodes))
        return np.asarray(count[contact.facet] == count.max())

    @cached_property
    def _numbering(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Nodes (n,) of the facets that are used, as numbers in `Fields.points`, and for each facet
        (f, k) the rows of its nodes among them, -1 for facets that are left out.
        """
        contact = self.fields.contact
        used = np.unique(contact.facet[self._members])
        nodes, local = np.unique(contact.facet_nodes[used], return_inverse=True)
        table = np.full(contact.facet_nodes.shape, -1, dtype=np.int64)
        table[used] = local.reshape(len(used), -1)
        return nodes, table

    @property
    def nodes(self) -> NDArray[np.int64]:
        """Nodes (n,) of the contact facets in use, as numbers in `Fields.points`, ascending."""
        return self._numbering[0]

    @cached_property
    def triangles(self) -> NDArray[np.int64]:
        """(t, 3) flat triangles through all nodes of the facets, as rows of `nodes`; of a section,
        lines (t, 2).
        """
        table = self._numbering[1]
        table = table[table[:, 0] >= 0]
        return _pieces(self.fields, table)

    @cached_property
    def _basis(self) -> sp.csr_matrix:
        """Values (q, n), sparse, of the shape functions of the nodes at the contact points that are
        used.
        """
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
        """Weighted shape functions (n, q), sparse, and LU factors of the mass matrix M (n, n)."""
        weighted = self._basis.T @ sp.diags(self.fields.contact.weights[self._members])
        return weighted.tocsr(), splu((weighted @ self._basis).tocsc())

    def project(self, values: Array) -> Array:
        """Nodal values x (n,) of values (q,) at all contact points, from M x = int phi values dA,
        with the shape functions phi and their mass matrix M = int phi phi^T dA.
        """
        weighted, factor = self._solver
        solve = factor.solve  # type: ignore[attr-defined]
        return np.asarray(solve(weighted @ values[self._members]))


def recover_surfaces(fields: Fields, frame: Frame, pressure: Callable[[Array], Array]) -> Surfaces:
    """Points, pressure, gap and displacement on the contact surfaces of slave and master.

    pressure: function that gives the smooth pressure (n,), MPa, at points (n, 3) in space, mm; it
        holds for both surfaces. The second entry is None where the master is rigid, or no facet
        of it lies opposite the slave's.
    """

    def surface(nodes: NDArray[np.int64], pieces: NDArray[np.int64], gap: Array) -> Surface:
        """Fields on one surface. nodes (n,): numbers in `Fields.points`. pieces (t, 3): its
        triangles, as rows of the nodes. gap (n,): mm.
        """
        points = fields.points[nodes]
        local, moved = frame.local(points)[:, :2], fields.displacement[nodes]
        return Surface(
            points=points,
            local=local,
            triangles=pieces,
            pressure=pressure(points),
            gap=gap,
            displacement=moved,
        )

    recovery, other = SurfaceRecovery(fields), fields.master_surface
    own = surface(recovery.nodes, recovery.triangles, recovery.project(fields.contact.gap))
    if other is None or not len(other.nodes):
        return own, None
    pieces = _pieces(fields, np.searchsorted(other.nodes, other.facet_nodes))
    return own, surface(other.nodes, pieces, other.gap)
