"""How bodies that yield respond to one load case: in load steps, with a history.

Each load step starts from the history that the last one left.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from petsc4py import PETSc

from railhead.solver.algebra import linear, newton
from railhead.solver.algebra.newton import NewtonResult
from railhead.solver.plasticity.plastic_problem import (
    PlasticProblem,
    State,
    bulk_points,
    surface_points,
)
from railhead.solver.plasticity.radial_return import ROOT, History, deviator
from railhead.solver.space.cells import CellSet
from railhead.solver.space.supports import on_facets
from railhead.solver.system.contact_system import ContactSystem, LoadCase
from railhead.solver.system.setup import LoadPath
from railhead.solver.system.solution import PlasticSolution, PlasticStrain, Solution
from railhead.theory.array_types import Array, Index, Mask

# Shares of the load from which the bodies are separated far beyond first yield: they follow the
# yield at the border of the patch as it begins to shrink. More steps change the residual state of a
# sphere at 20 times first yield by 0.3 % of the largest stress. Up to the load below, over that of
# first yield, the shares themselves change it by less than 1e-9, of a real pair at 5.6 times by
# 0.1 % of the largest stress.
UNLOADING = (0.95, 0.85)
UNLOADED_AT_ONCE = 10.0
PREDICTOR_TOLERANCE = 1e-2  # of the linear solve that predicts the state under the next load
REPORTED_SHARES = (1.0, 0.0)  # shares of the load whose solution is reported
START_TOLERANCE = 1e-2  # Newton's at the elastic solution from which the first step starts
STEP_TOLERANCE = 1e-3  # Newton's at other shares: moves pressure and area by up to 2e-4
LARGEST_GROWTH = 2.0  # of a load step over the last one: with more than 2.41 BDF2 is not stable
SAME_POWER = 0.05  # by which powers of the load that give the same first yield may differ in it
MOST_GUESSES = 4  # of the load of first yield


class Response:
    """Response of the bodies to one load case. It presses the bodies, presses them again under the
    tangential tractions that friction finds, and unloads them. Bodies that yield are loaded in
    shares of the load from first yield on; elastic ones have no history. Its methods are
    collective.

    Plastic strain follows by BDF2 at points that go on yielding, elsewhere by backward Euler. With
    the increments h of the load in this step and h' in the last one, r = h/h', the radial return
    of the step n + 1 starts from

        h* = h_n + r^2/(1 + 2 r) (h_n - h_(n-1))

    instead of the history h_n (Eckert, Baaser, Gross and Scherf, Computational Mechanics 34, 2004);
    back stresses follow the whole plastic strain of the step from h_n. The error of the load steps
    is then of second order.

    system: contact system.
    problem: contact problem with plastic strain, at the end one without contact; None: all bodies
        stay elastic.
    case: load case at its full load; missing as long as everything stays elastic.
    y: free unknowns from which the next step is predicted. y_share: share of the load that they
        belong to.
    share: share of the load that was reached.
    state: plastic histories at the Gauss points and at the contact points at that share.
    earlier: share that was reached before, and the histories there.
    yielded: numbers of the Gauss points and of the contact points that yielded in the last step.
    results: results of Newton's method in all load steps so far; none as long as everything stays
        elastic.
    solution: solution of the last load step, converged or not. Its plastic strain is that of the
        last step that converged.
    """

    case: LoadCase
    solution: Solution

    def __init__(self, system: ContactSystem, problem: PlasticProblem | None) -> None:
        self.system, self.problem, self.path = system, problem, system.setup.load_path
        self.results: list[NewtonResult] = []
        self.yielded: tuple[Index, Index] = (np.zeros(0, np.int64), np.zeros(0, np.int64))
        if problem is not None:
            problem.reset_history()
            self.state = self._start = problem.state

    def press(self, case: LoadCase) -> Solution:
        """Frictionless solution: elastic up to first yield, then in equal load steps.

        The elastic von Mises stress grows with a power of the load. It is Hertz's where a second
        elastic solution, at the first step, has it too, else that between the two solutions.
        The elastic solution is the field `reference` of the one returned. It is returned itself,
        without a field `plasticity`, where nothing yields or it does not converge.
        """
        elastic = self.system.press(case)
        problem, path = self.problem, self.path
        if problem is None or path is None or not elastic.newton.converged:
            return elastic
        worst = self._mises_over_yield(problem, elastic, case)
        if worst <= 1:
            return elastic
        over, start = worst**self.system.setup.kinematics.load_power, elastic
        for _ in range(MOST_GUESSES):
            first_yield, *up = np.linspace(1 / over, 1.0, path.steps + 1)
            share = min(up[0], 1 / over) if up[0] == 1 else up[0]
            active = predict_active_set(self.system, elastic.indicator, share)
            lower = replace(case.scaled(share), active=active, tolerance=START_TOLERANCE)
            less = self.system.press(lower)
            start = less if up[0] < 1 else elastic
            mises = self._mises_over_yield(problem, less, lower)
            again = worst ** (np.log(share) / np.log(mises / worst))
            if abs(again / over - 1) < SAME_POWER:
                break
            over = float(again)
        self.case, self.y_share = case, up[0]
        self.share, self.earlier = first_yield, (first_yield, self.state)
        self.y = start.newton.y
        newton.in_steps(up, first_yield, self._step)
        plasticity = PlasticSolution(
            load_over_first_yield=over,
            newton_results=tuple(self.results),
            loading_steps=len(self.results),
            indentation_depth={},
        )
        return replace(self.solution, reference=elastic, plasticity=plasticity)

    def _step(self, share: float) -> bool:
        """Solve one step to a share of the load; returns whether Newton's method converged. Its
        plastic state then becomes the history of the next step. The fields `solution` and `results`
        change in any case.

        It starts from a prediction; where the bodies are separated, from the given state.
        """
        system, problem = self.system, self.problem
        assert problem is not None
        tolerance = None if share in REPORTED_SHARES else STEP_TOLERANCE
        case = replace(self.case.scaled(share), tolerance=tolerance)

        def begin() -> PETSc.Vec:
            """Free unknowns that the step starts from, and its history."""
            if share < self.share:
                problem.commit(self.state)
            y = self._predicted(problem, share) if share else self.y
            problem.commit(self._history(share))
            return y

        solution = system.press(case, problem, begin)
        self.results.append(solution.newton)
        if solution.newton.converged:
            self.earlier, self.state = (self.share, self.state), problem.state
            self.yielded, self.share = problem.yielding_points, share
            self.y, self.y_share = solution.newton.y, share
        strain = plastic_strain(system, problem, self.state[0])
        self.solution = replace(solution, plastic_strain=strain)
        return solution.newton.converged

    def _history(self, share: float) -> State:
        """Histories of the bulk and of the contact points from which the radial return of the step
        to a share of the load starts (BDF2). Extrapolated at the points that yielded in the last
        step; the last state where the load turns back or this step is over twice as long
        (LARGEST_GROWTH).
        """
        before, earlier = self.earlier
        last, now = self.share - before, share - self.share
        ratio = now / last if last else 0.0
        if not 0 < ratio <= LARGEST_GROWTH:
            return self.state
        bulk, surface = (
            history.extrapolated(then, ratio**2 / (1 + 2 * ratio), points)
            for history, then, points in zip(self.state, earlier, self.yielded, strict=True)
        )
        return bulk, surface

    def _predicted(self, problem: PlasticProblem, share: float) -> PETSc.Vec:
        """Prediction of the free unknowns at a share of the load, from those of the last state.

        It solves the linear problem in which the active set follows the load as in Hertz's theory.
        Where its tangent is singular, the last ones are returned. Before the last state is made the
        history, the tangent is that of continued yield; afterwards it is that of unloading.
        """
        indicator, step = problem.indicator(self.y), self.y.duplicate()
        active = predict_active_set(self.system, indicator, share / self.y_share)
        residual = problem.residual(self.y, np.where(active, indicator, 0.0))
        preconditioner = self.system.preconditioner
        try:
            linear.solve(problem, preconditioner, active, residual, step, PREDICTOR_TOLERANCE)
        except linear.StalledError:
            return self.y
        return self.y - step

    def start_friction_step(self) -> None:
        """Mark the start of a friction load step: the present plastic state is the history from
        which `press_again` starts.
        """
        if self.problem is not None:
            self._start = self.state

    def press_again(self, solution: Solution, case: LoadCase) -> Solution:
        """Solution of the last load step again, under a load case whose force includes that of
        tangential tractions. Where pressing stayed elastic, the load case is pressed as a new one,
        and the bodies may yield.

        It starts from the history at the start of the friction load step. It takes over reference
        and load history of `solution`, the last one.
        """
        if not self.results:
            return self.press(case)
        self.case, self.state = case, self._start
        self._step(self.share)
        return replace(self.solution, reference=solution.reference, plasticity=solution.plasticity)

    def plastic_shear_stress(self, points: Index, tangents: Array, normals: Array) -> Array:
        """Shear stress that plastic strain takes, 2 mu t . eps_p . n (p, k), MPa, in the last
        state; zero for elastic bodies.

        points: numbers (p,) of contact points of this rank.
        tangents: unit tangents t (p, k, c).
        normals: unit normals n (p, c).
        """
        if self.problem is None:
            return np.zeros(tangents.shape[:2])
        plastic, mu = self.problem.state[1].plastic[points], self.problem.surface.mu[points]
        ways, dyads = np.moveaxis(tangents, 1, 0), self.system.setup.kinematics.dyads
        strain = [np.einsum("pm,pm->p", dyads(way, normals), plastic) for way in ways]
        return np.asarray(2 * mu[:, None] * np.transpose(strain))

    def unload(self, solution: Solution) -> Solution:
        """The solution with its residual state, where the load path has one. Up to ten times
        (UNLOADED_AT_ONCE) first yield the bodies are separated at once; beyond, the load is first
        lowered to 0.95 and 0.85 (UNLOADING). Where that fails, the residual state is that of the
        failed step, with the bodies in contact.

        Without unloading in the load path, and where nothing yielded or the solution did not
        converge, the solution itself.
        """
        plasticity, problem, path = solution.plasticity, self.problem, self.path
        if not (plasticity and problem and path and path.unload and solution.newton.converged):
            return solution
        force = problem.contact_force(self.solution.pressure)
        at_once = plasticity.load_over_first_yield <= UNLOADED_AT_ONCE
        if at_once or newton.in_steps(UNLOADING, self.share, self._step):
            self.problem, self.y = problem.separated(force), solution.newton.y
            if solution.reference is not None:  # begin with what yield adds to the elastic solution
                self.y = self.y - solution.reference.newton.y
            newton.in_steps([0.0], self.share, self._step)
        plasticity = replace(
            plasticity,
            newton_results=tuple(self.results),
            residual_state=self.solution,
            indentation_depth=indentation_depth(self.system, self.solution, solution.pressure),
        )
        return replace(solution, plasticity=plasticity)

    def _mises_over_yield(
        self, problem: PlasticProblem, elastic: Solution, case: LoadCase
    ) -> float:
        """Largest elastic von Mises stress over the yield stress, at the points at which plastic
        strain is followed (collective).
        """
        problem.set_prescribed_strain(self.system.prescribed(case))
        worst = 0.0
        for points in (problem.bulk, problem.surface):
            strain = points.strains(elastic.newton.y) + points.prescribed_strain
            stress = 2 * points.mu[:, None] * deviator(strain)
            size = np.sqrt(np.einsum("nm,nm->n", stress, stress))
            for members, hardening in points.groups:
                largest = float(np.max(size[members], initial=0.0))
                worst = max(worst, largest / hardening.initial_yield_stress)
        return float(max(self.system.comm.allgather(worst / ROOT)))


def plastic_problem(system: ContactSystem, path: LoadPath) -> PlasticProblem:
    """Contact problem of a system with plastic strain at the Gauss points near the contact and at
    the contact points of the slave; path: gives the region. Matrices are shared with the elastic
    problem.
    """
    hardening = system.materials[system.setup.slave].hardening
    return PlasticProblem(
        **system.problem.shared(),
        bulk=bulk_points(
            system.bulk,
            system.cell_tags,
            system.materials,
            path.near,
            system.reduction,
            system.comm,
        ),
        surface=surface_points(
            system.interface, hardening, system.bulk, system.reduction, system.comm
        ),
        normal_dyads=system.setup.kinematics.dyads(*[system.interface.normals] * 2),
    )


def predict_active_set(system: ContactSystem, indicator: Array, ratio: float) -> Mask:
    """Active points (n,) after the load is multiplied by a ratio: those with the highest indicator,
    at least one of all ranks (collective).

    Their area changes as in Hertz's theory: by ratio^(2/3), for a line contact by ratio^(1/2).
    indicator: (n,) at this rank's contact points before the change of the load, MPa; positive
        where they touch.
    """
    every = np.concatenate(system.comm.allgather(indicator))
    order = np.argsort(-every)
    area = np.cumsum(np.concatenate(system.comm.allgather(system.interface.weights))[order])
    touching = area[np.count_nonzero(every > 0) - 1]
    power = system.setup.kinematics.load_power
    last = np.searchsorted(area, touching * ratio ** ((power - 1) / power))
    return np.asarray(indicator >= every[order[min(int(last), len(order) - 1)]])


def plastic_strain(
    system: ContactSystem, problem: PlasticProblem, history: History
) -> PlasticStrain:
    """Plastic strain as tensors in space at the Gauss points of all cells of this rank, zero in
    cells where it is not followed; history: state at the Gauss points of the others
    (collective).
    """
    count, cells = len(CellSet.owned(system.bulk)), problem.bulk.cells
    each = len(history.equivalent) // max(len(cells), 1) or 1
    each = max(system.comm.allgather(each))
    strain, equivalent = np.zeros((count, each, 3, 3)), np.zeros((count, each))
    tensors = system.setup.kinematics.tensors(history.plastic)
    strain[cells] = tensors.reshape(len(cells), each, 3, 3)
    equivalent[cells] = history.equivalent.reshape(len(cells), each)
    return PlasticStrain(strain, equivalent)


def indentation_depth(
    system: ContactSystem, residual: Solution, pressure: Array
) -> Mapping[int, float]:
    """Body tag -> largest residual displacement of the contact surface of that body into it, mm,
    for each deformable body, negative where all of the surface moves outwards (collective).

    residual: solution after unloading.
    pressure: (n,) before unloading, MPa; the displacement counts along the resultant of the
        pressure on the meshed part.
    """
    interface, setup = system.interface, system.setup
    normal = system.comm.allreduce((interface.weights * pressure) @ interface.normals)
    normal = normal / np.linalg.norm(normal)
    moved = residual.displacement.array.reshape(-1, setup.kinematics.dim) @ normal
    depth = {}
    for body in (setup.fixed, setup.moving):
        if not body.rigid:
            inwards = -moved if body.tag == setup.slave else moved
            own = inwards[on_facets(system.bulk.space, system.facet_tags, body.contact)]
            depth[body.tag] = float(max(system.comm.allgather(np.max(own, initial=-np.inf))))
    return depth
