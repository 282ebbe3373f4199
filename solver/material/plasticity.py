"""The contact problem of bodies that yield.

    R(y) = R_elastic(y) - E^T w C eps_p + theta S^T w_c t - Bt^T w_c (p - p_elastic)

E y + e0 are the strains at the Gauss points of K and at the contact points, e0 those of the
prescribed displacement. Their plastic parts eps_p follow from the history by radial return
(`solver.material.hardening`). Plastic strain lowers the normal stress of Nitsche's method by
t = 2 mu n . eps_p . n, so that s = S u - t. Test functions stay elastic. The history is an array;
no matrix is assembled again.
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
from railhead.solver.material.elasticity import Material
from railhead.solver.material.hardening import Hardening, History, TangentReduction, radial_return
from railhead.solver.space.cells import Array, Bulk, CellSet, Index, quadrature_degree
from railhead.solver.space.constraints import Reduction
from railhead.solver.space.operators import add_transposed, assemble_strains, select_rows

State = tuple[History, History]
"""Histories at the Gauss points and at the contact points."""


@dataclass(kw_only=True)
class YieldPoints:
    """n local points at which plastic strain is followed, with m strain components each.

    strain_matrix: E, n m rows: strains of the free unknowns.
    full_strain_matrix: the same for all dofs.
    prescribed_strain: strain (n, m) of the prescribed displacement u0.
    cells: numbers (k,) of this rank's cells that the Gauss points lie in, cell by cell.
    points: (n, 3) mm in space.
    weights: (n,) mm3, of contact points mm2.
    mu: shear modulus (n,), MPa.
    groups: for each body that yields, numbers of its points, and its hardening.
    history: at the end of the last load step.
    """

    strain_matrix: PETSc.Mat
    full_strain_matrix: PETSc.Mat
    prescribed_strain: Array
    cells: Index
    points: Array
    weights: Array
    mu: Array
    groups: list[tuple[Index, Hardening]]
    history: History

    def strains(self, y: PETSc.Vec) -> Array:
        """E y (n, m)."""
        return np.asarray((self.strain_matrix * y).array).reshape(self.prescribed_strain.shape)

    def set_prescribed_strain(self, prescribed: PETSc.Vec) -> None:
        """Take the strain of a displacement u0 on all dofs, mm."""
        strain = np.array((self.full_strain_matrix * prescribed).array)
        self.prescribed_strain = strain.reshape(self.prescribed_strain.shape)

    def return_mapping(self, y: PETSc.Vec) -> tuple[History, TangentReduction | None]:
        """State after a step from the history to the strains of y, and by what yield reduces the
        tangent; None instead where no body yields here."""
        strain = self.strains(y) + self.prescribed_strain
        state = History(*(getattr(self.history, each.name).copy() for each in fields(History)))
        reductions = []
        for members, hardening in self.groups:
            before = History(*(getattr(state, each.name)[members] for each in fields(History)))
            after, reduction = radial_return(strain[members], self.mu[members], before, hardening)
            for each in fields(History):
                getattr(state, each.name)[members] = getattr(after, each.name)
            reductions.append(reduction.renumbered(members))
        return state, TangentReduction.joined(reductions) if reductions else None

    def strain_rows(self, reduction: TangentReduction | None) -> PETSc.Mat:
        """Rows of E of the points that yield: k m on this rank (collective)."""
        points = np.zeros(0, dtype=np.int64) if reduction is None else reduction.points
        size = self.prescribed_strain.shape[1]
        rows = (points[:, None] * size + np.arange(size)).ravel()
        return select_rows(self.strain_matrix, rows)

    def add_forces(self, stress: Array, out: PETSc.Vec) -> None:
        """out += E^T w stress, for stresses (n, m) in MPa."""
        add_transposed(self.strain_matrix, self.weights[:, None] * stress, out)


@dataclass
class PlasticProblem(ContactProblem):
    """The contact problem at one load step.

    bulk: Gauss points of the bodies that yield.
    surface: contact points; none where the slave does not yield.
    normal_dyads: n x n (q, m) at the contact points, in Mandel's notation.
    """

    bulk: YieldPoints = field(kw_only=True)
    surface: YieldPoints = field(kw_only=True)
    normal_dyads: Array = field(kw_only=True)

    def __post_init__(self) -> None:
        self._bulk: tuple[History, TangentReduction | None] = self.bulk.history, None
        self._surface: tuple[History, TangentReduction | None] = self.surface.history, None
        self._yielding_operators: tuple[PETSc.Mat, PETSc.Mat] | None = None

    @property
    def tangent_depends_on_state(self) -> bool:
        """True: yield changes the tangent while the active set stays."""
        return True

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric: not where contact points of Nitsche's method yield, on
        any rank."""
        reduction = self._surface[1]
        local = len(reduction.points) if reduction is not None and self.law.sigma else 0
        total = self.stiffness.comm.tompi4py().allreduce(local)
        return self.law.symmetric and not total

    def indicator(self, y: PETSc.Vec) -> Array:
        """-(B y + c - t) (n,), MPa. Sets the state that `residual`, `tangent` and `state` use."""
        self._bulk, self._surface = self.bulk.return_mapping(y), self.surface.return_mapping(y)
        self._yielding_operators = None
        plastic = self.plastic_normal_stress(self._surface[0].plastic)
        return super().indicator(y) + self.law.sigma * plastic

    def plastic_normal_stress(self, plastic: Array) -> Array:
        """t = 2 mu n . eps_p . n (n,), MPa, of plastic strains (n, m) at the contact points."""
        strain = np.einsum("nm,nm->n", self.normal_dyads, plastic)
        return np.asarray(2 * self.surface.mu * strain)

    def residual(self, y: PETSc.Vec, pressure: Array) -> PETSc.Vec:
        """R(y), N. pressure: p(y), which must have been the last call of `pressure`."""
        r = super().residual(y, pressure)
        plastic = self._bulk[0].plastic
        self.bulk.add_forces(-2 * self.bulk.mu[:, None] * plastic, r)
        if self.consistency:
            stress = self.plastic_normal_stress(self._surface[0].plastic)
            add_transposed(self.stress, self.consistency * self.weight * stress, r)
        return r

    def slope(self, y: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """t -> R(y + t step) . step, N mm."""

        def value(t: float) -> float:
            at = y.copy()
            at.axpy(t, step)
            return float(self.residual(at, self.pressure(at)).dot(step))

        return value

    def tangent(self, active: Mask) -> PETSc.Mat:
        """The consistent tangent of the last state as an operator (nothing is assembled)."""
        return self.shell(_PlasticTangent(self, active))

    def set_prescribed_strain(self, prescribed: PETSc.Vec) -> None:
        """Take the strains of a displacement u0 on all dofs, mm."""
        self.bulk.set_prescribed_strain(prescribed)
        self.surface.set_prescribed_strain(prescribed)

    def reset_history(self) -> None:
        """Set plastic strain and back stress to zero."""
        for points in (self.bulk, self.surface):
            points.history = History.virgin(*points.prescribed_strain.shape)
        self._bulk, self._surface = (self.bulk.history, None), (self.surface.history, None)
        self._yielding_operators = None

    @property
    def state(self) -> State:
        """State at the Gauss points and at the contact points after the last `indicator`."""
        return self._bulk[0], self._surface[0]

    def commit(self, state: State) -> None:
        """Make a state the history that the next step starts from."""
        self.bulk.history, self.surface.history = state

    @property
    def yielding_operators(self) -> tuple[PETSc.Mat, PETSc.Mat]:
        """Rows of E at the Gauss and at the contact points that yield in the last state."""
        if self._yielding_operators is None:
            self._yielding_operators = (
                self.bulk.strain_rows(self._bulk[1]),
                self.surface.strain_rows(self._surface[1]),
            )
        return self._yielding_operators

    def apply_tangent_loss(self, x: PETSc.Vec, out: PETSc.Vec) -> Array:
        """out -= E^T w (C - C_ep) E x.

        Returns n . (C - C_ep) E x . n (n,) at the contact points, MPa: by what yield reduces the
        change of their normal stress.
        """
        (bulk, surface), normal = self.yielding_operators, np.zeros(len(self.area))
        strain, reduction = (bulk * x).array, self._bulk[1]
        if reduction is not None:
            stress = reduction.stress(strain.reshape(reduction.normal.shape))
            strain = -self.bulk.weights[reduction.points, None] * stress
        add_transposed(bulk, strain, out)
        strain, reduction = (surface * x).array, self._surface[1]
        if reduction is not None:
            stress = reduction.stress(strain.reshape(reduction.normal.shape))
            dyads = self.normal_dyads[reduction.points]
            normal[reduction.points] = np.einsum("nm,nm->n", dyads, stress)
        return normal


class _PlasticTangent(Tangent):
    """y -> K y - E^T w (C - C_ep) E y - theta S^T w S_ep y + Bt^T w A B_ep y."""

    def mult(self, mat: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        super().mult(mat, x, y)
        problem = self.problem
        loss = problem.apply_tangent_loss(x, y)
        if not problem.symmetric:  # contact points yield, on any rank
            contact = -problem.law.sigma * problem.weight * self.active * loss
            add_transposed(problem.test_operator, contact, y)
            if problem.consistency:
                values = problem.consistency * problem.weight * loss
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

    materials: by the cell tag of the body. near: centroids of cells in space (k, 3) mm -> mask.
    """
    mesh, kinematics = bulk.space.mesh, bulk.kinematics
    own = mesh.topology.index_map(mesh.topology.dim).size_local
    parts, curves = [], []
    for tag, material in materials.items():
        if material.hardening is None:
            continue
        numbers = cell_tags.find(tag)
        numbers = numbers[numbers < own].astype(np.int64)
        if len(numbers):
            centroids = CellSet.of(bulk, numbers).nodes.mean(axis=1)
            numbers = numbers[near(kinematics.lift(centroids))]
        parts.append(numbers)
        curves.append(material.hardening)
    every = np.concatenate(parts)
    cells = CellSet.of(bulk, every)
    degree = quadrature_degree(cells.cell, cells.degree, kinematics)
    (index, reference), x, weights = cells.quadrature_points(degree)
    each = len(weights) // max(len(cells), 1)
    ends = np.cumsum([0, *(len(part) * each for part in parts)])
    groups = [
        (np.arange(start, end), curve)
        for start, end, curve in zip(ends, ends[1:], curves, strict=False)
    ]
    matrices = _strain_matrices(cells, index, reference, bulk, reduction, comm)
    return YieldPoints(
        **matrices,
        cells=every,
        points=kinematics.lift(x),
        weights=weights,
        mu=cells.lame[index, 1],
        groups=groups,
    )


def surface_points(
    interface: Interface,
    hardening: Hardening | None,
    bulk: Bulk,
    reduction: Reduction,
    comm: MPI.Intracomm,
) -> YieldPoints:
    """The contact points, in the slave; without hardening they stay elastic."""
    slave, index = interface.slave, interface.facet
    every = np.arange(len(index))
    reference = slave.reference(index, interface.xi)
    matrices = _strain_matrices(slave, index, reference, bulk, reduction, comm)
    return YieldPoints(
        **matrices,
        cells=np.zeros(0, dtype=np.int64),
        points=slave.kinematics.lift(interface.points),
        weights=interface.weights,
        mu=slave.lame[index, 1],
        groups=[] if hardening is None else [(every, hardening)],
    )


def _strain_matrices(
    cells: CellSet,
    index: Index,
    reference: Array,
    bulk: Bulk,
    reduction: Reduction,
    comm: MPI.Intracomm,
) -> dict[str, Any]:
    """Strain matrices and zero states of `YieldPoints` at reference points of cells."""
    owned = bulk.space.dofmap.index_map.size_local * cells.kinematics.dim
    full, size = assemble_strains(cells, index, reference, owned, comm)
    return {
        "strain_matrix": full.matMult(reduction.matrix),
        "full_strain_matrix": full,
        "prescribed_strain": np.zeros((len(index), size)),
        "history": History.virgin(len(index), size),
    }


def normal_dyads(normals: Array) -> Array:
    """n x n (q, m) of unit vectors (q, c), in Mandel's notation."""
    dim = normals.shape[1]
    shears = [(1, 2), (0, 2), (0, 1)] if dim == 3 else [(0, 1)]
    out = np.zeros((len(normals), 3 + len(shears)))
    out[:, :dim] = normals**2
    for column, (i, j) in enumerate(shears, 3):
        out[:, column] = np.sqrt(2) * normals[:, i] * normals[:, j]
    return out
