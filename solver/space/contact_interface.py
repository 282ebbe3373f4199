"""The contact interface: gap and normal stress as constant sparse matrices, and contact laws.

At the contact quadrature points of the slave surface, with weights W and initial gap g0,

    gap    g(u) = g0 + N u,   N u = n . (u_master - u_slave)
    stress s(u) = S u,        S u = n . sigma(u_slave) . n

n is the outward normal of the slave's exact surface, g0 the exact distance along it. Penalty and
Nitsche's method are one family of contact laws:

    p    = < -(sigma s + tau g) >+             pressure; sigma = 1 for Nitsche, 0 for penalty
    R(u) = K u - f - (theta sigma S + tau N)^T (W/tau) p - (theta sigma/tau) S^T W s

Chouly and Hild 2013 (Nitsche, theta = 1 symmetric, 0, -1); penalty is sigma = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.space.cells import quadrature_degree
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.operators import assemble_rows
from railhead.theory.array_types import Array, Index, Mask

LAYER_FACTOR = 2.0  # of the trace bound in hexahedra and quadrilaterals. Where Poisson's ratio is
# small, a whole layer of them that is stretched attains the bound in each cell at no other cost.
# Tetrahedra at a facet share their corners with others that have no contact facet.
METHODS = ("nitsche", "penalty")
PENALTY_FACTOR = 10.0  # penalty over the Nitsche parameter: bias against conditioning
LARGEST_PARAMETER = 3.0  # over E times the trace constant; of nearly incompressible bodies
ALIKE = 1e-9  # of the largest coordinate, by which gaps of flat surfaces differ by rounding
NEAREST = 12  # points of a contact that the iterations start from
STAGE_GROWTH = 10.0  # of the parameter from one stage of a stiff law to the next
Gap = Callable[[Array], tuple[Array, Array]]
"""Exact surfaces: points in space (n, 3) on the slave -> (initial gap (n,) in mm along the normal,
not finite where that misses the master, and outward unit normal of the slave (n, 3) in space)."""


@dataclass(frozen=True)
class ContactLaw:
    """Contact law: method and parameters.

    method: 'nitsche' or 'penalty'.
    theta: variant of Nitsche's method: 1 (symmetric), 0 or -1; None: `suited` chooses. For a
        penalty it only decides whether `suited` limits the parameter: not with 1.
    gamma_factor: parameter over the smallest stable one or, for a penalty, over ten times
        (PENALTY_FACTOR) the trace bound; positive.
    Raises ValueError for other values.
    """

    method: str = "nitsche"
    theta: int | None = None
    gamma_factor: float = 1.0

    def __post_init__(self) -> None:
        """Check method, theta and gamma_factor; raises ValueError for a value that is not
        allowed.
        """
        if self.method not in METHODS:
            raise ValueError(f"method {self.method!r} is unknown; give one of {METHODS}")
        if self.theta not in (None, 1, 0, -1):
            raise ValueError(f"theta {self.theta!r} is not allowed; give 1, 0, -1 or None")
        if not 0 < self.gamma_factor < math.inf:
            raise ValueError(f"gamma_factor {self.gamma_factor!r} is not allowed; give more than 0")

    @property
    def sigma(self) -> int:
        """Factor of the bulk stress in the contact law: 1 for Nitsche's method, 0 for a penalty."""
        return int(self.method == "nitsche")

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric: for a penalty, and for Nitsche's method with theta = 1,
        not with None.
        """
        return self.method == "penalty" or self.theta == 1

    @property
    def scale(self) -> float:
        """Parameter tau of the law over the stiffness bound of a facet
        (`Interface.stiffness_bound`).
        """
        return self.gamma_factor * (1.0 if self.sigma else PENALTY_FACTOR)

    def suited(self, young_modulus: float, lame: tuple[float, float]) -> ContactLaw:
        """The law with theta and factor chosen for the material of the slave.

        young_modulus: MPa.
        lame: Lame's constants (lambda, mu), MPa.

        theta = 1 is coercive down to factor 1, theta = -1 at any factor. So theta = -1 is chosen
        for factors below 1 where theta is None. Towards incompressibility the safe parameter grows
        with lambda, although the contact gets no stiffer. The parameter, also of a penalty, is then
        limited by the factor 3 E/(lambda + 2 mu) (LARGEST_PARAMETER), unless theta = 1 is given.
        """
        lam, mu = lame
        factor = self.gamma_factor
        if self.theta != 1:
            factor *= min(1.0, LARGEST_PARAMETER * young_modulus / (lam + 2 * mu))
        theta = self.theta if self.theta is not None else (1 if factor >= 1 else -1)
        return replace(self, theta=theta, gamma_factor=factor)

    @property
    def stages(self) -> list[ContactLaw]:
        """Laws to solve with one after the other, from a parameter near the default up to this law,
        which is the last; from one to the next the parameter grows by a factor 10 (STAGE_GROWTH).
        """
        count = max(0, math.ceil(math.log(self.scale / STAGE_GROWTH, STAGE_GROWTH)))
        return [
            replace(self, gamma_factor=self.gamma_factor / STAGE_GROWTH**k)
            for k in range(count, -1, -1)
        ]


@dataclass(frozen=True, kw_only=True)
class Interface:
    """n quadrature points of this rank on the slaves' contact surfaces, with k tangents each, and
    matrices on all dofs. c is the number of coordinates of the mesh. Matrices are made at their
    first use (collective).

    slave: contact facets of the slaves on this rank.
    master: contact facets of the masters, of all ranks; None where all of them are rigid.
    facet: number of the slave's facet that each point lies on (n,).
    xi: coordinates of each point in its reference facet (n, c - 1).
    partner: number of the master's facet opposite each point (n,); -1: a rigid surface.
    eta: coordinates of the point opposite in that facet (n, c - 1).
    points: position (n, c), mm.
    weights: area of each point (n,) in the meshed part, mm2, see `FacetSet.quadrature`.
    initial_gap: initial gap g0 (n,) along the normals, mm.
    normals: (n, c) unit normals of the contact, out of the slave. outward: of the slave's surface.
    tangents: unit tangents to the contact there (n, k, c), k = c - 1.
    contact: number of the contact that each point belongs to (n,).
    missed: share of the slave's surface of each contact that has nothing opposite.
    trace_bound: smallest stable parameter of Nitsche's method (n,), MPa/mm, of the cell of each
        point by itself, see the functions `trace_bound` and `stiffness_bound`.
    local_dofs: number of dofs that this rank owns. comm: communicator of the mesh.
    """

    slave: FacetSet
    master: FacetSet | None
    facet: Index
    xi: Array
    partner: Index
    eta: Array
    points: Array
    weights: Array
    initial_gap: Array
    normals: Array
    outward: Array
    tangents: Array
    contact: Index
    missed: list[float]
    trace_bound: Array
    local_dofs: int
    comm: MPI.Intracomm

    @property
    def facing(self) -> Mask:
        """Whether the points cover a facet of the slave (m,), but for 1 % of its area."""
        (facet, _), weights = self.slave.quadrature(2 * self.slave.degree)
        whole = np.bincount(facet, weights, minlength=len(self.slave))
        return np.bincount(self.facet, self.weights, minlength=len(whole)) > 0.99 * whole

    def nearest(
        self, closing: Array, touching: Callable[[int, Array, Array], int] = lambda *_: NEAREST
    ) -> Mask:
        """Mask (n,) of this rank's points among those of each contact, of all ranks, whose gaps
        close first, at least twelve (NEAREST) of each (collective).

        closing: by how much each gap closes under a motion (n,); a contact in which none does takes
            the smallest gaps.
        touching: number of a contact, gaps of its points (m,) in rising order, over what closes
            them, and their areas (m,) -> how many of them are taken.
        """
        out = np.zeros(len(self.contact), dtype=bool)
        alike = ALIKE * self.comm.allreduce(np.abs(self.points).max(initial=0.0), op=MPI.MAX)
        for number in range(len(self.missed)):
            own = np.flatnonzero(self.contact == number)
            gaps, rate = self.initial_gap[own], closing[own]
            if self.comm.allreduce(int((rate > 0).sum())):
                gaps = np.where(rate > 0, gaps / np.where(rate > 0, rate, 1.0), np.inf)
            every, area = (
                np.concatenate(self.comm.allgather(each)) for each in (gaps, self.weights[own])
            )
            order = np.argsort(every)[: np.isfinite(every).sum()]
            if not len(order):
                continue
            count = max(NEAREST, touching(number, every[order], area[order]))
            out[own] = gaps <= every[order][min(count, len(order)) - 1] + alike
        return out

    def stiffness_bound(self, law: ContactLaw) -> Array:
        """Value (n,) that the parameter of a contact law is a multiple of, MPa/mm.

        For Nitsche's method it is the smallest stable parameter, in layered cells (hexahedra and
        quadrilaterals) the trace bound times 2 (LAYER_FACTOR). For a penalty it is the trace bound:
        a penalty is stable at any parameter, and a larger one makes its pressure oscillate more.
        """
        layered = self.slave.cell in ("hexahedron", "quadrilateral")
        return LAYER_FACTOR * self.trace_bound if layered and law.sigma else self.trace_bound

    @cached_property
    def gap(self) -> PETSc.Mat:
        """N, change of the gap per displacement: n . (u_master - u_slave)."""
        return self._jump(-self.normals[:, None])

    @cached_property
    def stress(self) -> PETSc.Mat:
        """S, normal stress n . sigma(u_slave) . n, MPa/mm."""
        return self._stress(self.normals[:, None])

    @cached_property
    def slip(self) -> PETSc.Mat:
        """Slip t . (u_slave - u_master) along the tangents t per displacement, n k rows."""
        return self._jump(self.tangents)

    @cached_property
    def shear(self) -> PETSc.Mat:
        """Shear stress t . sigma(u_slave) . n along the tangents t, n k rows, MPa/mm."""
        return self._stress(self.tangents)

    def pull(self, directions: Array) -> Array:
        """Stress e . sigma n (n, k) along directions e (n, k, c) where the matrices start from."""
        return np.zeros(directions.shape[:2])

    def _stress(self, directions: Array) -> PETSc.Mat:
        """Stress e . sigma(u_slave) . n along directions e (n, k, c), n k rows (collective)."""
        at = self.facet, self.slave.reference(self.facet, self.xi)
        values = traction(self.slave, *at, directions, self.outward)
        return self.matrix([self.slave.rows(self.facet, values)])

    def restricted(self, points: Index, tangents: Array) -> Interface:
        """The interface of points with these numbers (m,), with other tangents (m, k, c)."""
        names = (
            "facet xi partner eta points weights initial_gap normals outward contact trace_bound"
        )
        own: dict[str, Any] = {name: getattr(self, name)[points] for name in names.split()}
        return replace(self, **own, tangents=tangents)

    def _jump(self, directions: Array) -> PETSc.Mat:
        """Displacement of the slave less that of the master along directions (n, k, c), n k rows
        (collective).
        """
        blocks = [self.slave.rows_at(self.facet, self.xi, directions)]
        if self.master is not None:
            met = (self.partner >= 0)[:, None, None]
            partner = np.maximum(self.partner, 0)
            blocks.append(self.master.rows_at(partner, self.eta, -directions * met))
        return self.matrix(blocks)

    def matrix(self, blocks: list[tuple[Index, Array]]) -> PETSc.Mat:
        """Matrix on all dofs from blocks of rows, see `assemble_rows` (collective)."""
        total = self.comm.allreduce(self.local_dofs)
        return assemble_rows(blocks, len(blocks[0][0]), self.local_dofs, total, self.comm)


def tangents_of(normals: Array) -> Array:
    """Orthonormal tangents (n, c - 1, c) at unit normals (n, c)."""
    if normals.shape[1] == 2:
        return np.stack([normals[:, 1], -normals[:, 0]], axis=1)[:, None]
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(normals, least)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(normals, first)], axis=1)


def trace_bound(slave: FacetSet, at: tuple[Index, Array], weights: Array, normals: Array) -> Array:
    """Smallest stable parameter tau (m,) of Nitsche's method on each of m facets F of cells K,
    MPa/mm: the largest eigenvalue of

        int_F (n . sigma(v) . n)^2 = tau a_K(v, v)   over the shape functions v of K.

    a_K is the strain energy product of the cell. tau is the constant of the trace-inverse
    inequality, computed for the cell as it is, of any shape, order, curvature and material.
    Warburton and Hesthaven 2003 bound it by (k+1)(k+3)/3 A/V (lambda + 2 mu) on straight
    tetrahedra. The value is multiplied by the number of contact facets of the cell, which share its
    energy.

    at, weights: quadrature points of the facets, see `FacetSet.quadrature`.
    normals: n there (n, c).
    """
    count = len(slave)
    if not count:  # this rank holds no part of the contact surface
        return np.zeros(0)
    stress = traction(slave, at[0], slave.reference(*at), normals[:, None], normals)
    size = slave.kinematics.dim * slave.dofs.shape[1]
    rows = stress.reshape(count, len(weights) // count, size)
    rows = rows * np.sqrt(weights).reshape(*rows.shape[:2], 1)
    energy = _cell_stiffness(slave)
    solved = np.linalg.solve(energy, rows.transpose(0, 2, 1))
    bound: Array = np.linalg.eigvalsh(rows @ solved)[:, -1]
    _, cell, shared = np.unique(slave.dofs, axis=0, return_inverse=True, return_counts=True)
    return bound * shared[cell]


def _cell_stiffness(slave: FacetSet) -> Array:
    """Stiffness matrix (m, c d, c d) of each of m cells with d dofs of c components, N/mm. A
    stiffness is added on rigid motions, which carry no stress, so that the matrix is regular.
    """
    kinematics, size = slave.kinematics, slave.kinematics.dim * slave.dofs.shape[1]
    order = quadrature_degree(slave.cell, slave.degree, kinematics)
    point, _, weights = slave.quadrature_points(order)
    lam, mu = slave.lame[point[0]].T
    strains = slave.strains(*point).reshape(len(weights), -1, size)
    traces = slave.divergence(*point).reshape(len(weights), 1, size)
    rows = np.sqrt(np.stack([2 * mu * weights, lam * weights]))[:, :, None, None]
    rows = np.concatenate([rows[0] * strains, rows[1] * traces], axis=1)
    rows = rows.reshape(len(slave), -1, size)
    energy = rows.transpose(0, 2, 1) @ rows
    x = slave.dof_points()
    x = x - x.mean(axis=1, keepdims=True)
    scale = np.abs(x).max(axis=(1, 2))[:, None, None]
    modes = kinematics.rigid_motions(x / scale)
    rigid = np.stack([mode.reshape(len(slave), size) for mode in modes], axis=1)
    weight = np.trace(energy, axis1=1, axis2=2) / size
    regular: Array = energy + weight[:, None, None] * rigid.transpose(0, 2, 1) @ rigid
    return regular


def traction(
    slave: FacetSet, facet: Index, reference: Array, directions: Array, normals: Array
) -> Array:
    """Coefficients (n, k, d, c) of the stresses e . sigma(u) . n along k directions e per
    displacement of the d dofs of a cell, MPa/mm.

    facet: facet of the slave at each of n points.
    reference: reference coordinates (n, c) of the points in the cells.
    directions: e (n, k, c). normals: unit normals n (n, c).
    """
    _, gradient = slave.basis(facet, reference)
    trace = slave.divergence(facet, reference)[:, None]
    lam, mu = slave.lame[facet].T[..., None, None, None]
    facing = np.einsum("nkc,nc->nk", directions, normals)[..., None, None]
    along = np.einsum("ndc,nkc->nkd", gradient, directions)[..., None] * normals[:, None, None]
    across = np.einsum("ndc,nc->nd", gradient, normals)[:, None, :, None] * directions[:, :, None]
    return np.asarray(lam * facing * trace + mu * (along + across))
