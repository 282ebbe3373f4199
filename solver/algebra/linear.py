"""Linear solvers of the contact tangent: a preconditioner that follows the active set, and Krylov.

Small problems are factorised (MUMPS), linear cells go to algebraic multigrid (GAMG); quadratic
ones to p-multigrid (`solver.multigrid`).
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
FORCING = {"nitsche": 0.1, "penalty": 1e-3}  # what any linear solve must reach of its right-hand
# side: a penalty's tangent is stiffer, and with less it wanders from one active set to the next
# (linear tetrahedra, 142 000 unknowns: 15 Newton steps and 329 Krylov iterations with a tenth, 5
# and 137 with a thousandth)
SLOWER = 2  # times the pace right after a set-up, beyond which the next linear solve gets a new one
EPSILON = np.finfo(float).eps  # of the right-hand side: a residual below it is rounding


class StalledError(RuntimeError):
    """A linear solve failed after some iterations; the text says why."""

    def __init__(self, iterations: int, text: str) -> None:
        super().__init__(text)
        self.iterations = iterations


class Preconditioner(ABC):
    """Approximates the tangent of a problem at one active set; set up again when that is stale.

    operator: the matrix the PC was made for; flexible: it holds a Krylov method itself; stale:
    change of the active area since the set-up, over that area, that calls for a new one; pace:
    Krylov iterations a decade of the residual right after the set-up, at least one.
    """

    pc: PETSc.PC | None = None
    operator: PETSc.Mat | None = None
    flexible: bool = False
    stale: float = 0.1
    pace: float = np.inf

    def __init__(self, problem: ContactProblem) -> None:
        self.problem = problem
        self.active: Mask | None = None

    def suit(self, active: Mask) -> bool:
        """Set up for these active points unless it was for almost the same; whether it did."""
        if self.active is not None:
            area = self.problem.weight * self.problem.tau
            local = np.array([area[active != self.active].sum(), area[active].sum()])
            changed, touching = self.problem.stiffness.comm.tompi4py().allreduce(local)
            if changed <= self.stale * touching:
                return False
        self.renew(active)
        return True

    def renew(self, active: Mask) -> None:
        """Set up for exactly these active points; the last set-up is given back before."""
        self.pc = self.operator = None
        compat.collect(self.problem.stiffness.comm.tompi4py())
        self.set_up(active)
        self.active = active

    @abstractmethod
    def set_up(self, active: Mask) -> None:
        """Make `pc` and `operator` for the tangent at these active points."""


class Direct(Preconditioner):
    """MUMPS: Cholesky, or LU."""

    def set_up(self, active: Mask) -> None:
        self.operator = self.problem.assembled_tangent(active)
        self.pc = PETSc.PC().create(self.operator.comm)
        self.pc.setOperators(self.operator)
        factorise(self.pc, self.problem.law.symmetric)
        self.pc.setUp()


class Algebraic(Preconditioner):
    """Smoothed aggregation (GAMG) with the rigid motions as near-nullspace."""

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
    """Let MUMPS be the preconditioner."""
    pc.setType("cholesky" if symmetric else "lu")
    pc.setFactorSolverType("mumps")


def near_nullspace(matrix: PETSc.Mat, rigid_modes: list[PETSc.Vec]) -> None:
    """Tell algebraic multigrid the rigid motions."""
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=rigid_modes, comm=matrix.comm))


def krylov(problem: ContactProblem, preconditioner: Preconditioner) -> PETSc.KSP:
    """CG (or GMRES), flexible where the preconditioner holds a Krylov method."""
    symmetric = problem.symmetric
    ksp = PETSc.KSP().create(problem.stiffness.comm)
    ksp.setType(("f" if preconditioner.flexible else "") + ("cg" if symmetric else "gmres"))
    if not symmetric:
        ksp.setPCSide(PETSc.PC.Side.RIGHT)
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    return ksp


class _Enough:
    """Convergence test of conjugate gradients, whose solution is at hand in every iteration."""

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


def general(ksp: PETSc.KSP) -> None:
    """From conjugate gradients to GMRES, which needs no definite preconditioner."""
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
    """Solve with the tangent at these active points; returns the Krylov iterations.

    enough: x -> a residual (N) that conjugate gradients need not fall below at x. Raises
    StalledError where even a preconditioner for exactly these points does not get there.
    """
    fresh = preconditioner.suit(active)
    operator = problem.tangent(active)
    ksp = krylov(problem, preconditioner)
    iterations = 0
    ksp.setTolerances(rtol=rtol, atol=0.0, max_it=KRYLOV_LIMIT)
    norm = rhs.norm()
    if enough is not None and problem.symmetric:
        ksp.setConvergenceTest(_Enough(rtol * norm, FORCING[problem.law.method] * norm, enough))
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
            general(ksp)  # a smoother whose largest eigenvalue was underestimated
            continue
        if fresh:
            raise StalledError(iterations, "the linear solver stalls")
        preconditioner.renew(active)
        fresh = True
    taken = int(ksp.getIterationNumber())  # with the last set-up
    decades = -np.log10(max(ksp.getResidualNorm() / norm, EPSILON)) if taken else np.inf
    pace = max(1.0, taken / decades)
    if fresh:
        preconditioner.pace = pace
    elif pace > SLOWER * preconditioner.pace:
        preconditioner.active = None
    compat.collect(problem.stiffness.comm.tompi4py())
    return iterations
