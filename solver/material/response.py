"""How the bodies respond to one load case: elastically, or with yield and a history.

A response is made for each load case. It presses the bodies, presses them again under the
tangential tractions that friction finds, and unloads them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from railhead.solver.algebra.contact_system import ContactSystem, LoadCase
from railhead.solver.material.hardening import ROOT, deviator
from railhead.solver.material.load_stepping import LoadStepping, predict_active_set
from railhead.solver.material.plasticity import (
    PlasticProblem,
    State,
    bulk_points,
    surface_points,
)
from railhead.solver.setup import LoadPath
from railhead.solver.solution import PlasticSolution, Solution
from railhead.solver.space.cells import Array, Index

# Shares of the load from which the bodies are separated: they follow the yield at the border of the
# patch as it begins to shrink. More steps change the residual state by less than 1e-6, of a sphere
# at 20 times first yield by 0.3 % of the largest stress.
UNLOADING = (0.95, 0.85)
LOWERING = (*UNLOADING, 0.4, 0.05)  # shares of the load before a further cycle


class ElasticResponse:
    """Response of elastic bodies to one load case, which has no history.

    system: contact system.
    """

    def __init__(self, system: ContactSystem) -> None:
        self.system = system

    def press(self, case: LoadCase) -> Solution:
        """Frictionless elastic solution of a load case (collective)."""
        return self.system.press(case)

    def start_friction_step(self) -> None:
        """Mark the start of a friction load step; elastic bodies have no history, so that nothing
        is done.
        """

    def press_again(self, solution: Solution, case: LoadCase) -> Solution:
        """Solution of a load case whose force holds tangential tractions; solution: the last one,
        which elastic bodies do not need.
        """
        return self.press(case)

    def plastic_shear_stress(self, points: Index, tangents: Array, normals: Array) -> Array:
        """Shear stress t . sigma . n that plastic strain takes (p, k), MPa: zero for elastic
        bodies.

        points: numbers (p,) of contact points of this rank.
        tangents: unit tangents t (p, k, c).
        normals: unit normals n (p, c).
        """
        return np.zeros(tangents.shape[:2])

    def unload(self, solution: Solution) -> Solution:
        """The solution itself, because elastic bodies leave no residual state."""
        return solution


class PlasticResponse(ElasticResponse):
    """Response of bodies that yield: they are loaded in steps from first yield on.

    system: contact system.
    problem: contact problem with plastic strain.
    path: number of load steps, cycles, unloading.
    stepping: load steps so far; None as long as everything stays elastic.
    _start: plastic state at the start of the friction load step.
    """

    stepping: LoadStepping | None = None

    def __init__(self, system: ContactSystem, problem: PlasticProblem, path: LoadPath) -> None:
        super().__init__(system)
        self.problem, self.path = problem, path
        problem.reset_history()
        self._start: State = problem.state

    def press(self, case: LoadCase) -> Solution:
        """Frictionless solution: elastic up to first yield, then in equal load steps (collective).

        With several cycles the load is lowered by the shares `LOWERING` before it is applied
        again. The elastic solution is the field `reference` of the one returned, or is returned
        itself where nothing yields or it does not converge.
        """
        elastic = super().press(case)
        over = self._load_over_first_yield(elastic, case)
        if not elastic.newton.converged or over <= 1:
            return elastic
        self.problem.reset_history()
        self.stepping = stepping = LoadStepping(self.system, self.problem, case)
        first_yield, *up = np.linspace(1 / over, 1.0, self.path.steps + 1)
        active = predict_active_set(self.system, elastic.indicator, first_yield)
        first = super().press(replace(case.scaled(first_yield), active=active))
        stepping.start(first, first_yield)
        result = stepping.solve_load_steps(up)
        loading_steps = len(stepping.results)
        for _ in range(self.path.cycles - 1):
            if result.converged and stepping.solve_load_steps(LOWERING).converged:
                result = stepping.solve_load_steps(up)
        plasticity = PlasticSolution(
            load_over_first_yield=over,
            newton_results=tuple(stepping.results),
            first_loading_steps=loading_steps,
            indentation_depth={},
        )
        return replace(stepping.solution, reference=elastic, plasticity=plasticity)

    def start_friction_step(self) -> None:
        """Mark the start of a friction load step: the present plastic state is the history from
        which `press_again` starts.
        """
        if self.stepping is None:
            self.problem.reset_history()
        self._start = self.problem.state if self.stepping is None else self.stepping.state

    def press_again(self, solution: Solution, case: LoadCase) -> Solution:
        """Solution of the last load step again, under a load case whose force holds tangential
        tractions.

        It starts from the history at the start of the friction load step. It takes over reference
        and load history of `solution`, the last one.
        """
        if self.stepping is None:
            return self.press(case)
        again = self.stepping.repeat(case, self._start)
        return replace(again, reference=solution.reference, plasticity=solution.plasticity)

    def plastic_shear_stress(self, points: Index, tangents: Array, normals: Array) -> Array:
        """Shear stress that plastic strain takes, 2 mu t . eps_p . n (p, k), MPa, in the last
        state.

        points: numbers (p,) of contact points of this rank.
        tangents: unit tangents t (p, k, c).
        normals: unit normals n (p, c).
        """
        kinematics = self.system.setup.kinematics
        strain = kinematics.tensors(self.problem.state[1].plastic[points])
        along = kinematics.in_space(tangents)
        shear = np.einsum("pkc,pcd,pd->pk", along, strain, kinematics.in_space(normals))
        return np.asarray(2 * self.problem.surface.mu[points, None] * shear)

    def unload(self, solution: Solution) -> Solution:
        """The solution with its residual state, where the load path has one: the load is lowered by
        the shares `UNLOADING`, then the bodies are separated. Otherwise the solution itself.
        """
        plasticity, stepping = solution.plasticity, self.stepping
        if not (plasticity and stepping and self.path.unload and solution.newton.converged):
            return solution
        force = self.problem.contact_force(stepping.solution.pressure)
        if stepping.solve_load_steps(UNLOADING).converged:
            stepping.separate(force)
            stepping.solve_load_steps([0.0])
        residual = stepping.solution
        plasticity = replace(
            plasticity,
            newton_results=tuple(stepping.results),
            residual_state=residual,
            indentation_depth=indentation_depth(self.system, residual, solution.pressure),
        )
        return replace(solution, plasticity=plasticity)

    def _load_over_first_yield(self, elastic: Solution, case: LoadCase) -> float:
        """Ratio of the load to that of first yield. In Hertz's theory it is the cube of the largest
        elastic von Mises stress over the yield stress, for a line contact the square
        (collective).
        """
        self.problem.set_prescribed_strain(self.system.prescribed(case))
        worst = 0.0
        for points in (self.problem.bulk, self.problem.surface):
            strain = points.strains(elastic.newton.y) + points.prescribed_strain
            stress = 2 * points.mu[:, None] * deviator(strain)
            size = np.sqrt(np.einsum("nm,nm->n", stress, stress))
            for members, hardening in points.groups:
                largest = float(np.max(size[members], initial=0.0))
                worst = max(worst, largest / hardening.initial_yield_stress)
        power = 2 if self.system.setup.kinematics.line_contact else 3
        return float(max(self.system.comm.allgather(worst / ROOT))) ** power


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
        normal_dyads=system.setup.kinematics.dyads(system.interface.normals),
    )


def indentation_depth(
    system: ContactSystem, residual: Solution, pressure: Array
) -> Mapping[int, float]:
    """Body tag -> largest residual displacement of the contact surface of that body into it, mm,
    for each deformable body (collective).

    residual: solution after unloading.
    pressure: (n,) before unloading, MPa; the displacement counts along the resultant of the
        pressure.
    """
    interface, setup = system.interface, system.setup
    normal = system.comm.allreduce((interface.weights * pressure) @ interface.normals)
    normal = normal / np.linalg.norm(normal)
    moved = residual.displacement.array.reshape(-1, setup.kinematics.dim) @ normal
    depth = {}
    for body in (setup.fixed, setup.moving):
        if not body.rigid:
            inwards = -moved if body.tag == setup.slave else moved
            own = inwards[system.nodes_on_facets(system.bulk.space, body.contact)]
            depth[body.tag] = float(max(system.comm.allgather(np.max(own, initial=-np.inf))))
    return depth
