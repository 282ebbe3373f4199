"""The reduced contact problem: everything in the free unknowns y, u = P y + u0.

    R(y) = K y - f - theta S^T w (S y + s0) - Bt^T w p(y),   p(y) = < -(B y + c) >+
    B = S + tau N,  Bt = theta S + tau N,  w = W/tau,  c = s0 + tau (g0 + N u0)

(Nitsche; for penalty S is absent). All matrices are constant: only the active set
A = {p > 0} changes the tangent  K - theta S^T w S + Bt^T w A B.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from solver.constraints import Reduction, petsc_matrix
from solver.facets import Array
from solver.interface import Interface
from solver.laws import Law

Mask = NDArray[np.bool_]


@dataclass
class ContactProblem:
    """One load case. tau (n,) MPa/mm, w (n,) mm3/N, c and s0 (n,) MPa at the local contact points;
    f (distributed like y) N. S and N are reduced to the free unknowns."""

    law: Law
    stiffness: PETSc.Mat
    gap: PETSc.Mat
    stress: PETSc.Mat
    tau: Array
    weight: Array
    offset: Array
    stress_offset: Array
    force: PETSc.Vec
    closing: Array

    def set_load(
        self,
        interface: Interface,
        reduction: Reduction,
        stiffness: PETSc.Mat,
        prescribed: PETSc.Vec,
        load: float,
        rigid_approach: float,
    ) -> None:
        """Load (N) on the approach and prescribed displacement u0 (mm): sets f, c and s0."""
        reduction.matrix.multTranspose(stiffness * prescribed, self.force)
        self.force.scale(-1.0)
        if reduction.approach >= 0:
            self.force.array[reduction.approach] += load
        self.stress_offset = (interface.stress * prescribed).array.copy()
        gap = interface.initial_gap + (interface.gap * prescribed).array
        gap = gap + self.closing * rigid_approach
        self.offset = self.tau * gap + self.law.sigma * self.stress_offset

    @cached_property
    def trace(self) -> PETSc.Mat:
        """B."""
        return self._combined(float(self.law.sigma))

    @cached_property
    def test_trace(self) -> PETSc.Mat:
        """Bt, the same object as B where the method is symmetric."""
        return self.trace if self.law.symmetric else self._combined(float(self.law.theta))

    def _combined(self, factor: float) -> PETSc.Mat:
        matrix = self.gap.copy()
        matrix.diagonalScale(L=self._vec(self.tau))
        if factor:
            matrix.axpy(factor, self.stress, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        return matrix

    def _vec(self, values: Array) -> PETSc.Vec:
        vec = self.gap.createVecLeft()
        vec.array[:] = values
        return vec

    @property
    def consistency(self) -> float:
        """Factor of the consistency term: theta for Nitsche, 0 for penalty."""
        return float(self.law.theta * self.law.sigma)

    def indicator(self, y: PETSc.Vec) -> Array:
        """-(B y + c) (n,) at the local contact points, MPa: positive where the bodies touch."""
        return np.asarray(-((self.trace * y).array + self.offset))

    def pressure(self, y: PETSc.Vec) -> Array:
        """p(y) (n,) at the local contact points, MPa."""
        return np.maximum(self.indicator(y), 0.0)

    def residual(self, y: PETSc.Vec, pressure: Array) -> PETSc.Vec:
        """R(y), N."""
        r = self.stiffness * y
        r.axpy(-1.0, self.force)
        self.add_transposed(self.test_trace, -self.weight * pressure, r)
        if self.consistency:
            s = (self.stress * y).array + self.stress_offset
            self.add_transposed(self.stress, -self.consistency * self.weight * s, r)
        return r

    def slope(self, y: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """t -> d/dt of the energy at y + t step, N mm (symmetric methods): R(y + t step) . step.

        Convex and piecewise quadratic energy: the slope grows with t.
        """
        k_step = self.stiffness * step
        start, rate = k_step.dot(y) - self.force.dot(step), k_step.dot(step)
        b, db = -self.indicator(y), (self.trace * step).array
        if self.consistency:
            s, ds = (self.stress * y).array + self.stress_offset, (self.stress * step).array
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

    def add_transposed(self, matrix: PETSc.Mat, values: Array, out: PETSc.Vec) -> None:
        matrix.multTransposeAdd(self._vec(values), out, out)

    def tangent(self, active: Mask) -> PETSc.Mat:
        """The tangent as an operator (nothing is assembled)."""
        shell = PETSc.Mat().createPython(
            self.stiffness.getSizes(), _Tangent(self, active), comm=self.stiffness.comm
        )
        shell.setUp()
        return shell

    def assembled_tangent(self, active: Mask) -> PETSc.Mat:
        """The tangent as a matrix, for a preconditioner."""
        different = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN
        right = self.trace.copy()
        right.diagonalScale(L=self._vec(self.weight * active))
        contact = self.test_trace.transposeMatMult(right)
        if self.consistency:
            right = self.stress.copy()
            right.diagonalScale(L=self._vec(self.weight))
            contact.axpy(-self.consistency, self.stress.transposeMatMult(right), different)
        contact.axpy(1.0, self.stiffness, different)
        contact.setOption(PETSc.Mat.Option.SYMMETRIC, self.law.symmetric)
        return contact

    def predictor(self, active: Mask) -> PETSc.Vec:
        """Right-hand side of the linear problem in which exactly `active` touches."""
        rhs = self.force.copy()
        self.add_transposed(self.test_trace, -self.weight * active * self.offset, rhs)
        if self.consistency:
            values = self.consistency * self.weight * self.stress_offset
            self.add_transposed(self.stress, values, rhs)
        return rhs


class _Tangent:
    """PETSc shell context of y -> K y - theta S^T w S y + Bt^T w A B y."""

    def __init__(self, problem: ContactProblem, active: Mask) -> None:
        self.problem = problem
        self.active_weight = problem.weight * active

    def mult(self, _: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        problem = self.problem
        problem.stiffness.mult(x, y)
        problem.add_transposed(
            problem.test_trace, self.active_weight * (problem.trace * x).array, y
        )
        if problem.consistency:
            values = -problem.consistency * problem.weight * (problem.stress * x).array
            problem.add_transposed(problem.stress, values, y)


def reduce_problem(
    stiffness: PETSc.Mat,
    interface: Interface,
    reduction: Reduction,
    law: Law,
    closing: Array,
) -> ContactProblem:
    """K, N and S in the free unknowns, without a load yet.

    closing (n,): change of the gap with the approach of a rigid counterface.
    """
    p = reduction.matrix
    gap = interface.gap.matMult(p)
    if reduction.rigid_approach:
        column = p.getSize()[1] - 1
        table = sp.csr_matrix(
            (closing, (np.arange(len(closing)), np.full(len(closing), column))),
            shape=(len(closing), column + 1),
        )
        extra = petsc_matrix(table, p.getLocalSize()[1], p.comm.tompi4py())
        gap.axpy(1.0, extra, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    tau = law.scale * interface.stiffness_bound
    reduced = stiffness.ptap(p)
    force = reduced.createVecRight()
    force.set(0.0)
    return ContactProblem(
        law, reduced, gap, interface.stress.matMult(p), tau, interface.weights / tau,
        tau * interface.initial_gap, np.zeros_like(tau), force, closing,
    )  # fmt: skip
