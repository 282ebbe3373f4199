"""Two bodies in contact: everything that does not depend on the load is built once."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from solver import compat, constraints, interface, linear, newton, transfer
from solver.elasticity import Bulk, Material, assemble
from solver.facets import Array, FacetSet
from solver.interface import Gap, Interface
from solver.laws import Law
from solver.problem import ContactProblem, reduce_problem

FarField = Callable[[float, int, Array], Array]
"""(load N, body tag, points (n, 3)) -> displacement (n, 3) of the supported faces, mm."""


@dataclass(frozen=True)
class Side:
    """Tags of one body: its cells, its contact facets and its supported facets."""

    tag: int
    contact: int
    support: int
    material: Material

    @property
    def rigid(self) -> bool:
        """Not meshed: only its exact surface takes part."""
        return bool(np.isinf(self.material.young_modulus))


@dataclass(frozen=True)
class Setup:
    """What is solved.

    fixed, moving: the body held at its support and the one pushed along `direction` by its rigid
    hub. gap: exact gap seen from the slave. planes: facet tag and normal of each symmetry plane.
    far_field: prescribed displacement of both supports on top of the rigid motion.
    load_control: the load is given and the approach an unknown, or the reverse.
    """

    fixed: Side
    moving: Side
    slave: int
    gap: Gap
    degree: int
    law: Law = field(default_factory=Law)
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    planes: tuple[tuple[int, tuple[float, float, float]], ...] = ()
    far_field: FarField | None = None
    load_control: bool = True
    linear: str = "auto"

    @property
    def parts(self) -> int:
        """How many times the modelled part makes up the whole."""
        return int(2 ** len(self.planes))


@dataclass(frozen=True)
class Solution:
    """One load case. displacement: owned dofs, mm. pressure (n,) MPa at the interface's points.

    load: what the pressure carries against the direction of the approach, of the whole model, N;
    reaction: the same at the support, N; approach: mm; penetration: largest overlap, mm.
    """

    displacement: PETSc.Vec
    pressure: Array
    approach: float
    load: float
    reaction: float
    penetration: float
    newton: newton.NewtonResult


class ContactModel:
    """Stiffness, interface, reduction and preconditioner of a Setup on a mesh."""

    def __init__(self, mesh: Any, cell_tags: Any, facet_tags: Any, setup: Setup) -> None:
        start = time.perf_counter()
        self.comm: MPI.Intracomm = mesh.comm
        self.setup = setup
        self.cell_tags, self.facet_tags = cell_tags, facet_tags
        sides = [s for s in (setup.fixed, setup.moving) if not s.rigid]
        self.bulk: Bulk = assemble(
            mesh, cell_tags, {s.tag: s.material for s in sides}, setup.degree
        )
        self.owned: int = self.bulk.space.dofmap.index_map.size_local
        by_tag = {s.tag: s for s in sides}
        slave = by_tag.pop(setup.slave)
        surfaces = [
            FacetSet.of(self.bulk, facet_tags.find(s.contact)) for s in (slave, *by_tag.values())
        ]
        self.interface: Interface = interface.build(
            surfaces[0],
            surfaces[1] if len(surfaces) > 1 else None,
            setup.gap,
            3 * self.owned,
            self.comm,
        )
        self.reduction = constraints.reduce(self.supports(self.bulk.space), self.comm)
        self.closing: Array = self.interface.normals @ np.array(setup.direction)
        self.problem: ContactProblem = reduce_problem(
            self.bulk.stiffness, self.interface, self.reduction, setup.law, self.closing
        )
        self.preconditioner: PETSc.PC | None = None
        self.seconds = {"assemble": time.perf_counter() - start, "solve": 0.0}

    @property
    def unknowns(self) -> int:
        """Free unknowns of all ranks."""
        return int(self.problem.stiffness.getSize()[0])

    def _members(self, space: Any, tag: int) -> NDArray[np.bool_]:
        space.mesh.topology.create_connectivity(2, 3)
        dofs = fem.locate_dofs_topological(space, 2, self.facet_tags.find(tag))
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
        planes = [(self._members(space, tag), np.array(normal)) for tag, normal in setup.planes]
        direction = np.array(setup.direction)
        return constraints.Supports(fixed, planes, hub, direction, setup.load_control)

    def prescribed(self, load: float, approach: float) -> PETSc.Vec:
        """u0: far field of the load and, under approach control, the rigid motion of the hub."""
        supports = self.supports(self.bulk.space)
        values = np.zeros((self.owned, 3))
        if self.setup.far_field is not None:
            points = self.bulk.space.tabulate_dof_coordinates()[: self.owned]
            for side, mask in (
                (self.setup.fixed, supports.fixed),
                (self.setup.moving, supports.hub),
            ):
                if mask is not None and mask.any():
                    values[mask] = self.setup.far_field(load, side.tag, points[mask])
        if not self.setup.load_control and supports.hub is not None:
            values[supports.hub] += approach * supports.direction
        vec = self.reduction.matrix.createVecLeft()
        vec.array[:] = values.ravel()
        return vec

    def solve(
        self,
        *,
        load: float = 0.0,
        approach: float = 0.0,
        active: NDArray[np.bool_],
        max_steps: int = 30,
        progress: Callable[[int, float], None] = lambda step, residual: None,
    ) -> Solution:
        """Solve for one load (N, whole model) or approach (mm), starting from an active set.

        The preconditioner of the first call serves all later ones.
        """
        start = time.perf_counter()
        prescribed = self.prescribed(load, approach)
        problem = self.problem
        share = load / self.setup.parts if self.setup.load_control else 0.0
        rigid_motion = 0.0 if self.setup.load_control or not self.setup.moving.rigid else approach
        problem.set_load(
            self.interface, self.reduction, self.bulk.stiffness, prescribed, share, rigid_motion
        )
        if not self.comm.allreduce(int(active.sum())):
            active = self._nearest()
        if self.preconditioner is None:
            self.preconditioner = self.precondition(problem.assembled_tangent(active))
        result = newton.solve(
            problem, active, self.preconditioner, max_steps=max_steps, progress=progress
        )
        displacement = prescribed.copy()
        self.reduction.matrix.multAdd(result.y, prescribed, displacement)
        if self.setup.load_control:
            local = result.y.array[self.reduction.approach] if self.reduction.approach >= 0 else 0.0
            approach = float(self.comm.allreduce(local))
        self.seconds["solve"] += time.perf_counter() - start
        return Solution(
            displacement,
            result.pressure,
            approach,
            self._carried(result.pressure),
            self._reaction(displacement, result.pressure),
            self._penetration(displacement, approach),
            result,
        )

    def _carried(self, pressure: Array) -> float:
        along = self.interface.normals @ np.array(self.setup.direction)
        sign = 1.0 if self.setup.slave == self.setup.moving.tag else -1.0
        local = sign * float(np.sum(self.interface.weights * pressure * along))
        return float(self.setup.parts * self.comm.allreduce(local))

    def _reaction(self, displacement: PETSc.Vec, pressure: Array) -> float:
        """What the support carries: R(u) of the unreduced problem, summed over the held nodes."""
        law, problem, interface = self.setup.law, self.problem, self.interface
        held = self.supports(self.bulk.space)
        mask, sign = (held.fixed, -1.0) if not self.setup.fixed.rigid else (held.hub, 1.0)
        force = self.bulk.stiffness * displacement
        push = interface.gap.createVecLeft()
        push.array[:] = -interface.weights * pressure
        interface.gap.multTransposeAdd(push, force, force)
        if law.sigma and law.theta:
            stress = (interface.stress * displacement).array
            push.array[:] = -law.theta * problem.weight * (pressure + stress)
            interface.stress.multTransposeAdd(push, force, force)
        local = sign * float(np.sum(force.array.reshape(-1, 3)[mask] @ held.direction))
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

    def precondition(self, matrix: PETSc.Mat) -> PETSc.PC:
        """A preconditioner of a contact tangent: direct, p-multigrid or GAMG, chosen by size."""
        symmetric = self.setup.law.symmetric
        choice = self.setup.linear
        if choice == "auto":
            choice = "direct" if self.unknowns < linear.DIRECT_BELOW else "multigrid"
        if choice == "direct":
            return linear.direct(matrix, symmetric)
        points = self.bulk.space.tabulate_dof_coordinates()[: self.owned]
        if self.setup.degree == 1:
            return linear.algebraic(matrix, transfer.rigid_modes(points, self.reduction))
        coarse = compat.vector_space(self.bulk.space.mesh, 1)
        reduction = constraints.reduce(self.supports(coarse), self.comm, padded=True)
        full = transfer.interpolation(coarse, self.bulk.space, self.setup.degree)
        prolongation = transfer.reduced_prolongation(full, self.reduction, reduction)
        coarse_points = coarse.tabulate_dof_coordinates()[: coarse.dofmap.index_map.size_local]
        modes = transfer.rigid_modes(coarse_points, reduction)
        return linear.multigrid(matrix, linear.Hierarchy(prolongation, modes), symmetric)
