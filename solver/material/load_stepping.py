"""Load steps of bodies that yield: each starts from the history that the last one left."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from petsc4py import PETSc

from railhead.solver.algebra import linear, newton
from railhead.solver.algebra.contact_system import ContactSystem, LoadCase
from railhead.solver.algebra.newton import NewtonResult
from railhead.solver.algebra.problem import Mask
from railhead.solver.material.hardening import History
from railhead.solver.material.plasticity import PlasticProblem, State
from railhead.solver.solution import PlasticStrain, Solution
from railhead.solver.space.cells import Array

PREDICTOR_TOLERANCE = 1e-2  # of the linear solve that predicts the state under the next load
REPORTED_SHARES = (1.0, 0.0)  # shares of the load whose solution is reported
STEP_TOLERANCE = 1e-4  # Newton's at other shares: moves pressure and area by up to 1e-5
SMALLEST_STEP = 1 / 32  # of a load step, below which it is cut no further


@dataclass
class SeparatedProblem(PlasticProblem):
    """Equilibrium of bodies that yield, without contact. Nothing resists the approach then; a
    spring in `stiffness` holds it. The other fields are those of `PlasticProblem`.

    reference_force: force that the residual is divided by, N.
    """

    reference_force: float = 1.0

    @classmethod
    def of(cls, problem: PlasticProblem, reference_force: float) -> SeparatedProblem:
        """The problem without contact; matrices and histories are shared with the given problem;
        reference_force: N.
        """
        stiffness = problem.stiffness.pinned(problem.stiffness.typical)
        return cls(**problem.shared() | {"stiffness": stiffness}, reference_force=reference_force)

    def indicator(self, y: PETSc.Vec) -> Array:
        """Array (n,) of -1 MPa: no contact point is active. The plastic state at the free unknowns
        y is computed and kept, as in `PlasticProblem.indicator`.
        """
        super().indicator(y)
        return np.full(len(self.area), -1.0)

    def contact_force(self, pressure: Array) -> float:
        """Force that the residual is divided by, N: the reference force, whatever the pressure."""
        return self.reference_force


class LoadStepping:
    """Solves a load case in shares of the full load, one after the other.

    system: contact system.
    problem: contact problem of the next step; after `separate` one without contact.
    case: load case at its full load.
    preconditioner: preconditioner of the next step.
    active: (n,) points that touch at the start of the next step.
    y: free unknowns at the last share reached; None before the first step.
    share: share of the load case that was reached.
    state: plastic histories at the Gauss points and at the contact points at that share.
    results: results of Newton's method in all steps so far.
    solution: solution of the last step, converged or not.
    """

    solution: Solution

    def __init__(self, system: ContactSystem, problem: PlasticProblem, case: LoadCase) -> None:
        self.system, self.problem, self.case = system, problem, case
        self.preconditioner = system.preconditioner
        self.results: list[NewtonResult] = []
        self.share, self.y = 0.0, None
        self.state: State = problem.bulk.history, problem.surface.history
        self.active: Mask = np.zeros(len(problem.area), dtype=bool)

    def start(self, solution: Solution, share: float) -> None:
        """Make an elastic solution the state that the first step starts from; share: its share of
        the load case. Without one, the first iterations yield where the solution does not.
        """
        self.share, self.y, self.active = share, solution.newton.y, solution.newton.pressure > 0

    def repeat(self, case: LoadCase, state: State) -> Solution:
        """Solution of the step to the present share, from another history `state` and with another
        load case.
        """
        self.case, self.state = case, state
        self._step(self.share)
        return self.solution

    def solve_load_steps(self, shares: Iterable[float]) -> NewtonResult:
        """Apply the load case in these shares of the full load, in turn. A step that does not
        converge is halved, down to `SMALLEST_STEP` of it. Returns the result of the last step.
        """
        for share in shares:
            least = abs(share - self.share) * SMALLEST_STEP
            while self.share != share:
                target = share
                while not (result := self._step(target)).converged:
                    if abs(target - self.share) <= least:
                        return result
                    target = (target + self.share) / 2
        return self.solution.newton

    def separate(self, reference_force: float) -> None:
        """Remove the contact from all further steps; reference_force: force that the residual is
        then divided by, N.
        """
        self.problem = SeparatedProblem.of(self.problem, reference_force)
        self.active = np.zeros(len(self.problem.area), dtype=bool)
        self.preconditioner = self.system.new_preconditioner(self.problem)

    def _step(self, share: float) -> NewtonResult:
        """Solve one step to a share of the load case; returns the result of Newton's method.

        If it converges, its plastic state becomes the history of the next step. The fields
        `solution` and `results` change in any case.
        """
        system, problem, case = self.system, self.problem, self.case.scaled(share)
        prescribed = system.apply(problem, case)
        problem.set_prescribed_strain(prescribed)
        y = self.y
        if share < self.share:
            problem.commit(self.state)
        if y is not None and share:
            y = self._predicted(y, share / self.share)
        problem.commit(self.state)
        result = newton.solve(
            problem,
            self.preconditioner,
            self.active,
            y,
            rtol=system.setup.tolerance if share in REPORTED_SHARES else STEP_TOLERANCE,
            max_steps=case.max_steps,
            progress=case.progress,
        )
        self.results.append(result)
        solution = system.solution(problem, result, prescribed, case)
        if result.converged:
            self.state = problem.state
            self.share, self.y, self.active = share, result.y, result.pressure > 0
        strain = plastic_strain(system, problem, self.state[0])
        self.solution = replace(solution, plastic_strain=strain)
        return result

    def _predicted(self, y: PETSc.Vec, ratio: float) -> PETSc.Vec:
        """Prediction of the free unknowns for the next load, from those of the last one (y).

        It solves the linear problem in which the active set follows the load as in Hertz's theory.
        Where its tangent is singular, y itself is returned. ratio: next load over the last one.
        Before the last state is made the history, the tangent is that of continued yield;
        afterwards it is that of unloading.
        """
        problem = self.problem
        indicator = problem.indicator(y)
        active = predict_active_set(self.system, indicator, ratio)
        residual, step = problem.residual(y, np.where(active, indicator, 0.0)), y.duplicate()
        try:
            linear.solve(problem, self.preconditioner, active, residual, step, PREDICTOR_TOLERANCE)
        except linear.StalledError:
            return y
        return y - step


def predict_active_set(system: ContactSystem, indicator: Array, ratio: float) -> Mask:
    """Active points (n,) after the load is multiplied by a ratio: those with the highest indicator
    (collective).

    Their area grows as in Hertz's theory: by ratio^(2/3), for a line contact by ratio^(1/2).
    indicator: (n,) at this rank's contact points before the change of the load, MPa.
    """
    every = np.concatenate(system.comm.allgather(indicator))
    order = np.argsort(-every)
    area = np.cumsum(np.concatenate(system.comm.allgather(system.interface.weights))[order])
    touching = area[np.count_nonzero(every > 0) - 1]
    power = 1 / 2 if system.setup.kinematics.line_contact else 2 / 3
    last = np.searchsorted(area, touching * ratio**power)
    return np.asarray(indicator >= every[order[min(int(last), len(order) - 1)]])


def plastic_strain(
    system: ContactSystem, problem: PlasticProblem, history: History
) -> PlasticStrain:
    """Plastic strain as tensors in space at the Gauss points of all cells of this rank, zero in
    cells where it is not followed; history: state at the Gauss points of the others
    (collective).
    """
    topology = system.bulk.space.mesh.topology
    count = topology.index_map(topology.dim).size_local
    cells = problem.bulk.cells
    each = len(history.equivalent) // max(len(cells), 1) or 1
    each = max(system.comm.allgather(each))
    strain, equivalent = np.zeros((count, each, 3, 3)), np.zeros((count, each))
    tensors = system.setup.kinematics.tensors(history.plastic)
    strain[cells] = tensors.reshape(len(cells), each, 3, 3)
    equivalent[cells] = history.equivalent.reshape(len(cells), each)
    return PlasticStrain(strain, equivalent)
