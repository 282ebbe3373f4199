"""Loading and unloading of bodies that yield, step by step."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace

import numpy as np
from petsc4py import PETSc

from railhead.solver.algebra import linear, newton
from railhead.solver.algebra.newton import NewtonResult
from railhead.solver.algebra.problem import ContactProblem, Mask
from railhead.solver.contact import NEWTON_TOLERANCE, ContactModel, LoadCase
from railhead.solver.material.hardening import ROOT, History, deviator
from railhead.solver.material.plasticity import PlasticProblem, bulk_points, surface_points
from railhead.solver.setup import Setup
from railhead.solver.solution import PlasticSolution, PlasticStrain, Solution
from railhead.solver.space.cells import Array

UNLOADING = (0.95, 0.85, 0.4, 0.05)  # of the load, before the bodies part; the first steps follow
# the yield at the border of the patch as it begins to shrink
START = 1e-2  # tolerance of the linear solve that a smaller load starts from
ENDS = (1.0, 0.0)  # shares of the load that are reported; ...
BETWEEN = 1e-4  # ... tolerance of those on the way: moves what is reported by less than 1e-6
HALVES = 32  # into which a load step may be cut

State = tuple[History, History]  # at the Gauss points and at the contact points


@dataclass
class Released(PlasticProblem):
    """The bodies apart: no contact, and the approach, which then is free, held by `stiffness`.
    reference: force that the residual is measured by, N."""

    reference: float = 1.0

    def indicator(self, y: PETSc.Vec) -> Array:
        """Negative everywhere."""
        super().indicator(y)
        return np.full(len(self.area), -1.0)

    def contact_force(self, pressure: Array) -> float:
        """That of the load that was taken away."""
        return self.reference


class YieldingModel(ContactModel):
    """A contact model whose bodies yield. loading: of the last load case that yielded; share: of
    the load in its last step."""

    loading: Loading | None = None
    share: float = 1.0

    def __init__(self, mesh: object, cell_tags: object, facet_tags: object, setup: Setup) -> None:
        super().__init__(mesh, cell_tags, facet_tags, setup)
        assert setup.load_path is not None
        materials = self.materials
        slave = materials[setup.slave].hardening
        shared = {each.name: getattr(self.problem, each.name) for each in fields(ContactProblem)}
        shared["force"] = self.problem.force.duplicate()
        near, reduction, comm = setup.load_path.near, self.reduction, self.comm
        self.plastic = PlasticProblem(
            **shared,
            bulk=bulk_points(self.bulk, cell_tags, materials, near, reduction, comm),
            surface=surface_points(self.interface, slave, self.bulk, reduction, comm),
            across=dyads(self.interface.normals),
        )

    def run(self, case: LoadCase) -> Solution:
        """Up to the load as often as asked, and back."""
        return self.unloaded(self.press(case))

    def press(self, case: LoadCase) -> Solution:
        """The elastic solution, and from its first yield on the load in steps."""
        self.loading, self.share = None, 1.0
        elastic = super().press(case)
        over = self.over_first_yield(elastic, case.load, case.approach)
        if not elastic.newton.converged or over <= 1:
            return elastic
        assert self.setup.load_path is not None
        self.plastic.forget()
        self.loading = loading = Loading(self, case)
        up = np.linspace(1 / over, 1.0, self.setup.load_path.steps + 1)[1:]
        loading.touching = self.within(elastic.indicator, up[0])
        result = loading.march(up)
        first = len(loading.steps)
        for _ in range(self.setup.load_path.cycles - 1):
            if result.converged and loading.march(UNLOADING).converged:
                result = loading.march(up)
        yielding = PlasticSolution(
            load_over_first_yield=over,
            newton_results=tuple(loading.steps),
            first_loading_steps=first,
            indentation_depth={},
        )
        return replace(loading.found, reference=elastic, plasticity=yielding)

    def unloaded(self, solution: Solution) -> Solution:
        """With what is left once the load is taken away."""
        yielding, path, loading = solution.plasticity, self.setup.load_path, self.loading
        assert path is not None
        if not (yielding and loading and path.unload and solution.newton.converged):
            return solution
        left = self._unload(loading)
        yielding = replace(
            yielding, newton_results=tuple(loading.steps), residual_state=left,
            indentation_depth=self._indentation(left, solution.pressure),
        )  # fmt: skip
        return replace(solution, plasticity=yielding)

    def _indentation(self, unloaded: Solution, pressure: Array) -> dict[int, float]:
        """Against the mean normal of the patch that was pressed."""
        interface, dim = self.interface, self.setup.kinematics.dim
        normal = self.comm.allreduce((interface.weights * pressure) @ interface.normals)
        normal = normal / np.linalg.norm(normal)
        moved = unloaded.displacement.array.reshape(-1, dim) @ normal
        found = {}
        for side in (self.setup.fixed, self.setup.moving):
            if not side.rigid:
                inwards = -moved if side.tag == self.setup.slave else moved
                own = inwards[self._members(self.bulk.space, side.contact)]
                found[side.tag] = float(max(self.comm.allgather(np.max(own, initial=-np.inf))))
        return found

    def within(self, indicator: Array, share: float) -> Mask:
        """Points that touch under a multiple of the load: those with the highest indicator, on an
        area that grows as Hertz's."""
        every = np.concatenate(self.comm.allgather(indicator))
        order = np.argsort(-every)
        area = np.cumsum(np.concatenate(self.comm.allgather(self.interface.weights))[order])
        touching = area[np.count_nonzero(every > 0) - 1]
        last = np.searchsorted(area, touching * share ** (1 / 2 if self._line else 2 / 3))
        return np.asarray(indicator >= every[order[min(int(last), len(order) - 1)]])

    @property
    def _line(self) -> bool:
        return self.setup.kinematics.dim == 2 and not self.setup.kinematics.revolved

    def over_first_yield(self, elastic: Solution, load: float, approach: float) -> float:
        """The load over that of first yield, by the largest elastic von Mises stress (Hertz: the
        cube of the stress, of a line contact the square)."""
        self.plastic.stretched(self.load(self.plastic, load, approach, None))
        worst = 0.0
        for points in (self.plastic.bulk, self.plastic.surface):
            strain = points.strains(elastic.newton.y) + points.start
            stress = 2 * points.mu[:, None] * deviator(strain)
            size = np.sqrt(np.einsum("nm,nm->n", stress, stress))
            for members, hardening in points.groups:
                worst = max(worst, float(np.max(size[members], initial=0.0)) / hardening.first)
        return float(max(self.comm.allgather(worst / ROOT))) ** (2 if self._line else 3)

    def _unload(self, loading: Loading) -> Solution:
        """Step by step, at last without contact."""
        reference = self.plastic.contact_force(loading.found.pressure)
        if loading.march(UNLOADING).converged:
            released = self._released(reference)
            loading.problem, loading.touching = released, np.zeros(len(released.area), dtype=bool)
            loading.preconditioner = self.new_preconditioner(released)
            loading.march([0.0])
        return loading.found

    def plastic_strain(self, history: History) -> PlasticStrain:
        """A history on all cells of this rank."""
        topology = self.bulk.space.mesh.topology
        count = topology.index_map(topology.dim).size_local
        cells = self.plastic.bulk.cells
        each = len(history.equivalent) // max(len(cells), 1) or 1
        each = max(self.comm.allgather(each))
        strain, equivalent = np.zeros((count, each, 3, 3)), np.zeros((count, each))
        own = self.setup.kinematics.tensors(history.plastic)
        strain[cells] = own.reshape(len(cells), each, 3, 3)
        equivalent[cells] = history.equivalent.reshape(len(cells), each)
        return PlasticStrain(strain, equivalent)

    def _released(self, reference: float) -> Released:
        given = {
            each.name: getattr(self.plastic, each.name)
            for each in fields(PlasticProblem)
            if each.init
        }
        given["force"] = self.plastic.force.duplicate()
        stiffness = self.plastic.stiffness
        given["stiffness"] = stiffness.pinned(stiffness.typical)
        return Released(**given, reference=reference)


