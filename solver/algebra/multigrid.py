"""p-multigrid: Chebyshev-Jacobi on the quadratic cells, Galerkin linear cells below them.

The fine tangent is never assembled: the smoother needs its product and its diagonal only. Below,

    Q^T (K - theta S^T w S) Q  +  (Bt Q)^T w A (B Q)

the first part is made once, and the second has one sparsity pattern for all active sets, so that a
new active set costs a small product and a numeric factorisation.
"""

from __future__ import annotations

from dataclasses import dataclass

from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.linear import Preconditioner, factorise, near_nullspace
from railhead.solver.algebra.problem import ContactProblem, Mask
from railhead.solver.algebra.stiffness import Stiffness

COARSE_DIRECT_BELOW = 40_000  # unknowns of the P1 level (measured from 20 000 to 33 000)
SMOOTHING = 3  # steps of Chebyshev's method before and after
PREFIX = "railhead_coarse_"  # of PETSc's options of the P1 level
THRESHOLD = 0.01  # of strong couplings in GAMG: with all of them (its default) the P1 level of
# `hertz_ellipse` with 374 000 unknowns takes 54 instead of 32 iterations to 1e-6
AGGRESSIVE = 2  # levels coarsened by the squared graph: with one (its default) the next one is so
# full that the set-up of 1 000 000 unknowns takes 3.7 instead of 2.2 s, for as many iterations
SUBSET = PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN
DIFFERENT = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN


@dataclass(frozen=True)
class Hierarchy:
    """Prolongation of the P1 unknowns to the unknowns of the problem; K of the P1 cells in these
    unknowns, by the quadrature of the quadratic ones, which makes it the Galerkin product without
    one; and its near-nullspace."""

    prolongation: PETSc.Mat
    stiffness: Stiffness
    rigid_modes: list[PETSc.Vec]


class PMultigrid(Preconditioner):
    """Two levels; the coarse one is factorised, or given to algebraic multigrid where large. Set up
    for the active points almost as they are: `s1002_60e1` takes 54 iterations where a tenth of them
    may be gone, 41 with a thirtieth, 32 with a hundredth and a third set-up, worth five; loads of a
    sweep on half-spaces then need twice the set-ups for hardly fewer iterations."""

    stale = 0.03

    def __init__(self, problem: ContactProblem, hierarchy: Hierarchy) -> None:
        super().__init__(problem)
        self.hierarchy = hierarchy
        self.coarse = CoarseTangent(problem, hierarchy)
        compat.collect(problem.stiffness.comm.tompi4py())
        self.flexible = self.coarse.matrix.getSize()[0] >= COARSE_DIRECT_BELOW

    def set_up(self, active: Mask) -> None:
        symmetric = self.problem.law.symmetric
        self.operator = self.problem.tangent(active)
        self.coarse.fill(active)
        # A new one: PCMG keeps the residual operator of its first set-up.
        self.pc = PETSc.PC().create(self.operator.comm)
        self.pc.setOperators(self.operator)
        self.pc.setType("mg")
        self.pc.setMGLevels(2)
        self.pc.setMGInterpolation(1, self.hierarchy.prolongation)
        smoother = self.pc.getMGSmoother(1)
        smoother.setType("chebyshev")
        smoother.getPC().setType("jacobi")
        smoother.setTolerances(max_it=SMOOTHING)
        smoother.setOperators(self.operator, self.operator)
        solver = self.pc.getMGCoarseSolve()
        solver.setOperators(self.coarse.matrix, self.coarse.matrix)
        if not self.flexible:
            solver.setType("preonly")
            factorise(solver.getPC(), symmetric)
        else:
            near_nullspace(self.coarse.matrix, self.hierarchy.rigid_modes)
            # One V-cycle solves the coarse problem too loosely: the iterations grew sixfold at 1e6
            # unknowns. A few of CG's steps around it keep them where a direct solver has them.
            solver.setType("cg" if symmetric else "gmres")
            solver.setTolerances(rtol=0.1, max_it=10)
            solver.setOptionsPrefix(PREFIX)
            solver.getPC().setType("gamg")
            options = PETSc.Options(PREFIX)
            options["pc_gamg_threshold"] = THRESHOLD
            options["pc_gamg_aggressive_coarsening"] = AGGRESSIVE
            solver.setFromOptions()
        self.pc.setUp()


class CoarseTangent:
    """The tangent on the P1 unknowns, in one sparsity pattern for all active sets."""

    def __init__(self, problem: ContactProblem, hierarchy: Hierarchy) -> None:
        self.problem, prolongation = problem, hierarchy.prolongation
        self.trace = problem.trace.matMult(prolongation)
        self.test_trace = (
            self.trace if problem.law.symmetric else problem.test_trace.matMult(prolongation)
        )
        self.scaled = self.trace.copy()
        self.contact = self.test_trace.transposeMatMult(self.trace)
        self.bulk = hierarchy.stiffness.pinned(problem.stiffness.spring).assembled()
        if problem.consistency:
            stress = problem.stress.matMult(prolongation)
            scaled = stress.copy()
            scaled.diagonalScale(L=problem.at_points(problem.weight))
            self.bulk.axpy(-problem.consistency, stress.transposeMatMult(scaled), DIFFERENT)
        self.matrix = self.bulk.copy()
        self.matrix.axpy(1.0, self.contact, DIFFERENT)
        self.matrix.setBlockSize(hierarchy.stiffness.blocks.getBlockSize())

    def fill(self, active: Mask) -> None:
        """Put the values of these active points into the matrix."""
        problem = self.problem
        self.trace.copy(self.scaled, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self.scaled.diagonalScale(L=problem.at_points(problem.weight * active))
        self.test_trace.transposeMatMult(self.scaled, result=self.contact)
        self.matrix.zeroEntries()
        self.matrix.axpy(1.0, self.bulk, SUBSET)
        self.matrix.axpy(1.0, self.contact, SUBSET)
