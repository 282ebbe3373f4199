"""Linear solvers of the contact tangent: Krylov methods, and preconditioners that follow the active
set.

Small problems are factorised (MUMPS), linear cells go to algebraic multigrid (GAMG), and quadratic
ones to p-multigrid (`solver.algebra.multigrid`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.problem import ContactProblem, Mask

DIRECT_BELOW = 12_000  # unknowns; below, a factorisation is the cheapest preconditioner
KRYLOV_LIMIT = 150  # iterations of one linear solve
LARGEST_RESIDUAL = {"nitsche": 0.1, "penalty": 1e-3}  # of the right-hand side, that any linear
# solve may leave. The tangent of a penalty is stiffer: with a larger one Newton's method wanders
# from one active set to the next (linear tetrahedra, 142 000 unknowns: 15 Newton steps and 329
# Krylov iterations with a tenth, 5 and 137 with a thousandth).
SLOWDOWN = 2  # growth of the iterations per decade after which the preconditioner is set up again
EPSILON = np.finfo(float).eps  # of the right-hand side: a residual below it is rounding


class StalledError(RuntimeError):
    """Raised where a linear solve fails.

    iterations: Krylov iterations until then. The text says why.
    """

    def __init__(self, iterations: int, text: str) -> None:
        super().__init__(text)
        self.iterations = iterations


class Preconditioner(ABC):
    """Approximates the tangent of a problem at one active set.

    pc: the PETSc preconditioner; None before it is set up.
    operator: the matrix that it was made for.
    active: the active set (n,) that it was made for; None: the next use sets it up anew.
    flexible: whether it holds a Krylov method, so that it changes between iterations.
    outdated_share: change of the active area since the set-up, over the active area, beyond which
        it is set up again.
    iterations_per_decade: Krylov iterations per decade of the residual right after the set-up, at
        least one.
    """

    pc: PETSc.PC | None = None
    operator: PETSc.Mat | None = None
    flexible: bool = False
    outdated_share: float = 0.1
    iterations_per_decade: float = np.inf

    def __init__(self, problem: ContactProblem) -> None:
        self.problem = problem
        self.active: Mask | None = None

    def update_if_outdated(self, active: Mask) -> bool:
        """Set up for these active points (n,), unless the last set-up was for almost the same.
        Returns whether it was set up (collective)."""
        if self.active is not None:
            area = self.problem.weight * self.problem.tau
            local = np.array([area[active != self.active].sum(), area[active].sum()])
            changed, touching = self.problem.stiffness.comm.tompi4py().allreduce(local)
            if changed <= self.outdated_share * touching:
                return False
        self.rebuild(active)
        return True

    def rebuild(self, active: Mask) -> None:
        """Set up for exactly these active points (n,); the last set-up is freed (collective)."""
        self.pc = self.operator = None
        compat.collect(self.problem.stiffness.comm.tompi4py())
        self.set_up(active)
        self.active = active

    @abstractmethod
    def set_up(self, active: Mask) -> None:
        """Make `pc` and `operator` for the tangent at these active points (n,)."""


class Direct(Preconditioner):
    """Factorisation by MUMPS: Cholesky, or LU where the law is not symmetric."""

    def set_up(self, active: Mask) -> None:
        self.operator = self.problem.assembled_tangent(active)
        self.pc = PETSc.PC().create(self.operator.comm)
        self.pc.setOperators(self.operator)
        factorise(self.pc, self.problem.law.symmetric)
        self.pc.setUp()


class Algebraic(Preconditioner):
    """Smoothed aggregation multigrid (GAMG) with the rigid motions as near-nullspace."""

    def __init__(self, problem: ContactProblem, rigid_modes: list[PETSc.Vec]) -> None:
        super().__init__(problem)
        self.rigid_modes = rigid_modes

    def set_up(self, active: Mask) -> None:
        self.operator = self.problem.assembled_tangent(active)
        near_nullspace(self.operator, self.rigid_modes)
        self.pc = PETSc.PC().create(self.operator.comm)
        self.pc.setOperators(self.operator)
        self.pc.setType("gamg")
        self.pc.setUp()


def factorise(pc: PETSc.PC, symmetric: bool) -> None:
    """Make a preconditioner a factorisation by MUMPS."""
    pc.setType("cholesky" if symmetric else "lu")
    pc.setFactorSolverType("mumps")


def near_nullspace(matrix: PETSc.Mat, rigid_modes: list[PETSc.Vec]) -> None:
    """Attach the rigid motions to a matrix, for algebraic multigrid."""
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=rigid_modes, comm=matrix.comm))


def krylov(problem: ContactProblem, preconditioner: Preconditioner) -> PETSc.KSP:
    """Conjugate gradients, or GMRES where the tangent is not symmetric; the flexible variant where
    the preconditioner holds a Krylov method."""
    symmetric = problem.symmetric
    ksp = PETSc.KSP().create(problem.stiffness.comm)
    ksp.setType(("f" if preconditioner.flexible else "") + ("cg" if symmetric else "gmres"))
    if not symmetric:
        ksp.setPCSide(PETSc.PC.Side.RIGHT)
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    return ksp


class ForcingTermTest:
    """Convergence test of conjugate gradients, which have the solution x in every iteration.

    least: residual (N) at which the solve ends in any case.
    most: residual above which it goes on.
    enough: x -> residual that suffices at x; in between, the solve ends at it.
    """

    def __init__(self, least: float, most: float, enough: Callable[[PETSc.Vec], float]) -> None:
        self.least, self.most, self.enough = least, most, enough

    def __call__(self, ksp: PETSc.KSP, iteration: int, residual: float) -> int:
        reason = PETSc.KSP.ConvergedReason
        if not np.isfinite(residual):
            return int(reason.DIVERGED_NANORINF)
        if residual <= self.least:
            return int(reason.CONVERGED_RTOL)
        if iteration and residual <= self.most and residual <= self.enough(ksp.getSolution()):
            return int(reason.CONVERGED_RTOL)
        return int(reason.ITERATING)


def switch_to_gmres(ksp: PETSc.KSP) -> None:
    """Turn conjugate gradients into flexible GMRES, which needs no definite preconditioner."""
    ksp.setType("fgmres")
    ksp.setConvergenceTest(None)
    ksp.setPCSide(PETSc.PC.Side.RIGHT)


def solve(
    problem: ContactProblem,
    preconditioner: Preconditioner,
    active: Mask,
    rhs: PETSc.Vec,
    out: PETSc.Vec,
    rtol: float,
    enough: Callable[[PETSc.Vec], float] | None = None,
) -> int:
    """Solve with the tangent at these active points (n,); returns the number of Krylov iterations.

    rhs, out: right-hand side and solution in the free unknowns.
    rtol: tolerance of the residual, relative to the right-hand side.
    enough: x -> residual (N) below which conjugate gradients need not go at x.
    Raises StalledError where even a preconditioner for exactly these points does not converge.
    """
    fresh = preconditioner.update_if_outdated(active)
    operator = problem.tangent(active)
    ksp = krylov(problem, preconditioner)
    iterations = 0
    ksp.setTolerances(rtol=rtol, atol=0.0, max_it=KRYLOV_LIMIT)
    norm = rhs.norm()
    if enough is not None and problem.symmetric:
        ksp.setConvergenceTest(
            ForcingTermTest(rtol * norm, LARGEST_RESIDUAL[problem.law.method] * norm, enough)
        )
    while True:
        ksp.setPC(preconditioner.pc)
        ksp.setOperators(operator, preconditioner.operator)
        ksp.solve(rhs, out)
        iterations += int(ksp.getIterationNumber())
        reason = ksp.getConvergedReason()
        if reason == PETSc.KSP.ConvergedReason.DIVERGED_INDEFINITE_MAT:
            raise StalledError(iterations, "the tangent is not positive definite")
        if reason > 0:
            break
        if reason == PETSc.KSP.ConvergedReason.DIVERGED_INDEFINITE_PC:
            switch_to_gmres(ksp)  # a smoother whose largest eigenvalue was underestimated
            continue
        if fresh:
            raise StalledError(iterations, "the linear solver stalls")
        preconditioner.rebuild(active)
        fresh = True
    taken = int(ksp.getIterationNumber())  # with the last set-up
    decades = -np.log10(max(ksp.getResidualNorm() / norm, EPSILON)) if taken else np.inf
    per_decade = max(1.0, taken / decades)
    if fresh:
        preconditioner.iterations_per_decade = per_decade
    elif per_decade > SLOWDOWN * preconditioner.iterations_per_decade:
        preconditioner.active = None
    compat.collect(problem.stiffness.comm.tompi4py())
    return iterations
