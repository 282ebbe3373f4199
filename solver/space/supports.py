"""Supports of bodies by the tags of their facets, as one affine map: u = P y + u0, with y the free
unknowns.

A fixed node has no unknown, a node on a symmetry plane moves in the plane only, and all nodes of
a rigid hub share one unknown, its approach. P has orthogonal columns. y has the layout of u, so
that a node keeps its block of unknowns; places without an unknown stay zero. Multigrid needs the
rigid motions in the free unknowns, and their prolongation from a coarser space.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.space.operators import local_rows, petsc_matrix, transposed, vector
from railhead.solver.space.rigid import RigidSurface
from railhead.solver.space.vectors import Direction, unit
from railhead.theory.array_types import Array, Index, Mask


@dataclass(frozen=True, eq=False)
class Clamp:
    """Facets that do not move."""

    tag: int


@dataclass(frozen=True, eq=False)
class Slide:
    """Facets that do not move along a normal, of either sense: a sliding face or a symmetry."""

    tag: int
    normal: Direction


@dataclass(frozen=True, eq=False)
class Hub:
    """Facets that move as a rigid face without turning, or a rigid surface that does. Along `free`,
    a direction, a force may be given; without it, only a motion. A hub without a load stays.

    tag: of the facets, or the rigid surface itself, which is the primary one of a contact.
    slides: whether the facets slide on the rigid face, and only move along `free` together.
    """

    tag: int | RigidSurface
    free: Direction | None = None
    slides: bool = False

    def __post_init__(self) -> None:
        """Raises ValueError for `slides` other than True and False, for facets that slide on a face
        without a free direction, and for `slides` with a rigid surface.
        """
        if not isinstance(self.slides, bool):
            raise ValueError(f"slides must be True or False, not {self.slides!r}")
        if self.slides and self.free is None:
            raise ValueError(f"Hub({self.tag}, slides=True) needs a free direction")
        if self.slides and self.rigid:
            raise ValueError(f"slides is for facets: {self.tag} has none")

    @property
    def rigid(self) -> bool:
        """Whether it moves a rigid surface."""
        return isinstance(self.tag, RigidSurface)


Support = Clamp | Slide | Hub


def must_exist(what: str, tags: Any, tag: int, comm: MPI.Intracomm) -> None:
    """Raise ValueError where no rank has an entity with this tag; what: word for the entity in the
    message; tags: MeshTags (collective).
    """
    if not comm.allreduce(len(tags.find(tag))):
        raise ValueError(f"no {what} carries the tag {tag}")


def on_facets(space: Any, facet_tags: Any, tag: int) -> Mask:
    """Mask (n,) over the owned block dofs of a space: True on the facets with this tag
    (collective).
    """
    dim = space.mesh.topology.dim
    space.mesh.topology.create_connectivity(dim - 1, dim)
    dofs = fem.locate_dofs_topological(space, dim - 1, facet_tags.find(tag))
    mask = np.zeros(space.dofmap.index_map.size_local, dtype=bool)
    mask[dofs[dofs < len(mask)]] = True
    return mask


def translation(space: Any, cells: Index, direction: Array) -> Array:
    """Displacement (n, c) of the owned block dofs of a space: a unit direction (c,) at those of the
    local cells with these numbers, else zero.
    """
    values = np.zeros((space.dofmap.index_map.size_local, len(direction)))
    dofs = np.unique(compat.cell_dofs(space)[cells])
    values[dofs[dofs < len(values)]] = direction
    return values


def masks(space: Any, facet_tags: Any, supports: Iterable[Support]) -> dict[Support, Mask]:
    """Of each support, the owned block dofs (n,) of a space on its facets (collective)."""
    none = np.zeros(space.dofmap.index_map.size_local, dtype=bool)
    return {
        each: none if isinstance(each.tag, RigidSurface) else on_facets(space, facet_tags, each.tag)
        for each in supports
    }


def held(space: Any, facet_tags: Any, parts: Iterable[Support], free: Sequence[Hub]) -> Held:
    """What supports leave to the owned block dofs of a space (collective). free: hubs whose motion
    along their free direction is an unknown.
    """
    found = masks(space, facet_tags, parts)
    fixed, planes = np.zeros(space.dofmap.index_map.size_local, dtype=bool), []
    for part, mask in found.items():
        if isinstance(part, Slide):
            planes.append((mask, unit("normal", part.normal)))
        elif isinstance(part, Hub) and part.slides:
            planes.append((mask, unit("free", part.free)))
        else:
            fixed |= mask
    hubs = [(found[hub], unit("free", hub.free)) for hub in free]
    return Held(fixed=fixed, planes=planes, hubs=hubs, dim=space.mesh.geometry.dim)


@dataclass(frozen=True, kw_only=True)
class Held:
    """What supports leave to the nodes of a displacement space, as masks over its n owned block
    dofs, and directions in the c coordinates of the mesh.

    fixed: (n,) nodes without an unknown of their own: they move by the prescribed displacement u0
        and with a hub.
    planes: (mask (n,), unit normal (c,)) of each symmetry plane; there u . normal = 0.
    hubs: (mask (n,), unit direction (c,)) of nodes that move by one unknown approach along it; no
        node: the moving body has no cells.
    dim: c.
    """

    fixed: NDArray[np.bool_]
    planes: list[tuple[NDArray[np.bool_], Array]] = field(default_factory=list)
    hubs: list[tuple[NDArray[np.bool_], Array]] = field(default_factory=list)
    dim: int = 3


@dataclass(frozen=True, kw_only=True)
class Reduction:
    """Linear map P from the free unknowns to displacements. Each of n nodes keeps its c places in
    both.

    matrix: P (c n x c n), distributed.
    free: (c n,) whether a local place holds an unknown of its node.
    aligned: whether every unknown moves its node along an axis of the mesh.
    places: local place of the approach of each hub, which is a place of no node's unknown; -1: on
        another rank.
    columns: numbers of these places among the places of all ranks.
    unknowns: number of free unknowns of all ranks, approaches included.
    rigid_approach: whether the approach is an unknown but moves no node, because the body that it
        moves is rigid.
    """

    matrix: PETSc.Mat
    free: NDArray[np.bool_]
    aligned: bool
    places: list[int]
    columns: list[int]
    unknowns: int
    rigid_approach: bool

    @property
    def approach(self) -> int:
        """Local place of the approach of the first hub; -1: on another rank, or prescribed."""
        return self.places[0] if self.places else -1

    def column(self, number: int, values: Array) -> PETSc.Mat:
        """Matrix of the free unknowns with values (n,), one a row of this rank, in the column of
        the approach of a hub, by its number.
        """
        size, places = len(values), np.full(len(values), self.columns[number])
        shape = size, self.matrix.getSize()[1]
        table = sp.csr_matrix((values, (np.arange(size), places)), shape=shape)
        local = self.matrix.getLocalSize()[1]
        return petsc_matrix(table, local, self.matrix.comm.tompi4py())

    def squared_norms(self) -> PETSc.Vec:
        """Squared norms of the columns of the map P from free unknowns to dofs, as a distributed
        vector: the diagonal of P^T P.
        """
        table, local = local_rows(self.matrix), self.matrix.getLocalSize()[1]
        squared = petsc_matrix(table.power(2), local, self.matrix.comm.tompi4py())
        return transposed(squared, np.ones(table.shape[0]))

    def restricted(self, displacement: PETSc.Vec) -> PETSc.Vec:
        """Free unknowns (P^T P)^-1 P^T u whose displacement is nearest to u; displacement: u on all
        dofs.
        """
        out = transposed(self.matrix, displacement.array)
        squares = self.squared_norms().array
        out.array[:] /= np.where(squares > 0, squares, 1.0)
        return out


def reduce(supports: Held, comm: MPI.Intracomm) -> Reduction:
    """Map from the free unknowns to displacements for given supports (collective).

    comm: communicator of the mesh. Raises ValueError where the approach is an unknown and every
        place holds an unknown of a node.
    """
    dim, count = supports.dim, len(supports.fixed)
    basis = np.tile(np.eye(dim), (count, 1, 1))  # columns: free directions of the node
    mask = np.zeros(count, dtype=np.int64)
    for bit, (members, _) in enumerate(supports.planes):
        mask[members] |= 1 << bit
    for code in np.unique(mask[mask > 0]):
        normals = [n for bit, (_, n) in enumerate(supports.planes) if code >> bit & 1]
        basis[mask == code] = _directions_normal_to(np.array(normals))
    basis[supports.fixed] = 0.0
    free = np.any(basis != 0.0, axis=1)

    start, total = comm.exscan(dim * count) or 0, comm.allreduce(dim * count)
    node, row, column = np.nonzero(basis)
    rows, values = dim * node + row, basis[node, row, column]
    columns = start + dim * node + column
    chosen = _places(start + np.flatnonzero(~free), len(supports.hubs), comm)
    for (hub, direction), place in zip(supports.hubs, chosen, strict=True):
        moved = np.flatnonzero(hub)
        rows = np.concatenate([rows, (dim * moved[:, None] + np.arange(dim)).ravel()])
        columns = np.concatenate([columns, np.full(dim * len(moved), place)])
        values = np.concatenate([values, np.tile(direction, len(moved))])
    places = [place - start if 0 <= place - start < dim * count else -1 for place in chosen]
    keep = values != 0.0
    table = sp.csr_matrix((values[keep], (rows[keep], columns[keep])), shape=(dim * count, total))
    moving = comm.allreduce(sum(int(hub.sum()) for hub, _ in supports.hubs))
    return Reduction(
        matrix=petsc_matrix(table, dim * count, comm),
        free=free.ravel(),
        aligned=not comm.allreduce(int(np.any(row != column))),
        places=places,
        columns=chosen,
        unknowns=int(comm.allreduce(int(free.sum())) + len(chosen)),
        rigid_approach=bool(chosen) and not moving,
    )


def _directions_normal_to(normals: Array) -> Array:
    """Orthonormal directions that are normal to all given vectors, as columns of a matrix (c, c)
    whose other columns are zero.

    normals: vectors (k, c). Directions along coordinate axes are in the columns of these axes.
    """
    _, size, rows = np.linalg.svd(normals)
    rank = int(np.sum(size > 1e-12))
    rest = rows[rank:]
    axes = np.abs(rest).sum(axis=0) > 1e-12
    if axes.sum() == len(rest):
        return np.diag(axes.astype(float))
    return np.column_stack([rest.T, np.zeros((normals.shape[1], rank))])


def _places(empty: NDArray[np.intp], count: int, comm: MPI.Intracomm) -> list[int]:
    """Places of approaches, numbers among those of all ranks: the last ones without an unknown
    (collective).

    empty: numbers of this rank's places without an unknown, ascending. count: of approaches. Raises
        ValueError where there are not so many.
    """
    every = np.concatenate(comm.allgather(empty[max(len(empty) - count, 0) :]))
    if len(every) < count:
        raise ValueError("nothing is held, so that there is no place for the approach")
    return [int(place) for place in every[len(every) - count :]]


def reduced_prolongation(full: PETSc.Mat, fine: Reduction, coarse: Reduction) -> PETSc.Mat:
    """Prolongation Q = (P_f^T P_f)^-1 P_f^T I P_c between free unknowns, so that P_f Q = I P_c.

    full: interpolation I from all coarse dofs to all fine dofs. fine, coarse: reductions with the
        maps P_f and P_c from free unknowns to dofs. The approach of a rigid body is carried over
        unchanged.
    """
    q = fine.matrix.transposeMatMult(full.matMult(coarse.matrix))
    scale = fine.squared_norms()
    if fine.rigid_approach:  # it moves no node: it is carried over as it is
        entry = PETSc.Mat().createAIJ(q.getSizes(), nnz=1, comm=q.comm)
        if fine.approach >= 0:
            scale.array[fine.approach] = 1.0
            row = scale.owner_range[0] + fine.approach
            entry.setValue(row, q.getOwnershipRangeColumn()[0] + coarse.approach, 1.0)
        entry.assemble()
        q.axpy(1.0, entry, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    scale.reciprocal()
    q.diagonalScale(L=scale)
    return q


def rigid_modes(
    points: Array, reduction: Reduction, kinematics: Kinematics = SOLID
) -> list[PETSc.Vec]:
    """Orthonormal rigid motions in the free unknowns, as the near-nullspace of algebraic multigrid.

    points: position of the owned block dofs (n, c), mm. reduction: map from free unknowns to dofs.
        Motions that the supports exclude are left out. Rotations are about the mean of the points
        of all ranks (collective).
    """
    comm = reduction.matrix.comm.tompi4py()
    *total, count = comm.allreduce(np.append(points.sum(axis=0), len(points)))
    centred = points - np.array(total) / count
    modes: list[PETSc.Vec] = []
    for motion in kinematics.rigid_motions(centred):
        full = vector(reduction.matrix, motion)
        mode = reduction.restricted(full)
        for other in modes:
            mode.axpy(-mode.dot(other), other)
        if mode.norm() > 1e-8 * full.norm():
            mode.normalize()
            modes.append(mode)
    return modes
