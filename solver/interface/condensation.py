"""Static condensation of a pressed contact: its response to tangential tractions.

The tangential jump is J u = t . (u_wheel - u_rail), along k tangents t at each of n contact points.
A is the tangent stiffness of the pressed contact, whose active set stays. Tractions c at the nodes
of the slave's facets, of the wheel on the rail, displace everything by

    u = -A^-1 J^T W F c        F: shape functions of the nodes at the points, W: areas

What friction needs of that displacement is linear in c:

    q = q0 + D c      trial traction          q = +-S_t u + tau G u, S_t u = t . sigma(u_slave) . n
    g = g0 + D_g c    relative displacement   g = G u: the jump, or, rolling, -d times its
    p = p0 + D_p c    pressure                derivative along x

The sign is + where the slave is the rail. Rolling along +x takes upstream differences of second
order, G u = 1.5 J u - 2 J u(x + d) + 0.5 J u(x + 2 d): symmetric ones would not dissipate. The
frictionless solution u0 has no shear stress at the surface, and its derivative needs no upwinding.
So S_t u0, which is the mesh's error, is left out of q, and G u0 takes symmetric differences over
two edges, whose noise is a seventh.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.contact_system import ContactSystem
from railhead.solver.algebra.linear import factorise
from railhead.solver.algebra.problem import Mask
from railhead.solver.material.response import ElasticResponse
from railhead.solver.setup import FrictionSettings
from railhead.solver.solution import Solution
from railhead.solver.space.cells import Array, Index
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.operators import assemble_rows, select_rows, vector
from railhead.solver.space.pairing import pair

UPSTREAM = ((0.0, 1.5), (1.0, -2.0), (2.0, 0.5))  # distance in steps d, and weight
CENTRAL_STEPS = 2.0  # d of the symmetric differences of the frictionless solution
STEP_PER_EDGE = 0.5  # d over the length of the elements' edges
COLUMNS_AT_ONCE = 256  # right-hand sides that are solved together
DIFFERENT = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN

Entry = TypeVar("Entry", bound=np.generic)


@dataclass(frozen=True, kw_only=True)
class ContactCompliance:
    """Response of n contact points, of all ranks, to m tractions at nodes, on every rank.

    The points are those on facets that touch; each has k tangents. The last four fields belong to
    the solution that the response is linearised around, without tractions.

    points: (n, 3) mm in space.
    weights: area of each point (n,) in the meshed part, mm2.
    tangents: (n, k, 3) unit vectors in space.
    tau: parameter of the contact law (n,), MPa/mm.
    step: length d of the upstream differences when rolling, mm; 1 for a shift.
    shape_functions: F (n k, m), tractions at the points of tractions at the nodes.
    trial_compliance: D (n k, m).
    displacement_compliance: D_g (n k, m), mm/MPa.
    pressure_compliance: D_p (n, m).
    parts: number of symmetric images that make up the whole model.
    active: whether a point touches (n,).
    trial_traction: q0 (n, k), MPa.
    displacement: g0 (n, k), mm.
    pressure: p0 (n,), MPa.
    """

    points: Array
    weights: Array
    tangents: Array
    tau: Array
    step: float
    shape_functions: sp.csr_matrix
    trial_compliance: Array
    displacement_compliance: Array
    pressure_compliance: Array
    parts: int
    active: Mask
    trial_traction: Array
    displacement: Array
    pressure: Array

    @property
    def area(self) -> Array:
        """Area of each point (n,) in the whole model, mm2."""
        return self.parts * self.weights

    def in_space(self, values: Array) -> Array:
        """Vectors in space (n, 3) of components along the tangents (n, k)."""
        return np.asarray(np.einsum("nk,nkc->nc", values, self.tangents))

    def force(self, axis: Array) -> Array:
        """(m,) resultant along a unit vector (3,), N of the whole model, per traction at a node."""
        share = self.area[:, None] * (self.tangents @ axis)
        return np.asarray(self.shape_functions.T @ share.ravel())


class StaticCondensation:
    """Factorises the tangent stiffness of a pressed contact and condenses it to the contact points.

    own: numbers of this rank's contact points on facets that touch.
    sign: of the slave's stress in q, -1 where the slave is the wheel.
    jump: J on all dofs. change: G. trial: +-S_t + tau G.
    noise: part of q (n, k) of the frictionless solution that is the mesh's error, MPa.
    Raises ValueError when rolling and a surface ends upstream of the patch.
    """

    def __init__(
        self,
        system: ContactSystem,
        response: ElasticResponse,
        settings: FrictionSettings,
        pressed: Solution,
    ) -> None:
        self.system, self.response, self.settings = system, response, settings
        self.comm, interface, setup = system.comm, system.interface, system.setup
        active = pressed.pressure > 0
        touched = np.zeros(len(interface.slave), dtype=bool)
        touched[interface.facet[active]] = True
        self.own = np.flatnonzero(touched[interface.facet])
        self.slave = interface.slave.gathered(self.comm)
        self.master = None if interface.master is None else interface.master.gathered(self.comm)
        self.sign = -1.0 if setup.slave == setup.moving.tag else 1.0
        self.normals, self.x = interface.normals[self.own], interface.points[self.own]
        self.tangents = surface_tangents(self.sign * self.normals)
        before = self.size * (self.comm.exscan(len(self.own)) or 0)
        self.rows = slice(before, before + self.size * len(self.own))
        self.step = STEP_PER_EDGE * self._mean_edge(touched) if settings.rolling else 1.0
        self.tangent = system.problem.assembled_tangent(active)
        self.pc = PETSc.PC().create(self.comm)
        self.pc.setOperators(self.tangent)
        factorise(self.pc, system.problem.law.symmetric)
        self.pc.setUp()
        self.jump = self._jump(0.0)
        self.change = self._relative_change()
        tau = np.repeat(system.problem.tau[self.own], self.size)
        self.trial = self.change.copy()
        self.trial.diagonalScale(L=vector(self.change, tau))
        self.noise = np.zeros((len(self.own), self.size))
        u = pressed.displacement
        if system.problem.law.sigma:
            shear = self._shear()
            self.trial.axpy(self.sign, shear, DIFFERENT)
            stress = (shear * u).array.reshape(-1, self.size)
            self.noise += self.sign * (stress - self._plastic_shear())
        if settings.rolling:
            wide = CENTRAL_STEPS * self.step
            central = self._jump(-wide) * u - self._jump(wide) * u
            noise = (self.change * u).array - central.array / (2 * CENTRAL_STEPS)
            self.noise += tau.reshape(-1, self.size) * noise.reshape(-1, self.size)

    @property
    def size(self) -> int:
        """Number of tangents at a point, k."""
        return int(self.tangents.shape[1])

    def condense(self, solution: Solution) -> ContactCompliance:
        """The response around a solution without tractions (collective)."""
        problem, setup = self.system.problem, self.system.setup
        pressure = select_rows(problem.normal_operator, self.own)
        pressure.scale(-1.0)
        weights, shape = self.system.interface.weights[self.own], self._shape_functions()
        trial, displacement, closing = self._compliances(pressure, weights, shape)
        active, trial_traction, place, indicator = self._linearisation(solution)
        contact = ContactCompliance(
            points=setup.kinematics.lift(self._all(self.x)),
            weights=self._all(weights),
            tangents=setup.kinematics.in_space(self._all(self.tangents)),
            tau=self._all(problem.tau[self.own]),
            step=self.step,
            shape_functions=shape,
            trial_compliance=trial,
            displacement_compliance=displacement,
            pressure_compliance=closing,
            parts=setup.parts,
            active=active,
            trial_traction=trial_traction,
            displacement=place,
            pressure=indicator,
        )
        for axis, (u, y) in zip(self.settings.axes, self._far_field_response, strict=False):
            force = contact.force(axis)
            trial += np.outer(self._all((self.trial * u).array), force)
            displacement += np.outer(self._all((self.change * u).array), force)
            closing += np.outer(self._all((pressure * y).array), force)
        return contact

    def _compliances(
        self, pressure: PETSc.Mat, weights: Array, shape: sp.csr_matrix
    ) -> tuple[Array, Array, Array]:
        """D, D_g and D_p of bodies whose supports stay, by solving with A for each node."""
        reduce = self.system.reduction.matrix
        outputs = [self.trial.matMult(reduce), self.change.matMult(reduce), pressure]
        jump = self.jump.matMult(reduce)
        weighted = sp.diags(np.repeat(weights, self.size)) @ shape[self.rows]
        blocks: list[list[Array]] = [[], [], []]
        for first in range(0, shape.shape[1], COLUMNS_AT_ONCE):
            tractions = -weighted[:, first : first + COLUMNS_AT_ONCE].toarray()
            x = self._solve(self._nodal_forces(jump, tractions))
            for found, matrix in zip(blocks, outputs, strict=True):
                product = matrix.matMult(x)  # which its array does not keep alive
                found.append(product.getDenseArray().copy())
            del x, product
            compat.collect(self.comm)
        trial, displacement, closing = (self._all(np.hstack(found)) for found in blocks)
        return trial, displacement, closing

    def linearised(
        self, contact: ContactCompliance, solution: Solution, nodal: Array
    ) -> ContactCompliance:
        """The response around another solution, found under tractions (m,) at the nodes."""
        active, trial, displacement, pressure = self._linearisation(solution)
        elastic = contact.displacement_compliance @ nodal
        return replace(
            contact,
            active=active,
            trial_traction=trial - (contact.trial_compliance @ nodal).reshape(trial.shape),
            displacement=displacement - elastic.reshape(displacement.shape),
            pressure=pressure - contact.pressure_compliance @ nodal,
        )

    def _linearisation(self, solution: Solution) -> tuple[Mask, Array, Array, Array]:
        """Active points (n,), q (n, k) MPa, g (n, k) mm and indicator (n,) MPa of a solution."""
        u, plastic = solution.displacement, self._plastic_shear()
        trial = (self.trial * u).array.reshape(-1, self.size)
        displacement = (self.change * u).array.reshape(-1, self.size)
        return (
            np.concatenate(self.comm.allgather(solution.pressure[self.own] > 0)),
            self._all(trial - self.sign * plastic - self.noise),
            self._all(displacement),
            self._all(solution.indicator[self.own]),
        )

    def _plastic_shear(self) -> Array:
        """Part of the shear stress (p, k) at this rank's points that plastic strain takes, MPa."""
        return self.response.plastic_shear_stress(self.own, self.tangents, self.normals)

    @cached_property
    def far_field(self) -> list[PETSc.Vec]:
        """Displacement of the supported faces under 1 N along and across, on all dofs, mm; empty
        where the bodies end at their supports."""
        system, field = self.system, self.settings.far_field
        if field is None:
            return []
        ways = range(system.setup.kinematics.dim - 1)
        fields = [system.support_field(partial(field, way)) for way in ways]
        return [vector(system.reduction.matrix, values) for values in fields]

    @cached_property
    def _far_field_response(self) -> list[tuple[PETSc.Vec, PETSc.Vec]]:
        """For each far field: displacement on all dofs, and of the free unknowns alone."""
        reduction, responses = self.system.reduction, []
        for field in self.far_field:
            u = field.copy()
            force, y = self.tangent.createVecRight(), self.tangent.createVecRight()
            reduction.matrix.multTranspose(self.system.reactions.forces(u), force)
            force.scale(-1.0)
            self.pc.apply(force, y)
            u.axpy(1.0, reduction.matrix * y)
            responses.append((u, y))
        return responses

    def _solve(self, rhs: PETSc.Mat) -> PETSc.Mat:
        """A^-1 of dense columns."""
        out = rhs.duplicate()
        self.pc.getFactorMatrix().matSolve(rhs, out)
        return out

    def forces(self, nodal: Array, contact: ContactCompliance) -> PETSc.Vec:
        """-J^T W F c on all dofs, N: forces on the bodies of tractions c (m,) at the nodes."""
        weights = np.repeat(self.system.interface.weights[self.own], self.size)
        force = self.jump.createVecRight()
        pull = vector(self.jump, -weights * (contact.shape_functions[self.rows] @ nodal))
        self.jump.multTranspose(pull, force)
        return force

    def _mean_edge(self, touched: Mask) -> float:
        """Mean length of two edges at a corner of the facets that touch, mm, of all ranks."""
        corners = self.system.interface.slave.vertices[touched]
        edges = np.linalg.norm(corners[:, 1:] - corners[:, :1], axis=2)
        total, count = (self.comm.allreduce(value) for value in (edges.sum(), edges.size))
        return float(total / count)

    def _relative_change(self) -> PETSc.Mat:
        """G on all dofs: J, or, rolling, its upstream difference."""
        change = self.jump.copy()
        if self.settings.rolling:
            change.scale(UPSTREAM[0][1])
            for distance, weight in UPSTREAM[1:]:
                change.axpy(weight, self._jump(distance * self.step), DIFFERENT)
        return change

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
        interface = self.system.interface
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
        system = self.system
        count = len(self.own) * self.size
        owned = system.setup.kinematics.dim * system.owned
        total = system.reduction.matrix.getSize()[0]
        return assemble_rows(blocks, count, owned, total, self.comm)

    def _shape_functions(self) -> sp.csr_matrix:
        """F for the points and tangents of all ranks."""
        interface = self.system.interface
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

    def _nodal_forces(self, jump: PETSc.Mat, block: Array) -> PETSc.Mat:
        """J^T W F c for the columns of a dense block, of which this rank has its rows."""
        columns = block.shape[1]
        sizes = ((block.shape[0], None), (None, columns))
        dense = PETSc.Mat().createDense(sizes, array=np.asfortranarray(block), comm=self.comm)
        return jump.transposeMatMult(dense)

    def _all(self, values: NDArray[Entry]) -> NDArray[Entry]:
        """Rows of all ranks, on every rank."""
        return np.concatenate(self.comm.allgather(values))


def surface_tangents(normals: Array) -> Array:
    """Unit tangents (n, k, c) of a surface: along x and, with three coordinates, across it.

    normals: (n, c), out of the rail.
    """
    along = np.zeros_like(normals)
    along[:, 0] = 1.0
    along -= normals[:, :1] * normals
    along /= np.linalg.norm(along, axis=1)[:, None]
    if normals.shape[1] == 2:
        return along[:, None]
    return np.stack([along, np.cross(normals, along)], axis=1)
