"""Preconditioners for the contact stiffness: MUMPS, p-multigrid, and p-multigrid over GAMG."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

DIRECT_BELOW = 12_000  # unknowns; below, a factorisation is the cheapest preconditioner
COARSE_DIRECT_BELOW = 20_000  # unknowns of the P1 level


@dataclass(frozen=True)
class Hierarchy:
    """Prolongation of the P1 unknowns to the unknowns of the problem, and its near-nullspace."""

    prolongation: PETSc.Mat
    rigid_modes: list[PETSc.Vec]


def direct(matrix: PETSc.Mat, symmetric: bool) -> PETSc.PC:
    """MUMPS Cholesky, or LU."""
    pc = PETSc.PC().create(matrix.comm)
    pc.setOperators(matrix)
    pc.setType("cholesky" if symmetric else "lu")
    pc.setFactorSolverType("mumps")
    pc.setUp()
    return pc


def multigrid(matrix: PETSc.Mat, hierarchy: Hierarchy, symmetric: bool) -> PETSc.PC:
    """p-multigrid: Chebyshev-Jacobi on the fine level, Galerkin P1 operator below."""
    pc = PETSc.PC().create(matrix.comm)
    pc.setOperators(matrix)
    pc.setType("mg")
    pc.setMGLevels(2)
    pc.setMGInterpolation(1, hierarchy.prolongation)
    smoother = pc.getMGSmoother(1)
    smoother.setType("chebyshev")
    smoother.getPC().setType("jacobi")
    smoother.setTolerances(max_it=3)
    smoother.setOperators(matrix, matrix)

    coarse_matrix = _with_full_diagonal(matrix.ptap(hierarchy.prolongation))
    coarse = pc.getMGCoarseSolve()
    coarse.setType("preonly")
    coarse.setOperators(coarse_matrix, coarse_matrix)
    if coarse_matrix.getSize()[0] < COARSE_DIRECT_BELOW:
        coarse.getPC().setType("cholesky" if symmetric else "lu")
        coarse.getPC().setFactorSolverType("mumps")
    else:
        _near_nullspace(coarse_matrix, hierarchy.rigid_modes)
        # One V-cycle solves the coarse problem too loosely: the iterations grew sixfold at 1e6
        # unknowns. A few of CG's steps around it keep them where a direct coarse solver has them.
        coarse.setType("cg" if symmetric else "gmres")
        coarse.setTolerances(rtol=0.1, max_it=10)
        coarse.getPC().setType("gamg")
    pc.setUp()
    return pc


def _with_full_diagonal(matrix: PETSc.Mat) -> PETSc.Mat:
    """The matrix with a typical value on the diagonal of its empty rows, in blocks of three."""
    diagonal = matrix.getDiagonal()
    typical = diagonal.sum() / diagonal.getSize()
    values = np.where(diagonal.array == 0.0, typical, 0.0)
    diagonal.array[:] = values
    extra = PETSc.Mat().createAIJ(matrix.getSizes(), nnz=1, comm=matrix.comm)
    extra.setDiagonal(diagonal)
    extra.assemble()
    matrix.axpy(1.0, extra, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    matrix.setBlockSize(3)
    return matrix


def algebraic(matrix: PETSc.Mat, rigid_modes: list[PETSc.Vec]) -> PETSc.PC:
    """Smoothed aggregation (GAMG) with the rigid motions as near-nullspace."""
    _near_nullspace(matrix, rigid_modes)
    pc = PETSc.PC().create(matrix.comm)
    pc.setOperators(matrix)
    pc.setType("gamg")
    pc.setUp()
    return pc


def _near_nullspace(matrix: PETSc.Mat, rigid_modes: list[PETSc.Vec]) -> None:
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=rigid_modes, comm=matrix.comm))


def krylov(comm: PETSc.Comm, pc: PETSc.PC, symmetric: bool) -> PETSc.KSP:
    """CG (or GMRES) with a given preconditioner, flexible where that holds a Krylov method."""
    varies = pc.getType() == "mg" and pc.getMGCoarseSolve().getType() != "preonly"
    ksp = PETSc.KSP().create(comm)
    ksp.setType(("f" if varies else "") + ("cg" if symmetric else "gmres"))
    ksp.setPC(pc)
    if not symmetric:
        ksp.setPCSide(PETSc.PC.Side.RIGHT)
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    return ksp
