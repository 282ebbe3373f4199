"""The contact problem of bodies that yield.

    R(y) = R_elastic(y) - E^T w C eps_p + theta S^T w_c t - Bt^T w_c (p - p_elastic)

with the strains E y + e0 at the Gauss points of K and at the contact points, their plastic parts
eps_p by a radial return from the history (`solver.hardening`), and t = 2 mu n . eps_p . n, by which
the normal stress of Nitsche's method is lower: s = S u - t. Test functions stay elastic. The
history is an array; nothing is assembled anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.algebra.problem import ContactProblem, Mask, Tangent
from railhead.solver.interface.jumps import Interface
from railhead.solver.material.elasticity import Bulk, Material, quadrature_degree
from railhead.solver.material.hardening import Hardening, History, Loss, returned
from railhead.solver.space.cells import Array, CellSet, Index
from railhead.solver.space.constraints import Reduction
from railhead.solver.space.operators import add_transposed, chosen, strains


@dataclass
class YieldPoints:
    """n local points whose plastic strain is followed, with m strain components each.

    strain: E (n m rows) on the free unknowns; full: the same on all dofs; weights (n,) mm3 (mm2 at
    contact points); mu (n,) MPa; groups: points and curve of each body; start (n, m): strain of u0;
    points (n, 3) mm in space, cells (k,) of this rank that they are in, cell by cell; history: at
    the end of the last load step.
    """

    strain: PETSc.Mat
    full: PETSc.Mat
    cells: Index
    points: Array
    weights: Array
    mu: Array
    groups: list[tuple[Index, Hardening]]
    history: History
    start: Array

    def strains(self, y: PETSc.Vec) -> Array:
        """E y (n, m)."""
        return np.asarray((self.strain * y).array).reshape(self.start.shape)

    def stretched(self, prescribed: PETSc.Vec) -> None:
        """Set the strain of u0."""
        self.start = np.array((self.full * prescribed).array).reshape(self.start.shape)

    def returned(self, y: PETSc.Vec) -> tuple[History, Loss | None]:
        """State after a step from the history to the strains of y, and what the tangent loses; None
        where there are no points."""
        strain = self.strains(y) + self.start
        state = History(*(getattr(self.history, each.name).copy() for each in fields(History)))
        losses = []
        for members, hardening in self.groups:
            before = History(*(getattr(state, each.name)[members] for each in fields(History)))
            after, loss = returned(strain[members], self.mu[members], before, hardening)
            for each in fields(History):
                getattr(state, each.name)[members] = getattr(after, each.name)
            losses.append(loss.among(members))
        return state, Loss.joined(losses) if losses else None

    def rows(self, points: Index) -> PETSc.Mat:
        """Those of E that belong to some of the points (k,): k m of this rank."""
        size = self.start.shape[1]
        return chosen(self.strain, (points[:, None] * size + np.arange(size)).ravel())

    def add_forces(self, stress: Array, out: PETSc.Vec) -> None:
        """out += E^T w stress, stresses (n, m) in MPa."""
        add_transposed(self.strain, self.weights[:, None] * stress, out)


@dataclass
class PlasticProblem(ContactProblem):
    """The contact problem at one load step. bulk: Gauss points; surface: contact points (none where
    the slave does not yield), with n x n (q, m) in Mandel's notation."""

    bulk: YieldPoints = field(kw_only=True)
    surface: YieldPoints = field(kw_only=True)
    across: Array = field(kw_only=True)

    def __post_init__(self) -> None:
        self._bulk: tuple[History, Loss | None] = self.bulk.history, None
        self._surface: tuple[History, Loss | None] = self.surface.history, None
        self._soft: tuple[PETSc.Mat, PETSc.Mat] | None = None

    @property
    def curved(self) -> bool:
        """Yield does that."""
        return True

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is: not where contact points of Nitsche's method yield (of all
        ranks)."""
        loss = self._surface[1]
        soft = len(loss.points) if loss is not None and self.law.sigma else 0
        total = self.stiffness.comm.tompi4py().allreduce(soft)
        return self.law.symmetric and not total

    def indicator(self, y: PETSc.Vec) -> Array:
        """-(B y + c - t) (n,), MPa. Sets the state that `residual` and `tangent` are of."""
        self._bulk, self._surface = self.bulk.returned(y), self.surface.returned(y)
        self._soft = None
        return super().indicator(y) + self.law.sigma * self.missing(self._surface[0].plastic)

    def missing(self, plastic: Array) -> Array:
        """t (n,) MPa at the contact points, of plastic strains there."""
        lost = 2 * self.surface.mu * np.einsum("nm,nm->n", self.across, plastic)
        return np.asarray(lost)

    def residual(self, y: PETSc.Vec, pressure: Array) -> PETSc.Vec:
        """R(y), N, for the pressure of the same y, asked before."""
        r = super().residual(y, pressure)
        plastic = self._bulk[0].plastic
        self.bulk.add_forces(-2 * self.bulk.mu[:, None] * plastic, r)
        if self.consistency:
            lost = self.missing(self._surface[0].plastic)
            add_transposed(self.stress, self.consistency * self.weight * lost, r)
        return r

    def slope(self, y: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """t -> R(y + t step) . step, N mm."""

        def value(t: float) -> float:
            at = y.copy()
            at.axpy(t, step)
            return float(self.residual(at, self.pressure(at)).dot(step))

        return value

    def tangent(self, active: Mask) -> PETSc.Mat:
        """The consistent tangent of the last state as an operator."""
        return self.shell(_PlasticTangent(self, active))

    def stretched(self, prescribed: PETSc.Vec) -> None:
        """Set the strains of u0."""
        self.bulk.stretched(prescribed)
        self.surface.stretched(prescribed)

    def forget(self) -> None:
        """Nothing has yielded yet."""
        for points in (self.bulk, self.surface):
            points.history = History.virgin(*points.start.shape)
        self._bulk, self._surface = (self.bulk.history, None), (self.surface.history, None)
        self._soft = None

    @property
    def state(self) -> tuple[History, History]:
        """The last one, at the Gauss and at the contact points."""
        return self._bulk[0], self._surface[0]

    def commit(self, state: tuple[History, History]) -> None:
        """Make a state the history of the next step."""
        self.bulk.history, self.surface.history = state

    @property
    def yielding(self) -> int:
        """Gauss points that yield in the last state, of all ranks."""
        local = 0 if self._bulk[1] is None else len(self._bulk[1].points)
        return int(self.stiffness.comm.tompi4py().allreduce(local))

    @property
    def soft(self) -> tuple[PETSc.Mat, PETSc.Mat]:
        """Rows of E at the Gauss and at the contact points that yield in the last state."""
        if self._soft is None:
            self._soft = tuple(
                at.rows(np.zeros(0, dtype=np.int64) if loss is None else loss.points)
                for at, loss in ((self.bulk, self._bulk[1]), (self.surface, self._surface[1]))
            )
        return self._soft

    def lost(self, x: PETSc.Vec, out: PETSc.Vec) -> Array:
        """out -= E^T w (C - C_ep) E x; returns what the normal stress loses at contact points."""
        (bulk, surface), normal = self.soft, np.zeros(len(self.area))
        strain, loss = (bulk * x).array, self._bulk[1]
        if loss is not None:
            stress = loss.of(strain.reshape(loss.normal.shape))
            strain = -self.bulk.weights[loss.points, None] * stress
        add_transposed(bulk, strain, out)
        strain, loss = (surface * x).array, self._surface[1]
        if loss is not None:
            stress = loss.of(strain.reshape(loss.normal.shape))
            normal[loss.points] = np.einsum("nm,nm->n", self.across[loss.points], stress)
        return normal


class _PlasticTangent(Tangent):
    """y -> K y - E^T w (C - C_ep) E y - theta S^T w S_ep y + Bt^T w A B_ep y."""

    def mult(self, mat: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        super().mult(mat, x, y)
        problem = self.problem
        lost = problem.lost(x, y)
        if not problem.symmetric:  # contact points yield, on any rank
            contact = -problem.law.sigma * problem.weight * self.active * lost
            add_transposed(problem.test_trace, contact, y)
            if problem.consistency:
                values = problem.consistency * problem.weight * lost
                add_transposed(problem.stress, values, y)


def bulk_points(
    bulk: Bulk,
    cell_tags: Any,
    materials: Mapping[int, Material],
    near: Callable[[Array], Mask],
    reduction: Reduction,
    comm: MPI.Intracomm,
) -> YieldPoints:
    """The Gauss points of K in this rank's cells near the contact, in the bodies that yield.

    near: points in space (k, 3) mm, the middles of cells -> mask.
    """
    mesh, kinematics = bulk.space.mesh, bulk.kinematics
    own = mesh.topology.index_map(mesh.topology.dim).size_local
    chosen, curves = [], []
    for tag, material in materials.items():
        if material.hardening is None:
            continue
        cells = cell_tags.find(tag)
        cells = cells[cells < own].astype(np.int64)
        nodes = CellSet.of(bulk, cells).nodes.mean(axis=1) if len(cells) else np.zeros((0, 3))
        cells = cells[near(kinematics.lift(nodes))] if len(cells) else cells
        chosen.append(cells)
        curves.append(material.hardening)
    every = np.concatenate(chosen)
    cells = CellSet.of(bulk, every)
    (index, reference), x, weights = cells.quadrature_points(
        quadrature_degree(cells.cell, cells.degree, kinematics)
    )
    each = len(weights) // max(len(cells), 1)
    ends = np.cumsum([0, *(len(part) * each for part in chosen)])
    groups = [
        (np.arange(start, end), curve)
        for start, end, curve in zip(ends, ends[1:], curves, strict=False)
    ]
    return _points(cells, every, index, reference, x, weights, groups, bulk, reduction, comm)


def surface_points(
    interface: Interface,
    hardening: Hardening | None,
    bulk: Bulk,
    reduction: Reduction,
    comm: MPI.Intracomm,
) -> YieldPoints:
    """The contact points, in the slave."""
    slave, index = interface.slave, interface.facet
    reference = slave.reference(index, interface.xi)
    here = np.arange(len(index))
    groups: list[tuple[Index, Hardening]] = [] if hardening is None else [(here, hardening)]
    return _points(
        slave, np.zeros(0, dtype=np.int64), index, reference, interface.points, interface.weights,
        groups, bulk, reduction, comm,
    )  # fmt: skip


def _points(
    cells: CellSet,
    numbers: Index,
    index: Index,
    reference: Array,
    x: Array,
    weights: Array,
    groups: list[tuple[Index, Hardening]],
    bulk: Bulk,
    reduction: Reduction,
    comm: MPI.Intracomm,
) -> YieldPoints:
    owned = bulk.space.dofmap.index_map.size_local * cells.kinematics.dim
    full, size = strains(cells, index, reference, owned, comm)
    return YieldPoints(
        full.matMult(reduction.matrix), full, numbers, cells.kinematics.lift(x), weights,
        cells.lame[index, 1], groups, History.virgin(len(index), size),
        np.zeros((len(index), size)),
    )  # fmt: skip
