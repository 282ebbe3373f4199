"""Stiffness P^T K P of the free unknowns, and reactions at the supports.

Blocks of the upper half are stored. A product with them costs two thirds to three quarters of one
with all blocks, and that two thirds of one with single entries. The approach couples all nodes
beside the hub. That fits into no block and is kept as a vector.

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

from railhead.solver.space.operators import add_transposed, select_rows
from railhead.solver.space.supports import Reduction
from railhead.theory.array_types import Array

DIFFERENT = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN


@dataclass(frozen=True)
class Stiffness:
    """Stiffness P^T K P of the free unknowns, stored as blocks and a border:

        P^T K P x = blocks x + e (border . x) + border (e . x)

    P is the map from free unknowns to dofs, K the stiffness on all dofs, e the unit vector of the
    approach.

    blocks: stiffness of the nodes' unknowns, N/mm, a symmetric matrix of blocks (SBAIJ); places
        without an unknown have a typical diagonal.
    border: force on all unknowns per unit approach, but half of it on the approach itself, N/mm;
        None where the approach is prescribed.
    approach: local place of the approach; -1: on another rank, or the approach is prescribed.
    spring: stiffness on the approach that the border contains beside K, N/mm.
    """

    blocks: PETSc.Mat
    border: PETSc.Vec | None
    approach: int
    spring: float = 0.0

    @classmethod
    def reduced(cls, full: PETSc.Mat, reduction: Reduction) -> Stiffness:
        """Stiffness P^T K P of the free unknowns, with the map P of the reduction; full: stiffness
        K on all dofs, N/mm, whose storage is reused, so that it must not be used afterwards
        (collective).
        """
        p, border = reduction.matrix, None
        if reduction.columns:
            moved, pushed, border = p.createVecLeft(), p.createVecLeft(), p.createVecRight()
            unit = unit_vector(border, reduction.approach)
            p.mult(unit, moved)
            full.mult(moved, pushed)
            p.multTranspose(pushed, border)
            if reduction.approach >= 0:
                border.array[reduction.approach] /= 2
        free = p.createVecRight()
        free.array[:] = reduction.free
        blocks = full if reduction.aligned else _rotated(full, p, free)
        blocks.diagonalScale(L=free, R=free)
        diagonal = blocks.getDiagonal()
        typical = diagonal.sum() / free.sum()
        empty = ~reduction.free
        if reduction.approach >= 0:
            empty[reduction.approach] = False
        diagonal.array[empty] = typical
        blocks.setDiagonal(diagonal)
        blocks.assemble()
        blocks.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        return cls(blocks.convert("sbaij", PETSc.Mat()), border, reduction.approach)

    def copy(self) -> Stiffness:
        """The same stiffness, stored anew (collective)."""
        border = None if self.border is None else self.border.copy()
        return replace(self, blocks=self.blocks.copy(), border=border)

    def add(self, rows: PETSc.Mat, weights: Array) -> None:
        """Add rows^T diag(weights) rows to the stiffness, in place (collective).

        rows: matrix with k rows on this rank, each with entries at the unknowns of one cell's nodes
            and at the approach. weights: (k,); the sum is in N/mm.
        """
        start, indices, values = rows.getValuesCSR()
        table = sp.csr_matrix((values, indices, start), shape=(len(weights), rows.getSize()[1]))
        if self.border is not None:
            place, force = self._place, self.border.duplicate()
            force.set(0.0)
            add_transposed(rows, weights * table[:, place].toarray().ravel(), force)
            if self.approach >= 0:
                force.array[self.approach] /= 2
            self.border.axpy(1.0, force)
            table.data[table.indices == place] = 0.0
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
    def _place(self) -> int:
        """Global number of the approach among the free unknowns, on all ranks (collective)."""
        local = self.blocks.getOwnershipRange()[0] + self.approach if self.approach >= 0 else 0
        return int(self.comm.tompi4py().allreduce(local))

    @property
    def comm(self) -> PETSc.Comm:
        """PETSc communicator of the ranks that hold the stiffness."""
        return self.blocks.comm

    @property
    def sizes(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """((local, global) number of rows, (local, global) number of columns) of the stiffness of
        the free unknowns.
        """
        sizes: tuple[tuple[int, int], tuple[int, int]] = self.blocks.getSizes()
        return sizes

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
        if self.border is None:
            return
        here = self.approach >= 0
        local = [self.border.array @ x.array_r, x.array_r[self.approach] if here else 0.0]
        force, moved = self.comm.tompi4py().allreduce(np.array(local))
        out.axpy(moved, self.border)
        if here:
            out.array[self.approach] += force

    def __mul__(self, x: PETSc.Vec) -> PETSc.Vec:
        """Product of the stiffness of the free unknowns with x, as a new vector (collective)."""
        out = x.duplicate()
        self.mult(x, out)
        return out

    def diagonal(self) -> PETSc.Vec:
        """Diagonal of the stiffness of the free unknowns as a new vector, N/mm; the approach is
        included.
        """
        out = self.blocks.getDiagonal()
        if self.border is not None and self.approach >= 0:
            out.array[self.approach] += 2 * self.border.array[self.approach]
        return out

    @property
    def typical(self) -> float:
        """Mean of the diagonal of the blocks over all rows of all ranks, N/mm (collective)."""
        return float(self.blocks.getDiagonal().sum() / self.sizes[0][1])

    def pinned(self, spring: float) -> Stiffness:
        """The same stiffness with a spring (N/mm) on the approach; unchanged where the approach is
        prescribed.
        """
        if self.border is None or not spring:
            return self
        border = self.border.copy()
        if self.approach >= 0:
            border.array[self.approach] += spring / 2
        return replace(self, border=border, spring=spring)

    def assembled(self) -> PETSc.Mat:
        """Stiffness of the free unknowns as one assembled matrix, N/mm, for a factorisation or
        multigrid (collective).
        """
        out = self.blocks.convert("aij", PETSc.Mat())
        out.setBlockSize(self.blocks.getBlockSize())
        if self.border is None:
            return out
        place, (start, _) = self._place, self.border.owner_range
        near = np.flatnonzero(self.border.array)
        coupled = PETSc.Mat().createAIJ(self.sizes, nnz=1, comm=self.comm)
        coupled.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        places, values = (near + start).astype(PETSc.IntType), self.border.array[near]
        coupled.setValues([place], places, values, addv=True)
        coupled.setValues(places, [place], values, addv=True)
        coupled.assemble()
        out.axpy(1.0, coupled, DIFFERENT)
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
        held, out = self.matrix.createVecLeft(), prescribed.duplicate()
        held.array[:] = prescribed.array[self.rows]
        self.matrix.multTranspose(held, out)
        return out

    def at(self, displacement: PETSc.Vec) -> NDArray[np.float64]:
        """Elastic forces at the k supported dofs of this rank, N: the stiffness times a
        displacement on all dofs, mm.
        """
        return np.array((self.matrix * displacement).array)
