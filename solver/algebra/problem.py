"""The contact problem in the free unknowns y, u = P y + u0.

    R(y) = K y - f - theta S^T w (S y + s0) - Bt^T w p(y),   p(y) = < -(B y + c) >+
    B = S + tau N,  Bt = theta S + tau N,  w = W/tau,  c = s0 + tau (g0 + N u0)

(Nitsche's method, Chouly and Hild 2013; for a penalty S is absent.) All matrices are constant. Only
the active set A = {p > 0} changes the tangent  K - theta S^T w S + Bt^T w A B.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver.algebra.reactions import SupportReactions
from railhead.solver.algebra.stiffness import Stiffness
from railhead.solver.interface.jumps import Interface
from railhead.solver.interface.laws import ContactLaw
from railhead.solver.space.cells import Array
from railhead.solver.space.constraints import Reduction, petsc_matrix
from railhead.solver.space.operators import add_transposed, vector

Mask = NDArray[np.bool_]


@dataclass
class ContactProblem:
    """One load case at the n local contact points, in the free unknowns.

    `dataclasses.replace` with another law shares the matrices.

    law: contact law.
    stiffness: K, of the free unknowns.
    gap: N, normal jump of the free unknowns.
    stress: S, normal stress of the slave, of the free unknowns.
    area: W (n,), mm2.
    bound: (n,) what the law's parameter tau is a multiple of, MPa/mm.
    gap_per_approach: change of the gap per approach of a rigid counterface (n,).
    force: f, N.
    start_gap: g0 + N u0 (n,), mm.
    start_stress: s0 = S u0 (n,), MPa.
    """

    law: ContactLaw
    stiffness: Stiffness
    gap: PETSc.Mat
    stress: PETSc.Mat
    area: Array
    bound: Array
    gap_per_approach: Array
    force: PETSc.Vec
    start_gap: Array
    start_stress: Array

    def set_load(
        self,
        interface: Interface,
        reduction: Reduction,
        held: SupportReactions,
        prescribed: PETSc.Vec,
        load: float,
        rigid_approach: float,
        force: PETSc.Vec | None = None,
    ) -> None:
        """Set f, g0 and s0 of a load case.

        prescribed: displacement u0 on all dofs, mm.
        load: on the approach, N. rigid_approach: of a rigid counterface, mm.
        force: further forces on all dofs, N.
        """
        given = held.forces(prescribed)
        given.scale(-1.0)
        if force is not None:
            given.axpy(1.0, force)
        reduction.matrix.multTranspose(given, self.force)
        if reduction.approach >= 0:
            self.force.array[reduction.approach] += load
        self.start_stress = (interface.stress * prescribed).array.copy()
        gap = interface.initial_gap + (interface.gap * prescribed).array
        self.start_gap = gap + self.gap_per_approach * rigid_approach

    @cached_property
    def tau(self) -> Array:
        """Parameter of the contact law (n,), MPa/mm."""
        return self.law.scale * self.bound

    @cached_property
    def weight(self) -> Array:
        """w = W/tau (n,), mm3/N."""
        return self.area / self.tau

    @property
    def tangent_depends_on_state(self) -> bool:
        """Whether the tangent changes while the active set stays."""
        return False

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric."""
        return self.law.symmetric

    @property
    def offset(self) -> Array:
        """c = s0 + tau (g0 + N u0) (n,), MPa."""
        return self.tau * self.start_gap + self.law.sigma * self.start_stress

    @cached_property
    def normal_operator(self) -> PETSc.Mat:
        """B = S + tau N, which gives the pressure."""
        return self._combined(float(self.law.sigma))

    @cached_property
    def test_operator(self) -> PETSc.Mat:
        """Bt = theta S + tau N, which tests the pressure; the same object as B where the method is
        symmetric."""
        return self.normal_operator if self.law.symmetric else self._combined(self.consistency)

    def _combined(self, factor: float) -> PETSc.Mat:
        matrix = self.gap.copy()
        matrix.diagonalScale(L=self.at_points(self.tau))
        if factor:
            matrix.axpy(factor, self.stress, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        return matrix

    def at_points(self, values: Array) -> PETSc.Vec:
        """A distributed vector of values (n,) at the local contact points."""
        return vector(self.gap, values)

    @property
    def consistency(self) -> float:
        """Factor of the consistency term S^T w S: theta for Nitsche's method, 0 for a penalty."""
        return float((self.law.theta or 0) * self.law.sigma)

    def indicator(self, y: PETSc.Vec) -> Array:
        """-(B y + c) (n,) at the local contact points, MPa: positive where the bodies touch."""
        return np.asarray(-((self.normal_operator * y).array + self.offset))

    def pressure(self, y: PETSc.Vec) -> Array:
        """p(y) (n,) at the local contact points, MPa."""
        return np.maximum(self.indicator(y), 0.0)

    def residual(self, y: PETSc.Vec, pressure: Array) -> PETSc.Vec:
        """R(y), N, for the pressure p(y) (n,)."""
        r = self.stiffness * y
        r.axpy(-1.0, self.force)
        add_transposed(self.test_operator, -self.weight * pressure, r)
        if self.consistency:
            s = (self.stress * y).array + self.start_stress
            add_transposed(self.stress, -self.consistency * self.weight * s, r)
        return r

    def slope(self, y: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """t -> R(y + t step) . step, N mm: the slope of the energy of a symmetric method, which is
        convex and piecewise quadratic, so that its slope grows with t."""
        k_step = self.stiffness * step
        start, rate = k_step.dot(y) - self.force.dot(step), k_step.dot(step)
        b, db = -self.indicator(y), (self.normal_operator * step).array
        if self.consistency:
            s, ds = (self.stress * y).array + self.start_stress, (self.stress * step).array
            b0 = -self.consistency * float(np.sum(self.weight * ds * s))
            b1 = -self.consistency * float(np.sum(self.weight * ds**2))
        else:
            b0 = b1 = 0.0
        comm = step.comm.tompi4py()

        def value(t: float) -> float:
            pressure = np.maximum(-(b + t * db), 0.0)
            local = b0 + t * b1 - float(np.sum(self.weight * db * pressure))
            return float(start + t * rate + comm.allreduce(local))

        return value

    def contact_force(self, pressure: Array) -> float:
        """Norm of the contact forces Bt^T w p, N."""
        force = self.gap.createVecRight()
        force.set(0.0)
        add_transposed(self.test_operator, self.weight * pressure, force)
        return float(force.norm())

    def active_set_residual(self, active: Mask, indicator: Array) -> Callable[[PETSc.Vec], float]:
        """x -> |Bt^T w (p(y + x) - A q(y + x))|, N: the part of R(y + x) that a step x
        makes by changing the active set. indicator: q = -(B y + c) (n,) at y, MPa."""

        def left(x: PETSc.Vec) -> float:
            q = indicator - (self.normal_operator * x).array
            out = self.stiffness.vector()
            add_transposed(self.test_operator, self.weight * (np.maximum(q, 0.0) - active * q), out)
            return float(out.norm())

        return left

    def tangent(self, active: Mask) -> PETSc.Mat:
        """The tangent at an active set as an operator (nothing is assembled)."""
        return self.shell(Tangent(self, active))

    def shell(self, context: Tangent) -> PETSc.Mat:
        """A PETSc matrix that is known by its products alone."""
        stiffness = self.stiffness
        matrix = PETSc.Mat().createPython(stiffness.sizes, context, comm=stiffness.comm)
        matrix.setUp()
        return matrix

    def diagonal(self, active: Mask, out: PETSc.Vec) -> None:
        """Write the diagonal of the tangent into a vector, N/mm."""
        self._bulk_diagonal.copy(out)
        add_transposed(self._squares, self.weight * active, out)

    @cached_property
    def _bulk_diagonal(self) -> PETSc.Vec:
        """Diagonal of K - theta S^T w S."""
        diagonal = self.stiffness.diagonal()
        if self.consistency:
            squares = _products(self.stress, self.stress)
            add_transposed(squares, -self.consistency * self.weight, diagonal)
        return diagonal

    @cached_property
    def _squares(self) -> PETSc.Mat:
        """Entrywise product of Bt and B."""
        return _products(self.test_operator, self.normal_operator)

    def assembled_tangent(self, active: Mask) -> PETSc.Mat:
        """The tangent at an active set as a matrix, for a preconditioner."""
        different = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN
        right = self.normal_operator.copy()
        right.diagonalScale(L=self.at_points(self.weight * active))
        contact = self.test_operator.transposeMatMult(right)
        if self.consistency:
            right = self.stress.copy()
            right.diagonalScale(L=self.at_points(self.weight))
            contact.axpy(-self.consistency, self.stress.transposeMatMult(right), different)
        contact.axpy(1.0, self.stiffness.assembled(), different)
        contact.setOption(PETSc.Mat.Option.SYMMETRIC, self.law.symmetric)
        return contact

    def predictor(self, active: Mask) -> PETSc.Vec:
        """Right-hand side of the linear problem in which exactly the active points touch, N."""
        rhs = self.force.copy()
        add_transposed(self.test_operator, -self.weight * active * self.offset, rhs)
        if self.consistency:
            values = self.consistency * self.weight * self.start_stress
            add_transposed(self.stress, values, rhs)
        return rhs


class Tangent:
    """PETSc shell context of y -> K y - theta S^T w S y + Bt^T w A B y.

    It refers to the problem weakly: PETSc leaks what is freed while it frees a shell.
    """

    def __init__(self, problem: ContactProblem, active: Mask) -> None:
        self.problem = weakref.proxy(problem)
        self.active = active

    def mult(self, _: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        problem = self.problem
        problem.stiffness.mult(x, y)
        values = problem.weight * self.active * (problem.normal_operator * x).array
        add_transposed(problem.test_operator, values, y)
        if problem.consistency:
            values = -problem.consistency * problem.weight * (problem.stress * x).array
            add_transposed(problem.stress, values, y)

    def getDiagonal(self, _: PETSc.Mat, out: PETSc.Vec) -> None:  # noqa: N802 (PETSc's name)
        self.problem.diagonal(self.active, out)


def _products(left: PETSc.Mat, right: PETSc.Mat) -> PETSc.Mat:
    """Entrywise product of two matrices of one layout."""
    tables = []
    for matrix in (left, right):
        indptr, indices, values = matrix.getValuesCSR()
        tables.append(
            sp.csr_matrix((values, indices, indptr), shape=(len(indptr) - 1, matrix.getSize()[1]))
        )
    return petsc_matrix(
        tables[0].multiply(tables[1]).tocsr(), left.getLocalSize()[1], left.comm.tompi4py()
    )


def reduce_problem(
    stiffness: PETSc.Mat,
    interface: Interface,
    reduction: Reduction,
    law: ContactLaw,
    gap_per_approach: Array,
) -> ContactProblem:
    """The problem in the free unknowns, without a load yet. K on all dofs is used up.

    gap_per_approach: (n,) change of the gap per approach of a rigid counterface.
    """
    p = reduction.matrix
    gap = interface.gap.matMult(p)
    if reduction.rigid_approach:
        count = len(gap_per_approach)
        places = np.arange(count), np.full(count, reduction.column)
        table = sp.csr_matrix((gap_per_approach, places), shape=(count, p.getSize()[1]))
        extra = petsc_matrix(table, p.getLocalSize()[1], p.comm.tompi4py())
        gap.axpy(1.0, extra, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    reduced = Stiffness.reduced(stiffness, reduction)
    return ContactProblem(
        law=law,
        stiffness=reduced,
        gap=gap,
        stress=interface.stress.matMult(p),
        area=interface.weights,
        bound=interface.stiffness_bound(law),
        gap_per_approach=gap_per_approach,
        force=reduced.vector(),
        start_gap=interface.initial_gap,
        start_stress=np.zeros_like(gap_per_approach),
    )