class Loading:
    """The way of a load case: shares of it, one after the other, each from the state of the
    last."""

    def __init__(self, model: YieldingModel, case: LoadCase) -> None:
        self.model, self.problem, self.case = model, model.plastic, case
        self.preconditioner = model.preconditioner
        self.steps: list[NewtonResult] = []
        self.share, self.y = 0.0, None
        self.state = self.problem.bulk.history, self.problem.surface.history
        self.touching: Mask = np.zeros(len(self.problem.area), dtype=bool)

    def sheared(self, force: PETSc.Vec, state: State) -> Solution:
        """The same share from a state, under another further force at the full load."""
        self.case, self.state = replace(self.case, force=force), state
        self._step(self.share)
        return self.found

    def march(self, shares: Iterable[float]) -> NewtonResult:
        """Go to shares of the load, by halves where a step does not converge."""
        for share in shares:
            least = abs(share - self.share) / HALVES
            while self.share != share:
                aim = share
                while not (result := self._step(aim)).converged:
                    if abs(aim - self.share) <= least:
                        return result
                    aim = (aim + self.share) / 2
        return self.found.newton

    def _step(self, share: float) -> NewtonResult:
        model, problem, case = self.model, self.problem, self.case
        approach = share * case.approach
        force = None if case.force is None else case.force * float(share)
        model.share = share
        prescribed = model.load(problem, share * case.load, approach, force)
        problem.stretched(prescribed)
        y = self.y
        if share < self.share:
            problem.commit(self.state)
        if y is not None and share:
            y = self._nearer(y, share / self.share)
        problem.commit(self.state)
        result = newton.solve(
            problem, self.preconditioner, self.touching, y,
            rtol=NEWTON_TOLERANCE if share in ENDS else BETWEEN, max_steps=case.max_steps,
            progress=case.progress,
        )  # fmt: skip
        self.steps.append(result)
        found = model.found(problem, result, prescribed, approach, force)
        if result.converged:
            self.state = problem.state
        self.found = replace(found, plastic_strain=model.plastic_strain(self.state[0]))
        if result.converged:
            self.share, self.y, self.touching = share, result.y, result.pressure > 0
        return result

    def _nearer(self, y: PETSc.Vec, share: float) -> PETSc.Vec:
        """The solution of the linear problem in which the patch changes with the load as Hertz's
        would, or the last solution where that tangent is singular. Before the last state is the
        history, that is with the tangent of yield that goes on, behind it with that of
        unloading."""
        problem = self.problem
        indicator = problem.indicator(y)
        touching = self.model.within(indicator, share)
        residual, step = problem.residual(y, np.where(touching, indicator, 0.0)), y.duplicate()
        try:
            linear.solve(problem, self.preconditioner, touching, residual, step, START)
        except linear.StalledError:
            return y
        return y - step


def dyads(normals: Array) -> Array:
    """n x n (q, m) in Mandel's notation of unit vectors (q, c)."""
    dim = normals.shape[1]
    shears = [(1, 2), (0, 2), (0, 1)] if dim == 3 else [(0, 1)]
    out = np.zeros((len(normals), 3 + len(shears)))
    out[:, :dim] = normals**2
    for column, (i, j) in enumerate(shears, 3):
        out[:, column] = np.sqrt(2) * normals[:, i] * normals[:, j]
    return out
