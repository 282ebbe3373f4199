"""A pressed contact, condensed: how points of its interface answer to tangential tractions.

The jump is J u = t . (u_wheel - u_rail) along k tangents t at each of n contact points. With A the
tangent of the pressed contact, whose active set stays, tractions c at the nodes of the slave's
facets, of the wheel on the rail, move everything by -A^-1 J^T W F c, F being the traces of the
nodes' shape functions. What is asked of that movement is linear in c:

    q = q0 + D c        q = +-S_t u + tau G u,   S_t u = t . sigma(u_slave) . n
    g = g0 + D_g c      G u: the jump, or, rolling, -d times its derivative along x
    p = p0 + D_p c

+ where the slave is the rail. Rolling along +x takes upstream differences of second order,
G u = 1.5 J u - 2 J u(x + d) + 0.5 J u(x + 2 d): symmetric ones would not dissipate. What is pressed
without friction, u0, has no shear stress at the surface and nothing to dissipate: S_t u0, which is
the mesh's error, is left out of q, and G u0 takes symmetric differences over two edges, whose noise
is a seventh.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.linear import factorise
from railhead.solver.solution import Solution
from railhead.solver.space.cells import Array, Index
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.operators import chosen, rows, vector
from railhead.solver.space.pairing import pair

if TYPE_CHECKING:
    from railhead.solver.interface.frictional_model import RubbingModel

UPSTREAM = ((0.0, 1.5), (1.0, -2.0), (2.0, 0.5))  # distance in steps d, and weight
CENTRAL = 2.0  # steps of the symmetric differences that what is pressed is differentiated with
STEP = 0.5  # d over the length of the elements' edges
BLOCK = 256  # right-hand sides that are solved at a time
DIFFERENT = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN

Entry = TypeVar("Entry", bound=np.generic)


@dataclass(frozen=True)
class ContactCompliance:
    """The n points on facets that touch, of all ranks, on every rank.

    points (n, 3) mm in space, weights (n,) mm2, tangents (n, k, 3), tau (n,) MPa/mm; step d, mm (1
    of a shift); traces F (n k, m); answer D, movement D_g (n k, m) and closing D_p (n, m); parts:
    of the whole model. Around a solution: touches (n,); start q0 and moved g0 (n, k) and pressure
    p0 (n,) MPa, without tractions.
    """

    points: Array
    weights: Array
    tangents: Array
    tau: Array
    step: float
    traces: sp.csr_matrix
    answer: Array
    movement: Array
    closing: Array
    parts: int
    touches: NDArray[np.bool_]
    start: Array
    moved: Array
    pressure: Array

    @property
    def area(self) -> Array:
        """(n,) mm2 of the whole model."""
        return self.parts * self.weights

    def in_space(self, values: Array) -> Array:
        """Vectors (n, 3) of components along the tangents (n, k)."""
        return np.asarray(np.einsum("nk,nkc->nc", values, self.tangents))

    def force(self, axis: Array) -> Array:
        """(m,) N of the whole model along a unit vector (3,), of tractions at the nodes."""
        share = self.area[:, None] * (self.tangents @ axis)
        return np.asarray(self.traces.T @ share.ravel())


class StaticCondensation:
    """Factorises the tangent of a pressed contact and condenses it. ValueError: it rolls, and a
    surface ends upstream of the patch."""

    def __init__(self, model: RubbingModel, solution: Solution, *, rolling: bool) -> None:
        self.model, self.comm = model, model.comm
        active = solution.pressure > 0
        interface, setup = model.interface, model.setup
        touched = np.zeros(len(interface.slave), dtype=bool)
        touched[interface.facet[active]] = True
        self.own = np.flatnonzero(touched[interface.facet])
        self.slave = interface.slave.gathered(self.comm)
        others = (side for side in (setup.fixed, setup.moving) if side.tag != setup.slave)
        master = next((side for side in others if not side.rigid), None)
        self.master = None
        if master is not None:
            facets = model.facet_tags.find(master.contact)
            self.master = FacetSet.on(model.bulk, facets).gathered(self.comm)
        self.sign = -1.0 if setup.slave == setup.moving.tag else 1.0  # of the rail's stress
        self.normals, self.x = interface.normals[self.own], interface.points[self.own]
        self.tangents = tangents(self.sign * self.normals)
        before = self.size * (self.comm.exscan(len(self.own)) or 0)
        self.rows = slice(before, before + self.size * len(self.own))
        corners = interface.slave.vertices[touched]
        edges = np.linalg.norm(corners[:, 1:] - corners[:, :1], axis=2)
        total, count = (self.comm.allreduce(value) for value in (edges.sum(), edges.size))
        self.step = STEP * float(total / count) if rolling else 1.0
        self.tangent = model.problem.assembled_tangent(active)
        self.pc = PETSc.PC().create(self.comm)
        self.pc.setOperators(self.tangent)
        factorise(self.pc, model.problem.law.symmetric)
        self.pc.setUp()
        self.jump = self._jump(0.0)
        self.change = self.jump.copy()
        if rolling:
            self.change.scale(UPSTREAM[0][1])
            for share, weight in UPSTREAM[1:]:
                self.change.axpy(weight, self._jump(share * self.step), DIFFERENT)
        self.answer = self.change.copy()
        tau = np.repeat(model.problem.tau[self.own], self.size)
        self.answer.diagonalScale(L=vector(self.change, tau))
        if model.problem.law.sigma:
            shear = self._shear()
            self.answer.axpy(self.sign, shear, DIFFERENT)

        u, self.rest = solution.displacement, np.zeros((len(self.own), self.size))
        if model.problem.law.sigma:
            sheared = (shear * u).array.reshape(-1, self.size)
            self.rest += self.sign * (sheared - model.lost_shear(self))
        if rolling:
            wide = CENTRAL * self.step
            central = self._jump(-wide) * u - self._jump(wide) * u
            noise = (self.change * u).array - central.array / (2 * CENTRAL)
            self.rest += tau.reshape(-1, self.size) * noise.reshape(-1, self.size)

    @property
    def size(self) -> int:
        """Tangents at a point, k."""
        return int(self.tangents.shape[1])

    def condense(self, solution: Solution) -> ContactCompliance:
        """Around a solution without tractions."""
        model, problem = self.model, self.model.problem
        interface, reduce = model.interface, model.reduction.matrix
        pressure = chosen(problem.trace, self.own)
        pressure.scale(-1.0)
        weights = interface.weights[self.own]
        traces = self._traces()
        reduced = [matrix.matMult(reduce) for matrix in (self.answer, self.change)] + [pressure]
        push = self.jump.matMult(reduce)
        weighted = sp.diags(np.repeat(weights, self.size)) @ traces[self.rows]
        answers: list[list[Array]] = [[], [], []]
        for first in range(0, traces.shape[1], BLOCK):
            block = -weighted[:, first : first + BLOCK].toarray()
            x = self.solve(self._dense(push, block))
            for found, matrix in zip(answers, reduced, strict=True):
                product = matrix.matMult(x)  # which its array does not keep alive
                found.append(product.getDenseArray().copy())
            del x, product
            compat.collect(self.comm)
        answer, movement, closing = (self._all(np.hstack(found)) for found in answers)
        values = (self.x, weights, self.tangents, problem.tau[self.own])
        points, weights, along, tau = (self._all(each) for each in values)
        lift = model.setup.kinematics.lift
        condensed = ContactCompliance(
            lift(points), weights,
            lift(along.reshape(-1, along.shape[2])).reshape(len(points), self.size, 3), tau,
            self.step, traces, answer, movement, closing, model.setup.parts,
            *self.state(solution),
        )  # fmt: skip
        for axis, (u, y) in zip(model.friction_settings.axes, self.far, strict=False):
            row = condensed.force(axis)
            for known, moved in ((answer, self.answer * u), (movement, self.change * u),
                                 (closing, pressure * y)):  # fmt: skip
                known += np.outer(self._all(moved.array), row)
        return condensed

    def around(
        self, contact: ContactCompliance, solution: Solution, nodal: Array
    ) -> ContactCompliance:
        """Linear around a solution under tractions (m,) at the nodes."""
        touches, start, moved, pressure = self.state(solution)
        return replace(
            contact,
            touches=touches,
            start=start - (contact.answer @ nodal).reshape(start.shape),
            moved=moved - (contact.movement @ nodal).reshape(moved.shape),
            pressure=pressure - contact.closing @ nodal,
        )

    def state(self, solution: Solution) -> tuple[NDArray[np.bool_], Array, Array, Array]:
        """Touches (n,), q and G u (n, k), MPa and mm, and pressure (n,) of a solution."""
        u, lost = solution.displacement, self.model.lost_shear(self)
        answer, moved = ((matrix * u).array.reshape(-1, self.size)
                         for matrix in (self.answer, self.change))  # fmt: skip
        touches = np.concatenate(self.comm.allgather(solution.pressure[self.own] > 0))
        values = answer - self.sign * lost - self.rest, moved, solution.indicator[self.own]
        start, place, pressure = (self._all(np.asarray(each)) for each in values)
        return touches, start, place, pressure

    @cached_property
    def far(self) -> list[tuple[PETSc.Vec, PETSc.Vec]]:
        """Of 1 N along and across: displacement on all dofs and free unknowns where what lies
        beyond the bodies gives way."""
        found = []
        for given in self.model.far:
            u = given.copy()
            rhs = self.model.held.forces(u)
            force, y = self.tangent.createVecRight(), self.tangent.createVecRight()
            self.model.reduction.matrix.multTranspose(rhs, force)
            force.scale(-1.0)
            self.pc.apply(force, y)
            u.axpy(1.0, self.model.reduction.matrix * y)
            found.append((u, y))
        return found

    def solve(self, rhs: PETSc.Mat) -> PETSc.Mat:
        """A^-1 of dense columns."""
        out = rhs.duplicate()
        self.pc.getFactorMatrix().matSolve(rhs, out)
        return out

    def push(self, nodal: Array, contact: ContactCompliance) -> PETSc.Vec:
        """What tractions (m,) at the nodes do to the bodies: forces on all dofs, N."""
        weights = np.repeat(self.model.interface.weights[self.own], self.size)
        force = self.jump.createVecRight()
        pull = vector(self.jump, -weights * (contact.traces[self.rows] @ nodal))
        self.jump.multTranspose(pull, force)
        return force

    def _jump(self, shift: float) -> PETSc.Mat:
        """J at the points moved by `shift` mm along x, on all dofs."""
        at = self.x + shift * self.tangents[:, 0]
        blocks = []
        for surface, sign in ((self.slave, -self.sign), (self.master, self.sign)):
            if surface is None:
                continue
            facet, xi = pair(at, self.normals, surface)
            if np.any(facet < 0):
                raise ValueError("a surface ends upstream of the patch")
            phi, _ = surface.basis(facet, surface.reference(facet, xi))
            values = sign * phi[:, None, :, None] * self.tangents[:, :, None, :]
            blocks.append(self._block(surface, facet, values))
        return self._rows(blocks)

    def _shear(self) -> PETSc.Mat:
        """S_t on all dofs."""
        interface = self.model.interface
        facet, xi = interface.facet[self.own], interface.xi[self.own]
        slave, t, n = interface.slave, self.tangents, self.normals
        _, gradient = slave.basis(facet, slave.reference(facet, xi))
        along = np.einsum("pdc,pkc->pkd", gradient, t)[..., None] * n[:, None, None, :]
        normal = np.einsum("pdc,pc->pd", gradient, n)[:, None, :, None] * t[:, :, None, :]
        values = slave.lame[facet, 1][:, None, None, None] * (along + normal)
        return self._rows([self._block(slave, facet, values)])

    def _block(self, surface: FacetSet, facet: Index, values: Array) -> tuple[Index, Array]:
        """Dofs and coefficients, a row a point and tangent, of values (n, k, nodes, c) at the nodes
        of facets (n,)."""
        dim = self.tangents.shape[2]
        dofs = dim * surface.dofs[facet][:, :, None] + np.arange(dim)
        return np.repeat(dofs, self.size, axis=0), values.reshape(-1, *values.shape[2:])

    def _rows(self, blocks: list[tuple[Index, Array]]) -> PETSc.Mat:
        model = self.model
        count = len(self.own) * self.size
        owned = model.setup.kinematics.dim * model.owned
        total = model.reduction.matrix.getSize()[0]
        return rows(blocks, count, owned, total, self.comm)

    def _traces(self) -> sp.csr_matrix:
        """F for all ranks' points and tangents."""
        interface = self.model.interface
        facet, xi = interface.facet[self.own], interface.xi[self.own]
        slave = interface.slave
        phi, _ = slave.basis(facet, slave.reference(facet, xi))
        values, dofs = self._all(phi), self._all(slave.dofs[facet])
        on = np.abs(values) > 1e-9  # the others belong to nodes off the facet
        used, column = np.unique(dofs[on], return_inverse=True)
        table = sp.csr_matrix(
            (values[on], (np.nonzero(on)[0], column)), shape=(len(values), len(used))
        )
        return sp.kron(table, sp.eye(self.size), format="csr")

    def _dense(self, push: PETSc.Mat, block: Array) -> PETSc.Mat:
        """J^T W F c for the columns of a block of this rank's rows."""
        columns = block.shape[1]
        dense = PETSc.Mat().createDense(
            ((block.shape[0], None), (None, columns)), array=np.asfortranarray(block),
            comm=self.comm,
        )  # fmt: skip
        return push.transposeMatMult(dense)

    def _all(self, values: NDArray[Entry]) -> NDArray[Entry]:
        return np.concatenate(self.comm.allgather(values))


def tangents(normals: Array) -> Array:
    """(n, k, c): along x in the surface and across it, from the normals out of the rail (n, c)."""
    along = np.zeros_like(normals)
    along[:, 0] = 1.0
    along -= normals[:, :1] * normals
    along /= np.linalg.norm(along, axis=1)[:, None]
    if normals.shape[1] == 2:
        return along[:, None]
    return np.stack([along, np.cross(normals, along)], axis=1)
