"""p-multigrid: Chebyshev-Jacobi on the quadratic cells, a Galerkin product on linear cells.

The fine tangent is never assembled: the smoother needs its product and its diagonal only. With the
prolongation Q the tangent on the linear cells is

    Q^T (K - theta S^T w S) Q  +  (Bt Q)^T w A (B Q)

That is the tangent of a contact problem in the unknowns of these cells, with the gap N Q and the
normal stress S Q. Its first part is made once; a new active set costs a small product.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.linear import Preconditioner, factorise, near_nullspace
from railhead.solver.algebra.problem import ContactProblem
from railhead.solver.algebra.reduced_stiffness import Stiffness
from railhead.solver.algebra.stiffness import assemble
from railhead.solver.material import Material
from railhead.solver.space.cells import Bulk, quadrature_degree
from railhead.solver.space.supports import Reduction, reduced_prolongation, rigid_modes
from railhead.theory.array_types import Mask

COARSE_DIRECT_BELOW = 40_000  # unknowns of the P1 level (measured from 20 000 to 33 000)
SMOOTHING_STEPS = 3  # of Chebyshev's method, before and after the coarse level
OPTIONS_PREFIX = "railhead_coarse_"  # of PETSc's options of the P1 level
GAMG_THRESHOLD = 0.01  # of strong couplings in GAMG: with all of them (its default) the P1 level of
# `hertz_ellipse` with 374 000 unknowns takes 54 instead of 32 iterations to 1e-6
AGGRESSIVE_LEVELS = 2  # levels coarsened by the squared graph: with one (its default) the next
# level is so full that the set-up of 1 000 000 unknowns takes 3.7 instead of 2.2 s, for as many
# iterations


@dataclass(frozen=True)
class Hierarchy:
    """Coarse level of linear (P1) cells for a contact problem on quadratic cells.

    prolongation: matrix Q from the P1 unknowns to those of the problem.
    stiffness: stiffness of the P1 cells in their unknowns. It uses the quadrature of the quadratic
        cells, so that it equals the Galerkin product Q^T K Q with their stiffness K, without
        forming it.
    rigid_modes: orthonormal rigid motions in the P1 unknowns, the near-nullspace of that matrix.
    """

    prolongation: PETSc.Mat
    stiffness: Stiffness
    rigid_modes: list[PETSc.Vec]

    @classmethod
    def of(
        cls,
        fine: Bulk,
        cell_tags: Any,
        materials: dict[int, Material],
        reduction: Reduction,
        reduce: Callable[[Any], Reduction],
    ) -> Hierarchy:
        """Level of linear cells on the mesh of quadratic ones (collective).

        fine, cell_tags, materials, reduction: space of the problem, with its supports. reduce: from
            a space to the supports there.
        """
        mesh, kinematics = fine.space.mesh, fine.kinematics
        rule = quadrature_degree(compat.cell_type(mesh), fine.degree, kinematics)
        coarse, matrix = assemble(mesh, cell_tags, materials, 1, kinematics, rule)
        reduced = reduce(coarse.space)
        full = compat.interpolation(coarse.space, fine.space)
        return cls(
            reduced_prolongation(full, reduction, reduced),
            Stiffness.reduced(matrix, reduced),
            rigid_modes(compat.dof_points(coarse.space), reduced, kinematics),
        )


class PMultigrid(Preconditioner):
    """Preconditioner with two levels, quadratic and linear cells. The linear level is factorised,
    or solved by algebraic multigrid where it is large. The other fields are those of
    `Preconditioner`.

    hierarchy: the level of linear cells.
    coarse: contact problem on that level.
    flexible: whether that level is solved by a Krylov method with algebraic multigrid.

    It is set up again for small changes of the active set (`outdated_share`). `s1002_60e1` takes 54
    iterations where a tenth of the active area may have changed, and 41 with a thirtieth. With a
    hundredth it takes 32 and a third set-up, which costs as much as five. A load 4 % lower on the
    same mesh takes half of the time with a hundredth: with the preconditioner of the load before,
    Newton's method needs six steps, not two or three.
    """

    outdated_share = 0.01

    def __init__(self, problem: ContactProblem, hierarchy: Hierarchy) -> None:
        super().__init__(problem)
        self.hierarchy = hierarchy
        self.coarse = problem.coarser(hierarchy.prolongation, hierarchy.stiffness)
        compat.collect(problem.stiffness.comm.tompi4py())
        self.flexible = self.coarse.stiffness.blocks.getSize()[0] >= COARSE_DIRECT_BELOW

    def set_up(self, active: Mask) -> None:
        """Compute the coarse tangent at these active points (n,), and build smoother and coarse
        solver (collective).
        """
        symmetric = self.problem.law.symmetric
        matrix = self.coarse.assembled_tangent(active)
        # A new one: PCMG keeps the residual operator of its first set-up.
        pc = self.start(self.problem.tangent(active))
        pc.setType("mg")
        pc.setMGLevels(2)
        pc.setMGInterpolation(1, self.hierarchy.prolongation)
        smoother = pc.getMGSmoother(1)
        smoother.setType("chebyshev")
        smoother.getPC().setType("jacobi")
        smoother.setTolerances(max_it=SMOOTHING_STEPS)
        smoother.setOperators(self.operator, self.operator)
        solver = pc.getMGCoarseSolve()
        solver.setOperators(matrix, matrix)
        if not self.flexible:
            solver.setType("preonly")
            factorise(solver.getPC(), symmetric)
        else:
            near_nullspace(matrix, self.hierarchy.rigid_modes)
            # One V-cycle solves the coarse problem too loosely: the iterations grew sixfold at 1e6
            # unknowns. A few of CG's steps around it keep them where a direct solver has them.
            solver.setType("cg" if symmetric else "gmres")
            solver.setTolerances(rtol=0.1, max_it=10)
            solver.setOptionsPrefix(OPTIONS_PREFIX)
            solver.getPC().setType("gamg")
            options = PETSc.Options(OPTIONS_PREFIX)
            options["pc_gamg_threshold"] = GAMG_THRESHOLD
            options["pc_gamg_aggressive_coarsening"] = AGGRESSIVE_LEVELS
            solver.setFromOptions()
        pc.setUp()
