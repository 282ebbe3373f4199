"""The contact problem in the free unknowns y, u = P y + u0.

    R(y) = K y - f - theta S^T w (S y + s0) - Bt^T w p(y),   p(y) = < -(B y + c) >+
    B = S + tau N,  Bt = theta S + tau N,  w = W/tau,  c = s0 + tau (g0 + N u0)

(Nitsche's method, Chouly and Hild 2013; for a penalty S is absent.) All matrices are constant. Only
the active set A = {p > 0} changes the tangent  K - theta S^T w S + Bt^T w A B.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from petsc4py import PETSc

from railhead.solver.algebra.reduced_stiffness import DIFFERENT, Stiffness
from railhead.solver.space.contact_interface import ContactLaw, Interface
from railhead.solver.space.operators import (
    add_transposed,
    local_rows,
    petsc_matrix,
    select_rows,
    transposed,
    vector,
    weighted_product,
)
from railhead.theory.array_types import Array, Mask


class Tangent:
    """PETSc shell context of the tangent of a problem at an active set. B and Bt are its
    `normal_operator` and `test_operator`.

    problem: the contact problem, by a weak reference, because PETSc leaks what is freed while it
        frees a shell.
    active: active set A (n,).
    rows: the rows of B and Bt of the active points.
    """

    def __init__(self, problem: ContactProblem, active: Mask) -> None:
        """Select the rows of the active points (collective)."""
        self.problem = weakref.proxy(problem)
        self.active = active
        points, symmetric = np.flatnonzero(active), problem.law.symmetric
        normal = select_rows(problem.normal_operator, points)
        self.rows = normal, normal if symmetric else select_rows(problem.test_operator, points)

    def mult(self, _: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Product of the tangent with x, written into y; called by PETSc."""
        self.problem.apply_tangent(self.active, self.rows, x, y)

    def getDiagonal(self, _: PETSc.Mat, out: PETSc.Vec) -> None:  # noqa: N802 (PETSc's name)
        """Diagonal of the tangent, written into `out`, N/mm; called by PETSc."""
        self.problem.diagonal(self.active, out)


