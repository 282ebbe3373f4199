"""Linear solvers of the contact tangent: Krylov methods, and preconditioners that follow the active
set.

Small problems are factorised (MUMPS), linear cells go to algebraic multigrid (GAMG), and quadratic
ones to p-multigrid (`solver.algebra.multigrid`).
"""

from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.problem import ContactProblem
from railhead.theory.array_types import Mask

KRYLOV_LIMIT = 150  # iterations of one linear solve
LARGEST_RESIDUAL = {"nitsche": 0.1, "penalty": 1e-3}  # of the right-hand side, that any linear
# solve may leave. The tangent of a penalty is stiffer: with a larger one Newton's method wanders
# from one active set to the next (linear tetrahedra, 142 000 unknowns: 15 Newton steps and 329
# Krylov iterations with a tenth, 5 and 137 with a thousandth).
NO_MEMORY = 55  # PETSc's error
NOT_ALLOCATED = -5, -7, -13, -19  # INFOG(1) of MUMPS where memory is missing


class StalledError(RuntimeError):
    """Raised where a linear solve fails; the text says why.

    iterations: number of Krylov iterations until then.
    """

    def __init__(self, iterations: int, text: str) -> None:
        super().__init__(text)
        self.iterations = iterations


def stalled(error: StalledError | PETSc.Error) -> StalledError:
    """An error of a linear solve; one of PETSc with its number and its last line. One of memory is
    raised again.
    """
    if isinstance(error, StalledError):
        return error
    if error.ierr == NO_MEMORY:
        raise error
    last = str(error).splitlines()[-1].partition("] ")
    return StalledError(0, f"PETSc's error {error.ierr}: {last[2] or last[0]}")


class Preconditioner(ABC):
    """Approximation of the inverse of the tangent of a problem at one active set. n is the number
    of contact points of this rank.

    problem: the contact problem.
    pc: the PETSc preconditioner; None before it is set up.
    operator: matrix that it was made for; None before that.
    state: state of the contact points that it was made for (`ContactProblem.branches`); None before
        that.
    flexible: whether it contains a Krylov method, so that it changes between iterations.
    outdated_share: area whose state has changed since the set-up, over the active area, beyond
        which it is set up again.
    """

    state: Mask | None = None
    pc: PETSc.PC | None = None
    operator: PETSc.Mat | None = None
    flexible: bool = False
    outdated_share: float = 0.1

    def __init__(self, problem: ContactProblem) -> None:
        self.problem = problem

    def update_if_outdated(self, active: Mask) -> bool:
        """Set up for these active points (n,), unless the last set-up was for almost the same area;
        returns whether it was set up (collective).
        """
        state, area = self.problem.branches(active), self.problem.area
        if self.state is not None:
            differs = (state != self.state).any(axis=0)
            local = np.array([area[differs].sum(), area[active].sum()])
            changed, touching = self.problem.stiffness.comm.tompi4py().allreduce(local)
            if not touching or changed <= self.outdated_share * touching:
                return False  # without contact the tangent may be singular
        self.rebuild(active)
        return True

    def rebuild(self, active: Mask) -> None:
        """Set up for exactly these active points (n,); matrices of the last set-up are freed
        (collective).
        """
        self.pc = self.operator = None
        compat.collect(self.problem.stiffness.comm.tompi4py())
        self.set_up(active)
        self.state = self.problem.branches(active)

    def start(self, operator: PETSc.Mat) -> PETSc.PC:
        """New PETSc preconditioner of a matrix; both become the fields `pc` and `operator`."""
        self.operator, self.pc = operator, PETSc.PC().create(operator.comm)
        self.pc.setOperators(operator)
        return self.pc

    @abstractmethod
    def set_up(self, active: Mask) -> None:
        """Make `pc` and `operator` for the tangent at these active points (n,) (collective)."""


class Direct(Preconditioner):
    """Preconditioner that factorises the tangent by MUMPS: Cholesky, or LU where the contact law is
    not symmetric. Its fields are those of `Preconditioner`.
    """

    def set_up(self, active: Mask) -> None:
        """Assemble and factorise the tangent at these active points (n,) (collective)."""
        pc = self.start(self.problem.assembled_tangent(active))
        factorise(pc, self.problem.law.symmetric)


