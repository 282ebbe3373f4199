"""Semismooth Newton's method on the active set, with inexact linear solves.

With the residual R(y) of `solver.algebra.problem`, the active set A = {p(y) > 0} and the tangent
K_A, each step solves

    K_A(y) s = -R(y)  to a tolerance eta |R(y)|,      y <- y + t s

(inexact steps: Eisenstat and Walker, SIAM J. Sci. Comput. 17, 1996). A symmetric method
has a convex energy, and t nearly minimises it along s. An unsymmetric one takes t = 1, and halves t
whenever an active set comes back, until it stays.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from petsc4py import PETSc
from scipy.optimize import brentq

from railhead.solver.algebra import linear
from railhead.solver.algebra.linear import Preconditioner, StalledError
from railhead.solver.algebra.problem import ContactProblem
from railhead.theory.array_types import Array, Mask

ROUNDING = 100 * np.finfo(float).eps  # of diag(K) y: the residual cannot fall below it
MOST_ROUNDING = 1e-4  # of the largest contact force so far, above which no residual is rounding:
# bodies that fly off are far away, and that is no solution
OVERSHOOT = 0.3  # slope past the minimum, relative to the slope at the start, that is let pass
LEAST_FORCE = 1e-3  # of the contact, over that of an earlier state, by which a residual is divided
LEAST_FALL, LEAST_LENGTH = 0.9, 0.2  # of the residual of deformed bodies in a step, else half of
# it is taken, down to that length
MOST_RETURNED = 8  # halves of steps that lose contact
SETTLED = 2  # steps with the same active set, after which they are whole again
MOST_RETURNS = 3  # times an active set may come back before the method gives up
SMALLEST_STEP = 1 / 64  # of a load, over a step of it, below which that is cut no further
CONVERGED = "residual below tolerance"
FINAL_FRACTION = 0.3  # of Newton's tolerance, below which the residual of a linear solve need not
# fall. Where the tangent changes within an active set, the tolerances of the linear solves are also
# at least these: of the first, of those far from the solution, and beyond which residual that is.
FIRST_ETA, FAR_ETA, FAR_RESIDUAL = 1e-4, 1e-2, 3e-3


@dataclass(frozen=True, kw_only=True)
class NewtonStep:
    """State of Newton's method after one linear solve.

    residual: norm of the residual R(y) over that of the nodal contact forces; None where it is not
        finite or not known.
    active: number of active contact points of all ranks; 0 where the linear solve failed.
    linear_iterations: number of Krylov iterations of the solve.
    length: step length t, by which the solution of the solve was multiplied; 0 where it failed.
    factor: `gamma_factor` of the contact law in the solve, which changes from stage to stage
        (`ContactLaw.stages`).
    problem: why there is no residual: nothing touches, a value is not finite, or the linear solve
        failed; otherwise empty.
    share: of the way from the loads of the last solution to those that are solved.
    """

    residual: float | None
    active: int
    linear_iterations: int
    length: float
    factor: float
    problem: str = ""
    share: float = 1.0


@dataclass
class NewtonResult:
    """Outcome of Newton's method, converged or not.

    y: free unknowns of the last state; zero where there is no state.
    pressure: pressure at the contact points of this rank (n,), MPa; zero where there is no state.
    reason: why the iterations ended; CONVERGED where they converged.
    history: all steps.
    stalled: whether a linear solve failed.
    """

    y: PETSc.Vec
    pressure: Array
    reason: str
    history: list[NewtonStep] = field(default_factory=list)
    stalled: bool = False

    def __getstate__(self) -> dict[str, Any]:
        """The attributes without y, a PETSc vector, which cannot be pickled."""
        return {**self.__dict__, "y": None}

    @property
    def converged(self) -> bool:
        """Whether the iterations ended because the residual is below the tolerance."""
        return self.reason == CONVERGED

    @property
    def residual(self) -> float | None:
        """Norm of the residual over that of the nodal contact forces in the last step that has one;
        None where no step has.
        """
        states = [step.residual for step in self.history if step.residual is not None]
        return states[-1] if states else None


def forcing_term(problem: ContactProblem, rtol: float, residual: float | None) -> float:
    """Relative tolerance eta of a linear solve in Newton's method.

    rtol: tolerance of Newton's method. residual: relative residual of the state that the step
        starts from; None: the solve gives the first state.
    """
    eta = FINAL_FRACTION * rtol / (residual or 1.0)
    if not problem.tangent_depends_on_state:
        return eta
    if residual is None:
        return FIRST_ETA
    return max(eta, FAR_ETA if residual > FAR_RESIDUAL else residual)


def line_search(problem: ContactProblem, y: PETSc.Vec, step: PETSc.Vec) -> float:
    """Step length t, from 1e-3 to 1, that nearly minimises the convex energy at y + t step. It is 1
    where the energy still falls at t = 1 or rises only slightly, or does not fall at t = 0.
    """
    slope = problem.slope(y, step)
    first = slope(0.0)
    if slope(1.0) <= OVERSHOOT * abs(first) or first >= 0:
        return 1.0
    return max(float(brentq(slope, 0.0, 1.0, xtol=1e-2)), 1e-3)


class _Cycles:
    """How often active sets of all ranks came back."""

    def __init__(self) -> None:
        """None did so far."""
        self._seen, self._last, self._stays = Counter[bytes](), b"", 0

    def length(self, key: bytes) -> float:
        """Length of the step from an active set: halved each time that it comes back, until it
        stays; 0 where it came back more often than MOST_RETURNS.
        """
        same = key == self._last
        self._seen[key] += not same
        self._last, self._stays = key, self._stays + 1 if same else 0
        returns = self._seen[key] - 1
        if returns > MOST_RETURNS:
            return 0.0
        return 1.0 if self._stays >= SETTLED else 0.5**returns


def solve(
    problem: ContactProblem,
    preconditioner: Preconditioner,
    active: Mask,
    start: PETSc.Vec | None = None,
    *,
    rtol: float,
    max_steps: int = 30,
    progress: Callable[[int, float], None] = lambda step, residual: None,
    anew: Callable[[PETSc.Vec, Mask], tuple[ContactProblem, Mask]] | None = None,
) -> NewtonResult:
    """Solve R(y) = 0 for the free unknowns y by semismooth Newton's method (collective).

    problem: contact problem with its residual and tangent.
    preconditioner: preconditioner of the tangent.
    active: (n,) contact points of this rank; without a start, the first state is the solution of
        the linear problem in which exactly these touch.
    start: free unknowns to start from; `active` then has no effect without `anew`.
    rtol: tolerance of the norm of the residual over that of the nodal contact forces. A residual
        that is down to rounding counts as converged at any tolerance.
    max_steps: largest number of states.
    progress: called with the number and the relative residual of each state, infinite where
        nothing touches.
    anew: equations that are exact at free unknowns, made linear there, and active points of theirs,
        from those of the last; None: they stay as they are. Exactly the active points touch in the
        first state: linear bodies show better where that is than where they lie shows.

    A linear solve ends early where its solution changes the active set so much that this leaves
    more in R than the linear residual. Where the tangent changes within a set, see
    `forcing_term`.
    Where nothing has to touch and nothing does, the residual is measured by the applied forces or,
    without any, by the largest contact force so far: bodies apart are a solution. The residual must
    fall by half there in each step. A result that did not converge is returned too.
    """
    comm = problem.stiffness.comm.tompi4py()
    result = NewtonResult(problem.force.duplicate(), np.zeros(len(active)), "too many Newton steps")
    y, diagonal, increment = result.y, problem.stiffness.diagonal(), None
    y.set(0.0)
    told, cycles = partial(NewtonStep, factor=problem.law.gamma_factor), _Cycles()
    iterations, length, largest = 0, 1.0, problem.reference_force
    last = np.inf  # residual of deformed bodies in the last state
    returned, before = 0, np.inf  # steps taken back; residual in the last state without contact
    try:
        if start is not None:
            start.copy(y)
        else:
            eta, first = forcing_term(problem, rtol, None), problem.predictor(active)
            ends = problem.active_set_residual(active, -problem.offset)
            iterations = linear.solve(problem, preconditioner, active, first, y, eta, ends)
        for step in range(1, max_steps + 1):
            if anew is not None:
                problem, active = anew(y, active)
                preconditioner.problem, preconditioner.state = problem, None
            indicator = problem.indicator(y)
            given = anew is not None and step == 1
            reached = active if given else indicator > problem.floor
            result.pressure = pressure = np.where(reached, indicator, problem.floor)
            active, contact = reached, problem.contact_force(pressure)
            residual, apart = problem.residual(y, pressure), not contact
            largest = max(largest, contact)
            scale = max(contact, LEAST_FORCE * problem.reference_force)
            rounding = min(ROUNDING * (diagonal * y).norm(), MOST_ROUNDING * largest)
            if apart:  # bodies may rest without contact, and y is large where nothing holds them
                scale = problem.applied or largest or residual.norm() or 1.0
                rounding = problem.least_force
            norm, failure = residual.norm() / scale, ""
            goal = max(rtol, rounding / scale)
            worse = not np.isfinite(norm)  # of cells turned inside out
            if anew is not None:
                falls = norm <= goal or residual.norm() <= LEAST_FALL * last
                worse |= not falls and (apart or length > LEAST_LENGTH)
            elif apart:  # where something touched
                worse = not norm <= max(goal, before / 2 if np.isfinite(before) else 0.0)
            if worse and increment is not None and returned < MOST_RETURNED:
                returned, length = returned + 1, length / 2
                y.axpy(-length, increment)
                continue
            if not np.isfinite(norm):
                failure = "the residual is not a number"
            elif apart and (worse if anew is not None else norm > max(goal, before / 2)):
                failure = "the bodies do not touch"
            if apart:
                before = norm
            last, returned = (np.inf, returned) if apart else (residual.norm(), 0)
            result.history.append(
                told(
                    residual=None if failure else norm,
                    active=int(comm.allreduce(int(active.sum()))),
                    linear_iterations=iterations,
                    length=length,
                    problem=failure,
                )
            )
            progress(step, norm)
            if failure and not apart:
                _clear(result)
            if failure or (norm <= goal and not given):
                result.reason = failure or CONVERGED
                return result
            if step == max_steps:
                return result
            increment = problem.force.duplicate()
            eta = forcing_term(problem, rtol, norm)
            ends = problem.active_set_residual(active, indicator)
            iterations = linear.solve(
                problem, preconditioner, active, -residual, increment, eta, ends
            )
            if problem.law.symmetric:
                length = line_search(problem, y, increment)
            else:
                branches = np.packbits(problem.branches(active)).tobytes()
                length = cycles.length(b"".join(comm.allgather(branches)))
            if not length:
                result.reason = "the active set cycles"
                return result
            y.axpy(length, increment)
    except StalledError as error:
        result.reason, result.stalled = str(error), True
        if not result.history:  # what the failed first solve left in y is no state
            _clear(result)
        failed = told(residual=None, active=0, linear_iterations=error.iterations, length=0.0)
        result.history.append(replace(failed, problem=str(error)))
    return result


def _clear(result: NewtonResult) -> None:
    """Set the free unknowns and the pressure of a result to zero."""
    result.y.set(0.0)
    result.pressure = np.zeros_like(result.pressure)


def in_steps(goals: Iterable[float], done: float, step: Callable[[float], bool | None]) -> bool:
    """Go to shares of a load, one after the other. A step that fails is halved, down to 1/64
    (SMALLEST_STEP) of it; then all of the rest is tried again. Returns whether the last goal was
    reached.

    done: share where the first step starts.
    step: goes to a share from the last one that was reached, and says whether it succeeded; None: a
        smaller one fails, too.
    """
    for goal in goals:
        least = abs(goal - done) * SMALLEST_STEP
        while done != goal:
            target = goal
            while not (went := step(target)):
                if went is None or abs(target - done) <= least:
                    return False
                target = (target + done) / 2
            done = target
    return True
