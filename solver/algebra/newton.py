"""Semismooth Newton's method on the active set, with inexact linear solves.

With the residual R(y) of `solver.algebra.problem`, the active set A = {p(y) > 0} and the tangent
K_A, each step solves

    K_A(y) s = -R(y)  to a tolerance eta |R(y)|,      y <- y + t s

(inexact steps: Eisenstat and Walker, SIAM J. Sci. Comput. 17, 1996). A symmetric method
has a convex energy, and t nearly minimises it along s. An unsymmetric one takes t = 1, and halves t
whenever an active set comes back, until it stays.
"""

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


@dataclass(frozen=True, kw_only=True)
class _State:
    """Unknowns y in Newton's method: what touches there, and how far they are from a solution.

    indicator: value (n,) at the contact points of this rank, MPa, positive where they touch.
    active: which of them count as touching (n,).
    pressure: pressure there (n,), MPa.
    residual: R(y).
    apart: whether nothing touches on any rank.
    norm: norm of R over the nodal contact forces; where bodies are apart, over the applied forces
        or, without any, over the largest contact force so far.
    goal: norm at which y is a solution: the tolerance, or what is rounding.
    """

    indicator: Array
    active: Mask
    pressure: Array
    residual: PETSc.Vec
    apart: bool
    norm: float
    goal: float

    @property
    def solved(self) -> bool:
        """Whether y is a solution."""
        return self.norm <= self.goal


class _Descent:
    """Which states Newton's method may go on from, one after the other.

    deformed: whether the equations are made linear anew in each state (`solve`, `anew`).
    """

    def __init__(self, problem: ContactProblem, rtol: float, *, deformed: bool) -> None:
        """Before the first state; rtol: tolerance of the norm of the residual."""
        self.rtol, self.deformed = rtol, deformed
        self._diagonal, self._largest = problem.stiffness.diagonal(), problem.reference_force
        self._touching, self._apart = np.inf, np.inf  # residuals in the last state of either kind

    def state(self, problem: ContactProblem, y: PETSc.Vec, active: Mask | None) -> _State:
        """State of unknowns y; active: points (n,) that count as touching; None: where the
        indicator is above its floor.
        """
        indicator = problem.indicator(y)
        active = indicator > problem.floor if active is None else active
        pressure = np.where(active, indicator, problem.floor)
        contact, residual = problem.contact_force(pressure), problem.residual(y, pressure)
        self._largest = max(self._largest, contact)
        scale = max(contact, LEAST_FORCE * problem.reference_force)
        rounding = min(ROUNDING * (self._diagonal * y).norm(), MOST_ROUNDING * self._largest)
        if not contact:  # bodies may rest apart, and y is large where nothing holds them
            scale = problem.applied or self._largest or residual.norm() or 1.0
            rounding = problem.least_force
        return _State(
            indicator=indicator,
            active=active,
            pressure=pressure,
            residual=residual,
            apart=not contact,
            norm=residual.norm() / scale,
            goal=max(self.rtol, rounding / scale),
        )

    def worse(self, state: _State, length: float) -> bool:
        """Whether a part of the step of the given length would have been better: a value is no
        number (cells turned inside out), the residual of deformed bodies does not fall, or contact
        is lost where that is no solution.
        """
        if not np.isfinite(state.norm):
            return True
        if state.solved:
            return False
        if self.deformed:
            falls = state.residual.norm() <= LEAST_FALL * self._touching
            return not falls and (state.apart or length > LEAST_LENGTH)
        return state.apart and not state.norm <= self._apart / 2 < np.inf

    def failure(self, state: _State, length: float) -> str:
        """Why there is no way on from a state, in words; empty where there is one. States apart
        must come nearer to a solution by half each.
        """
        if not np.isfinite(state.norm):
            return "the residual is not a number"
        lost = self.worse(state, length) if self.deformed else state.norm > self._apart / 2
        return "the bodies do not touch" if state.apart and lost and not state.solved else ""

    def passed(self, state: _State) -> None:
        """Go on from a state."""
        if state.apart:
            self._apart, self._touching = state.norm, np.inf
        else:
            self._touching = state.residual.norm()


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
    y, increment = result.y, None
    y.set(0.0)
    told, cycles = partial(NewtonStep, factor=problem.law.gamma_factor), _Cycles()
    descent = _Descent(problem, rtol, deformed=anew is not None)
    iterations, length, returned = 0, 1.0, 0
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
            given = anew is not None and step == 1
            state = descent.state(problem, y, active if given else None)
            result.pressure, active = state.pressure, state.active
            if returned < MOST_RETURNED and increment is not None and descent.worse(state, length):
                returned, length = returned + 1, length / 2
                y.axpy(-length, increment)
                continue
            failure = descent.failure(state, length)
            descent.passed(state)
            returned = returned if state.apart else 0
            result.history.append(
                told(
                    residual=None if failure else state.norm,
                    active=int(comm.allreduce(int(active.sum()))),
                    linear_iterations=iterations,
                    length=length,
                    problem=failure,
                )
            )
            progress(step, state.norm)
            if failure and not state.apart:
                _clear(result)
            if failure or (state.solved and not given):
                result.reason = failure or CONVERGED
                return result
            if step == max_steps:
                return result
            increment = problem.force.duplicate()
            eta = forcing_term(problem, rtol, state.norm)
            ends = problem.active_set_residual(active, state.indicator)
            iterations = linear.solve(
                problem, preconditioner, active, -state.residual, increment, eta, ends
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
    except (StalledError, PETSc.Error) as failed_solve:
        error = linear.stalled(failed_solve)
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
