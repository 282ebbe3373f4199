"""Response of a pressed contact of solids to tangential tractions at points of its surfaces.

The tangential jump is J u = t . (u_wheel - u_rail), along two tangents t at each of n points. The
wheel is the moving body, the rail the fixed one.
Forces f along the tangents there, of the wheel on the rail, act on the bodies as -J^T f. With the
tangent stiffness A of the pressed contact, whose active set stays, they displace everything by

    u = P y + u_far,    A y = -P^T (J^T f + K u_far)

P is the map from free unknowns to dofs, u_far the displacement of the supported faces under the
resultant of the forces, where the bodies are half-spaces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.algebra import linear
from railhead.solver.friction.pressed_surfaces import (
    PressedSurfaces,
    far_displacement,
    surface_tangents,
)
from railhead.solver.space.facets import pair
from railhead.solver.space.operators import vector
from railhead.theory.array_types import Array, Mask

TOLERANCE = 1e-3  # relative, of the linear solves


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
        out = self.jump.createVecRight()
        own = -forces[self.met].ravel()[first:last] / self.images
        self.jump.multTranspose(vector(self.jump, own), out)
        return out


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
        out = far_displacement(self.far_field, self.settings.axes[:2] @ points.resultant(forces))
        load = points.loads(forces)
        if out is None:
            out = load.duplicate()
            out.set(0.0)
        else:
            load.axpy(-1.0, system.reactions.forces(out))
        rhs, y = problem.stiffness.vector(), problem.stiffness.vector()
        system.reduction.matrix.multTranspose(load, rhs)
        linear.solve(problem, system.preconditioner, self.active, rhs, y, TOLERANCE)
        system.reduction.matrix.multAdd(y, out, out)
        return out
