"""Semismooth Newton's method on the active set, with one preconditioner for all steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from petsc4py import PETSc
from scipy.optimize import brentq

from solver.facets import Array
from solver.linear import krylov
from solver.problem import ContactProblem, Mask

ROUNDING = 100 * np.finfo(float).eps  # of diag(K) y: what the residual cannot fall below
OVERSHOOT = 0.3  # slope past the minimum, relative to the slope at the start, that is let pass


@dataclass(frozen=True)
class Step:
    """State after one linear solve: residual relative to the contact force, size of the active set
    (all ranks), Krylov iterations, step length of the line search."""

    residual: float
    active: int
    linear_iterations: int
    length: float


@dataclass
class NewtonResult:
    """y, the pressure at the local contact points (MPa), and the history."""

    y: PETSc.Vec
    pressure: Array
    converged: bool
    reason: str
    history: list[Step] = field(default_factory=list)


def line_search(problem: ContactProblem, y: PETSc.Vec, step: PETSc.Vec) -> float:
    """Length t in (0, 1] that nearly minimises the convex energy along the step; 1 if that does."""
    slope = problem.slope(y, step)
    first = slope(0.0)
    if slope(1.0) <= OVERSHOOT * abs(first) or first >= 0:
        return 1.0
    return max(float(brentq(slope, 0.0, 1.0, xtol=1e-2)), 1e-3)


def solve(
    problem: ContactProblem,
    active: Mask,
    preconditioner: PETSc.PC,
    *,
    rtol: float = 1e-8,
    max_steps: int = 30,
    progress: Callable[[int, float], None] = lambda step, residual: None,
) -> NewtonResult:
    """Solve R(y) = 0 starting from the linear problem in which exactly `active` touches.

    rtol: residual over the contact force. Every linear system is solved by a Krylov method to a
    tolerance that tightens with the residual (the first one loosely), so only the last step pays
    for full accuracy.
    """
    comm = problem.stiffness.comm
    mpi = comm.tompi4py()
    ksp = krylov(comm, preconditioner, problem.law.symmetric)
    y = problem.force.duplicate()
    y.set(0.0)
    ksp.setOperators(problem.tangent(active), preconditioner.getOperators()[1])
    ksp.setTolerances(rtol=1e-4, max_it=500)
    ksp.solve(problem.predictor(active), y)
    iterations = ksp.getIterationNumber()
    history: list[Step] = []
    length = 1.0
    diagonal = problem.stiffness.getDiagonal()

    for step in range(1, max_steps + 1):
        pressure = problem.pressure(y)
        residual = problem.residual(y, pressure)
        contact = problem.gap.createVecRight()
        contact.set(0.0)
        problem.add_transposed(problem.test_trace, problem.weight * pressure, contact)
        scale = max(contact.norm(), np.finfo(float).tiny)
        norm = residual.norm() / scale
        rounding = ROUNDING * (diagonal * y).norm() / scale
        active = pressure > 0.0
        touching = int(mpi.allreduce(int(active.sum())))
        history.append(Step(norm, touching, iterations, length))
        progress(step, norm)
        if norm <= max(rtol, rounding):
            return NewtonResult(y, pressure, True, "residual below tolerance", history)
        if not np.isfinite(norm):
            return NewtonResult(y, pressure, False, "the residual is not a number", history)
        if step == max_steps:
            break
        if touching == 0:
            return NewtonResult(y, pressure, False, "the bodies do not touch", history)
        ksp.setOperators(problem.tangent(active), preconditioner.getOperators()[1])
        forcing = min(1e-3, max(0.1 * rtol / norm, 0.01 * norm))
        ksp.setTolerances(rtol=forcing, max_it=500)
        increment = problem.force.duplicate()
        ksp.solve(residual, increment)
        iterations = ksp.getIterationNumber()
        increment.scale(-1.0)
        length = line_search(problem, y, increment) if problem.law.symmetric else 1.0
        y.axpy(length, increment)
    return NewtonResult(y, pressure, False, "too many Newton steps", history)
