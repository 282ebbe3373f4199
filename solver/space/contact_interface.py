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

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.space import pieces
from railhead.solver.space.cells import quadrature_degree
from railhead.solver.space.facets import FacetSet, pair
from railhead.solver.space.operators import assemble_rows
from railhead.theory.array_types import Array, Index, Mask

SECTION_QUADRATURE = 15  # degree of the contact quadrature in a plane section, where points are
# cheap: it follows the edge of the patch, and the pressure's error falls tenfold
LAYER_FACTOR = 2.0  # of the trace bound in hexahedra and quadrilaterals. Where Poisson's ratio is
# small, a whole layer of them that is stretched attains the bound in each cell at no other cost.
# Tetrahedra at a facet share their corners with others that have no contact facet.
METHODS = ("nitsche", "penalty")
PENALTY_FACTOR = 10.0  # penalty over the Nitsche parameter: bias against conditioning
LARGEST_PARAMETER = 3.0  # over E times the trace constant; of nearly incompressible bodies
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
    """n quadrature points of this rank on the slave's contact surface, and matrices N (gap) and S
    (normal stress) on all dofs. c is the number of coordinates of the mesh.

    slave: contact facets of the slave on this rank.
    master: contact facets of the master on this rank; None where it is rigid.
    points: position (n, c), mm.
    weights: area of each point (n,) in the meshed part, mm2, see `FacetSet.quadrature`.
    initial_gap: exact initial gap g0 (n,) along the normals, mm.
    normals: (n, c) outward unit normals of the slave's exact surface.
    trace_bound: smallest stable parameter of Nitsche's method (n,), MPa/mm, of the cell of each
        point by itself, see the functions `trace_bound` and `stiffness_bound`.
    layered: whether the cells are hexahedra or quadrilaterals, which lie in layers.
    facet: number of the slave's facet that each point lies on (n,).
    xi: coordinates of each point in its reference facet (n, c - 1).
    gap: N, change of the gap per displacement: n . (u_master - u_slave).
    stress: S, normal stress n . sigma(u_slave) . n, MPa/mm.
    """

    slave: FacetSet
    master: FacetSet | None
    points: Array
    weights: Array
    initial_gap: Array
    normals: Array
    trace_bound: Array
    layered: bool
    facet: Index
    xi: Array
    gap: PETSc.Mat
    stress: PETSc.Mat

    @property
    def facing(self) -> Mask:
        """Whether the points cover a facet of the slave (m,), but for 1 % of its area."""
        (facet, _), weights = self.slave.quadrature(2 * self.slave.degree)
        whole = np.bincount(facet, weights, minlength=len(self.slave))
        return np.bincount(self.facet, self.weights, minlength=len(whole)) > 0.99 * whole

    def stiffness_bound(self, law: ContactLaw) -> Array:
        """Value (n,) that the parameter of a contact law is a multiple of, MPa/mm.

        For Nitsche's method it is the smallest stable parameter, in layered cells the trace bound
        times 2 (LAYER_FACTOR). For a penalty it is the trace bound: a penalty is stable at any
        parameter, and a larger one makes its pressure oscillate more.
        """
        return LAYER_FACTOR * self.trace_bound if self.layered and law.sigma else self.trace_bound


def build(
    slave: FacetSet,
    master: FacetSet | None,
    exact: Gap,
    local_dofs: int,
    comm: MPI.Intracomm,
    cut: bool = True,
) -> Interface:
    """Contact points of the slave, paired with the master, and the matrices of gap and normal
    stress (collective).

    slave: contact facets of the slave on this rank.
    master: contact facets of the master on this rank; None: a rigid counterface.
    exact: exact initial gap and the slave's outward normals.
    local_dofs: number of owned dofs of the displacement space on this rank.
    comm: communicator of the mesh.
    cut: whether the points lie on the pieces into which the facets of both surfaces cut each other;
        otherwise, and with a rigid counterface, on the slave's whole facets.
    Points whose normal misses the master surface, or where the gap is not finite, are left out;
    raises ValueError where none is left on any rank.
    """
    other = None if master is None else master.gathered(comm)
    cut = cut and other is not None
    order = quadrature_order(slave)
    (facet, xi), weights = (
        pieces.quadrature(slave, other, order) if cut and other else slave.quadrature(order)
    )
    points, _ = slave.tangents(facet, xi)
    initial_gap, normals = _exact(slave, exact, points)
    keep = np.isfinite(initial_gap)
    if other is not None:
        partner, eta = pair(points, normals, other)
        keep &= partner >= 0
    if not comm.allreduce(int(keep.sum())):
        raise ValueError("no contact point has a finite gap and a facet of the other body opposite")
    opposite = None if other is None else (other, partner[keep], eta[keep])
    chosen = (facet[keep], xi[keep]), weights[keep], points[keep], normals[keep]
    bound = trace_bound(slave, 2 * slave.degree, lambda *at: _exact(slave, exact, at[2])[1])
    return assembled(slave, master, chosen, initial_gap[keep], opposite, bound, local_dofs, comm)


