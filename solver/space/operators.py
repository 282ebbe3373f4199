"""Constant operators of points on the displacement as sparse matrices."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.space.cells import Array, CellSet, Index
from railhead.solver.space.constraints import petsc_matrix


def assemble_rows(
    blocks: list[tuple[Index, Array]], count: int, local: int, total: int, comm: MPI.Intracomm
) -> PETSc.Mat:
    """Distributed matrix of `count` rows from blocks of (dofs, coefficients), (count, ...) each;
    local: dofs of this rank, total: of all."""
    places = [np.repeat(np.arange(count), d[0].size if count else 0) for d, _ in blocks]
    table = sp.csr_matrix(
        (
            np.concatenate([v.ravel() for _, v in blocks]),
            (np.concatenate(places), np.concatenate([d.ravel() for d, _ in blocks])),
        ),
        shape=(count, total),
    )
    return petsc_matrix(table, local, comm)


def assemble_strains(
    cells: CellSet, index: Index, reference: Array, local: int, comm: MPI.Intracomm
) -> tuple[PETSc.Mat, int]:
    """Strains at n reference points of cells, m rows each in Mandel's notation, and m."""
    values = cells.strains(index, reference)
    count, size = values.shape[:2]
    dim = cells.kinematics.dim
    dofs = dim * cells.dofs[index][:, :, None] + np.arange(dim)
    places = np.broadcast_to(np.arange(count * size).reshape(count, size, 1, 1), values.shape)
    columns = np.broadcast_to(dofs[:, None], values.shape)
    used = values != 0.0
    table = sp.csr_matrix(
        (values[used], (places[used], columns[used])),
        shape=(count * size, comm.allreduce(local)),
    )
    return petsc_matrix(table, local, comm), size


def vector(matrix: PETSc.Mat, values: Array) -> PETSc.Vec:
    """Values of this rank's rows as a distributed vector."""
    out = matrix.createVecLeft()
    out.array[:] = values.ravel()
    return out


def add_transposed(matrix: PETSc.Mat, values: Array, out: PETSc.Vec) -> None:
    """out += matrix^T values, of this rank's rows."""
    matrix.multTransposeAdd(vector(matrix, values), out, out)


def select_rows(matrix: PETSc.Mat, local: Index) -> PETSc.Mat:
    """Rows of a distributed matrix by their numbers (k,) on this rank, with all columns."""
    first, comm = matrix.getOwnershipRange()[0], matrix.comm
    own, end = matrix.getOwnershipRangeColumn()
    rows = PETSc.IS().createGeneral((local + first).astype(PETSc.IntType), comm=comm)
    return matrix.createSubMatrix(rows, PETSc.IS().createStride(end - own, own, 1, comm=comm))
