"""Structured block below a moving load: graded axes, mesh, stiffness, and its supports.

The coordinates are x along the way of the load, y across it in a solid, and z out of the surface,
which is z = 0. The load stands at the origin and moves to +x, so that the body flows to -x.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
import scipy.sparse as sp
from dolfinx.mesh import meshtags
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy.spatial import cKDTree

from railhead.solver import compat
from railhead.solver.algebra import linear
from railhead.solver.algebra.reduced_stiffness import Stiffness
from railhead.solver.algebra.stiffness import assemble
from railhead.solver.material import Material
from railhead.solver.plasticity.plastic_problem import YieldPoints, bulk_points
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.space.operators import petsc_matrix, transposed, vector
from railhead.solver.space.supports import Held, Reduction, reduce
from railhead.theory.array_types import Array, Index

TAG = 1  # of the cells
CELLS = {2: "quadrilateral", 3: "hexahedron"}
KINEMATICS = {2: Kinematics(axes=np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])), 3: SOLID}
NEAR = 1e-9  # of the largest coordinate: nodes on a face


def graded(inner: float, size: float, reach: float, growth: float) -> Array:
    """Ascending coordinates from 0 to `reach` or, if that is less, to `inner`, mm. Cells are at
    most `size` wide up to `inner`. Beyond, each is wider than the last by the factor `growth`, and
    all are narrowed by one factor so that they end at `reach`.
    """
    count = max(int(np.ceil(inner / size - 1e-9)), 1)
    nodes = list(np.linspace(0.0, inner, count + 1))
    step = nodes[1]
    widths: list[float] = []
    while sum(widths) < reach - inner:
        step *= growth
        widths.append(step)
    if widths:
        nodes += list(inner + np.cumsum(widths) * ((reach - inner) / sum(widths)))
    return np.array(nodes)


def mirrored(axis: Array) -> Array:
    """Coordinates (2 n - 1,) of an axis (n,) from 0 on, and of its mirror image."""
    return np.concatenate([-axis[:0:-1], axis])


@dataclass(frozen=True)
class Block:
    """Block of quadratic quadrilaterals (plane strain) or hexahedra on one process.

    axes: ascending node coordinates of the cells along x, in a solid y, and z, whose last is 0, mm.
    material: elastic constants and flow curve.
    half: whether y = 0 is a symmetry plane, where the second axis begins.
    depth: depth down to which plastic strain is followed, mm.
    aside: distance |y| up to which it is followed, mm.
    tied: whether all planes x = constant move alike: the section of a body that does not change
        along x.
    """

    axes: tuple[Array, ...]
    material: Material
    half: bool = False
    depth: float = np.inf
    aside: float = np.inf
    tied: bool = False

    @property
    def dim(self) -> int:
        """Number of coordinates: 2 in plane strain, 3 in a solid."""
        return len(self.axes)

    @property
    def kinematics(self) -> Kinematics:
        """Meaning of the coordinates."""
        return KINEMATICS[self.dim]

    @cached_property
    def slab(self) -> Block:
        """Slab of one cell along x, with tied planes and the same section."""
        width = float(np.diff(self.axes[-1]).max())
        return replace(self, axes=(np.array([0.0, width]), *self.axes[1:]), tied=True)

    @cached_property
    def mesh(self) -> Any:
        """dolfinx mesh with straight hexahedra, in plane strain quadrilaterals, mm."""
        sizes = [len(axis) for axis in self.axes]
        points = np.stack(np.meshgrid(*self.axes, indexing="ij"), axis=-1).reshape(-1, self.dim)
        number = np.arange(len(points)).reshape(sizes)
        corners = [
            number[tuple(slice(c, n - 1 + c) for c, n in zip(reversed(at), sizes, strict=True))]
            for at in product((0, 1), repeat=self.dim)  # the first coordinate changes first
        ]
        cells = np.stack(corners, axis=-1).reshape(-1, 2**self.dim)
        return compat.cells_mesh(MPI.COMM_SELF, cells, points, CELLS[self.dim])

    @property
    def _tags(self) -> Any:
        """MeshTags of the cells, which all carry TAG."""
        cells = np.arange(np.prod([len(axis) - 1 for axis in self.axes]), dtype=np.int32)
        return meshtags(self.mesh, self.dim, cells, np.full_like(cells, TAG))

    @cached_property
    def _assembled(self) -> tuple[Any, PETSc.Mat]:
        """Displacement space and stiffness on all dofs. Matrices of earlier blocks are freed."""
        compat.collect(MPI.COMM_SELF)
        return assemble(self.mesh, self._tags, {TAG: self.material}, 2, self.kinematics)

    @cached_property
    def nodes(self) -> Array:
        """Coordinates (n, c) of the nodes of the displacement, mm."""
        return compat.dof_points(self._assembled[0].space)

    def at(self, axis: int, value: float) -> NDArray[np.bool_]:
        """Mask (n,) of the nodes on a plane: their coordinate number `axis` is `value`, mm."""
        scale = max(float(np.abs(each).max()) for each in self.axes)
        return np.asarray(np.abs(self.nodes[:, axis] - value) < NEAR * scale)

    @cached_property
    def outflow(self) -> NDArray[np.bool_]:
        """Mask (n,) of the nodes where the body leaves, at the least x."""
        return self.at(0, self.axes[0][0])

    @cached_property
    def surface(self) -> tuple[Array, Array, Index]:
        """x (nx,), y (ny,), ascending, mm, of the nodes of the displacement on the surface z = 0,
        and their numbers (nx, ny) in `nodes`; in plane strain y is a single zero.
        """
        numbers = np.flatnonzero(self.at(self.dim - 1, 0.0))
        at = self.nodes[numbers]
        y = self.kinematics.lift(at)[:, 1]
        order = np.lexsort((np.round(y, 9), np.round(at[:, 0], 9)))
        table = numbers[order].reshape(len(np.unique(np.round(at[:, 0], 9))), -1)
        return self.nodes[table[:, 0], 0], y[order][: table.shape[1]], table

    @cached_property
    def reduction(self) -> Reduction:
        """Map from free unknowns to dofs. The bottom is held. The faces normal to x, unless `tied`,
        and in a solid those normal to y, move in their planes.
        """
        unit = np.eye(self.dim)
        planes = [
            (self.at(axis, self.axes[axis][side]), unit[axis])
            for axis in range(int(self.tied), self.dim - 1)
            for side in (0, -1)
        ]
        fixed = self.at(self.dim - 1, self.axes[-1][0])
        supports = Held(fixed=fixed, planes=planes, dim=self.dim)
        return reduce(supports, MPI.COMM_SELF)

    @cached_property
    def points(self) -> YieldPoints:
        """Gauss points where plastic strain is followed."""

        def near(centroids: Array) -> NDArray[np.bool_]:
            """Whether plastic strain is followed in cells with these centroids (k, 3), mm."""
            below, beside = -centroids[:, 2] < self.depth, np.abs(centroids[:, 1]) < self.aside
            return np.asarray(below & beside)

        return bulk_points(
            self._assembled[0],
            self._tags,
            {TAG: self.material},
            near,
            self.reduction,
            MPI.COMM_SELF,
        )

    @cached_property
    def stiffness(self) -> PETSc.Mat:
        """Stiffness on all dofs, N/mm."""
        return self._assembled[1]

    @cached_property
    def _solver(self) -> tuple[PETSc.Mat, PETSc.PC]:
        """Map from unknowns to dofs, and the factorised stiffness of the unknowns."""
        if self.tied:
            map_, matrix = self._tied_stiffness()
        else:
            map_ = self.reduction.matrix
            matrix = Stiffness.reduced(self.stiffness.copy(), self.reduction).assembled()
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        factors = PETSc.PC().create(MPI.COMM_SELF)
        factors.setOperators(matrix)
        linear.factorise(factors, symmetric=True)
        return map_, factors

    def _tied_stiffness(self) -> tuple[PETSc.Mat, PETSc.Mat]:
        """Map from the unknowns of one plane to all dofs, and the stiffness of these unknowns."""
        first = np.flatnonzero(self.outflow)
        own = cKDTree(self.nodes[first, 1:]).query(self.nodes[:, 1:])[1]
        free = self.reduction.free.reshape(-1, self.dim)[first].ravel()
        number = np.cumsum(free) - 1
        dofs = (own[:, None] * self.dim + np.arange(self.dim)).ravel()
        rows = np.flatnonzero(free[dofs])
        entries = np.ones(len(rows)), (rows, number[dofs[rows]])
        table = sp.csr_matrix(entries, shape=(len(dofs), free.sum()))
        map_ = petsc_matrix(table, table.shape[1], MPI.COMM_SELF)
        full = self.stiffness.convert("aij", PETSc.Mat())
        return map_, full.ptap(map_)

    def solve(self, force: PETSc.Vec, prescribed: Array | None = None) -> Array:
        """Displacement on all dofs (n c,), mm, under forces on all dofs, N, and a prescribed u_x
        (k,) of the k nodes of the outflow, mm; None: zero.
        """
        map_, factors = self._solver
        start = self.stiffness.createVecRight()
        start.set(0.0)
        load = force.copy()
        if prescribed is not None:
            values = start.array.reshape(-1, self.dim)
            values[self.outflow, 0] = prescribed
            load.axpy(-1.0, self.stiffness * start)
        y = map_.createVecRight()
        factors.apply(transposed(map_, load.array), y)
        map_.multAdd(y, start, start)
        compat.collect(MPI.COMM_SELF)
        return np.array(start.array)

    def force(self) -> PETSc.Vec:
        """New vector of zero forces on all dofs."""
        out = self.stiffness.createVecLeft()
        out.set(0.0)
        return out

    def strains(self, displacement: Array) -> Array:
        """Strain (k, m) at the Gauss points of a displacement on all dofs (n c,), mm."""
        strain = (self.points.full_strain_matrix * vector(self.stiffness, displacement)).array
        return np.array(strain).reshape(len(self.points.weights), -1)

    def plastic_force(self, plastic: Array) -> PETSc.Vec:
        """Forces on all dofs of plastic strains (k, m) without trace at the Gauss points, N."""
        points = self.points
        stress = 2 * points.mu[:, None] * plastic * points.weights[:, None]
        return transposed(points.full_strain_matrix, stress)
