"""Two bodies in contact: everything that does not depend on the load is built once."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra import linear, newton
from railhead.solver.algebra.linear import Preconditioner
from railhead.solver.algebra.multigrid import Hierarchy, PMultigrid
from railhead.solver.algebra.problem import ContactProblem, Mask, reduce_problem
from railhead.solver.algebra.reactions import SupportReactions
from railhead.solver.algebra.stiffness import Stiffness
from railhead.solver.interface import jumps
from railhead.solver.interface.jumps import Interface
from railhead.solver.material.elasticity import Bulk, assemble, quadrature_degree
from railhead.solver.setup import Setup
from railhead.solver.solution import Solution
from railhead.solver.space import constraints, transfer
from railhead.solver.space.cells import Array
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.operators import vector

NEWTON_TOLERANCE = 1e-8  # residual over the contact force
LINEAR_DIRECT_BELOW = 80_000  # unknowns of linear cells, whose multigrid is slow on stretched ones
SECTION_DIRECT_BELOW = 200_000  # unknowns of a section, where factors stay sparse
STAGE_TOLERANCE = 0.1  # the same for the softer laws on the way to a stiff one


@dataclass(frozen=True)
class LoadCase:
    """What `ContactModel.solve` is given."""

    load: float
    approach: float
    active: Mask
    max_steps: int = 30
    progress: Callable[[int, float], None] = lambda step, residual: None
    force: PETSc.Vec | None = None


class ContactModel:
    """Stiffness, interface, reduction and preconditioner of a Setup on a mesh (dolfinx, with
    MeshTags of its cells and facets). ValueError for a tag that nothing carries, but the support of
    the fixed body where there are planes, which may hold it."""

    def __init__(self, mesh: Any, cell_tags: Any, facet_tags: Any, setup: Setup) -> None:
        start = time.perf_counter()
        self.comm: MPI.Intracomm = mesh.comm
        self.setup = setup
        self.cell_tags, self.facet_tags = cell_tags, facet_tags
        sides = [s for s in (setup.fixed, setup.moving) if not s.rigid]
        for side in sides:
            self._must_exist("cell", cell_tags, side.tag)
            self._must_exist("contact facet", facet_tags, side.contact)
            if side is setup.moving or not setup.planes:  # planes may hold the other one
                self._must_exist("support facet", facet_tags, side.support)
        for tag, _ in setup.planes:
            self._must_exist("plane facet", facet_tags, tag)
        self.materials = {side.tag: side.material for side in sides}
        self.bulk: Bulk
        self.bulk, stiffness = assemble(
            mesh, cell_tags, self.materials, setup.degree, setup.kinematics
        )
        self.owned: int = self.bulk.space.dofmap.index_map.size_local
        by_tag = {s.tag: s for s in sides}
        slave = by_tag.pop(setup.slave)
        surfaces = [
            FacetSet.on(self.bulk, facet_tags.find(s.contact)) for s in (slave, *by_tag.values())
        ]
        self.interface: Interface = jumps.build(
            surfaces[0],
            surfaces[1] if len(surfaces) > 1 else None,
            setup.gap,
            setup.kinematics.dim * self.owned,
            self.comm,
        )
        supports = self.supports(self.bulk.space)
        self.reduction = constraints.reduce(supports, self.comm)
        self.held = SupportReactions.of(stiffness, supports.held, setup.kinematics.dim)
        material = next(side for side in sides if side.tag == setup.slave).material
        self.law = setup.law.suited(material.young_modulus, material.lame)
        self.closing: Array = self.interface.normals @ setup.push
        self.problem: ContactProblem = reduce_problem(
            stiffness, self.interface, self.reduction, self.law, self.closing
        )
        del stiffness
        compat.collect(self.comm)
        self.seconds = {"assemble": time.perf_counter() - start, "solve": 0.0}

    def _must_exist(self, what: str, tags: Any, tag: int) -> None:
        if not self.comm.allreduce(len(tags.find(tag))):
            raise ValueError(f"no {what} carries the tag {tag}")

    def release(self) -> None:
        """Free all matrices; the model is of no use afterwards (collective)."""
        self.__dict__ = {"comm": self.comm}
        compat.collect(self.comm)

    @property
    def unknowns(self) -> int:
        """Free unknowns of all ranks."""
        return self.reduction.unknowns

    def _members(self, space: Any, tag: int) -> NDArray[np.bool_]:
        dim = space.mesh.topology.dim
        space.mesh.topology.create_connectivity(dim - 1, dim)
        dofs = fem.locate_dofs_topological(space, dim - 1, self.facet_tags.find(tag))
        count = space.dofmap.index_map.size_local
        mask = np.zeros(count, dtype=bool)
        mask[dofs[dofs < count]] = True
        return mask

    def supports(self, space: Any) -> constraints.Supports:
        """Fixed faces, planes and hub as masks over the owned block dofs of a space."""
        setup = self.setup
        none = np.zeros(space.dofmap.index_map.size_local, dtype=bool)
        fixed = none if setup.fixed.rigid else self._members(space, setup.fixed.support)
        hub = none if setup.moving.rigid else self._members(space, setup.moving.support)
        flatten = setup.kinematics.flatten
        planes = [
            (self._members(space, tag), flatten(np.array(normal))) for tag, normal in setup.planes
        ]
        return constraints.Supports(fixed, planes, hub, setup.push, setup.load_control)

    def prescribed(self, load: float, approach: float) -> PETSc.Vec:
        """u0: far field of the load and, under approach control, the rigid motion of the hub."""
        values: Array = np.zeros((self.owned, self.setup.kinematics.dim))
        if self.setup.far_field is not None and load:
            values = self.following(partial(self.setup.far_field, load))
        supports = self.supports(self.bulk.space)
        if not self.setup.load_control and supports.hub is not None:
            values[supports.hub] += approach * supports.direction
        return vector(self.reduction.matrix, values)

    def following(self, field: Callable[[int, Array], Array]) -> Array:
        """Displacement (n, c) of the owned block dofs, mm, where the supported faces follow a
        field: (body tag, points in space (k, 3) mm) -> (k, 3) mm."""
        supports, kinematics = self.supports(self.bulk.space), self.setup.kinematics
        points = kinematics.lift(compat.dof_points(self.bulk.space))
        values = np.zeros((self.owned, kinematics.dim))
        for side, mask in ((self.setup.fixed, supports.fixed), (self.setup.moving, supports.hub)):
            if mask is not None and mask.any():
                values[mask] = kinematics.flatten(field(side.tag, points[mask]))
        return values

    def solve(
        self,
        *,
        load: float = 0.0,
        approach: float = 0.0,
        active: Mask,
        max_steps: int = 30,
        progress: Callable[[int, float], None] = lambda step, residual: None,
        force: PETSc.Vec | None = None,
    ) -> Solution:
        """Solve for one load (N, whole model) or approach (mm), starting from an active set.

        force: on the owned dofs of `bulk.space`, N, e.g. an assembled body force. ValueError for
        the one of load and approach that the setup does not control; a far field takes a load
        beside the approach.
        """
        if approach and self.setup.load_control:
            raise ValueError("approach is unknown under load control; give a load")
        if load and not self.setup.load_control and self.setup.far_field is None:
            raise ValueError("load is unknown under approach control; give an approach")
        start = time.perf_counter()
        solution = self.run(LoadCase(load, approach, active, max_steps, progress, force))
        self.seconds["solve"] += time.perf_counter() - start
        return solution

    def run(self, case: LoadCase) -> Solution:
        """All that a load case goes through."""
        return self.press(case)

    def press(self, case: LoadCase) -> Solution:
        """Elastic bodies without friction."""
        prescribed = self.load(self.problem, case.load, case.approach, case.force)
        active = case.active
        if not self.comm.allreduce(int(active.sum())):
            active = self._nearest()
        result = self._newton(active, case.max_steps, case.progress)
        return self.found(self.problem, result, prescribed, case.approach, case.force)

    def load(
        self, problem: ContactProblem, load: float, approach: float, force: PETSc.Vec | None
    ) -> PETSc.Vec:
        """Give a problem its load (N, whole model), approach (mm) and further forces; u0."""
        prescribed = self.prescribed(load, approach)
        share = load / self.setup.parts if self.setup.load_control else 0.0
        rigid_motion = 0.0 if self.setup.load_control or not self.setup.moving.rigid else approach
        problem.set_load(
            self.interface, self.reduction, self.held, prescribed, share, rigid_motion, force
        )
        return prescribed

    def found(
        self,
        problem: ContactProblem,
        result: newton.NewtonResult,
        prescribed: PETSc.Vec,
        approach: float,
        force: PETSc.Vec | None,
    ) -> Solution:
        """What a problem's y stands for."""
        displacement = prescribed.copy()
        self.reduction.matrix.multAdd(result.y, prescribed, displacement)
        if self.setup.load_control:
            local = result.y.array[self.reduction.approach] if self.reduction.approach >= 0 else 0.0
            approach = float(self.comm.allreduce(local))
        return Solution(
            displacement=displacement,
            pressure=result.pressure,
            indicator=problem.indicator(result.y),
            approach=approach,
            load=self._carried(result.pressure),
            reaction=self._reaction(displacement, result.pressure, force),
            penetration=self._penetration(displacement, approach),
            newton=result,
        )

    def _newton(
        self, active: Mask, max_steps: int, progress: Callable[[int, float], None]
    ) -> newton.NewtonResult:
        """Stage by stage up to the law asked for; factorised where iterations do not get there."""
        history: list[newton.Step] = []
        result: newton.NewtonResult | None = None
        for law in self.problem.law.stages:
            last = law == self.problem.law
            problem = self.problem if last else replace(self.problem, law=law)
            preconditioner = self.preconditioner if last else self.new_preconditioner(problem)
            while True:
                result = newton.solve(
                    problem,
                    preconditioner,
                    active,
                    result.y if result and result.converged else None,
                    rtol=NEWTON_TOLERANCE if last else STAGE_TOLERANCE,
                    max_steps=max_steps,
                    progress=progress,
                )
                history += result.history
                if not result.stalled or isinstance(preconditioner, linear.Direct):
                    break
                preconditioner = linear.Direct(problem)
                if last:
                    self.preconditioner = preconditioner
            active = result.pressure > 0
            compat.collect(self.comm)
        assert result is not None
        return replace(result, history=history)

    def _carried(self, pressure: Array) -> float:
        along = self.interface.normals @ self.setup.push
        sign = 1.0 if self.setup.slave == self.setup.moving.tag else -1.0
        local = sign * float(np.sum(self.interface.weights * pressure * along))
        return float(self.setup.parts * self.comm.allreduce(local))

    def _reaction(self, displacement: PETSc.Vec, pressure: Array, outer: PETSc.Vec | None) -> float:
        """What the support carries: R(u) of the unreduced problem, summed over the held nodes."""
        law, problem, jumps = self.law, self.problem, self.interface
        supports = self.supports(self.bulk.space)
        mask, sign = (supports.fixed, -1.0) if not self.setup.fixed.rigid else (supports.hub, 1.0)
        force, push = jumps.gap.createVecRight(), jumps.gap.createVecLeft()
        push.array[:] = -jumps.weights * pressure
        jumps.gap.multTranspose(push, force)
        if law.sigma and law.theta:
            stress = (jumps.stress * displacement).array
            push.array[:] = -law.theta * problem.weight * (pressure + stress)
            jumps.stress.multTransposeAdd(push, force, force)
        force.array[self.held.rows] += self.held.reactions(displacement)
        if outer is not None:
            force.axpy(-1.0, outer)
        nodal = force.array.reshape(-1, self.setup.kinematics.dim)
        local = sign * float(np.sum(nodal[mask] @ supports.direction))
        return float(self.setup.parts * self.comm.allreduce(local))

    def gaps(self, displacement: PETSc.Vec, approach: float) -> Array:
        """g(u) (n,) at the local contact points, mm."""
        gap = self.interface.initial_gap + (self.interface.gap * displacement).array
        return np.asarray(gap + (self.closing * approach if self.setup.moving.rigid else 0.0))

    def _penetration(self, displacement: PETSc.Vec, approach: float) -> float:
        overlap = float(np.max(-self.gaps(displacement, approach), initial=0.0))
        return float(self.comm.allreduce(overlap, op=MPI.MAX))

    def _nearest(self) -> NDArray[np.bool_]:
        """The few points with the smallest gap, where nothing else is known to touch."""
        gaps = self.interface.initial_gap
        lowest = np.sort(np.concatenate(self.comm.allgather(np.sort(gaps)[:12])))[:12]
        return np.asarray(gaps <= lowest[-1])

    @cached_property
    def preconditioner(self) -> Preconditioner:
        """Serves all loads."""
        return self.new_preconditioner(self.problem)

    def new_preconditioner(self, problem: ContactProblem) -> Preconditioner:
        """Direct, p-multigrid or GAMG, chosen by size."""
        choice = self.setup.linear
        if choice == "auto":
            limit = linear.DIRECT_BELOW
            if self.setup.degree == 1:
                limit = LINEAR_DIRECT_BELOW
            if self.setup.kinematics.dim == 2:
                limit = SECTION_DIRECT_BELOW
            choice = "direct" if self.unknowns < limit else "multigrid"
        if choice == "direct":
            return linear.Direct(problem)
        if self.setup.degree == 1:
            points = compat.dof_points(self.bulk.space)
            modes = transfer.rigid_modes(points, self.reduction, self.setup.kinematics)
            return linear.Algebraic(problem, modes)
        return PMultigrid(problem, self.hierarchy)

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """Linear cells below those of the problem."""
        mesh, kinematics = self.bulk.space.mesh, self.setup.kinematics
        rule = quadrature_degree(compat.cell_type(mesh), self.setup.degree, kinematics)
        coarse, stiffness = assemble(mesh, self.cell_tags, self.materials, 1, kinematics, rule)
        reduction = constraints.reduce(self.supports(coarse.space), self.comm)
        full = compat.interpolation(coarse.space, self.bulk.space)
        return Hierarchy(
            transfer.reduced_prolongation(full, self.reduction, reduction),
            Stiffness.reduced(stiffness, reduction),
            transfer.rigid_modes(compat.dof_points(coarse.space), reduction, kinematics),
        )