class Algebraic(Preconditioner):
    """Preconditioner by smoothed aggregation multigrid (PETSc's GAMG). The other fields are those
    of `Preconditioner`.

    rigid_modes: list of orthonormal vectors, the rigid motions of the bodies in the free unknowns;
        they are the near-nullspace.
    """

    def __init__(self, problem: ContactProblem, rigid_modes: list[PETSc.Vec]) -> None:
        super().__init__(problem)
        self.rigid_modes = rigid_modes

    def set_up(self, active: Mask) -> None:
        """Assemble the tangent at these active points (n,) and build the multigrid levels
        (collective).
        """
        operator = self.problem.assembled_tangent(active)
        near_nullspace(operator, self.rigid_modes)
        pc = self.start(operator)
        pc.setType("gamg")
        pc.setUp()


def factorise(pc: PETSc.PC, symmetric: bool) -> None:
    """Factorise the operator of a PETSc preconditioner by MUMPS: Cholesky where `symmetric`,
    otherwise LU (collective). MemoryError: memory is missing.
    """
    pc.setType("cholesky" if symmetric else "lu")
    pc.setFactorSolverType("mumps")
    pc.setUp()
    if pc.getFactorMatrix().getMumpsInfog(1) in NOT_ALLOCATED:
        raise MemoryError("MUMPS cannot factorise the matrix")


def near_nullspace(matrix: PETSc.Mat, rigid_modes: list[PETSc.Vec]) -> None:
    """Attach rigid motions to a matrix as its near-nullspace, for algebraic multigrid; rigid_modes:
    orthonormal vectors.
    """
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=rigid_modes, comm=matrix.comm))


def krylov(problem: ContactProblem, preconditioner: Preconditioner) -> PETSc.KSP:
    """Krylov method for a problem: conjugate gradients, or GMRES with the preconditioner on the
    right where the tangent is not symmetric; the flexible variant where the preconditioner
    contains a Krylov method.
    """
    symmetric = problem.symmetric
    ksp = PETSc.KSP().create(problem.stiffness.comm)
    ksp.setType(("f" if preconditioner.flexible else "") + ("cg" if symmetric else "gmres"))
    if not symmetric:
        ksp.setPCSide(PETSc.PC.Side.RIGHT)
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    return ksp


def convergence_test(
    least: float, most: float, enough: Callable[[PETSc.Vec], float]
) -> Callable[[PETSc.KSP, int, float], int]:
    """Convergence test of conjugate gradients, which have the solution x in every iteration: from
    the number of the iteration and the residual to PETSc's reason. All residuals are norms, N.

    least: residual at or below which the solve ends in any case.
    most: residual above which the solve goes on.
    enough: x -> residual that suffices at x; between `least` and `most` the solve ends at or below
        it, but not before the first iteration.
    """
    reason = PETSc.KSP.ConvergedReason

    def test(ksp: PETSc.KSP, iteration: int, residual: float) -> int:
        """PETSc's convergence reason, as an integer."""
        if not np.isfinite(residual):
            return int(reason.DIVERGED_NANORINF)
        suffices = iteration and residual <= most
        if residual <= least or (suffices and residual <= enough(ksp.getSolution())):
            return int(reason.CONVERGED_RTOL)
        return int(reason.ITERATING)

    return test


def solve(
    problem: ContactProblem,
    preconditioner: Preconditioner,
    active: Mask,
    rhs: PETSc.Vec,
    out: PETSc.Vec,
    rtol: float,
    enough: Callable[[PETSc.Vec], float] | None = None,
) -> int:
    """Solve a linear system with the tangent at these active points (n,); returns the number of
    Krylov iterations (collective).

    problem: contact problem whose tangent is used.
    preconditioner: set up again where it is outdated or where the solve does not converge.
    rhs: right-hand side in the free unknowns, N.
    out: vector that the solution is written into; the iterations start from zero.
    rtol: tolerance of the residual, relative to the norm of the right-hand side.
    enough: x -> norm of the residual (N) that suffices at x. At most the share LARGEST_RESIDUAL of
        the right-hand side counts. Without effect where the tangent is not symmetric; None: `rtol`
        alone decides.
    Raises StalledError where conjugate gradients meet a tangent that is not positive definite, or
    where even a preconditioner for exactly these points does not converge.
    """
    fresh = preconditioner.update_if_outdated(active)
    operator = problem.tangent(active)
    ksp = krylov(problem, preconditioner)
    iterations = 0
    ksp.setTolerances(rtol=rtol, atol=0.0, max_it=KRYLOV_LIMIT)
    norm = rhs.norm()
    if enough is not None and problem.symmetric:
        ksp.setConvergenceTest(
            convergence_test(rtol * norm, LARGEST_RESIDUAL[problem.law.method] * norm, enough)
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
        if fresh:
            raise StalledError(iterations, "the linear solver stalls")
        preconditioner.rebuild(active)
        fresh = True
    compat.collect(problem.stiffness.comm.tompi4py())
    return iterations
