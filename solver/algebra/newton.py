"""Semismooth Newton's method on the active set."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from hashlib import blake2b

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
from scipy.optimize import brentq

from railhead.solver.algebra import linear
from railhead.solver.algebra.linear import Preconditioner, StalledError
from railhead.solver.algebra.problem import ContactProblem, Mask
from railhead.solver.space.cells import Array

ROUNDING = 100 * np.finfo(float).eps  # of diag(K) y: what the residual cannot fall below
FIRST, LOOSE = 1e-4, 1e-2  # where the tangent changes within an active set: tolerances of the first
# linear solve and of those far from the solution, ...
FAR = 3e-3  # ... which are those with a larger residual than this
TIGHT = 0.3  # of what is left to reach, that a linear solve may leave
OVERSHOOT = 0.3  # slope past the minimum, relative to the slope at the start, that is let pass
CYCLES = 3  # times an active set may come back before the method gives up
CONVERGED = "residual below tolerance"


@dataclass(frozen=True)
class Step:
    """State after one linear solve: residual relative to the contact force, size of the active set
    (all ranks), Krylov iterations, step length, factor of the law on the safe parameter.

    residual is None where there is no finite one; problem says why then: nothing touches, or the
    linear solve failed and left no state.
    """

    residual: float | None
    active: int
    linear_iterations: int
    length: float
    factor: float
    problem: str = ""


@dataclass
class NewtonResult:
    """y, the pressure at the local contact points (MPa), and the history. stalled: it was a linear
    solve that failed. Both are always finite: zero where no state was found."""

    y: PETSc.Vec
    pressure: Array
    reason: str
    history: list[Step] = field(default_factory=list)
    stalled: bool = False

    @property
    def converged(self) -> bool:
        """Whether R(y) = 0 is met."""
        return self.reason == CONVERGED

    @property
    def residual(self) -> float | None:
        """Of the last state; None where it has none."""
        states = [step.residual for step in self.history if step.residual is not None]
        return states[-1] if states else None


def line_search(problem: ContactProblem, y: PETSc.Vec, step: PETSc.Vec) -> float:
    """Length t in (0, 1] that nearly minimises the convex energy along the step; 1 if that does."""
    slope = problem.slope(y, step)
    first = slope(0.0)
    if slope(1.0) <= OVERSHOOT * abs(first) or first >= 0:
        return 1.0
    return max(float(brentq(slope, 0.0, 1.0, xtol=1e-2)), 1e-3)


def solve(
    problem: ContactProblem,
    preconditioner: Preconditioner,
    active: Mask,
    start: PETSc.Vec | None = None,
    *,
    rtol: float = 1e-8,
    max_steps: int = 30,
    progress: Callable[[int, float], None] = lambda step, residual: None,
) -> NewtonResult:
    """Solve R(y) = 0 from a state, or from the linear problem in which exactly `active` touches.

    rtol: residual over the contact force. No linear system is solved further than to what the
    change of the active set by its solution leaves in R (inexact Newton), nor, where the tangent
    changes within a set, than to the square of the step. The symmetric methods have a convex
    energy, along which an exact line search stops overshoots; the others halve their steps when an
    active set comes back.
    """
    comm = problem.stiffness.comm.tompi4py()
    result = NewtonResult(problem.force.duplicate(), np.zeros(len(active)), "too many Newton steps")
    y = result.y
    y.set(0.0)
    iterations, length = 0, 1.0
    seen = _Seen(comm)
    diagonal = problem.stiffness.diagonal()
    try:
        if start is not None:
            start.copy(y)
        else:
            iterations = linear.solve(
                problem, preconditioner, active, problem.predictor(active), y,
                FIRST if problem.curved else TIGHT * rtol, problem.changes(active, -problem.offset),
            )  # fmt: skip
        for step in range(1, max_steps + 1):
            indicator = problem.indicator(y)
            result.pressure = pressure = np.maximum(indicator, 0.0)
            residual = problem.residual(y, pressure)
            scale = problem.contact_force(pressure)
            norm = residual.norm() / scale if scale else float("inf")
            rounding = ROUNDING * (diagonal * y).norm()
            active = pressure > 0.0
            touching = int(comm.allreduce(int(active.sum())))
            lost = ""
            if not np.isfinite(norm):
                lost = "the residual is not a number" if scale else "the bodies do not touch"
            result.history.append(
                Step(
                    None if lost else norm, touching, iterations, length,
                    problem.law.gamma_factor, lost,
                )
            )  # fmt: skip
            progress(step, norm)
            if lost:
                result.reason = lost
                if scale:
                    _forget(result)
                return result
            if norm <= max(rtol, rounding / scale):
                result.reason = CONVERGED
                return result
            if step == max_steps:
                return result
            tolerance = TIGHT * rtol / norm
            if problem.curved:
                tolerance = max(tolerance, LOOSE if norm > FAR else norm)
            increment = problem.force.duplicate()
            iterations = linear.solve(
                problem, preconditioner, active, -residual, increment, tolerance,
                problem.changes(active, indicator),
            )  # fmt: skip
            if problem.law.symmetric:
                length = line_search(problem, y, increment)
            else:
                returns = seen.count(active)
                if returns > CYCLES:
                    result.reason = "the active set cycles"
                    return result
                length = 0.5**returns
            y.axpy(length, increment)
    except StalledError as error:
        result.reason, result.stalled = str(error), True
        if not result.history:  # what the predictor left in y is no state
            _forget(result)
        result.history.append(
            Step(None, 0, error.iterations, 0.0, problem.law.gamma_factor, str(error))
        )
    return result


def _forget(result: NewtonResult) -> None:
    """Leave the state at zero."""
    result.y.set(0.0)
    result.pressure = np.zeros_like(result.pressure)


class _Seen:
    """Which active sets were met."""

    def __init__(self, comm: MPI.Intracomm) -> None:
        self.comm = comm
        self.last = b""
        self.times: dict[bytes, int] = {}

    def count(self, active: Mask) -> int:
        """How often this one came back after another one."""
        local = blake2b(np.packbits(active).tobytes(), digest_size=8).digest()
        key = b"".join(self.comm.allgather(local))
        if key != self.last:
            self.times[key] = self.times.get(key, -1) + 1
        self.last = key
        return self.times[key]
