"""Bodies with an energy psi(u) per volume before deformation, and contact of the deformed bodies.

    R(u) = d/du int psi dX,   sigma = P F^T / J,   P = d psi / d grad u,   F = I + grad u

The contact points lie on the deformed surfaces, and sigma, the Cauchy stress, takes the place of
the linear law's stress in Nitsche's method. From a state u0 it is taken as linear:

    sigma(u) = sigma(u0) + d sigma / d grad u : grad (u - u0)
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import basix
import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering
from ufl.algorithms.apply_derivatives import apply_derivatives
from ufl.corealg.map_dag import map_expr_dag
from ufl.corealg.multifunction import MultiFunction

from railhead.solver import compat
from railhead.solver.algebra.reduced_stiffness import DIFFERENT
from railhead.solver.model.problem import FrictionalProblem
from railhead.solver.space.cells import tabulate
from railhead.solver.space.contact_interface import Interface
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.operators import blockwise
from railhead.solver.system.surfaces import compliance
from railhead.theory.array_types import Array, Index, Mask

SOFTEST = 1e-9  # stiffness of a strain, over the largest one, below which there is none


@dataclass(frozen=True, kw_only=True)
class Deformed(Interface):
    """Contact points on deformed surfaces, with the Cauchy stress of the secondary body.

    cauchy: (n, c, c) where the bodies are. slope: its derivative (n, c, c, c, c + 1) by
        grad u and, last, by u or u/r.
    moved, opposite: secondary and primary facets where they are; None: all of these are rigid.
    curvature: change of the normal over the way along a rigid primary surface (n, c, c), else zero.
    points: before deformation. All else is that of the deformed surfaces.
    """

    cauchy: Array
    slope: Array
    moved: FacetSet
    opposite: FacetSet | None
    curvature: Array

    def pull(self, directions: Array) -> Array:
        """Stress e . sigma n (n, k) now along directions e (n, k, c)."""
        return np.asarray(np.einsum("nki,nij,nj->nk", directions, self.cauchy, self.outward))

    def _stress(self, directions: Array) -> PETSc.Mat:
        """Change of e . sigma n along directions e (n, k, c), n k rows (collective)."""
        reference = self.slave.reference(self.facet, self.xi)
        value, gradient = self.slave.basis(self.facet, reference)
        if self.slave.kinematics.revolved:
            value = value / self.points[:, :1]
        both = np.concatenate([gradient, value[..., None]], axis=2)
        change = np.einsum("nki,nj,nijcl->nkcl", directions, self.outward, self.slope)
        values = np.einsum("nkcl,ndl->nkdc", change, both)
        return self.matrix([self.slave.rows(self.facet, values)])

    def turning(self, pressure: Array, traction: Array) -> PETSc.Mat:
        """Change (n c rows) of the forces at the points per displacement, by that of areas and
        directions: W (tr h - n . h n) and, where a deformed body is opposite, n - h^T n, with the
        gradient h of the change along the surface, of both surfaces as they share n (collective).

        pressure, traction: along the tangents, (n,) and (n, k), which stay.
        """
        force = self._force(pressure, traction)
        value, along = self._along(self.moved, self.facet, self.xi)
        now = self.moved.tangents(self.facet, self.xi)[0]
        wider = self.slave.kinematics.divergence(value, along, now[:, None])
        change = np.einsum("ni,ndc->nidc", force, wider)
        if self.opposite is None:
            return self.matrix([self.slave.rows(self.facet, change)])
        partner, met = np.maximum(self.partner, 0), self.partner >= 0
        own = compliance(self.slave.lame[self.facet])
        other = compliance(self.opposite.lame[partner])
        _, across = self._along(self.opposite, partner, self.eta)
        rubs = force + (pressure * self.weights)[:, None] * self.normals
        turned = []
        for h, share in ((along, other), (across, own)):
            turns = (pressure * self.weights)[:, None, None] * h.transpose(0, 2, 1)
            turns += np.einsum("ni,ndj,nj->nid", self.normals, h, rubs)
            turns *= (met[:, None] * share / (own + other))[..., None]
            turned.append(np.einsum("nid,nc->nidc", turns, self.normals))
        blocks = self.slave.rows(self.facet, change + turned[0])
        return self.matrix([blocks, self.opposite.rows(partner, turned[1])])

    def sliding(self, pressure: Array, traction: Array) -> PETSc.Mat | None:
        """Forces at the points times the gradient of the primary displacement along its surface
        (n c rows), as they meet other points of it when surfaces slide; None where all of it is
        rigid (collective). Arguments as of `turning`.
        """
        if self.opposite is None:
            return None
        partner = np.maximum(self.partner, 0)
        _, along = self._along(self.opposite, partner, self.eta)
        force = self._force(pressure, traction) * (self.partner >= 0)[:, None]
        return self.matrix([self.opposite.rows(partner, np.einsum("ndi,nc->nidc", along, force))])

    def rolling(self, pressure: Array, traction: Array) -> Array:
        """Change (n, c, c) of the force at each point per jump there, as the normal n of a rigid
        surface turns by its curvature H: W (p H + n t . H), with the tangential traction t.
        Arguments as of `turning`.
        """
        rubs = np.einsum("nk,nkc,ncd->nd", traction, self.tangents, self.curvature)
        turns = pressure[:, None, None] * self.curvature + self.normals[:, :, None] * rubs[:, None]
        return np.asarray(turns * self.weights[:, None, None])

    def _force(self, pressure: Array, traction: Array) -> Array:
        """Force of each point on the secondary body (n, c)."""
        along = np.einsum("nk,nkc->nc", traction, self.tangents)
        return np.asarray((along - pressure[:, None] * self.normals) * self.weights[:, None])

    def _along(self, face: FacetSet, facet: Index, xi: Array) -> tuple[Array, Array]:
        """Shape functions (n, d) at points of a surface, and their gradients along it (n, d, c)."""
        value, g = face.basis(facet, face.reference(facet, xi))
        n = self.normals
        return value, g - np.einsum("ndc,nc,ni->ndi", g, n, n)

    @property
    def jump(self) -> PETSc.Mat:
        """Displacement of the secondary surface less the other's, n c rows (collective)."""
        return self._jump(np.tile(np.eye(self.points.shape[1]), (len(self.points), 1, 1)))


