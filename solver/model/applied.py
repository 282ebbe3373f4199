"""What acts on the bodies of a model besides contact and supports: forces and heat of bodies,
pressures, tractions and springs of facets.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx.fem.petsc import assemble_vector
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.algebra.reduced_stiffness import DIFFERENT
from railhead.solver.model.parts import Body, Part, Pressure, Spring, Traction, cell_values
from railhead.solver.space.cells import Bulk
from railhead.solver.space.contact_interface import Interface
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.operators import assemble_rows, transposed, vector, weighted_product
from railhead.solver.space.vectors import finite
from railhead.theory.array_types import Array


class Applied:
    """Loads of bodies and facets, and springs.

    force: of all loads on all dofs, with that of thermal strain.
    thermal: stress (cells,) by which thermal strain e lowers the normal stresses of the elastic law
        in all local cells: (3 lambda + 2 mu) e or, in plane stress, (2 lambda + 2 mu) e of its
        constants.
    springs: stiffness of each spring on all dofs.
    """

    def __init__(
        self,
        bulk: Bulk,
        stiffness: PETSc.Mat,
        tags: tuple[Any, Any],
        section: str | None,
        parts: Sequence[Part],
    ) -> None:
        """stiffness: of the bodies, for its layout. tags: of cells and of facets (collective).
        Raises ValueError for values that do not fit.
        """
        self.comm, self._bulk = bulk.space.mesh.comm, bulk
        self._cell_tags, self._facet_tags = tags
        self._bodies = [each for each in parts if isinstance(each, Body)]
        self.thermal = self._thermal(2 if section == "plane stress" else 3)
        self.force = vector(stiffness, np.zeros(stiffness.getLocalSize()[0]))
        self._body_force()
        self.springs: dict[Spring, PETSc.Mat] = {}
        for each in parts:
            if isinstance(each, Pressure | Traction | Spring):
                self._load(each)

    def _thermal(self, ways: int) -> Array:
        """The stress `thermal` (cells,) of strain in 3 or 2 ways."""
        lam, mu = self._bulk.lame.T
        out = np.zeros(len(lam))
        for body in self._bodies:
            cells = self._cell_tags.find(body.tag)
            given = cell_values("thermal_strain", body.thermal_strain, cells)
            out[cells] = finite(f"Body {body.tag}", "thermal_strain", given, *np.shape(given))
        return np.asarray(out * (ways * lam + 2 * mu))

    def thermal_at(self, pairing: Interface) -> Array:
        """The stress `thermal` at contact points of this rank (n,)."""
        return self.thermal[pairing.slave.numbers[pairing.facet]]

    def _load(self, load: Pressure | Traction | Spring) -> None:
        """Add a load of facets to the forces, or a spring to the foundations (collective). Raises
        ValueError for values that do not fit.
        """
        dim, local = self._bulk.kinematics.dim, self.force.getLocalSize()
        facets = FacetSet.on(self._bulk, self._facet_tags.find(load.tag))
        at, weights = facets.quadrature(2 * self._bulk.degree + 2)
        x, tangents = facets.tangents(*at)
        every = np.tile(np.eye(dim), (len(x), 1, 1))
        blocks, total = [facets.rows_at(*at, every)], self.force.getSize()
        rows = assemble_rows(blocks, dim * len(x), local, total, self.comm)
        if isinstance(load, Spring):
            each = weights[:, None] * _at_points(load, "stiffness", load.stiffness, x, dim)
            if self.comm.allreduce(int((each < 0).sum())):
                raise ValueError(f"{load}: stiffness must not be negative")
            self.springs[load] = weighted_product(rows, each.ravel(), rows)
            return
        if isinstance(load, Pressure):
            value = _at_points(load, "value", load.value, x, 1)
            values = -value * facets.normals(at[0], tangents)
        else:
            values = _at_points(load, "vector", load.vector, x, dim)
        self.force.axpy(1.0, transposed(rows, (weights[:, None] * values).ravel()))

    def sprung(self, stiffness: PETSc.Mat) -> PETSc.Mat:
        """Stiffness on all dofs with that of the springs (collective)."""
        if not self.springs:
            return stiffness
        matrix = stiffness.convert("aij")
        for each in self.springs.values():
            matrix.axpy(1.0, each, DIFFERENT)
        matrix.setBlockSize(self._bulk.kinematics.dim)
        matrix = matrix.convert("baij")
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        return matrix

    def spring_force(self, spring: Spring, displacement: PETSc.Vec) -> Array:
        """Force (c,) of a spring on the bodies (collective)."""
        nodal = (self.springs[spring] * displacement).array.reshape(-1, self._bulk.kinematics.dim)
        return np.asarray(self.comm.allreduce(-nodal.sum(axis=0)))

    def _body_force(self) -> None:
        """Put the forces of bodies and of thermal strain into `force` (collective)."""
        mesh, kinematics = self._bulk.space.mesh, self._bulk.kinematics
        given = [each for each in self._bodies if each.force is not None]
        hot = self.comm.allreduce(bool(self.thermal.any()), op=MPI.LOR)
        if not given and not hot:
            return
        values = np.zeros((len(self._bulk.lame), kinematics.dim))
        v, more = ufl.TestFunction(self._bulk.space), 0
        for body in given:
            cells = self._cell_tags.find(body.tag)
            if hasattr(body.force, "ufl_shape"):
                inside = np.zeros(len(values))
                inside[cells] = 1.0
                more += compat.cellwise_constant(mesh, inside) * ufl.inner(body.force, v)
            else:
                values[cells] = np.asarray(body.force, float)
        load = ufl.as_vector([compat.cellwise_constant(mesh, each.copy()) for each in values.T])
        r = ufl.SpatialCoordinate(mesh)[0]
        if hot:
            swells = kinematics.dilatation(v, r) if kinematics.revolved else ufl.div(v)
            more += compat.cellwise_constant(mesh, self.thermal) * swells
        form = (
            (2 * np.pi * r if kinematics.revolved else 1.0) * (ufl.inner(load, v) + more) * ufl.dx
        )
        found = assemble_vector(compat.form(form, mesh))
        found.ghostUpdate(PETSc.InsertMode.ADD, PETSc.ScatterMode.REVERSE)
        self.force.array[:] = found.array[: self.force.getLocalSize()]


def _at_points(load: Any, name: str, given: Any, x: Array, size: int) -> Array:
    """Values (n, size) of a load's attribute at points (n, c), from a number, a vector or a
    function of points. Raises ValueError for others, and for what is not finite.
    """
    values = np.asarray(given(x) if callable(given) else given)
    if size == 1:
        values = values[..., None]
    if values.shape == (size,) or (not values.shape and name == "stiffness"):
        values = np.broadcast_to(values, (len(x), size))
    right = values.shape == (len(x), size) and values.dtype.kind in "iuf"
    if not right or not np.isfinite(values).all():
        raise ValueError(f"{load}: {name} must be finite, {size} number(s) at each point")
    return values
