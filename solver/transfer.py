"""From the P1 unknowns to the unknowns of the problem: the prolongation of p-multigrid."""

from __future__ import annotations

from typing import Any

import basix
import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.constraints import Reduction, petsc_matrix
from railhead.solver.facets import Array, tabulate
from railhead.solver.kinematics import SOLID, Kinematics


def interpolation(coarse: Any, fine: Any, degree: int) -> PETSc.Mat:
    """P1 -> P`degree` interpolation of vector fields, distributed; exact as the spaces nest."""
    cell = compat.cell_type(fine.mesh)
    element = basix.create_element(
        basix.ElementFamily.P,
        getattr(basix.CellType, cell),
        degree,
        basix.LagrangeVariant.gll_warped,
    )
    phi = tabulate(cell, 1, np.asarray(element.points))[0]
    fine_dofs, coarse_dofs = compat.cell_dofs(fine), compat.cell_dofs(coarse)
    fine_map, coarse_map = fine.dofmap.index_map, coarse.dofmap.index_map
    # Each fine dof takes its row from one cell that holds it; all cells agree.
    count = fine_map.size_local
    owner = np.full(count + fine_map.num_ghosts, -1, dtype=np.int64)
    place = np.zeros_like(owner)
    owner[fine_dofs] = np.arange(len(fine_dofs))[:, None]
    place[fine_dofs] = np.arange(fine_dofs.shape[1])
    owner, place = owner[:count], place[:count]
    ghosted = np.arange(coarse_map.size_local + coarse_map.num_ghosts, dtype=np.int32)
    to_global = np.asarray(coarse_map.local_to_global(ghosted))
    rows = np.repeat(np.arange(count), phi.shape[1])
    columns = to_global[coarse_dofs[owner]].ravel()
    values = phi[place].ravel()
    keep = np.abs(values) > 1e-12
    table = sp.csr_matrix(
        (values[keep], (rows[keep], columns[keep])), shape=(count, coarse_map.size_global)
    )
    dim = fine.mesh.geometry.dim
    blocks = sp.kron(table, sp.identity(dim), format="csr")
    return petsc_matrix(blocks, dim * coarse_map.size_local, fine.mesh.comm)


def reduced_prolongation(full: PETSc.Mat, fine: Reduction, coarse: Reduction) -> PETSc.Mat:
    """Q with P_fine Q = I P_coarse: (P_fine^T P_fine)^-1 P_fine^T I P_coarse."""
    q = fine.matrix.transposeMatMult(full.matMult(coarse.matrix))
    scale = fine.norms()
    # A rigid body's approach moves no node: it is carried over as it is.
    if fine.approach >= 0 and scale.array[fine.approach] == 0.0:
        scale.array[fine.approach] = 1.0
        row = scale.owner_range[0] + fine.approach
        column = q.getOwnershipRangeColumn()[0] + coarse.approach
        q = _with_entry(q, row, column)
    elif fine.rigid_approach:
        q = _with_entry(q, -1, -1)
    scale.reciprocal()
    q.diagonalScale(L=scale)
    return q


def _with_entry(matrix: PETSc.Mat, row: int, column: int) -> PETSc.Mat:
    """matrix with a 1 at (row, column) if row >= 0 (collective)."""
    extra = PETSc.Mat().createAIJ(matrix.getSizes(), nnz=1, comm=matrix.comm)
    if row >= 0:
        extra.setValue(row, column, 1.0)
    extra.assemble()
    matrix.axpy(1.0, extra, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    return matrix


def rigid_modes(
    points: Array, reduction: Reduction, kinematics: Kinematics = SOLID
) -> list[PETSc.Vec]:
    """Orthonormal rigid motions in the reduced unknowns, for algebraic multigrid.

    points: (n, c) of the owned block dofs.
    """
    scale = reduction.norms()
    scale.array[:] = np.where(scale.array > 0, scale.array, 1.0)
    centred = points - points.mean(axis=0) if len(points) else points
    modes: list[PETSc.Vec] = []
    for field in kinematics.rigid_motions(centred):
        full, mode = reduction.matrix.createVecLeft(), reduction.matrix.createVecRight()
        full.array[:] = field.ravel()
        reduction.matrix.multTranspose(full, mode)
        mode.pointwiseDivide(mode, scale)
        for other in modes:
            mode.axpy(-mode.dot(other), other)
        if mode.norm() > 1e-8 * full.norm():
            mode.normalize()
            modes.append(mode)
    return modes
