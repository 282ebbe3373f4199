"""Stiffness P^T K P of the free unknowns, and reactions at the supports.

Blocks of the upper half are stored. A product with them costs two thirds to three quarters of one
with all blocks, and that two thirds of one with single entries. The motion of a hub couples all
nodes beside it. That fits into no block, and is a matrix of its own, with few entries.

Of the unreduced stiffness K only the rows K_s at the supported dofs s are kept:

    forces     K u0 = K_s^T u0_s    for a u0 that is zero elsewhere (K is symmetric)
    reactions  (K u)_s = K_s u
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver.space.operators import local_rows, select_rows, transposed
from railhead.solver.space.supports import Reduction
from railhead.theory.array_types import Array

DIFFERENT = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN


@dataclass(frozen=True)
class Stiffness:
    """Stiffness P^T K P = blocks + hubs of the free unknowns. P is the map from free unknowns to
    dofs, K the stiffness on all dofs.

    blocks: stiffness of the nodes' unknowns, N/mm, a symmetric matrix of blocks (SBAIJ); places
        without an unknown have a typical diagonal.
    hubs: rows and columns of the motions of hubs, N/mm, single entries.
    columns: numbers of these motions among the free unknowns of all ranks.
    spring: stiffness on the motion of the first hub that `hubs` contains beside K, N/mm.
    """

    blocks: PETSc.Mat
    hubs: PETSc.Mat
    columns: list[int]
    spring: float = 0.0

    @classmethod
    def reduced(cls, full: PETSc.Mat, reduction: Reduction) -> Stiffness:
        """Stiffness P^T K P of the free unknowns, with the map P of the reduction; full: stiffness
        K on all dofs, N/mm, whose storage is reused, so that it must not be used afterwards
        (collective).
        """
        p, columns = reduction.matrix, reduction.columns
        free = p.createVecRight()
        free.array[:] = reduction.free
        moved = [p * unit_vector(free, place) for place in reduction.places]
        forces = [transposed(p, (full * each).array) for each in moved]
        blocks = full if reduction.aligned else _rotated(full, p, free)
        blocks.diagonalScale(L=free, R=free)
        diagonal = blocks.getDiagonal()
        typical = diagonal.sum() / free.sum()
        empty = ~reduction.free
        empty[[place for place in reduction.places if place >= 0]] = False
        diagonal.array[empty] = typical
        blocks.setDiagonal(diagonal)
        blocks.assemble()
        blocks.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        hubs = PETSc.Mat().createAIJ(p.getSizes(), nnz=1, comm=p.comm)
        hubs.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        out = cls(blocks.convert("sbaij", PETSc.Mat()), hubs, columns)
        out._couple(forces)
        return out

    def _couple(self, forces: list[PETSc.Vec]) -> None:
        """Add the force on all unknowns per unit motion of each hub, N/mm, as rows and columns; a
        column leaves out the motions of hubs, which have rows of their own (collective).
        """
        for column, force in zip(self.columns, forces, strict=True):
            near = np.flatnonzero(force.array)
            values, places = force.array[near], (near + force.owner_range[0]).astype(PETSc.IntType)
            nodal = ~np.isin(places, self.columns)
            self.hubs.setValues([column], places, values, addv=True)
            self.hubs.setValues(places[nodal], [column], values[nodal], addv=True)
        self.hubs.assemble()

    def copy(self) -> Stiffness:
        """The same stiffness, stored anew (collective)."""
        return replace(self, blocks=self.blocks.copy(), hubs=self.hubs.copy())

    def add(self, rows: PETSc.Mat, weights: Array) -> None:
        """Add rows^T diag(weights) rows to the stiffness, in place (collective).

        rows: matrix with k rows on this rank, each with entries at the unknowns of one cell's nodes
            and at the motions of hubs. weights: (k,); the sum is in N/mm.
        """
        table = local_rows(rows)
        moved = [table[:, column].toarray().ravel() for column in self.columns]
        self._couple([transposed(rows, weights * each) for each in moved])
        table.data[np.isin(table.indices, self.columns)] = 0.0
        table.eliminate_zeros()
        size = self.blocks.getBlockSize()
        added = (table.T @ sp.diags(weights) @ table).tobsr((size, size))
        rows_of_blocks = np.repeat(np.arange(len(added.indptr) - 1), np.diff(added.indptr))
        places = (each[:, None].astype(PETSc.IntType) for each in (rows_of_blocks, added.indices))
        self.blocks.setOption(PETSc.Mat.Option.IGNORE_LOWER_TRIANGULAR, True)
        if added.nnz:  # PETSc divides by their number
            self.blocks.setValuesBlockedRCV(*places, added.data, addv=True)
        self.blocks.assemble()

    @property
    def comm(self) -> PETSc.Comm:
        """PETSc communicator of the ranks that hold the stiffness."""
        return self.blocks.comm

    def vector(self) -> PETSc.Vec:
        """Zero vector of the free unknowns, distributed as the matrix is."""
        out = self.blocks.createVecRight()
        out.set(0.0)
        return out

    def mult(self, x: PETSc.Vec, out: PETSc.Vec) -> None:
        """Write the product of the stiffness of the free unknowns with x into the vector `out`
        (collective).
        """
        self.blocks.mult(x, out)
        self.hubs.multAdd(x, out, out)

    def __mul__(self, x: PETSc.Vec) -> PETSc.Vec:
        """Product of the stiffness of the free unknowns with x, as a new vector (collective)."""
        out = x.duplicate()
        self.mult(x, out)
        return out

    def diagonal(self) -> PETSc.Vec:
        """Diagonal of the stiffness of the free unknowns as a new vector, N/mm; motions of hubs are
        included.
        """
        return self.blocks.getDiagonal() + self.hubs.getDiagonal()

    @property
    def typical(self) -> float:
        """Mean of the diagonal of the blocks over all rows of all ranks, N/mm (collective)."""
        return float(self.blocks.getDiagonal().sum() / self.blocks.getSize()[0])

    def pinned(self, spring: float) -> Stiffness:
        """The same stiffness with a spring (N/mm) on the motion of the first hub; unchanged where
        no hub is free (collective).
        """
        if not self.columns or not spring:
            return self
        hubs, column = self.hubs.copy(), self.columns[0]
        if self.comm.rank == 0:
            hubs.setValue(column, column, spring, addv=True)
        hubs.assemble()
        return replace(self, hubs=hubs, spring=spring)

    def assembled(self) -> PETSc.Mat:
        """Stiffness of the free unknowns as one assembled matrix, N/mm, for a factorisation or
        multigrid (collective).
        """
        out = self.blocks.convert("aij", PETSc.Mat())
        out.setBlockSize(self.blocks.getBlockSize())
        out.axpy(1.0, self.hubs, DIFFERENT)
        return out


def unit_vector(like: PETSc.Vec, place: int) -> PETSc.Vec:
    """Vector with the layout of `like`, zero but for 1 at a local place; place -1: the place is on
    another rank.
    """
    out = like.duplicate()
    out.set(0.0)
    if place >= 0:
        out.array[place] = 1.0
    return out


def _rotated(full: PETSc.Mat, p: PETSc.Mat, free: PETSc.Vec) -> PETSc.Mat:
    """Stiffness on all dofs, turned into the directions of the unknowns of each node, N/mm; places
    without an unknown keep the axes of the mesh (collective).

    full: stiffness on all dofs, N/mm. p: map from free unknowns to dofs. free: 1 at places that
        hold an unknown of a node, 0 elsewhere.
    """
    nodes, size, rest = p.copy(), full.getBlockSize(), free.duplicate()
    nodes.diagonalScale(R=free)
    rest.array[:] = 1.0 - free.array
    axes = PETSc.Mat().createAIJ(p.getSizes(), nnz=1, comm=p.comm)
    axes.setDiagonal(rest)
    axes.assemble()
    nodes.axpy(1.0, axes, DIFFERENT)
    turned = full.convert("aij").ptap(nodes)
    turned.setBlockSize(size)
    return turned.convert("baij")


@dataclass(frozen=True)
class SupportReactions:
    """Rows of the stiffness matrix on all dofs that belong to the nodes of fixed faces and hub.

    rows: local numbers (k,) of the dofs that the rows belong to.
    matrix: the rows, distributed, N/mm.
    """

    rows: NDArray[np.int64]
    matrix: PETSc.Mat

    @classmethod
    def of(cls, stiffness: PETSc.Mat, nodes: NDArray[np.bool_], size: int = 3) -> SupportReactions:
        """Rows of a symmetric stiffness matrix for the marked nodes (n,) of this rank, with `size`
        dofs each (collective).
        """
        local = np.flatnonzero(np.repeat(nodes, size))
        return cls(local, select_rows(stiffness, local))

    def forces(self, prescribed: PETSc.Vec) -> PETSc.Vec:
        """Forces on all dofs, N, that hold a displacement (mm, on all dofs) which is zero off the
        supported nodes: the stiffness times that displacement.
        """
        return transposed(self.matrix, prescribed.array[self.rows])

    def at(self, displacement: PETSc.Vec) -> NDArray[np.float64]:
        """Elastic forces at the k supported dofs of this rank, N: the stiffness times a
        displacement on all dofs, mm.
        """
        return np.array((self.matrix * displacement).array)
