"""Prolongation and near-nullspace of p-multigrid."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from railhead.solver.space.cells import Array
from railhead.solver.space.constraints import Reduction
from railhead.solver.space.kinematics import SOLID, Kinematics


def reduced_prolongation(full: PETSc.Mat, fine: Reduction, coarse: Reduction) -> PETSc.Mat:
    """Prolongation Q = (P_f^T P_f)^-1 P_f^T I P_c between free unknowns, so that P_f Q = I P_c.

    full: interpolation I from all coarse dofs to all fine dofs. fine, coarse: reductions with the
        maps P_f and P_c from free unknowns to dofs. The approach of a rigid body is carried over
        unchanged.
    """
    q = fine.matrix.transposeMatMult(full.matMult(coarse.matrix))
    scale = fine.norms()
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
        Motions that the supports exclude are left out.
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
