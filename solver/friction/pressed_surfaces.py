"""The surfaces of a pressed contact: facets, tangents, rows of displacement, and the far field.

Both ways to friction of solids start from them: static condensation, and the response at points of
a grid (`solver.friction.surface_response`).
"""

from __future__ import annotations

from functools import partial

import numpy as np
from petsc4py import PETSc

from railhead.solver.space.operators import vector
from railhead.solver.system.contact_system import ContactSystem
from railhead.solver.system.setup import FrictionSettings
from railhead.solver.system.solution import Solution
from railhead.theory.array_types import Array

ALONG = 1e-6  # cosine of a normal to the mesh's first axis, below 1, that leaves no tangent


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
        self.far_field = far_field(system, settings)

    @property
    def edge(self) -> float:
        """Mean distance of the other corners from the first corner of the facets that touch, of all
        ranks, mm (collective).
        """
        return self.system.interface.slave.mean_edge(self.touched, self.system.comm)


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


def far_displacement(fields: list[PETSc.Vec], force: Array) -> PETSc.Vec | None:
    """Displacement of the supported faces, on all dofs, mm, under a force (2,) of the wheel on the
    rail along and across the rail, N; None without fields. fields: see `far_field`.
    """
    out = None
    for value, field in zip(force, fields, strict=False):
        out = field * float(value) if out is None else out + field * float(value)
    return out


def far_field(system: ContactSystem, settings: FrictionSettings) -> list[PETSc.Vec]:
    """Displacement of the supported faces under 1 N of the wheel on the rail along the rail and, in
    a solid, under 1 N across it: vectors on all dofs, mm/N; empty where the settings have no far
    field (collective).
    """
    if settings.far_field is None:
        return []
    ways = range(system.setup.kinematics.dim - 1)
    fields = [system.support_field(partial(settings.far_field, way)) for way in ways]
    return [vector(system.reduction.matrix, values) for values in fields]
