"""Loading and unloading of bodies that yield, step by step."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver import newton
from railhead.solver.cells import Array
from railhead.solver.contact import NEWTON_TOLERANCE, ContactModel, Solution
from railhead.solver.hardening import ROOT, History, deviator
from railhead.solver.newton import NewtonResult
from railhead.solver.plasticity import PlasticProblem, bulk_points, surface_points
from railhead.solver.problem import ContactProblem

UNLOADING = (0.6, 0.3, 0.1, 0.02)  # of the load, before the bodies part
APART = 1.0  # mm, by which the surfaces are moved apart in the end


@dataclass(frozen=True)
class Yielded(Solution):
    """A load case with yield. elastic: the same without; over: load over that of first yield (1 or
    less: nothing yields, and the rest is None); points (n, 3) mm and weights (n,) mm3 of the local
    Gauss points that were followed, and their history under the load; steps: Newton's histories of
    all load steps; unloaded: the residual state (None if it was not asked for)."""

    elastic: Solution
    over: float
    points: Array
    weights: Array
    history: History
    steps: list[NewtonResult]
    unloaded: Unloaded | None = None


@dataclass(frozen=True)
class Unloaded:
    """displacement: owned dofs, mm, the bodies apart; history of the points of `Yielded`."""

    displacement: PETSc.Vec
    history: History
    newton: NewtonResult


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
    """A contact model whose bodies yield."""

    def __init__(self, mesh: object, cell_tags: object, facet_tags: object, setup: object) -> None:
        super().__init__(mesh, cell_tags, facet_tags, setup)
        setup = self.setup
        assert setup.path is not None
        sides = [side for side in (setup.fixed, setup.moving) if not side.rigid]
        materials = {side.tag: side.material for side in sides}
        slave = materials[setup.slave].hardening
        normals = self.interface.normals
        shared = {each.name: getattr(self.problem, each.name) for each in fields(ContactProblem)}
        shared["force"] = self.problem.force.duplicate()
        self.plastic = PlasticProblem(
            **shared,
            bulk=bulk_points(
                self.bulk, cell_tags, materials, setup.path.near, self.reduction, self.comm
            ),
            surface=surface_points(self.interface, slave, self.bulk, self.reduction, self.comm),
            across=dyads(normals),
        )

    def solve(
        self,
        *,
        load: float = 0.0,
        approach: float = 0.0,
        active: NDArray[np.bool_],
        max_steps: int = 30,
        progress: Callable[[int, float], None] = lambda step, residual: None,
        force: PETSc.Vec | None = None,
    ) -> Solution:
        """The elastic solution, and from its first yield on the load in steps and back."""
        elastic = super().solve(
            load=load, approach=approach, active=active, max_steps=max_steps, progress=progress,
            force=force,
        )  # fmt: skip
        path, problem = self.setup.path, self.plastic
        over = self.over_first_yield(elastic, load, approach)
        if not elastic.newton.converged or over <= 1 or path is None:
            return elastic
        start = time.perf_counter()
        steps: list[NewtonResult] = []
        y: PETSc.Vec | None = None
        shares = np.linspace(1 / over, 1.0, path.steps + 1)[1:]
        touching = self._within(elastic.pressure, shares[0])
        for share in shares:
            prescribed = self._strain(problem, share * load, share * approach, force)
            result = newton.solve(
                problem, self.preconditioner, touching, y,
                rtol=NEWTON_TOLERANCE, max_steps=max_steps, progress=progress,
            )  # fmt: skip
            steps.append(result)
            found = self.found(problem, result, prescribed, share * approach, force)
            if not result.converged:
                break
            problem.commit()
            y, touching = result.y, result.pressure > 0
        points = problem.bulk
        given = {each.name: getattr(found, each.name) for each in fields(Solution)}
        solution = Yielded(
            **given, elastic=elastic, over=over, points=points.points, weights=points.weights,
            history=points.history, steps=steps,
        )  # fmt: skip
        if path.unload and result.converged:
            solution = replace(
                solution, unloaded=self._unload(load, approach, y, found, max_steps, progress)
            )
        self.seconds["solve"] += time.perf_counter() - start
        return solution

    def _strain(
        self, problem: PlasticProblem, load: float, approach: float, force: PETSc.Vec | None
    ) -> PETSc.Vec:
        prescribed = self.load(problem, load, approach, force)
        problem.bulk.stretched(prescribed)
        problem.surface.stretched(prescribed)
        return prescribed

    def _within(self, pressure: Array, share: float) -> NDArray[np.bool_]:
        """Points that touch under a share of the load, if the pressure is Hertz's."""
        highest = max(self.comm.allgather(float(np.max(pressure, initial=0.0))))
        return np.asarray(pressure > highest * np.sqrt(1 - min(share, 1.0) ** (2 / 3)))

    def over_first_yield(self, elastic: Solution, load: float, approach: float) -> float:
        """The load over that of first yield, by the largest elastic von Mises stress (Hertz: the
        cube of the stress, of a line contact the square)."""
        self._strain(self.plastic, load, approach, None)
        worst = 0.0
        for points in (self.plastic.bulk, self.plastic.surface):
            stress = 2 * points.mu[:, None] * deviator(
                points.strains(elastic.newton.y) + points.start
            )
            size = np.sqrt(np.einsum("nm,nm->n", stress, stress))
            for members, hardening in points.groups:
                worst = max(worst, float(np.max(size[members], initial=0.0)) / hardening.first)
        line = self.setup.kinematics.dim == 2 and not self.setup.kinematics.revolved
        return float(max(self.comm.allgather(worst / ROOT))) ** (2 if line else 3)

    def _unload(
        self,
        load: float,
        approach: float,
        y: PETSc.Vec,
        found: Solution,
        max_steps: int,
        progress: Callable[[int, float], None],
    ) -> Unloaded:
        problem = self.plastic
        reference = problem.contact_force(found.pressure)
        for share in UNLOADING:
            self._strain(problem, share * load, share * approach, None)
            result = newton.solve(
                problem, self.preconditioner, found.pressure > 0, y,
                rtol=NEWTON_TOLERANCE, max_steps=max_steps, progress=progress,
            )  # fmt: skip
            if not result.converged:
                return Unloaded(found.displacement, problem.bulk.history, result)
            problem.commit()
            y = result.y
        released = self._released(reference)
        prescribed = self._strain(released, 0.0, 0.0, None)
        result = newton.solve(
            released, self.new_preconditioner(released), np.zeros(len(found.pressure), dtype=bool),
            y, rtol=NEWTON_TOLERANCE, max_steps=max_steps, progress=progress,
        )  # fmt: skip
        released.commit()
        displacement = prescribed.copy()
        self.reduction.matrix.multAdd(result.y, prescribed, displacement)
        return Unloaded(displacement, released.bulk.history, result)

    def _released(self, reference: float) -> Released:
        given = {
            each.name: getattr(self.plastic, each.name)
            for each in fields(PlasticProblem)
            if each.init
        }
        stiffness = self.plastic.stiffness.copy()
        if self.setup.load_control:
            diagonal = stiffness.getDiagonal()
            typical = diagonal.sum() / diagonal.getSize()
            extra = diagonal.duplicate()
            extra.set(0.0)
            if self.reduction.approach >= 0:
                extra.array[self.reduction.approach] = typical
            stiffness.setDiagonal(diagonal + extra)
        given["stiffness"] = stiffness
        given["force"] = self.plastic.force.duplicate()
        return Released(**given, reference=reference)


def dyads(normals: Array) -> Array:
    """n x n (q, m) in Mandel's notation of unit vectors (q, c)."""
    dim = normals.shape[1]
    shears = [(1, 2), (0, 2), (0, 1)] if dim == 3 else [(0, 1)]
    out = np.zeros((len(normals), 3 + len(shears)))
    out[:, :dim] = normals**2
    for column, (i, j) in enumerate(shears, 3):
        out[:, column] = np.sqrt(2) * normals[:, i] * normals[:, j]
    return out