@dataclass(kw_only=True)
class DeformedProblem(FrictionalProblem):
    """Contact problem of deformed bodies, linear around one state. exact: whether it is solved at
    that state, with the change of areas and directions in its tangent.

    points: contact points there. map: P from free unknowns to dofs. jump: displacement of the
        secondary surface less the other's, n c rows, per free unknown. outer: norm of the applied
        force; the field `force` is what the linear equations take.
    """

    points: Deformed
    map: PETSc.Mat
    jump: PETSc.Mat
    outer: float
    exact: bool = False
    _turning: PETSc.Mat | None = None

    @property
    def applied(self) -> float:
        """Norm of the applied force."""
        return self.outer

    def residual(self, y: PETSc.Vec, pressure: Array) -> PETSc.Vec:
        """Residual of equilibrium in the free unknowns, see `FrictionalProblem.residual`."""
        r = super().residual(y, pressure)
        if not self.exact:
            return r
        forces = pressure, self.traction
        turning = self.points.turning(*forces).matMult(self.map)
        turns = blockwise(self.points.rolling(*forces), self.jump)
        turning.axpy(1.0, turns, DIFFERENT)
        self._turning = self.jump.transposeMatMult(turning)
        if sliding := self.points.sliding(*forces):
            back = sliding.matMult(self.map).transposeMatMult(self.jump)
            self._turning.axpy(-1.0, back, DIFFERENT)
        return r

    def apply_tangent(
        self, active: Mask, rows: tuple[PETSc.Mat, PETSc.Mat], x: PETSc.Vec, out: PETSc.Vec
    ) -> None:
        """As `FrictionalProblem.apply_tangent`, with the change of areas and directions."""
        super().apply_tangent(active, rows, x, out)
        if self._turning:
            out.axpy(-1.0, self._turning * x)

    def assembled_tangent(self, active: Mask) -> PETSc.Mat:
        """As `FrictionalProblem.assembled_tangent`, with the change of areas and directions."""
        out = super().assembled_tangent(active)
        if self._turning:
            out.axpy(-1.0, self._turning, DIFFERENT)
        return out


class _Pointwise(MultiFunction):
    """Puts variables in place of a Function u and of its gradient."""

    expr = MultiFunction.reuse_if_untouched

    def __init__(self, u: Any) -> None:
        super().__init__()
        self.u, self.value, self.gradient = u, ufl.variable(u), ufl.variable(ufl.grad(u))

    def grad(self, o: Any) -> Any:
        """The variable for grad u; any other gradient as it is."""
        return self.gradient if o.ufl_operands[0] == self.u else o

    def coefficient(self, o: Any) -> Any:
        """The variable for u; any other Function as it is."""
        return self.value if o == self.u else o


