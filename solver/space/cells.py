"""Cells: basis functions, strains and quadrature in them, without the mesh."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Self

import basix
import numpy as np

from railhead.solver import compat
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.theory.array_types import Array, Index

_HEXAHEDRON = [0, 1, 3, 2, 4, 5, 7, 6]
# (cell, degree): VTK's name in meshio, and the basix number of each node in VTK's order: vertices,
# edges (as pairs of vertices), faces and interior.
VTK_CELLS = {
    ("triangle", 1): ("triangle", [0, 1, 2]),
    ("triangle", 2): ("triangle6", [0, 1, 2, 5, 3, 4]),
    ("quadrilateral", 1): ("quad", [0, 1, 3, 2]),
    ("quadrilateral", 2): ("quad9", [0, 1, 3, 2, 4, 6, 7, 5, 8]),
    ("tetrahedron", 1): ("tetra", [0, 1, 2, 3]),
    ("tetrahedron", 2): ("tetra10", [0, 1, 2, 3, 9, 6, 8, 7, 5, 4]),
    ("hexahedron", 1): ("hexahedron", _HEXAHEDRON),
    ("hexahedron", 2): (
        "hexahedron27",
        [*_HEXAHEDRON, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 15, 14, 22, 23, 21, 24, 20, 25, 26],
    ),
}


@dataclass(frozen=True)
class Bulk:
    """Displacement space of all bodies of one mesh.

    space: dolfinx function space of vectors.
    lame: Lame's constants lambda and mu of every local cell, ghosts included (cells, 2), MPa.
    degree: polynomial degree of the displacement.
    kinematics: meaning of the mesh coordinates: a solid, plane strain, or a section that is
        revolved.
    """

    space: Any
    lame: Array
    degree: int
    kinematics: Kinematics = SOLID


def quadrature_degree(cell: str, degree: int, kinematics: Kinematics = SOLID) -> int:
    """Degree of the quadrature for the stiffness matrix.

    cell: type of the cells, for example 'tetrahedron'. degree: polynomial degree of the
        displacement.
    The rule is exact on straight-sided simplices and on boxes. In a meridian section the hoop
    strain u_r/r is a rational function, and no rule is exact.
    """
    if kinematics.revolved:
        return 2 * degree + 2
    simplex = cell in ("tetrahedron", "triangle")
    return max(2 * (degree - 1), 1) if simplex else 2 * degree


def centroid(cell: str) -> Array:
    """Coordinates (d,) of the centroid of the reference cell of a type, for example
    'tetrahedron'.
    """
    return np.asarray(basix.geometry(getattr(basix.CellType, cell))).mean(axis=0)


@lru_cache
def lagrange_element(cell: str, degree: int, variant: basix.LagrangeVariant) -> Any:
    """basix element of continuous Lagrange functions on a cell type; degree: polynomial degree;
    variant: position of the nodes on edges and faces.
    """
    return basix.create_element(
        basix.ElementFamily.P, getattr(basix.CellType, cell), degree, variant
    )


def tabulate(
    cell: str, degree: int, points: Array, *, geometry: bool = False, derivatives: int = 1
) -> Array:
    """Values (first) and reference derivatives of the Lagrange basis, (1 + c, n, dofs), at
    reference points; derivatives: 0 leaves them out.

    cell: type of the cell. degree: polynomial degree. points: reference points (n, c).
    geometry: whether the basis is that of the coordinate map, whose nodes are equispaced; otherwise
        that of the displacement, with nodes at Gauss-Lobatto-Legendre points (warped).
    """
    equispaced = basix.LagrangeVariant.equispaced
    variant = equispaced if geometry else basix.LagrangeVariant.gll_warped
    element = lagrange_element(cell, degree, variant)
    if not len(points):  # basix aborts at none in hexahedra
        return np.zeros((1 + points.shape[1], 0, element.dim))
    return np.asarray(element.tabulate(derivatives, points))[..., 0]


def inverse(matrices: Array) -> tuple[Array, Array]:
    """Inverses (n, c, c) and determinants (n,) of n matrices with two or three rows, by cofactors.
    LAPACK is called matrix by matrix and takes sixteen times as long.
    """
    a = np.ascontiguousarray(matrices.transpose(1, 2, 0))
    if len(a) == 2:
        adjugate = np.array([[a[1, 1], -a[0, 1]], [-a[1, 0], a[0, 0]]])
    else:
        adjugate = np.empty_like(a)
        for i, k in np.ndindex(3, 3):
            p, q, r, s = (k + 1) % 3, (k + 2) % 3, (i + 1) % 3, (i + 2) % 3
            adjugate[i, k] = a[p, r] * a[q, s] - a[p, s] * a[q, r]
    determinant = np.asarray((a[0] * adjugate[:, 0]).sum(axis=0))
    return (adjugate / determinant).transpose(2, 0, 1), determinant


@dataclass(frozen=True)
class CellSet:
    """m cells of a mesh with c coordinates, with all that is needed to evaluate fields in them.
    Each cell has k geometry nodes and d block dofs.

    cell: 'tetrahedron', 'hexahedron', 'triangle' or 'quadrilateral'.
    geometry_degree: polynomial degree of the coordinate map.
    degree: polynomial degree of the displacement.
    nodes: position of the geometry nodes (m, k, c), mm.
    dofs: global block dofs (m, d).
    numbers: local number of each cell on its rank (m,).
    lame: Lame's constants lambda and mu (m, 2), MPa.
    kinematics: meaning of the coordinates: a solid, plane strain, or a section that is revolved.
    """

    cell: str
    geometry_degree: int
    degree: int
    nodes: Array
    dofs: Index
    numbers: Index
    lame: Array
    kinematics: Kinematics

    @classmethod
    def of(cls, bulk: Bulk, cells: Index, **own: Any) -> Self:
        """Set of the local cells of this rank with the given numbers (m,); own: further fields."""
        mesh = bulk.space.mesh
        block_dofs = compat.cell_dofs(bulk.space)[cells]
        to_global = bulk.space.dofmap.index_map.local_to_global
        dofs = to_global(block_dofs.reshape(-1).astype(np.int32)).reshape(block_dofs.shape)
        return cls(
            cell=compat.cell_type(mesh),
            geometry_degree=compat.geometry_degree(mesh),
            degree=bulk.degree,
            nodes=compat.node_points(mesh)[compat.cell_nodes(mesh)[cells]],
            dofs=dofs.astype(np.int64),
            numbers=np.asarray(cells),
            lame=bulk.lame[cells],
            kinematics=bulk.kinematics,
            **own,
        )

    @classmethod
    def owned(cls, bulk: Bulk) -> Self:
        """Set of the cells that belong to this rank, without those that it shares as ghosts."""
        topology = bulk.space.mesh.topology
        return cls.of(bulk, np.arange(topology.index_map(topology.dim).size_local))

    def tags(self, cell_tags: Any) -> Index:
        """Tag of each cell (m,), from MeshTags in which each cell has one."""
        return np.asarray(cell_tags.values[np.searchsorted(cell_tags.indices, self.numbers)])

    def __len__(self) -> int:
        """Number m of cells."""
        return len(self.nodes)

    def _map(self, index: Index, points: Array) -> tuple[Array, Array]:
        """Position x (n, c) and its derivatives dx_i/dX_j (n, c, c) at reference points X (n, c) of
        the cells with these numbers (n,), mm.
        """
        phi = tabulate(self.cell, self.geometry_degree, points, geometry=True)
        nodes = self.nodes[index]
        x = np.einsum("nk,nkd->nd", phi[0], nodes)
        return x, np.einsum("jnk,nkd->ndj", phi[1:], nodes)

    def basis(self, index: Index, points: Array) -> tuple[Array, Array]:
        """Values (n, d) of the basis functions of the displacement and their gradients (n, d, c),
        1/mm, at reference points (n, c) of the cells with these numbers (n,).
        """
        phi = tabulate(self.cell, self.degree, points)
        _, jacobian = self._map(index, points)
        return phi[0], np.einsum("jnd,njc->ndc", phi[1:], inverse(jacobian)[0])

    def divergence(self, index: Index, points: Array) -> Array:
        """Trace of the strain of each basis function and component (n, d, c), 1/mm, at reference
        points (n, c) of the cells with these numbers (n,). With mean dilatation it is that at the
        centroid or, in a meridian section, its mean over the cell.
        """
        if self.kinematics.averaged:
            return self._mean_divergence[index]
        if self.kinematics.mean_dilatation:
            points = np.broadcast_to(centroid(self.cell), points.shape)
        value, gradient = self.basis(index, points)
        x = self._map(index, points)[0]
        return self.kinematics.divergence(value, gradient, x[:, None])

    def strains(self, index: Index, points: Array) -> Array:
        """Strain components per displacement of the cells' dofs (n, m, d, c), 1/mm, at reference
        points (n, c) of the cells with these numbers (n,).

        The m components are in Mandel's notation. In a solid they are 11, 22, 33 and sqrt(2) times
        23, 13, 12. In a section they are 11, 22, the component normal to the section, and sqrt(2)
        times 12. Mean dilatation is not applied: their trace is that at the point.
        """
        value, gradient = self.basis(index, points)
        dim, shears = self.kinematics.dim, self.kinematics.shears
        out = np.zeros((len(index), 3 + len(shears), gradient.shape[1], dim))
        for k in range(dim):
            out[:, k, :, k] = gradient[:, :, k]
        for row, (i, j) in enumerate(shears, 3):
            out[:, row, :, i] = gradient[:, :, j] / np.sqrt(2)
            out[:, row, :, j] = gradient[:, :, i] / np.sqrt(2)
        if dim == 2:
            x = self._map(index, points)[0]
            out[:, 2] = self.kinematics.divergence(value, gradient, x[:, None]) - gradient
        return out

    def quadrature_points(self, degree: int) -> tuple[tuple[Index, Array], Array, Array]:
        """Quadrature points of all cells, cell by cell: (cell number (n,), reference point (n, c)),
        position (n, c) in mm, and weight (n,) in mm3: of a plane section times its thickness, of a
        meridian section of the whole turn. degree: degree of the quadrature.
        """
        points, weights = basix.make_quadrature(getattr(basix.CellType, self.cell), degree)
        index = np.repeat(np.arange(len(self)), len(weights))
        reference = np.tile(points, (len(self), 1))
        x, jacobian = self._map(index, reference)
        size = self.kinematics.measure(x) * np.abs(np.linalg.det(jacobian))
        return (index, reference), x, np.tile(weights, len(self)) * size

    @cached_property
    def _mean_divergence(self) -> Array:
        """Mean over each cell of the trace of the strain of each basis function and component (m,
        d, c), 1/mm.
        """
        order = quadrature_degree(self.cell, self.degree, self.kinematics)
        point, x, weights = self.quadrature_points(order)
        value, gradient = self.basis(*point)
        traces = self.kinematics.divergence(value, gradient, x[:, None])
        shares = weights.reshape(len(self), len(weights) // max(len(self), 1))
        shares = shares / shares.sum(axis=1, keepdims=True)
        traces = traces.reshape(*shares.shape, *traces.shape[1:])
        return np.asarray(np.einsum("mp,mpdc->mdc", shares, traces))

    def dof_points(self) -> Array:
        """Position of the cells' dofs (m, d, c), mm."""
        variant = basix.LagrangeVariant.gll_warped
        points = np.asarray(lagrange_element(self.cell, self.degree, variant).points)
        phi = tabulate(self.cell, self.geometry_degree, points, geometry=True)[0]
        return np.asarray(np.einsum("dk,fkc->fdc", phi, self.nodes))
