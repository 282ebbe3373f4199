"""The contact problem of bodies that yield.

    R(y) = R_elastic(y) - E^T w C eps_p + theta S^T w_c t - Bt^T w_c (p - p_elastic)

E y + e0 are the strains at the Gauss points of K and at the contact points, e0 those of the
prescribed displacement. Their plastic parts eps_p follow from the history by radial return
(`solver.material.hardening`). Plastic strain lowers the normal stress of Nitsche's method by
t = 2 mu n . eps_p . n, so that s = S u - t. Test functions stay elastic. The history is an array;
no matrix is assembled again.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.algebra.problem import ContactProblem
from railhead.solver.material import Hardening, Material, backs
from railhead.solver.plasticity.radial_return import History, TangentReduction, radial_return
from railhead.solver.space.cells import Bulk, CellSet, quadrature_degree
from railhead.solver.space.contact_interface import Interface
from railhead.solver.space.operators import add_transposed, assemble_strains, select_rows
from railhead.solver.space.supports import Reduction
from railhead.theory.array_types import Array, Index, Mask

State = tuple[History, History]
"""Histories at the Gauss points and at the contact points."""


@dataclass(kw_only=True)
class YieldPoints:
    """n points of this rank at which plastic strain is followed, with m strain components each, in
    Mandel's notation.

    strain_matrix: E with n m rows: strains per free unknown, 1/mm.
    full_strain_matrix: strains per dof, n m rows, 1/mm.
    prescribed_strain: strain (n, m) of the prescribed displacement.
    cells: numbers (k,) of this rank's cells that the Gauss points lie in, cell by cell; none for
        contact points.
    points: position in space (n, 3), mm.
    weights: quadrature weight (n,) in the meshed part, mm3, of contact points mm2.
    mu: shear modulus (n,), MPa.
    groups: (numbers of its points, hardening) of each body that yields.
    history: plastic state from which the present load step starts.
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
        """Strains (n, m), Mandel's notation, of the free unknowns y at the n yield points of this
        rank; the strains of the prescribed displacement are left out.
        """
        return np.asarray((self.strain_matrix * y).array).reshape(self.prescribed_strain.shape)

    def set_prescribed_strain(self, prescribed: PETSc.Vec) -> None:
        """Set the prescribed strain to that of a displacement on all dofs, mm."""
        strain = np.array((self.full_strain_matrix * prescribed).array)
        self.prescribed_strain = strain.reshape(self.prescribed_strain.shape)

    def return_mapping(self, y: PETSc.Vec) -> tuple[History, TangentReduction]:
        """State after a step from the history to the strains of the free unknowns y and of the
        prescribed displacement, and the reduction of the tangent by yield. The history stays.
        """
        strain = self.strains(y) + self.prescribed_strain
        state = self.history.at(np.arange(len(strain)))
        reductions = [TangentReduction.none(strain.shape[1])]
        for members, hardening in self.groups:
            before, mu = self.history.at(members), self.mu[members]
            after, reduction = radial_return(strain[members], mu, before, hardening)
            state.put(members, after)
            reductions.append(replace(reduction, points=members[reduction.points]))
        return state, TangentReduction.joined(reductions)

    def strain_rows(self, points: Index) -> PETSc.Mat:
        """Rows of the strain matrix that belong to points with these numbers (k,): k m rows on this
        rank (collective).
        """
        size = self.prescribed_strain.shape[1]
        rows = (points[:, None] * size + np.arange(size)).ravel()
        return select_rows(self.strain_matrix, rows)

    def add_forces(self, stress: Array, out: PETSc.Vec) -> None:
        """Add the nodal forces of stresses (n, m), MPa, times the quadrature weights, to a vector
        `out` of the free unknowns, N.
        """
        add_transposed(self.strain_matrix, self.weights[:, None] * stress, out)