@dataclass(kw_only=True)
class ContactProblem:
    """One load case of a contact, at n contact points of this rank, in the free unknowns y; the
    displacement is u = P y + u0. Forces are those on the meshed part.

    law: contact law.
    stiffness: K - theta S^T w S, the stiffness of the free unknowns with the part of Nitsche's
        method that all active sets share, N/mm.
    gap: N, change of the gap per free unknown (n rows).
    stress: S, normal stress of the slave per free unknown (n rows), MPa/mm.
    area: area W of each point in the meshed part (n,), mm2.
    bound: (n,) value that the law's parameter tau is a multiple of, MPa/mm.
    force: force f in the free unknowns, N.
    start_gap: gap at zero free unknowns, g0 + N u0 (n,), mm; where a rigid body moves under
        approach control, less what the approach closes.
    start_stress: normal stress at zero free unknowns, s0 = S u0 (n,), MPa.
    reference_force: force that the residual may be divided by where nothing, or hardly anything,
        touches, N: of an earlier state.
    least_force: norm of residuals that is rounding where nothing touches, N.
    floor: least pressure, of all points or of each (n,): 0, or -inf of those that cannot part.
    tangent_depends_on_state: whether the tangent changes while the active set stays.
    """

    law: ContactLaw
    stiffness: Stiffness
    gap: PETSc.Mat
    stress: PETSc.Mat
    area: Array
    bound: Array
    force: PETSc.Vec
    start_gap: Array
    start_stress: Array
    reference_force: float = 0.0
    least_force: float = 0.0
    floor: Any = 0.0
    _tangents: list[Any] = field(init=False, repr=False, default_factory=list)
    tangent_depends_on_state: ClassVar[bool] = False

    @classmethod
    def reduced(
        cls,
        law: ContactLaw,
        stiffness: Stiffness,
        face: Interface,
        p: PETSc.Mat,
        gap: PETSc.Mat | None = None,
        **more: Any,
    ) -> Self:
        """Contact problem in the free unknowns, from the matrices of an interface on all dofs
        (collective).

        stiffness: P^T K P of the free unknowns, N/mm, to which the part is added that all active
            sets share. p: map P from free unknowns to dofs. gap: N in the free unknowns, where
            a rigid surface moves too; None: N P. more: the other fields.
        """
        made = cls(
            law=law,
            stiffness=stiffness,
            gap=face.gap.matMult(p) if gap is None else gap,
            stress=face.stress.matMult(p),
            area=face.weights,
            bound=face.stiffness_bound(law),
            **more,
        )
        if made.consistency:  # normal stress depends on the nodes of one cell, as blocks do
            stiffness.add(made.stress, -made.consistency * made.weight)
        return made

    def shared(self) -> dict[str, Any]:
        """Fields by name, for another problem with the same matrices and a force vector of its own,
        whose values are not set.
        """
        own = {each.name: getattr(self, each.name) for each in fields(self) if each.init}
        return own | {"force": self.force.duplicate()}

    @property
    def applied(self) -> float:
        """Norm of the applied force, N."""
        return float(self.force.norm())

    @cached_property
    def tau(self) -> Array:
        """Parameter tau of the contact law at each point (n,), MPa/mm."""
        return self.law.scale * self.bound

    @cached_property
    def weight(self) -> Array:
        """Area of each point over the law's parameter, w = W/tau (n,), mm3/N."""
        return self.area / self.tau

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric, as the contact law says."""
        return self.law.symmetric

    @property
    def offset(self) -> Array:
        """Negative indicator at zero free unknowns (n,), MPa: tau times the start gap and, for
        Nitsche's method, plus the start stress.
        """
        return self.tau * self.start_gap + self.law.sigma * self.start_stress

    @cached_property
    def normal_operator(self) -> PETSc.Mat:
        """Matrix from the free unknowns to the change of the negative indicator at the contact
        points, MPa/mm: B = S + tau N for Nitsche's method, tau N for a penalty; S: normal
        stress, N: gap.
        """
        return self._combined(float(self.law.sigma))

    @cached_property
    def test_operator(self) -> PETSc.Mat:
        """Matrix Bt = theta S + tau N, MPa/mm, whose transpose gives the forces of the pressure; S:
        normal stress, N: gap. Where the law is symmetric it is the same object as
        `normal_operator`.
        """
        return self.normal_operator if self.law.symmetric else self._combined(self.consistency)

    def _combined(self, factor: float) -> PETSc.Mat:
        """Matrix factor S + tau N with one row for each contact point, MPa/mm. S: normal
        stress, N: gap per free unknown, tau: parameter of the contact law at the points, MPa/mm.
        """
        matrix = self.gap.copy()
        matrix.diagonalScale(L=vector(self.gap, self.tau))
        if factor:
            matrix.axpy(factor, self.stress, DIFFERENT)
        return matrix

    @property
    def consistency(self) -> float:
        """Factor theta of the term -theta S^T w S of the tangent; 0 for a penalty. S: normal stress
        per free unknown, w: area over the law's parameter.
        """
        return float((self.law.theta or 0) * self.law.sigma)

    def with_law(self, law: ContactLaw) -> ContactProblem:
        """This problem with another law of the same method and theta; what does not depend on it
        is shared (collective).
        """
        other = replace(self, law=law)
        other._tangents = self._tangents  # the other problem may be gone before its tangents are
        if self.consistency:
            other.stiffness = self.stiffness.copy()
            change = self.consistency * (self.weight - other.weight)
            other.stiffness.add(self.stress, change)
        return other

    def coarser(self, prolongation: PETSc.Mat, stiffness: Stiffness) -> ContactProblem:
        """The contact problem in coarser unknowns, whose tangent is the Galerkin product of this
        one's elastic tangent (collective).

        prolongation: Q, from the coarser unknowns to these. stiffness: Q^T K Q of the bodies alone,
            N/mm, without a spring.
        """
        stress = self.stress.matMult(prolongation)
        stiffness = stiffness.pinned(self.stiffness.spring)
        if self.consistency:
            stiffness = stiffness.copy()
            stiffness.add(stress, -self.consistency * self.weight)
        return ContactProblem(
            law=self.law,
            stiffness=stiffness,
            gap=self.gap.matMult(prolongation),
            stress=stress,
            area=self.area,
            bound=self.bound,
            force=stiffness.vector(),
            start_gap=self.start_gap,
            start_stress=self.start_stress,
        )

    def set_prescribed_strain(self, prescribed: PETSc.Vec) -> None:
        """Take over the strains of a displacement on all dofs, mm, where bodies have a history."""

    def add_consistency_forces(self, stress: Array, out: PETSc.Vec) -> None:
        """Add the forces -theta S^T w s of normal stresses s (n,), MPa, of Nitsche's method to the
        vector `out` of the free unknowns, N; nothing for a penalty.
        """
        if self.consistency:
            add_transposed(self.stress, -self.consistency * self.weight * stress, out)

    def indicator(self, y: PETSc.Vec) -> Array:
        """Pressure before its negative part is set to zero (n,), MPa, at the free unknowns y:
        -(sigma s + tau g) with normal stress s and gap g, positive where the surfaces touch;
        sigma is 1 for Nitsche's method and 0 for a penalty, tau the parameter of the contact law.
        """
        return self.linear_indicator(y)

    def linear_indicator(self, y: PETSc.Vec) -> Array:
        """Indicator (n,), MPa, at the free unknowns y while the history of the bodies stays as it
        is: a linear function of y.
        """
        return np.asarray(-((self.normal_operator * y).array + self.offset))

    def pressure(self, y: PETSc.Vec) -> Array:
        """Contact pressure p(y) (n,), MPa: the positive part of the indicator at the free unknowns
        y.
        """
        return np.maximum(self.indicator(y), self.floor)

    def residual(self, y: PETSc.Vec, pressure: Array) -> PETSc.Vec:
        """Residual R(y) of equilibrium in the free unknowns y, N: internal forces less applied and
        contact forces; pressure: contact pressure at y (n,), MPa.
        """
        r = self.stiffness * y
        r.axpy(-1.0, self.force)
        add_transposed(self.test_operator, -self.weight * pressure, r)
        self.add_consistency_forces(self.start_stress, r)
        return r

    def slope(self, y: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """Function t -> R(y + t step) . step, N mm, with the residual R. It is the slope of the
        energy of a symmetric method along a step, which is convex, so that the slope grows with t.
        """

        def value(t: float) -> float:
            """Product R(y + t step) . step at a step length t, N mm."""
            at = y.copy()
            at.axpy(t, step)
            return float(self.residual(at, self.pressure(at)).dot(step))

        return value

    def contact_force(self, pressure: Array) -> float:
        """Norm of the vector of nodal forces of the contact pressure in the free unknowns, N, which
        is not their resultant; pressure: (n,), MPa.
        """
        return float(transposed(self.test_operator, self.weight * pressure).norm())

    def active_set_residual(self, active: Mask, indicator: Array) -> Callable[[PETSc.Vec], float]:
        """Function x -> norm, N, of the part of the residual at y + x that a step x makes by
        changing the active set. It is the norm of the forces of the tractions max(q, 0) - A q,
        with the indicator q at y + x and the mask A.

        active: A (n,). indicator: q (n,) at y, MPa.
        """

        def left(x: PETSc.Vec) -> float:
            """Norm of the part of the residual that a step x of the free unknowns makes by changing
            the active set, N.
            """
            q = indicator - (self.normal_operator * x).array
            change = self.weight * (np.maximum(q, self.floor) - active * q)
            return float(transposed(self.test_operator, change).norm())

        return left

    def branches(self, active: Mask) -> Mask:
        """State of the contact points that the tangent depends on, as rows: the active set itself
        (1, n).
        """
        return active[None]

    def tangent(self, active: Mask) -> PETSc.Mat:
        """Tangent at an active set (n,), as a PETSc operator known by its products and its
        diagonal; no matrix is assembled.
        """
        # Rows of a tangent are freed after it, see `Tangent.problem`.
        self._tangents[:] = [each for each in self._tangents if each[0]() is not None]
        context, stiffness = Tangent(self, active), self.stiffness
        self._tangents.append((weakref.ref(context), context.rows))
        matrix = PETSc.Mat().createPython(stiffness.blocks.getSizes(), context, comm=stiffness.comm)
        matrix.setUp()
        return matrix

    def apply_tangent(
        self, active: Mask, rows: tuple[PETSc.Mat, PETSc.Mat], x: PETSc.Vec, out: PETSc.Vec
    ) -> None:
        """Write the product K x - theta S^T w S x + Bt^T w A B x of the tangent into `out`, N.

        active: active set A (n,). rows: the rows of B and Bt of its points. x: step of the free
            unknowns.
        """
        normal, test = rows
        self.stiffness.mult(x, out)
        add_transposed(test, self.weight[active] * (normal * x).array, out)

    def diagonal(self, active: Mask, out: PETSc.Vec) -> None:
        """Write the diagonal of the tangent at an active set (n,) into the vector `out`, N/mm."""
        self._stiffness_diagonal.copy(out)
        add_transposed(self._squares, self.weight * active, out)

    @cached_property
    def _stiffness_diagonal(self) -> PETSc.Vec:
        """Diagonal of the part of the tangent that all active sets share, N/mm."""
        return self.stiffness.diagonal()

    @cached_property
    def _squares(self) -> PETSc.Mat:
        """Entrywise product of `test_operator` and `normal_operator`, MPa2/mm2; its weighted column
        sums are the diagonal of the contact term.
        """
        test, normal = local_rows(self.test_operator), local_rows(self.normal_operator)
        local, comm = self.gap.getLocalSize()[1], self.gap.comm.tompi4py()
        return petsc_matrix(test.multiply(normal).tocsr(), local, comm)

    def assembled_tangent(self, active: Mask) -> PETSc.Mat:
        """Tangent at an active set (n,) as an assembled matrix, N/mm, for a factorisation or
        multigrid.
        """
        contact = weighted_product(self.test_operator, self.weight * active, self.normal_operator)
        out = self.stiffness.assembled()
        out.axpy(1.0, contact, DIFFERENT)
        out.setOption(PETSc.Mat.Option.SYMMETRIC, self.law.symmetric)
        return out

    def predictor(self, active: Mask) -> PETSc.Vec:
        """Right-hand side, N, of the linear problem for y in which exactly the active points (n,)
        touch and the others do not: less the residual at y = 0. Its matrix is the tangent.
        """
        rest = self.stiffness.vector()
        return -self.residual(rest, np.where(active, self.linear_indicator(rest), 0.0))
