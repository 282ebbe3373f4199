"""P^T K P in blocks of a node, the approach as a border.

A product with whole blocks costs two thirds of one with single entries. What the approach couples,
all nodes beside the hub, fits into no block and is kept as a vector.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from petsc4py import PETSc

from railhead.solver.space.constraints import Reduction

DIFFERENT = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN


@dataclass(frozen=True)
class Stiffness:
    """P^T K P x = blocks x + e (border . x) + border (e . x), with e the approach.

    blocks: of the unknowns of nodes, with a typical diagonal where a place holds none (N/mm);
    border: force on all unknowns where the approach moves by 1, half of that on itself (N/mm);
    approach: its place on this rank (-1: not here). Without a border the approach is given.
    spring: what is in the border beside K, N/mm.
    """

    blocks: PETSc.Mat
    border: PETSc.Vec | None
    approach: int
    spring: float = 0.0

    @classmethod
    def reduced(cls, full: PETSc.Mat, reduction: Reduction) -> Stiffness:
        """Of a K on all dofs, which is used up."""
        p, border = reduction.matrix, None
        if reduction.column >= 0:
            moved, pushed, border = p.createVecLeft(), p.createVecLeft(), p.createVecRight()
            unit = _at(border, reduction.approach, 1.0)
            p.mult(unit, moved)
            full.mult(moved, pushed)
            p.multTranspose(pushed, border)
            if reduction.approach >= 0:
                border.array[reduction.approach] /= 2
        free = p.createVecRight()
        free.array[:] = reduction.free
        blocks = full if reduction.aligned else _turned(full, p, free)
        blocks.diagonalScale(L=free, R=free)
        diagonal = blocks.getDiagonal()
        typical = diagonal.sum() / free.sum()
        empty = ~reduction.free
        if reduction.approach >= 0:
            empty[reduction.approach] = False
        diagonal.array[empty] = typical
        blocks.setDiagonal(diagonal)
        blocks.assemble()
        return cls(blocks, border, reduction.approach)

    @property
    def comm(self) -> PETSc.Comm:
        """That of the matrix."""
        return self.blocks.comm

    @property
    def sizes(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """Local and global rows, and columns."""
        sizes: tuple[tuple[int, int], tuple[int, int]] = self.blocks.getSizes()
        return sizes

    def vector(self) -> PETSc.Vec:
        """Of the unknowns, zero."""
        out = self.blocks.createVecRight()
        out.set(0.0)
        return out

    def mult(self, x: PETSc.Vec, out: PETSc.Vec) -> None:
        """out = P^T K P x."""
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
        out = x.duplicate()
        self.mult(x, out)
        return out

    def diagonal(self) -> PETSc.Vec:
        """Of the matrix, N/mm."""
        out = self.blocks.getDiagonal()
        if self.border is not None and self.approach >= 0:
            out.array[self.approach] += 2 * self.border.array[self.approach]
        return out

    @property
    def typical(self) -> float:
        """Mean of the diagonal, N/mm."""
        return float(self.blocks.getDiagonal().sum() / self.sizes[0][1])

    def pinned(self, spring: float) -> Stiffness:
        """With a spring (N/mm) on the approach, where that is free."""
        if self.border is None or not spring:
            return self
        border = self.border.copy()
        if self.approach >= 0:
            border.array[self.approach] += spring / 2
        return replace(self, border=border, spring=spring)

    def assembled(self) -> PETSc.Mat:
        """One matrix, for a factorisation."""
        out = self.blocks.convert("aij", PETSc.Mat())
        out.setBlockSize(self.blocks.getBlockSize())
        if self.border is None:
            return out
        comm, (start, _) = self.comm.tompi4py(), self.border.owner_range
        place = comm.allreduce(start + self.approach if self.approach >= 0 else 0)
        near = np.flatnonzero(self.border.array)
        coupled = PETSc.Mat().createAIJ(self.sizes, nnz=1, comm=self.comm)
        coupled.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        places, values = (near + start).astype(PETSc.IntType), self.border.array[near]
        coupled.setValues([place], places, values, addv=True)
        coupled.setValues(places, [place], values, addv=True)
        coupled.assemble()
        out.axpy(1.0, coupled, DIFFERENT)
        return out


def _at(like: PETSc.Vec, place: int, value: float) -> PETSc.Vec:
    """A vector of zeros but for one value at a place of this rank (none: -1)."""
    out = like.duplicate()
    out.set(0.0)
    if place >= 0:
        out.array[place] = value
    return out


def _turned(full: PETSc.Mat, p: PETSc.Mat, free: PETSc.Vec) -> PETSc.Mat:
    """K in the directions that P gives the nodes; places without an unknown keep their axes."""
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