@dataclass(kw_only=True)
class PlasticProblem(ContactProblem):
    """Contact problem of bodies that yield, at one load step. The other fields are those of
    `ContactProblem`. The assembled tangent and the diagonal, which preconditioners use, leave yield
    out; the products of the tangent have it.

    bulk: Gauss points of the bodies that yield.
    surface: the n contact points; no group of them yields where the slave stays elastic.
    normal_dyads: dyads n x n of the normals (n, m) at the contact points, in Mandel's notation.
    apart: whether the bodies are separated, so that no point touches.
    """

    bulk: YieldPoints
    surface: YieldPoints
    normal_dyads: Array
    apart: bool = False
    tangent_depends_on_state: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Start with the histories of the points as their states."""
        self.freeze()

    def freeze(self) -> None:
        """Make the histories of the points their states, in which none yields."""
        nothing = TangentReduction.none(self.normal_dyads.shape[1])
        self._bulk, self._surface = (self.bulk.history, nothing), (self.surface.history, nothing)
        self._yielding_operators: tuple[PETSc.Mat, PETSc.Mat] | None = None

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric (collective): where that of the contact law and those of
        the material are, and no contact point of Nitsche's method yields on any rank.
        """
        points = self.law.sigma * len(self._surface[1].points)
        total = self.stiffness.comm.tompi4py().allreduce(points + (not self._bulk[1].symmetric))
        return self.law.symmetric and not total

    def indicator(self, y: PETSc.Vec) -> Array:
        """Pressure before its negative part is set to zero (n,), MPa, at the free unknowns y, from
        the elastic indicator and the normal stress that plastic strain takes. The plastic state
        at y is kept for `residual`, `tangent` and `state`.
        """
        self._bulk, self._surface = self.bulk.return_mapping(y), self.surface.return_mapping(y)
        self._yielding_operators = None
        if self.apart:
            return np.full(len(self.area), -1.0)
        return self.linear_indicator(y)

    def linear_indicator(self, y: PETSc.Vec) -> Array:
        """Indicator (n,), MPa, at the free unknowns y while plastic strain stays as it is."""
        plastic = self.plastic_normal_stress(self._surface[0].plastic)
        return super().linear_indicator(y) + self.law.sigma * plastic

    def predictor(self, active: Mask) -> PETSc.Vec:
        """Right-hand side, N, of the linear problem in which the active points (n,) touch and
        plastic strain is that of the history; its tangent is elastic.
        """
        self.freeze()
        return super().predictor(active)

    def plastic_normal_stress(self, plastic: Array) -> Array:
        """Normal stress that plastic strain takes, t = 2 mu n . eps_p . n (n,), MPa, from plastic
        strains (n, m) at the contact points.
        """
        strain = np.einsum("nm,nm->n", self.normal_dyads, plastic)
        return np.asarray(2 * self.surface.mu * strain)

    def residual(self, y: PETSc.Vec, pressure: Array) -> PETSc.Vec:
        """Residual R(y) of equilibrium in the free unknowns, N. pressure: contact pressure at y
        (n,), MPa; its computation must be the last use of `indicator`, which keeps the plastic
        state.
        """
        r = super().residual(y, pressure)
        plastic = self._bulk[0].plastic
        self.bulk.add_forces(-2 * self.bulk.mu[:, None] * plastic, r)
        self.add_consistency_forces(-self.plastic_normal_stress(self._surface[0].plastic), r)
        return r

    def set_prescribed_strain(self, prescribed: PETSc.Vec) -> None:
        """Set the prescribed strains of all points to those of a displacement on all dofs, mm."""
        self.bulk.set_prescribed_strain(prescribed)
        self.surface.set_prescribed_strain(prescribed)

    def reset_history(self) -> None:
        """Set plastic strain, equivalent plastic strain and back stress of all points to zero, in
        the history and in the last state.
        """
        for points in (self.bulk, self.surface):
            count, size = points.prescribed_strain.shape
            points.history = History.virgin(count, size, points.history.back.shape[1])
        self.freeze()

    def contact_force(self, pressure: Array) -> float:
        """Force that the residual is divided by, N: that of the pressure (n,), MPa; of separated
        bodies the reference force.
        """
        return self.reference_force if self.apart else super().contact_force(pressure)

    def separated(self, reference_force: float) -> Self:
        """These equations without contact; matrices and histories are shared. Nothing resists the
        approach then, so a spring holds it. reference_force: as the field.
        """
        stiffness = self.stiffness.pinned(self.stiffness.typical)
        return replace(self, stiffness=stiffness, reference_force=reference_force, apart=True)

    @property
    def state(self) -> State:
        """Histories at the Gauss points of the bodies that yield and at the contact points, for the
        unknowns of the last call of `indicator`; before the first call those that a step starts
        from.
        """
        return self._bulk[0], self._surface[0]

    @property
    def yielding_points(self) -> tuple[Index, Index]:
        """Numbers of the Gauss points and of the contact points that yield in the last state."""
        return self._bulk[1].points, self._surface[1].points

    def commit(self, state: State) -> None:
        """Make a state the history that the next step starts from; state: at the Gauss points and
        at the contact points.
        """
        self.bulk.history, self.surface.history = state

    @property
    def yielding_operators(self) -> tuple[PETSc.Mat, PETSc.Mat]:
        """Strains per free unknown at the points that yield in the last state, m rows a point: at
        the Gauss points, and of the slave's material at the contact points; made at the first use
        after `indicator` (collective).
        """
        if self._yielding_operators is None:
            self._yielding_operators = (
                self.bulk.strain_rows(self._bulk[1].points),
                self.surface.strain_rows(self._surface[1].points),
            )
        return self._yielding_operators

    def apply_tangent(
        self, active: Mask, rows: tuple[PETSc.Mat, PETSc.Mat], x: PETSc.Vec, out: PETSc.Vec
    ) -> None:
        """Write the product K x - E^T w (C - C_ep) E x - theta S^T w S_ep x + Bt^T w A B_ep x of
        the tangent into `out`, N; arguments as of `ContactProblem.apply_tangent`.

        C_ep is the consistent tangent. S_ep and B_ep are S and B less the normal stress that yield
        takes, n . (C - C_ep) E x . n at the contact points.
        """
        super().apply_tangent(active, rows, x, out)
        reductions = self._bulk[1], self._surface[1]
        bulk, surface = (
            reduction.stress((strains * x).array.reshape(reduction.matrix.shape[:2]))
            for strains, reduction in zip(self.yielding_operators, reductions, strict=True)
        )
        weights = self.bulk.weights[reductions[0].points, None]
        add_transposed(self.yielding_operators[0], -weights * bulk, out)
        if self.symmetric:  # no contact point yields, on any rank
            return
        points, loss = reductions[1].points, np.zeros(len(self.area))
        loss[points] = np.einsum("nm,nm->n", self.normal_dyads[points], surface)
        add_transposed(self.test_operator, -self.law.sigma * self.weight * active * loss, out)
        self.add_consistency_forces(-loss, out)


