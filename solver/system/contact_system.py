"""Discrete system of two elastic bodies in contact, assembled once for all load cases."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra import linear, newton
from railhead.solver.algebra.linear import Preconditioner
from railhead.solver.algebra.multigrid import Hierarchy, PMultigrid
from railhead.solver.algebra.problem import ContactProblem
from railhead.solver.algebra.reduced_stiffness import (
    DIFFERENT,
    Stiffness,
    SupportReactions,
    unit_vector,
)
from railhead.solver.algebra.stiffness import assemble
from railhead.solver.space.cells import Bulk
from railhead.solver.space.contact_interface import Interface
from railhead.solver.space.operators import add_transposed, vector
from railhead.solver.space.supports import (
    Clamp,
    Held,
    Hub,
    Slide,
    held,
    masks,
    must_exist,
    reduce,
    rigid_modes,
    translation,
)
from railhead.solver.system.setup import Setup
from railhead.solver.system.solution import Solution
from railhead.solver.system.surfaces import Contact, Surfaces
from railhead.theory.array_types import Array, Mask

STAGE_TOLERANCE = 0.1  # residual over the contact force for the softer laws before a stiff one
DIRECT_BELOW = {(3, 2): 6_000, (3, 1): 80_000, (2, 2): 200_000, (2, 1): 200_000}
"""Unknowns, by number of coordinates and degree, below which a factorisation is the cheapest
preconditioner: multigrid is slow on stretched linear cells, factors of a section stay sparse."""


@dataclass(frozen=True, kw_only=True)
class LoadCase:
    """Load of a contact system, and where the iterations start.

    load: N, of the whole model, along the direction of the setup: applied under load control; it
        also scales the far field.
    approach: of the moving body along the direction of the setup, mm, under approach control;
        without effect under load control.
    active: (n,) contact points of this rank that touch at the start; where no rank has one, the
        twelve points with the smallest initial gap.
    max_steps: largest number of Newton's steps in each solve of the pressure; what has not
        converged by then is returned as not converged.
    progress: called with the number and the relative residual of each of Newton's steps.
    force: further forces on the meshed part, on all owned dofs, N; None: zero.
    support_displacement: displacement prescribed at the supported faces beside far field and
        approach, on all owned dofs, mm; None: zero.
    tolerance: Newton's tolerance for elastic bodies, norm of the residual over that of the nodal
        contact forces; None: that of the setup.
    """

    load: float = 0.0
    approach: float = 0.0
    active: Mask
    max_steps: int = 30
    progress: Callable[[int, float], None] = lambda step, residual: None
    force: PETSc.Vec | None = None
    support_displacement: PETSc.Vec | None = None
    tolerance: float | None = None

    def scaled(self, share: float) -> LoadCase:
        """The same load case with load, approach, force and support displacement multiplied by a
        share.
        """
        force, displacement = self.force, self.support_displacement
        return replace(
            self,
            load=share * self.load,
            approach=share * self.approach,
            force=None if force is None else force * float(share),
            support_displacement=None if displacement is None else displacement * float(share),
        )


class ContactSystem:
    """Discrete system of two elastic bodies in frictionless contact, assembled on a mesh. n is the
    number of contact points of this rank.

    comm: communicator of the mesh.
    setup: bodies, contact law, supports and further settings of the model.
    cell_tags, facet_tags: MeshTags of the cells and facets.
    materials: cell tag of each deformable body -> its material.
    bulk: displacement space and elastic constants of the cells.
    owned: number of block dofs that this rank owns.
    interface: contact points, with gap and normal stress as matrices.
    clamp, hub: support of the fixed body, and that of the moving one, which moves along the push.
    masks: owned block dofs (nodes,) of each support and symmetry plane.
    reduction: supports, as the map from free unknowns to dofs.
    reactions: rows of the stiffness matrix at the supported nodes.
    law: contact law, with the parameters that suit the slave's material.
    gap_per_approach: (n,) component of the slave's outward normal along the direction: the change
        of the gap per unit approach of a rigid moving body.
    problem: contact problem in the free unknowns.
    Raises ValueError for a tag of a deformable body or a plane that no cell or facet carries.
    """

    def __init__(self, mesh: Any, cell_tags: Any, facet_tags: Any, setup: Setup) -> None:
        self.comm: MPI.Intracomm = mesh.comm
        self.setup = setup
        self.cell_tags, self.facet_tags = cell_tags, facet_tags
        sides = [s for s in (setup.fixed, setup.moving) if not s.rigid]
        for side in sides:
            must_exist("cell", cell_tags, side.tag, self.comm)
            must_exist("contact facet", facet_tags, side.contact, self.comm)
            if side is setup.moving or not setup.planes:  # planes may hold the other one
                must_exist("support facet", facet_tags, side.support, self.comm)
        for tag, _ in setup.planes:
            must_exist("plane facet", facet_tags, tag, self.comm)
        self.materials = {side.tag: side.material for side in sides}
        self.bulk: Bulk
        self.bulk, stiffness = assemble(
            mesh, cell_tags, self.materials, setup.degree, setup.kinematics
        )
        self.owned: int = self.bulk.space.dofmap.index_map.size_local
        sides.sort(key=lambda side: side.tag != setup.slave)
        slave, *master = (side.contact for side in sides)
        contact = Contact(slave, master[0] if master else None, gap=setup.exact)
        surfaces = Surfaces([contact], self.bulk, facet_tags, self.comm, cut=setup.cut)
        rest = np.zeros((self.bulk.space.dofmap.index_map.size_global, setup.kinematics.dim))
        self.interface: Interface = surfaces.pair(rest)
        tags = (-1 if side.rigid else side.support for side in (setup.fixed, setup.moving))
        self.clamp, self.hub = Clamp(next(tags)), Hub(next(tags), tuple(setup.push))
        flatten = setup.kinematics.flatten
        planes = [Slide(tag, tuple(flatten(np.array(normal)))) for tag, normal in setup.planes]
        self.masks = masks(self.bulk.space, facet_tags, [self.clamp, self.hub, *planes])
        supports = self.supports(self.bulk.space)
        self.reduction = reduce(supports, self.comm)
        self.reactions = SupportReactions.of(stiffness, supports.fixed, setup.kinematics.dim)
        material = self.materials[setup.slave]
        self.law = setup.law.suited(material.young_modulus, material.lame)
        self.gap_per_approach: Array = self.interface.normals @ setup.push
        reduced, p = Stiffness.reduced(stiffness, self.reduction), self.reduction.matrix
        del stiffness
        self.problem: ContactProblem = ContactProblem.reduced(
            self.law,
            reduced,
            self.interface,
            p,
            force=reduced.vector(),
            start_gap=self.interface.initial_gap,
            start_stress=np.zeros_like(self.gap_per_approach),
        )
        if self.reduction.rigid_approach:
            moved = self.reduction.column(0, self.gap_per_approach)
            self.problem.gap.axpy(1.0, moved, DIFFERENT)
        compat.collect(self.comm)

    def release(self) -> None:
        """Drop everything but `comm`, which frees all matrices; afterwards the system cannot be
        used (collective).
        """
        self.__dict__ = {"comm": self.comm}
        compat.collect(self.comm)

    @property
    def unknowns(self) -> int:
        """Number of free unknowns of all ranks."""
        return self.reduction.unknowns

    def supports(self, space: Any) -> Held:
        """Conditions on the displacement at the owned block dofs of a space, by the fixed face, the
        symmetry planes and, under load control, the hub, which moves freely along the push
        (collective).
        """
        hubs = [self.hub] if self.setup.load_control else []
        return held(space, self.facet_tags, self.masks, hubs)

    def prescribed(self, case: LoadCase) -> PETSc.Vec:
        """Prescribed displacement u0 on all dofs, mm: far field of the load, support displacement
        of the load case and, under approach control, the rigid motion of the hub (collective).
        """
        values: Array = np.zeros((self.owned, self.setup.kinematics.dim))
        if self.setup.far_field is not None and case.load:
            values = self.support_field(partial(self.setup.far_field, case.load))
        if not self.setup.load_control:
            values[self.masks[self.hub]] += case.approach * self.setup.push
        out = vector(self.reduction.matrix, values)
        if case.support_displacement is not None:
            out.axpy(1.0, case.support_displacement)
        return out

    def support_field(self, field: Callable[[int, Array], Array]) -> Array:
        """Displacement (n, c), mm, at the n block dofs of this rank: that of a field on the fixed
        face and at the hub, zero elsewhere (collective).

        field: (body tag, points in space (k, 3) mm) -> displacement in space (k, 3) mm.
        """
        setup, kinematics = self.setup, self.setup.kinematics
        points = kinematics.lift(compat.dof_points(self.bulk.space))
        values = np.zeros((self.owned, kinematics.dim))
        for side, part in ((setup.fixed, self.clamp), (setup.moving, self.hub)):
            mask = self.masks[part]
            if mask.any():
                values[mask] = kinematics.flatten(field(side.tag, points[mask]))
        return values

    def press(
        self,
        case: LoadCase,
        problem: ContactProblem | None = None,
        begin: Callable[[], PETSc.Vec] | None = None,
    ) -> Solution:
        """Solution of a load case without friction, converged or not (collective).

        problem: its equations, which take over the loads; None: those of elastic bodies.
        begin: gives the free unknowns to start from, once the problem has its loads; None: exactly
            the active points of the case touch at the start, and softer contact laws are solved
            first, up to that of the problem.
        A solve whose linear solves fail is repeated with a factorisation. The history holds the
        steps of all solves.
        """
        problem = self.problem if problem is None else problem
        prescribed = self.apply(problem, case)
        history: list[newton.NewtonStep] = []
        active, start = case.active, begin and begin()
        if not self.comm.allreduce(int(active.sum())):
            active = self.interface.nearest(np.zeros(len(active)))
        for law in problem.law.stages if start is None else [problem.law]:
            last = law == problem.law
            solved = problem if last else problem.with_law(law)
            kept = last and problem.stiffness is self.problem.stiffness
            preconditioner = self.preconditioner if kept else self.new_preconditioner(solved)
            while True:
                result = newton.solve(
                    solved,
                    preconditioner,
                    active,
                    start,
                    rtol=(case.tolerance or self.setup.tolerance) if last else STAGE_TOLERANCE,
                    max_steps=case.max_steps,
                    progress=case.progress,
                )
                history += result.history
                if not result.stalled or isinstance(preconditioner, linear.Direct):
                    break
                preconditioner = linear.Direct(solved)
                if kept:
                    self.preconditioner = preconditioner
            active, start = result.pressure > 0, result.y if result.converged else None
            compat.collect(self.comm)
        if result.converged:
            self.balance(problem, result)
        return self.solution(problem, replace(result, history=history), prescribed, case)

    def apply(self, problem: ContactProblem, case: LoadCase) -> PETSc.Vec:
        """Set the forces of a contact problem, and its gap, stress and strains at zero free
        unknowns, to those of a load case; nothing is solved. The result is the prescribed
        displacement u0 on all dofs, mm (collective).
        """
        setup, prescribed = self.setup, self.prescribed(case)
        force = self.reactions.forces(prescribed)
        force.scale(-1.0)
        if case.force is not None:
            force.axpy(1.0, case.force)
        self.reduction.matrix.multTranspose(force, problem.force)
        if self.reduction.approach >= 0:
            problem.force.array[self.reduction.approach] += case.load / setup.parts
        problem.start_stress = (self.interface.stress * prescribed).array.copy()
        problem.start_gap = self.gaps(prescribed, 0.0 if setup.load_control else case.approach)
        problem.set_prescribed_strain(prescribed)
        return prescribed

    def solution(
        self,
        problem: ContactProblem,
        result: newton.NewtonResult,
        prescribed: PETSc.Vec,
        case: LoadCase,
    ) -> Solution:
        """Solution, with forces and penetration, that belongs to a result of Newton's method;
        nothing is solved (collective).

        problem: the problem that was solved.
        result: its free unknowns y and pressure; the displacement is P y plus the prescribed one,
            with the map P of the reduction.
        prescribed: prescribed displacement on all dofs, mm.
        case: load case.
        """
        displacement, approach = prescribed.copy(), case.approach
        self.reduction.matrix.multAdd(result.y, prescribed, displacement)
        if self.setup.load_control:
            local = result.y.array[self.reduction.approach] if self.reduction.approach >= 0 else 0.0
            approach = float(self.comm.allreduce(local))
        overlap = float(np.max(-self.gaps(displacement, approach), initial=0.0))
        return Solution(
            displacement=displacement,
            pressure=result.pressure,
            indicator=problem.indicator(result.y),
            approach=approach,
            load=self._carried(result.pressure),
            reaction=self._reaction(displacement, result.pressure, case.force),
            penetration=float(self.comm.allreduce(overlap, op=MPI.MAX)),
            newton=result,
        )

    def balance(self, problem: ContactProblem, result: newton.NewtonResult) -> None:
        """Add translations of the bodies along the approach to the state of a result, in place, so
        that its forces balance to rounding at any tolerance of Newton's method (collective).

        With the translations T, the residual R and the tangent K_A at the active set of the state,
        y <- y - T (T^T K_A T)^-1 T^T R.
        problem: the problem that was solved. The pressure in the result changes, too.
        """
        residual = problem.residual(result.y, result.pressure)
        tangent = problem.tangent(result.pressure > 0)
        forces = [tangent * motion for motion in self._translations]
        matrix = [[motion.dot(force) for force in forces] for motion in self._translations]
        unbalanced = [motion.dot(residual) for motion in self._translations]
        for motion, length in zip(
            self._translations, np.linalg.solve(matrix, unbalanced), strict=True
        ):
            result.y.axpy(-length, motion)
        result.pressure[:] = np.maximum(problem.indicator(result.y), 0.0)

    @cached_property
    def _translations(self) -> list[PETSc.Vec]:
        """Unit translation along the approach of each body in the free unknowns. Fixed faces stay;
        a hub moves with its body where the approach is unknown, else it stays. A rigid moving body
        moves by the approach, and has none where the approach is prescribed.
        """
        space, reduction = self.bulk.space, self.reduction
        motions = []
        for tag in self.materials:
            full = translation(space, self.cell_tags.find(tag), self.setup.push)
            motions.append(reduction.restricted(vector(reduction.matrix, full)))
        if reduction.rigid_approach:
            like = reduction.matrix.createVecRight()
            motions.append(unit_vector(like, reduction.approach))
        return motions

    def _carried(self, pressure: Array) -> float:
        """Resultant of the pressure (n,), MPa, on the moving body against the direction of the
        approach, N of the whole model (collective).
        """
        sign = 1.0 if self.setup.slave == self.setup.moving.tag else -1.0
        local = sign * float(np.sum(self.interface.weights * pressure * self.gap_per_approach))
        return float(self.setup.parts * self.comm.allreduce(local))

    def _reaction(self, displacement: PETSc.Vec, pressure: Array, outer: PETSc.Vec | None) -> float:
        """Force at the support against the direction of the approach, N of the whole model: the
        residual of the equations without supports, summed over the supported nodes (collective).

        displacement: on all dofs, mm.
        pressure: (n,), MPa.
        outer: further forces on all dofs, N; None: zero.
        The support is that of the fixed body; where that body is rigid, it is the hub, and the
        force counts along the direction.
        """
        problem, face, force = self.problem, self.interface, displacement.duplicate()
        part, sign = (self.hub, 1.0) if self.setup.fixed.rigid else (self.clamp, -1.0)
        force.set(0.0)
        add_transposed(face.gap, -face.weights * pressure, force)
        normal = (face.stress * displacement).array
        push = problem.consistency * problem.weight * (pressure + normal)
        add_transposed(face.stress, -push, force)
        force.array[self.reactions.rows] += self.reactions.at(displacement)
        if outer is not None:
            force.axpy(-1.0, outer)
        nodal = force.array.reshape(-1, self.setup.kinematics.dim)
        local = sign * float(np.sum(nodal[self.masks[part]] @ self.setup.push))
        return float(self.setup.parts * self.comm.allreduce(local))

    def gaps(self, displacement: PETSc.Vec, approach: float) -> Array:
        """Gap between the deformed surfaces (n,) at the contact points of this rank, mm, negative
        where they overlap (collective).

        displacement: on all dofs, mm. approach: mm; without effect where the moving body is meshed,
            because the displacement then contains it.
        """
        gap = self.interface.initial_gap + (self.interface.gap * displacement).array
        return np.asarray(
            gap + (self.gap_per_approach * approach if self.setup.moving.rigid else 0.0)
        )

    @cached_property
    def preconditioner(self) -> Preconditioner:
        """Preconditioner of the elastic problem, kept from one load case to the next. Once linear
        solves failed with it, a factorisation takes its place.
        """
        return self.new_preconditioner(self.problem)

    def new_preconditioner(self, problem: ContactProblem) -> Preconditioner:
        """Preconditioner of a problem: a factorisation, p-multigrid or algebraic multigrid, chosen
        by `setup.linear`, the degree of the cells and the number of unknowns.
        """
        choice = self.setup.linear
        if choice == "auto":
            limit = DIRECT_BELOW[self.setup.kinematics.dim, min(self.setup.degree, 2)]
            choice = "direct" if self.unknowns < limit else "multigrid"
        if choice == "direct":
            return linear.Direct(problem)
        if self.setup.degree == 1:
            points = compat.dof_points(self.bulk.space)
            modes = rigid_modes(points, self.reduction, self.setup.kinematics)
            return linear.Algebraic(problem, modes)
        return PMultigrid(problem, self.hierarchy)

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """Coarse level of p-multigrid: linear cells on the same mesh, with the quadrature of the
        quadratic cells.
        """
        return Hierarchy.of(
            self.bulk,
            self.cell_tags,
            self.materials,
            self.reduction,
            lambda space: reduce(self.supports(space), self.comm),
        )