class Energies:
    """Energies of all bodies of a mesh.

    u: displacement, a dolfinx Function, of which they are expressions. psi: of each body's tag.
    """

    def __init__(self, u: Any, degree: int, cell_tags: Any, revolved: bool, psi: Mapping[int, Any]):
        """degree: of the displacement. revolved: whether coordinates are (r, z)."""
        space, mesh = u.function_space, u.function_space.mesh
        self.u, self.degree, self.mesh = u, degree, mesh
        self.cell, dim = compat.cell_type(mesh), mesh.geometry.dim
        rule = {"quadrature_degree": 2 * degree + 2 * revolved}
        r = ufl.SpatialCoordinate(mesh)[0]
        dx = ufl.Measure("dx", domain=mesh, subdomain_data=cell_tags, metadata=rule)
        far = r if revolved else 1
        around = 2 * np.pi * r if revolved else 1
        total = sum(around * each * dx(tag) for tag, each in psi.items())
        force = ufl.derivative(total, u, ufl.TestFunction(space))
        tangent = ufl.derivative(force, u, ufl.TrialFunction(space))
        self._force, self._tangent = compat.form(force, mesh), compat.form(tangent, mesh)
        kind = getattr(basix.CellType, self.cell)
        self.reference = basix.make_quadrature(kind, 2 * degree)[0]
        self._stress = []
        for tag, each in psi.items():
            at = _Pointwise(u)
            energy = map_expr_dag(at, apply_derivatives(apply_algebra_lowering(each)))
            f, hoop = ufl.Identity(dim) + at.gradient, 1 + at.value[0] / r if revolved else 1
            sigma = ufl.diff(energy, at.gradient) * f.T / (ufl.det(f) * hoop)
            every = sigma, ufl.diff(sigma, at.gradient), far * ufl.diff(sigma, at.value)
            flat = [e[i] for e in every for i in np.ndindex(*e.ufl_shape)]
            made = compat.expression(ufl.as_vector(flat), self.reference, mesh)
            self._stress.append((cell_tags.find(tag), made))

    def put(self, displacement: PETSc.Vec) -> None:
        """Give u the values of all dofs (collective)."""
        self.u.x.array[: displacement.getLocalSize()] = displacement.array
        self.u.x.scatter_forward()

    def linear(self, displacement: PETSc.Vec) -> tuple[PETSc.Mat, PETSc.Vec]:
        """Tangent and internal forces on all dofs at a displacement (collective)."""
        self.put(displacement)
        tangent = fem.petsc.create_matrix(self._tangent, "baij")
        fem.petsc.assemble_matrix(tangent, self._tangent)
        tangent.assemble()
        tangent.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        found, out = fem.petsc.assemble_vector(self._force), displacement.duplicate()
        found.ghostUpdate(PETSc.InsertMode.ADD, PETSc.ScatterMode.REVERSE)
        out.array[:] = found.array[: len(out.array)]
        return tangent, out

    def stress(self, cells: Index) -> tuple[Array, Array]:
        """Cauchy stress (m, g, c, c) of u in local cells (m,) at `reference`, and its derivative by
        grad u and, last, by u, in axisymmetric sections by u/r (m, g, c, c, c, c + 1).
        """
        dim, count = self.mesh.geometry.dim, len(self.reference)
        out = np.zeros((len(cells), count, dim**2 + dim**4 + dim**3))
        for members, made in self._stress:
            own = np.flatnonzero(np.isin(cells, members))
            if len(own):
                found = compat.evaluated(made, self.mesh, cells[own])
                out[own] = found.reshape(len(own), count, -1)
        shape = len(cells), count, dim, dim
        sigma, *slopes = np.split(out, [dim**2, dim**2 + dim**4], axis=2)
        slopes = [each.reshape(*shape, dim, -1) for each in slopes]
        return sigma.reshape(shape), np.concatenate(slopes, axis=-1)

    def moduli(self, cells: Index) -> tuple[Array, Array]:
        """Young's modulus and Poisson's ratio (m,) at rest in local cells (m,), of the isotropic
        law that is nearest to the derivative of the stress. Raises ValueError where there is none.
        """
        self.u.x.array[:] = 0.0
        slope = self.stress(cells)[1][..., :-1].mean(axis=1)
        d = slope.shape[1]
        traces, whole = np.einsum("miijj->m", slope), np.einsum("mijij->m", slope)
        mu = (d * whole - traces) / (d * (d - 1) * (d + 2))
        lam = (traces - 2 * d * mu) / d**2
        even = slope + slope.swapaxes(1, 2)
        even = (even + even.swapaxes(3, 4)).reshape(-1, d * d, d * d)
        stiff = np.linalg.eigvalsh(even + even.swapaxes(1, 2))  # 0 for each of the rotations
        if not np.all(stiff[:, d * (d - 1) // 2] > SOFTEST * stiff[:, -1]):
            raise ValueError("psi has no stiffness at rest against some strain")
        return mu * (3 * lam + 2 * mu) / (lam + mu), lam / (2 * (lam + mu))

    def deformed(
        self, face: Interface, displacement: PETSc.Vec, every: Array, curvature: Array
    ) -> Deformed:
        """Contact points with the stress at a displacement of all dofs, by the polynomial in each
        cell that is nearest to the stress at `reference` (collective). every: the displacement
        (dofs, c) of all ranks. curvature: see `Deformed`.
        """
        self.put(displacement)
        used, of = np.unique(face.facet, return_inverse=True)
        fit = np.linalg.pinv(tabulate(self.cell, self.degree, self.reference)[0])
        points = face.slave.reference(face.facet, face.xi)
        basis = tabulate(self.cell, self.degree, points, derivatives=0)[0] @ fit
        cauchy, slope = (
            np.einsum("ng,ng...->n...", basis, values[of])
            for values in self.stress(face.slave.numbers[used])
        )
        own: dict[str, Any] = {each.name: getattr(face, each.name) for each in fields(Interface)}
        moved, opposite = face.slave.moved(every), face.master and face.master.moved(every)
        own |= {"cauchy": cauchy, "slope": slope, "curvature": curvature}
        return Deformed(**own, moved=moved, opposite=opposite)
