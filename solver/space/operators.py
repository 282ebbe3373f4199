"""Operators from displacements to values at points, as distributed sparse matrices."""

import numpy as np
import scipy.sparse as sp
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.space.cells import CellSet
from railhead.theory.array_types import Array, Index


def petsc_matrix(table: sp.csr_matrix, local_columns: int, comm: MPI.Intracomm) -> PETSc.Mat:
    """Distributed PETSc matrix (collective).

    table: rows of this rank, with global column numbers.
    local_columns: number of columns that this rank owns.
    """
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


def local_rows(matrix: PETSc.Mat) -> sp.csr_matrix:
    """Rows of this rank of a distributed matrix, with the columns of all ranks."""
    starts, columns, values = matrix.getValuesCSR()
    return sp.csr_matrix((values, columns, starts), shape=(len(starts) - 1, matrix.getSize()[1]))


def blockwise(blocks: Array, matrix: PETSc.Mat) -> PETSc.Mat:
    """Distributed matrix whose rows of each of n points are a block (a, b) times the b rows of a
    matrix there; blocks: (n, a, b) of this rank (collective).
    """
    count, *sizes = blocks.shape
    every = np.arange(count + 1)
    shape = count * sizes[0], count * sizes[1]
    table = sp.bsr_matrix((blocks, every[:-1], every), shape=shape).tocsr() @ local_rows(matrix)
    return petsc_matrix(table, matrix.getLocalSize()[1], matrix.comm.tompi4py())


def assemble_rows(
    blocks: list[tuple[Index, Array]], count: int, local: int, total: int, comm: MPI.Intracomm
) -> PETSc.Mat:
    """Distributed matrix from dofs to values, with `count` rows on this rank (collective).

    blocks: pairs (global dofs (count, ...), coefficients (count, ...)), of which no two have the
        same dof in a row.
    local: number of dofs that this rank owns. total: number of dofs of all ranks.
    """
    columns, values = (
        np.concatenate([a.reshape(count, int(np.prod(a.shape[1:]))) for a in part], axis=1)
        for part in zip(*blocks, strict=True)
    )
    starts = np.arange(count + 1) * columns.shape[1]
    table = sp.csr_matrix((values.ravel(), columns.ravel(), starts), shape=(count, total))
    return petsc_matrix(table, local, comm)


def assemble_strains(
    cells: CellSet, index: Index, reference: Array, local: int, comm: MPI.Intracomm
) -> tuple[PETSc.Mat, int]:
    """Distributed matrix that takes the displacement at all dofs, mm, to the strains at n points of
    this rank, and the number m of strain components at a point (collective).

    cells: cells that the points lie in. index: number of the cell of each point in that set (n,).
    reference: coordinates (n, c) of the points in the reference cell.
    local: number of dofs that this rank owns.
    Rows n m of this rank: the m components of a point follow each other, in Mandel's notation and
    in the order of `CellSet.strains`.
    """
    values = cells.strains(index, reference)
    count, size = values.shape[:2]
    dim = cells.kinematics.dim
    dofs = dim * cells.dofs[index][:, :, None] + np.arange(dim)
    columns = np.broadcast_to(dofs[:, None], values.shape)
    used = values != 0.0
    entries = np.count_nonzero(used, axis=(2, 3)).ravel()
    table = sp.csr_matrix(
        (values[used], columns[used], np.concatenate([[0], np.cumsum(entries)])),
        shape=(count * size, comm.allreduce(local)),
    )
    return petsc_matrix(table, local, comm), size


def vector(matrix: PETSc.Mat, values: Array) -> PETSc.Vec:
    """Distributed vector with the layout of a matrix's rows; values: values of this rank, of any
    shape with as many entries as local rows.
    """
    out = matrix.createVecLeft()
    out.array[:] = values.ravel()
    return out


def add_transposed(matrix: PETSc.Mat, values: Array, out: PETSc.Vec) -> None:
    """Add matrix^T values to the vector `out`; values: one for each of this rank's rows, of any
    shape (collective).
    """
    matrix.multTransposeAdd(vector(matrix, values), out, out)


def transposed(matrix: PETSc.Mat, values: Array) -> PETSc.Vec:
    """Product matrix^T values as a new vector; values: as of `add_transposed` (collective)."""
    out = matrix.createVecRight()
    matrix.multTranspose(vector(matrix, values), out)
    return out


def weighted_product(left: PETSc.Mat, weights: Array, right: PETSc.Mat) -> PETSc.Mat:
    """Distributed matrix left^T diag(weights) right; weights: one for each of this rank's rows
    (collective).
    """
    scaled = right.copy()
    scaled.diagonalScale(L=vector(right, weights))
    return left.transposeMatMult(scaled)


def select_rows(matrix: PETSc.Mat, local: Index) -> PETSc.Mat:
    """Distributed matrix of some rows of a matrix; local: local numbers (k,) of these rows on this
    rank (collective).
    """
    first, comm = matrix.getOwnershipRange()[0], matrix.comm
    own, end = matrix.getOwnershipRangeColumn()
    rows = PETSc.IS().createGeneral((local + first).astype(PETSc.IntType), comm=comm)
    return matrix.createSubMatrix(rows, PETSc.IS().createStride(end - own, own, 1, comm=comm))
