"""Supports as one affine map: u = P y + u0, with y the free unknowns.

A fixed node has no unknown, a node on a symmetry plane moves in the plane only, and all nodes of
the rigid hub share one unknown, the approach. P has orthogonal columns.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Supports:
    """Boolean masks over the owned block dofs of a space (n,), and directions.

    fixed: u = u0. planes: (mask, normal) with u . normal = 0. hub: u = u0 + approach * direction;
    `hub_free` False keeps the approach out of the unknowns (approach control).
    """

    fixed: NDArray[np.bool_]
    planes: list[tuple[NDArray[np.bool_], Array]] = field(default_factory=list)
    hub: NDArray[np.bool_] | None = None
    direction: Array = field(default_factory=lambda: np.array([0.0, 0.0, -1.0]))
    hub_free: bool = True

    @property
    def held(self) -> NDArray[np.bool_]:
        """Nodes of fixed faces and of the hub (n,)."""
        return self.fixed if self.hub is None else self.fixed | self.hub


@dataclass(frozen=True)
class Reduction:
    """P (c n x free, distributed) and the local position of the approach in y (-1: not here).

    rigid_approach: the approach is an unknown but moves no node (a rigid counterface).
    """

    matrix: PETSc.Mat
    approach: int
    rigid_approach: bool

    def norms(self) -> PETSc.Vec:
        """Squared norms of the columns of P: the diagonal of P^T P."""
        indptr, indices, values = self.matrix.getValuesCSR()
        squared = self.matrix.duplicate()
        squared.setValuesCSR(indptr, indices, values**2)
        squared.assemble()
        ones, out = squared.createVecLeft(), squared.createVecRight()
        ones.set(1.0)
        squared.multTranspose(ones, out)
        return out


def reduce(supports: Supports, comm: MPI.Intracomm, *, padded: bool = False) -> Reduction:
    """Build P. The approach, if free, is the last unknown of the last rank.

    padded: keep three columns for every node and for the approach, empty where nothing is free, so
    that the unknowns come in blocks of three, as algebraic multigrid wants them.
    """
    dim = len(supports.direction)
    count = len(supports.fixed)
    hub = supports.hub if supports.hub is not None else np.zeros(count, dtype=bool)
    basis = np.tile(np.eye(dim), (count, 1, 1))  # columns: free directions of the node
    free = np.full(count, dim)
    mask = np.zeros(count, dtype=np.int64)
    for bit, (members, _) in enumerate(supports.planes):
        mask[members] |= 1 << bit
    for code in np.unique(mask[mask > 0]):
        normals = [n for bit, (_, n) in enumerate(supports.planes) if code >> bit & 1]
        _, size, rows = np.linalg.svd(np.array(normals))
        rank = int(np.sum(size > 1e-12))
        basis[mask == code] = np.column_stack([rows[rank:].T, np.zeros((dim, rank))])
        free[mask == code] = dim - rank
    free[supports.fixed | hub] = 0

    owns_approach = supports.hub_free and comm.rank == comm.size - 1
    slots = np.full(count, 3) if padded else free
    local = int(slots.sum()) + int(owns_approach) * (3 if padded else 1)
    start = comm.exscan(local) or 0
    total = comm.allreduce(local)
    last = total - (3 if padded else 1)
    first = start + np.concatenate([[0], np.cumsum(slots)[:-1]])

    node, column = np.nonzero(np.arange(dim) < free[:, None])
    rows = (dim * node[:, None] + np.arange(dim)).ravel()
    columns = np.repeat(first[node] + column, dim)
    values: Array = basis[node, :, column].ravel()
    if supports.hub_free:
        nodes = np.flatnonzero(hub & ~supports.fixed)
        rows = np.concatenate([rows, (dim * nodes[:, None] + np.arange(dim)).ravel()])
        columns = np.concatenate([columns, np.full(dim * len(nodes), last)])
        values = np.concatenate([values, np.tile(supports.direction, len(nodes))])
    keep = values != 0.0
    table = sp.csr_matrix((values[keep], (rows[keep], columns[keep])), shape=(dim * count, total))
    moved = comm.allreduce(int(hub.sum()))
    return Reduction(
        petsc_matrix(table, local, comm),
        local - total + last if owns_approach else -1,
        supports.hub_free and not moved,
    )


def petsc_matrix(table: sp.csr_matrix, local_columns: int, comm: MPI.Intracomm) -> PETSc.Mat:
    """Distributed matrix from each rank's rows with global column numbers."""
    table.sort_indices()
    return PETSc.Mat().createAIJ(
        ((table.shape[0], PETSc.DETERMINE), (local_columns, table.shape[1])),
        csr=(
            table.indptr.astype(PETSc.IntType),
            table.indices.astype(PETSc.IntType),
            table.data,
        ),
        comm=comm,
    )
