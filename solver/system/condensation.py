"""Static condensation of a pressed contact: its response to tangential tractions.

The tangential jump is J u = t . (u_wheel - u_rail), along k tangents t at each of n contact points.
The wheel is the moving body, the rail the fixed one. A is the tangent stiffness of the pressed
contact, whose active set stays. Tractions c at the nodes of the slave's facets, of the wheel on the
rail, displace everything by

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

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.coulomb import ContactCompliance
from railhead.solver.algebra.linear import Direct
from railhead.solver.algebra.reduced_stiffness import DIFFERENT
from railhead.solver.space.facets import pair
from railhead.solver.space.operators import select_rows, transposed, vector
from railhead.solver.system.contact_system import ContactSystem
from railhead.solver.system.load_stepping import Response
from railhead.solver.system.pressed_surfaces import PressedSurfaces, surface_tangents
from railhead.solver.system.setup import FrictionSettings
from railhead.solver.system.solution import Solution
from railhead.theory.array_types import Array, Mask

UPSTREAM = ((0.0, 1.5), (1.0, -2.0), (2.0, 0.5))  # distance in steps d, and weight
CENTRAL_STEPS = 2.0  # d of the symmetric differences of the frictionless solution
STEP_PER_EDGE = 0.5  # d over the length of the elements' edges
COLUMNS_AT_ONCE = 256  # right-hand sides that are solved together

Entry = TypeVar("Entry", bound=np.generic)


class StaticCondensation(PressedSurfaces):
    """Factorisation of the tangent stiffness of a pressed contact, and its condensation to the
    contact points. Its matrices are distributed, and its methods are collective.

    p contact points of this rank lie on facets of which some point touches; each has k tangents t.

    response: response of the bodies; gives the shear stress that plastic strain takes.
    comm: communicator of the mesh.
    own: numbers (p,) of these points among this rank's contact points.
    face: these points, with tangents along the rail and across it.
    rows: slice of this rank's rows among those of all ranks.
    step: distance d of the upstream differences, mm; 1 for a shift.
    pc: factorisation of the tangent stiffness A of the free unknowns.
    jump: matrix J on all dofs of the tangential jump t . (u_wheel - u_rail).
    change: matrix G on all dofs: J or, when rolling, -d times its upstream derivative along x.
    trial: matrix on all dofs of the trial traction, MPa/mm: sign times the slave's shear stress,
        plus tau G with the parameter tau of the contact law; tau G alone for a penalty.
    noise: part (p, k) of the trial traction of the frictionless solution that is error of the mesh,
        MPa.
    Raises ValueError when rolling and a surface ends upstream of the patch.
    """

    def __init__(
        self,
        system: ContactSystem,
        response: Response,
        settings: FrictionSettings,
        pressed: Solution,
    ) -> None:
        super().__init__(system, settings, pressed)
        self.response, self.comm, interface = response, system.comm, system.interface
        self.own = np.flatnonzero(np.isin(interface.facet, self.touched))
        tangents = surface_tangents(self.sign * interface.normals[self.own])
        self.face = interface.restricted(self.own, tangents)
        before = self.size * (self.comm.exscan(len(self.own)) or 0)
        self.rows = slice(before, before + self.size * len(self.own))
        self.step = STEP_PER_EDGE * self.edge if settings.rolling else 1.0
        direct = Direct(system.problem)
        direct.rebuild(self.active)
        self.pc: Any = direct.pc
        self.jump = self._jump(0.0)
        self.change = self._relative_change()
        tau = np.repeat(system.problem.tau[self.own], self.size)
        self.trial = self.change.copy()
        self.trial.diagonalScale(L=vector(self.change, tau))
        self.noise = np.zeros((len(self.own), self.size))
        u = pressed.displacement
        if system.problem.law.sigma:
            self.trial.axpy(self.sign, self.face.shear, DIFFERENT)
            stress = (self.face.shear * u).array.reshape(-1, self.size)
            self.noise += self.sign * (stress - self._plastic_shear())
        if settings.rolling:
            wide = CENTRAL_STEPS * self.step
            central = self._jump(-wide) * u - self._jump(wide) * u
            noise = (self.change * u).array - central.array / (2 * CENTRAL_STEPS)
            self.noise += tau.reshape(-1, self.size) * noise.reshape(-1, self.size)

    @property
    def size(self) -> int:
        """Number k of tangents at a point: 2 in a solid, 1 in a section."""
        return int(self.face.tangents.shape[1])

    def condense(self, solution: Solution) -> ContactCompliance:
        """Compliance of the contact points, and the linearisation around a solution without
        tangential tractions (collective).
        """
        problem, setup = self.system.problem, self.system.setup
        pressure = select_rows(problem.normal_operator, self.own)
        pressure.scale(-1.0)
        shape = self._shape_functions()
        trial, displacement, pressure_compliance = self._compliances(pressure, shape)
        active, trial_traction, place, indicator = self._linearisation(solution)
        contact = ContactCompliance(
            points=setup.kinematics.lift(self._all(self.face.points)),
            area=setup.parts * self._all(self.face.weights),
            tangents=setup.kinematics.in_space(self._all(self.face.tangents)),
            tau=self._all(problem.tau[self.own]),
            step=self.step,
            shape_functions=shape,
            trial_compliance=trial,
            displacement_compliance=displacement,
            pressure_compliance=pressure_compliance,
            active=active,
            trial_traction=trial_traction,
            displacement=place,
            pressure=indicator,
        )
        for axis, field in zip(self.settings.axes, self.far_field, strict=False):
            u, y = self._moved_with(field)
            force = contact.force(axis)
            trial += np.outer(self._all((self.trial * u).array), force)
            displacement += np.outer(self._all((self.change * u).array), force)
            pressure_compliance += np.outer(self._all((pressure * y).array), force)
        return contact

    def _compliances(self, pressure: PETSc.Mat, shape: sp.csr_matrix) -> tuple[Array, Array, Array]:
        """Derivatives of trial traction (n k, m), relative displacement (n k, m) and pressure (n,
        m) by m nodal tractions, for bodies whose supports stay (collective).

        pressure: matrix from the free unknowns to the pressure at this rank's points.
        shape: shape functions of all points (n k, m).
        One linear system with the tangent stiffness is solved for each nodal traction.
        """
        reduce = self.system.reduction.matrix
        outputs = [self.trial.matMult(reduce), self.change.matMult(reduce), pressure]
        jump = self.jump.matMult(reduce)
        weighted = sp.diags(np.repeat(self.face.weights, self.size)) @ shape[self.rows]
        blocks: list[list[Array]] = [[], [], []]
        for first in range(0, shape.shape[1], COLUMNS_AT_ONCE):
            block = np.asfortranarray(-weighted[:, first : first + COLUMNS_AT_ONCE].toarray())
            sizes = ((len(block), None), (None, block.shape[1]))
            tractions = PETSc.Mat().createDense(sizes, array=block, comm=self.comm)
            forces = jump.transposeMatMult(tractions)
            x = forces.duplicate()
            self.pc.getFactorMatrix().matSolve(forces, x)
            for found, matrix in zip(blocks, outputs, strict=True):
                product = matrix.matMult(x)  # which its array does not keep alive
                found.append(product.getDenseArray().copy())
            del x, product
            compat.collect(self.comm)
        trial, displacement, pressure_compliance = (self._all(np.hstack(found)) for found in blocks)
        return trial, displacement, pressure_compliance

    def linearised(
        self, contact: ContactCompliance, solution: Solution, nodal: Array
    ) -> ContactCompliance:
        """Compliance linearised around another solution: `active` is that of the solution, and
        `trial_traction`, `displacement` and `pressure` are its own less the elastic effect of the
        nodal tractions. The matrices and the stiffness stay those of the pressed contact.

        solution: solution of the bodies under the nodal tractions.
        nodal: nodal tractions (m,), MPa (collective).
        """
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
        """Values of a solution at the n points of all ranks (collective): active points (n,), trial
        traction (n, k) in MPa, relative displacement (n, k) in mm, and indicator (n,) in MPa.

        The stress that plastic strain takes and the error of the mesh are subtracted from the trial
        traction.
        """
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
        """Shear stress (p, k), MPa, along the k tangents of this rank's p contact points, by which
        plastic strain lowers that of the elastic law at the total strain; zero for elastic bodies.
        """
        return self.response.plastic_shear_stress(self.own, self.face.tangents, self.face.normals)

    def _moved_with(self, field: PETSc.Vec) -> tuple[PETSc.Vec, PETSc.Vec]:
        """Displacement of both bodies that a far field of 1 N causes while the active set stays,
        mm/N: on all dofs, and the part of the free unknowns alone.
        """
        u, p = field.copy(), self.system.reduction.matrix
        force = transposed(p, self.system.reactions.forces(u).array)
        y = force.duplicate()
        self.pc.apply(-force, y)
        u.axpy(1.0, p * y)
        return u, y

    def forces(self, nodal: Array, contact: ContactCompliance) -> PETSc.Vec:
        """Forces on the bodies of the meshed part from tangential tractions, on all dofs, N: the
        transposed jump times weighted tractions, negative.

        nodal: tractions (m,) of the wheel on the rail at the nodes, MPa.
        contact: compliance that holds the shape functions.
        """
        weights = np.repeat(self.face.weights, self.size)
        return transposed(self.jump, -weights * (contact.shape_functions[self.rows] @ nodal))

    def _relative_change(self) -> PETSc.Mat:
        """Matrix G on all dofs: the tangential jump J or, when rolling, its upstream difference of
        second order, which is -d times its derivative along x.
        """
        change = self.jump.copy()
        if self.settings.rolling:
            change.scale(UPSTREAM[0][1])
            for distance, weight in UPSTREAM[1:]:
                change.axpy(weight, self._jump(distance * self.step), DIFFERENT)
        return change

    def _jump(self, shift: float) -> PETSc.Mat:
        """Matrix on all dofs of the tangential jump t . (u_wheel - u_rail) at this rank's points: k
        rows a point, one for each of its tangents, which follow each other.

        shift: distance by which the points are first moved along their first tangent, mm. Raises
            ValueError where a moved point finds no facet.
        """
        at = self.face.points + shift * self.face.tangents[:, 0]
        blocks = []
        for surface, sign in ((self.slave, -self.sign), (self.master, self.sign)):
            if surface is None:
                continue
            facet, xi = pair(at, self.face.normals, surface)
            if np.any(facet < 0):
                raise ValueError("a surface ends upstream of the patch")
            blocks.append(surface.rows_at(facet, xi, sign * self.face.tangents))
        return self.face.matrix(blocks)

    def _shape_functions(self) -> sp.csr_matrix:
        """Shape functions F (n k, m): tractions at the n points along k tangents per traction at
        each node of the facets, of all ranks (collective).
        """
        slave, facet = self.face.slave, self.face.facet
        phi, _ = slave.basis(facet, slave.reference(facet, self.face.xi))
        values, dofs = self._all(phi), self._all(slave.dofs[facet])
        on = np.abs(values) > 1e-9  # the others belong to nodes off the facet
        used, column = np.unique(dofs[on], return_inverse=True)
        table = sp.csr_matrix(
            (values[on], (np.nonzero(on)[0], column)), shape=(len(values), len(used))
        )
        return sp.kron(table, sp.eye(self.size), format="csr")

    def _all(self, values: NDArray[Entry]) -> NDArray[Entry]:
        """Array with the rows of all ranks in their order, on every rank (collective)."""
        return np.concatenate(self.comm.allgather(values))