def assembled(
    slave: FacetSet,
    master: FacetSet | None,
    chosen: tuple[tuple[Index, Array], Array, Array, Array],
    initial_gap: Array,
    opposite: tuple[FacetSet, Index, Array] | None,
    bound: Array,
    local_dofs: int,
    comm: MPI.Intracomm,
) -> Interface:
    """Contact interface at chosen points, with its matrices (collective).

    slave, master, local_dofs, comm: see `build`.
    chosen: (facet (n,) and coordinates xi (n, c - 1)), weights (n,), positions (n, c) and normals
        (n, c) of the points.
    initial_gap: along the normals (n,), mm.
    opposite: facets of the master of all ranks, and the facet (n,) and coordinates (n, c - 1) there
        that each point meets, -1 where that is rigid; None: all is rigid.
    bound: trace bound of each facet of the slave, see `trace_bound`.
    """
    (facet, xi), weights, points, normals = chosen
    reference = slave.reference(facet, xi)
    phi, _ = slave.basis(facet, reference)
    dim = slave.kinematics.dim
    dofs = dim * slave.dofs[facet][:, :, None] + np.arange(dim)
    blocks = [(dofs, -phi[:, :, None] * normals[:, None, :])]
    if opposite is not None:
        other, partner, eta = opposite
        met = (partner >= 0)[:, None]
        partner = np.maximum(partner, 0)
        values = met * other.basis(partner, other.reference(partner, eta))[0]
        partner_dofs = dim * other.dofs[partner][:, :, None] + np.arange(dim)
        blocks.append((partner_dofs, values[:, :, None] * normals[:, None, :]))

    traction = normal_stress(slave, facet, reference, normals)
    total = comm.allreduce(local_dofs)
    return Interface(
        slave=slave,
        master=master,
        points=points,
        weights=weights,
        initial_gap=initial_gap,
        normals=normals,
        trace_bound=bound[facet],
        layered=slave.cell in ("hexahedron", "quadrilateral"),
        facet=facet,
        xi=xi,
        gap=assemble_rows(blocks, len(facet), local_dofs, total, comm),
        stress=assemble_rows([(dofs, traction)], len(facet), local_dofs, total, comm),
    )


def quadrature_order(slave: FacetSet) -> int:
    """Degree of the contact quadrature on each piece or facet."""
    return SECTION_QUADRATURE if slave.kinematics.dim == 2 else 2 * slave.degree + 1


def _exact(slave: FacetSet, exact: Gap, points: Array) -> tuple[Array, Array]:
    """Exact gap (n,) in mm and unit normals (n, c) at points (n, c) of the slave, in the c
    coordinates of the mesh.
    """
    gap, normals = exact(slave.kinematics.lift(points))
    return gap, slave.kinematics.flatten(normals)


def trace_bound(
    slave: FacetSet, degree: int, normals_at: Callable[[Index, Array, Array], Array]
) -> Array:
    """Smallest stable parameter tau (m,) of Nitsche's method on each of m facets F of cells K,
    MPa/mm: the largest eigenvalue of

        int_F (n . sigma(v) . n)^2 = tau a_K(v, v)   over the shape functions v of K.

    a_K is the strain energy product of the cell. tau is the constant of the trace-inverse
    inequality, computed for the cell as it is, of any shape, order, curvature and material.
    Warburton and Hesthaven 2003 bound it by (k+1)(k+3)/3 A/V (lambda + 2 mu) on straight
    tetrahedra. The value is multiplied by the number of contact facets of the cell, which share its
    energy.

    degree: degree of the quadrature on the facets.
    normals_at: facet (n,), coordinates xi there (n, c - 1) and position (n, c) -> normals n (n, c).
    """
    count = len(slave)
    if not count:  # this rank holds no part of the contact surface
        return np.zeros(0)
    (facet, xi), weights = slave.quadrature(degree)
    points, _ = slave.tangents(facet, xi)
    normals = normals_at(facet, xi, points)
    reference = slave.reference(facet, xi)
    traction = normal_stress(slave, facet, reference, normals)
    size = slave.kinematics.dim * slave.dofs.shape[1]
    rows = traction.reshape(count, len(facet) // count, size)
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


def shear_stress(
    slave: FacetSet, facet: Index, reference: Array, normals: Array, tangents: Array
) -> Array:
    """Coefficients (n, k, d, c) of the shear stress t . sigma(u) . n along k tangents t per
    displacement of the d dofs of a cell, MPa/mm; tangents: (n, k, c), the rest as in
    `normal_stress`.
    """
    _, gradient = slave.basis(facet, reference)
    along = np.einsum("ndc,nkc->nkd", gradient, tangents)[..., None] * normals[:, None, None, :]
    across = np.einsum("ndc,nc->nd", gradient, normals)[:, None, :, None] * tangents[:, :, None, :]
    return np.asarray(slave.lame[facet, 1][:, None, None, None] * (along + across))


def normal_stress(slave: FacetSet, facet: Index, reference: Array, normals: Array) -> Array:
    """Coefficients (n, d, c) of the normal stress n . sigma(u) . n per displacement of the d dofs
    of a cell, MPa/mm.

    facet: facet of the slave at each of n points.
    reference: reference coordinates (n, c) of the points in the cells.
    normals: unit normals (n, c).
    """
    _, gradient = slave.basis(facet, reference)
    trace = slave.divergence(facet, reference)
    lam, mu = slave.lame[facet].T[..., None, None]
    along = np.einsum("ndc,nc->nd", gradient, normals)
    return np.asarray(lam * trace + 2 * mu * along[:, :, None] * normals[:, None, :])