def bulk_points(
    bulk: Bulk,
    cell_tags: Any,
    materials: Mapping[int, Material],
    near: Callable[[Array], Mask],
    reduction: Reduction,
    comm: MPI.Intracomm,
) -> YieldPoints:
    """Gauss points of the stiffness matrix in this rank's cells near the contact, in the bodies
    that yield (collective).

    bulk: displacement space.
    cell_tags: MeshTags of the cells.
    materials: cell tag of each body -> its material.
    near: centroids of cells in space (k, 3), mm -> (k,) whether plastic strain is followed there.
    reduction: map from free unknowns to dofs.
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
        curves.append((material.hardening, np.searchsorted(cell_tags.find(tag), numbers)))
    every = np.concatenate([np.zeros(0, np.int64), *parts])
    cells = CellSet.of(bulk, every)
    degree = quadrature_degree(cells.cell, cells.degree, kinematics)
    (index, reference), x, weights = cells.quadrature_points(degree)
    each = len(weights) // max(len(cells), 1)
    ends = np.cumsum([0, *(len(part) * each for part in parts)])
    groups = [
        (np.arange(start, end), curve.at(np.repeat(places, each)))
        for start, end, (curve, places) in zip(ends, ends[1:], curves, strict=False)
    ]
    count = backs(materials.values())
    matrices = _strain_matrices(cells, index, reference, bulk, reduction, comm, count)
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
    """The contact points of this rank, as points of the slave (collective); hardening: flow curve
    of the slave, None: it stays elastic.
    """
    slave, index = interface.slave, interface.facet
    every = np.arange(len(index))
    reference = slave.reference(index, interface.xi)
    count = len(hardening.backstresses) if hardening else 1
    matrices = _strain_matrices(slave, index, reference, bulk, reduction, comm, max(count, 1))
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
    backs: int,
) -> dict[str, Any]:
    """Strain matrices, zero prescribed strain and zero history, as fields of `YieldPoints` by name;
    index: cell of each point (n,); reference: its reference coordinates (n, c); backs: number of
    back stresses (collective).
    """
    owned = bulk.space.dofmap.index_map.size_local * cells.kinematics.dim
    full, size = assemble_strains(cells, index, reference, owned, comm)
    return {
        "strain_matrix": full.matMult(reduction.matrix),
        "full_strain_matrix": full,
        "prescribed_strain": np.zeros((len(index), size)),
        "history": History.virgin(len(index), size, backs),
    }
