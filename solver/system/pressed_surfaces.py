"""The surfaces of a pressed contact: facets, tangents, far field, and the response of two solids to
tangential tractions at points of a grid.

The tangential jump is J u = t . (u_wheel - u_rail), along two tangents t at each of n points. The
wheel is the moving body, the rail the fixed one.
Forces f along the tangents there, of the wheel on the rail, act on the bodies as -J^T f. With the
tangent stiffness A of the pressed contact, whose active set stays, they displace everything by

    u = P y + u_far,    A y = -P^T (J^T f + K u_far)

P is the map from free unknowns to dofs, u_far the displacement of the supported faces under the
resultant of the forces, where the bodies are half-spaces.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.algebra import linear
from railhead.solver.space.facets import pair
from railhead.solver.space.operators import transposed, vector
from railhead.solver.system.contact_system import ContactSystem
from railhead.solver.system.setup import FrictionSettings
from railhead.solver.system.solution import Solution
from railhead.theory.array_types import Array, Mask

ALONG = 1e-6  # cosine of a normal to the mesh's first axis, below 1, that leaves no tangent
TOLERANCE = 1e-3  # relative, of the linear solves


class PressedSurfaces:
    """The surfaces of a pressed contact, gathered from all ranks (collective).

    system: contact system.
    settings: friction settings.
    active: (n,) contact points of this rank that touch.
    touched: numbers of the slave's facets of this rank of which some point touches.
    slave, master: contact facets of all ranks; master None: a rigid body.
    sign: sign of the slave's stress in a traction of the wheel on the rail: -1 where the slave is
        the wheel, else 1.
    far_field: displacement of the supported faces under 1 N along and, in a solid, 1 N across the
        rail, on all dofs, mm/N; empty where the bodies end at their supports.
    """

    def __init__(
        self, system: ContactSystem, settings: FrictionSettings, pressed: Solution
    ) -> None:
        self.system, self.settings = system, settings
        self.active = pressed.pressure > 0
        self.touched = np.unique(system.interface.facet[self.active])
        self.slave = system.interface.slave.gathered(system.comm)
        self.master = system.interface.master
        self.sign = -1.0 if system.setup.slave == system.setup.moving.tag else 1.0
        self.far_field: list[PETSc.Vec] = []
        if settings.far_field is not None:
            for way in range(system.setup.kinematics.dim - 1):
                values = system.support_field(partial(settings.far_field, way))
                self.far_field.append(vector(system.reduction.matrix, values))

    @property
    def edge(self) -> float:
        """Mean distance of the other corners from the first corner of the facets that touch, of all
        ranks, mm (collective).
        """
        corners = self.system.interface.slave.vertices[self.touched]
        edges = np.linalg.norm(corners[:, 1:] - corners[:, :1], axis=2)
        total, count = self.system.comm.allreduce(np.array([edges.sum(), edges.size]))
        return float(total / count)

    def far_displacement(self, force: Array) -> PETSc.Vec:
        """Displacement of the supported faces, on all dofs, mm, under a force (2,) of the wheel on
        the rail along and across the rail, N; zero where the bodies end at their supports.
        """
        out = self.system.reduction.matrix.createVecLeft()
        out.set(0.0)
        for value, field in zip(force, self.far_field, strict=False):
            out.axpy(float(value), field)
        return out


def surface_tangents(normals: Array) -> Array:
    """Unit tangents (n, k, c) of a surface: the first axis of the mesh projected on the tangent
    plane and, with three coordinates, the normal times that tangent (cross product). The first axis
    is x, along the rail; only in a section across the rail it is y.

    normals: unit normals (n, c), out of the rail. Raises ValueError for a normal along the first
        axis of the mesh.
    """
    if np.any(np.abs(normals[:, 0]) > 1 - ALONG):
        raise ValueError("the contact's normal lies along the mesh's first axis: turn the mesh")
    along = np.zeros_like(normals)
    along[:, 0] = 1.0
    along -= normals[:, :1] * normals
    along /= np.linalg.norm(along, axis=1)[:, None]
    if normals.shape[1] == 2:
        return along[:, None]
    return np.stack([along, np.cross(normals, along)], axis=1)


@dataclass(frozen=True, kw_only=True)
class SurfacePoints:
    """Points on the slave's surface, opposite which the other body's surface lies, the same on all
    ranks. n counts the given places, m those that have such a point.

    comm: communicator of the mesh.
    met: (n,) whether a place has such a point.
    points: (m, 3) in space, mm; in a model cut at symmetry planes some may lie in the part left
        out.
    tangents: (m, 2, 3) unit vectors in space: along the rail, and across it in the tangent plane.
    jump: J, two rows a point, distributed over the ranks.
    images: number of symmetric parts of the patch, of which one is meshed.
    """

    comm: MPI.Intracomm
    met: Mask
    points: Array
    tangents: Array
    jump: PETSc.Mat
    images: int

    def jumps(self, displacement: PETSc.Vec) -> Array:
        """Tangential jump (n, 2) along the tangents at the given places, wheel less rail, mm, of a
        displacement on all dofs; zero where a place met no surface. All ranks get all of it
        (collective).
        """
        values = np.concatenate(self.comm.allgather((self.jump * displacement).array))
        return self.spread(values.reshape(-1, 2))

    def spread(self, values: Array) -> Array:
        """Values (n, ...) at all places from those at the points (m, ...), zero elsewhere."""
        out = np.zeros((len(self.met), *values.shape[1:]))
        out[self.met] = values
        return out

    def resultant(self, forces: Array) -> Array:
        """Resultant in space (3,), N, of forces (n, 2) along the tangents, N; those at places
        without a point do not count.
        """
        return np.einsum("mk,mkc->c", forces[self.met], self.tangents)

    def loads(self, forces: Array) -> PETSc.Vec:
        """Forces on the bodies of the meshed part, N, on all dofs, from forces (n, 2) along the
        tangents of the wheel on the rail, N, of the whole patch (collective).
        """
        first, last = self.jump.getOwnershipRange()
        return transposed(self.jump, -forces[self.met].ravel()[first:last] / self.images)


class SurfaceResponse(PressedSurfaces):
    """Jumps of the surfaces of two solids, and their response to forces while the active set
    stays.
    """

    def at(self, places: Array, normal: Array, mirrors: tuple[Array, ...]) -> SurfacePoints:
        """Points of the surfaces at places (n, 3) in space, mm, near the slave (collective). From a
        place the unit normal (3,) is followed to the slave, from there the slave's own normal to
        the other body. A place from which either body is missed has no point: `met` (n,) says which
        have one.

        mirrors: unit normals (3,), along axes of space, of the symmetry planes through the origin
            that the patch meets; places behind one, where x . normal < 0, have the mirrored
            displacement of those before it.
        """
        flip = np.ones_like(places)
        for plane in mirrors:
            flip[places @ plane < 0] *= 1 - 2 * np.abs(plane)
        before, normals = places * flip, np.broadcast_to(normal, places.shape) * flip
        facet, xi = pair(before, normals, self.slave)
        met = facet >= 0
        on = self.slave.tangents(facet[met], xi[met])[0]
        gap, normals = self.system.setup.gap(on)
        kept = np.isfinite(gap)
        if self.master is not None:
            partner, eta = pair(on, normals, self.master)
            kept &= partner >= 0
            partner, eta = partner[kept], eta[kept]
        met[met] = kept
        facet, xi, flip, on, normals = facet[met], xi[met], flip[met], on[kept], normals[kept]
        tangents = surface_tangents(self.sign * normals * flip)
        comm, system = self.system.comm, self.system
        count = len(facet)
        own = np.arange(count * comm.rank // comm.size, count * (comm.rank + 1) // comm.size)
        rows = (self.sign * tangents * flip[:, None])[own]
        blocks = [self.slave.rows_at(facet[own], xi[own], -rows)]
        if self.master is not None:
            blocks.append(self.master.rows_at(partner[own], eta[own], rows))
        return SurfacePoints(
            comm=comm,
            met=met,
            points=on * flip,
            tangents=tangents,
            jump=system.interface.matrix(blocks),
            images=2 ** len(mirrors),
        )

    def displacement(self, points: SurfacePoints, forces: Array) -> PETSc.Vec:
        """Displacement on all dofs, mm, by forces (n, 2) along the tangents at the places of
        `points`, of the wheel on the rail, N (collective). Raises StalledError where the linear
        solve fails.
        """
        system, problem = self.system, self.system.problem
        out = self.far_displacement(self.settings.axes[:2] @ points.resultant(forces))
        load = points.loads(forces)
        load.axpy(-1.0, system.reactions.forces(out))
        p, y = system.reduction.matrix, problem.force.duplicate()
        rhs = transposed(p, load.array)
        linear.solve(problem, system.preconditioner, self.active, rhs, y, TOLERANCE)
        p.multAdd(y, out, out)
        return out
