"""The contact interface: gap and normal stress as constant sparse matrices.

At the contact quadrature points of the slave surface, with weights W and initial gap g0,

    gap    g(u) = g0 + N u,   N u = n . (u_master - u_slave)
    stress s(u) = S u,        S u = n . sigma(u_slave) . n

n is the outward normal of the slave's exact surface, g0 the exact distance along it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from railhead.solver.interface.laws import ContactLaw
from railhead.solver.space.cells import Array, Index, quadrature_degree
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.operators import assemble_rows
from railhead.solver.space.pairing import pair

SECTION_QUADRATURE = 15  # degree of the contact quadrature in a plane section, where points are
# cheap: it integrates across the master's element edges, and the pressure's error falls tenfold
LAYER_FACTOR = 2.0  # of the trace bound in hexahedra and quadrilaterals. Where Poisson's ratio is
# small, a whole layer of them that is stretched attains the bound in each cell at no other cost.
# Tetrahedra at a facet share their corners with others that have no contact facet.
Gap = Callable[[Array], tuple[Array, Array]]
"""Exact surfaces: points in space (n, 3) on the slave -> (initial gap (n,), its normal (n, 3))."""


@dataclass(frozen=True, kw_only=True)
class Interface:
    """n local quadrature points of the slave's contact surface, and the operators N and S on all
    dofs.

    slave: facets of the slave, of this rank.
    master: facets of the master, of this rank; None where it is rigid.
    points: (n, c) mm, in the c coordinates of the mesh.
    weights: area of each point (n,), mm2.
    initial_gap: g0 (n,), mm.
    normals: (n, c) outward unit normals of the slave's exact surface.
    trace_bound: see the function `trace_bound`, of the facet of each point (n,), MPa/mm.
    layered: whether the cells are hexahedra or quadrilaterals, which lie in layers.
    facet: facet of the slave that each point lies on (n,).
    xi: coordinates of each point in its facet (n, c - 1).
    gap: N.
    stress: S, MPa/mm.
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

    def stiffness_bound(self, law: ContactLaw) -> Array:
        """What the parameter of a law is a multiple of (n,), MPa/mm: for Nitsche's method the
        smallest stable one. A penalty is stable at any, and a larger one makes its pressure
        oscillate more."""
        return LAYER_FACTOR * self.trace_bound if self.layered and law.sigma else self.trace_bound


def build(
    slave: FacetSet,
    master: FacetSet | None,
    exact: Gap,
    local_dofs: int,
    comm: MPI.Intracomm,
) -> Interface:
    """Pair the surfaces and assemble N and S (collective).

    slave, master: facets of this rank; master None is a rigid counterface.
    exact: exact initial gap.
    local_dofs: number of owned dofs of the displacement space on this rank.
    Points whose normal misses the master surface cannot touch it and are left out.
    """
    flat = slave.kinematics.dim == 2
    order = SECTION_QUADRATURE if flat else 2 * slave.degree + 1
    (facet, xi), weights = slave.quadrature(order)
    points, _ = slave.tangents(facet, xi)
    initial_gap, normals = _exact(slave, exact, points)
    keep = np.isfinite(initial_gap)
    if master is not None:
        other = master.gathered(comm)
        partner, eta = pair(points, normals, other)
        keep &= partner >= 0
        partner, eta = partner[keep], eta[keep]
    facet, xi, weights = facet[keep], xi[keep], weights[keep]
    points, normals, initial_gap = points[keep], normals[keep], initial_gap[keep]

    reference = slave.reference(facet, xi)
    phi, _ = slave.basis(facet, reference)
    dim = slave.kinematics.dim
    dofs = dim * slave.dofs[facet][:, :, None] + np.arange(dim)
    blocks = [(dofs, -phi[:, :, None] * normals[:, None, :])]
    if master is not None:
        values, _ = other.basis(partner, other.reference(partner, eta))
        partner_dofs = dim * other.dofs[partner][:, :, None] + np.arange(dim)
        blocks.append((partner_dofs, values[:, :, None] * normals[:, None, :]))

    traction = normal_stress(slave, facet, reference, normals)
    bound = trace_bound(slave, exact, 2 * slave.degree)[facet]
    total = comm.allreduce(local_dofs)
    return Interface(
        slave=slave,
        master=master,
        points=points,
        weights=weights,
        initial_gap=initial_gap,
        normals=normals,
        trace_bound=bound,
        layered=slave.cell in ("hexahedron", "quadrilateral"),
        facet=facet,
        xi=xi,
        gap=assemble_rows(blocks, len(facet), local_dofs, total, comm),
        stress=assemble_rows([(dofs, traction)], len(facet), local_dofs, total, comm),
    )


def _exact(slave: FacetSet, exact: Gap, points: Array) -> tuple[Array, Array]:
    """Exact gap (n,) and normals (n, c) at points (n, c), in the coordinates of the mesh."""
    gap, normals = exact(slave.kinematics.lift(points))
    return gap, slave.kinematics.flatten(normals)


def trace_bound(slave: FacetSet, exact: Gap, degree: int) -> Array:
    """Smallest stable parameter tau (m,) of each facet F of its cell K, MPa/mm: the largest
    eigenvalue of

        int_F (n . sigma(v) . n)^2 = tau a_K(v, v)   over the shape functions v of K.

    This is the constant of the trace-inverse inequality, computed for the cell as it is, of any
    shape, order, curvature and material. Warburton and Hesthaven 2003 bound it by
    (k+1)(k+3)/3 A/V (lambda + 2 mu) on straight tetrahedra. A cell with several contact facets
    shares its energy among them. degree: of the quadrature on the facets.
    """
    count = len(slave)
    if not count:  # this rank holds no part of the contact surface
        return np.zeros(0)
    (facet, xi), weights = slave.quadrature(degree)
    points, _ = slave.tangents(facet, xi)
    _, normals = _exact(slave, exact, points)
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
    """Stiffness of each cell (m, cd, cd), with a stiffness added on rigid motions, which carry no
    stress, so that it is regular."""
    kinematics = slave.kinematics
    order = quadrature_degree(slave.cell, slave.degree, kinematics)
    gradients, traces, volumes = slave.cell_strains(order)
    lam, mu = slave.lame.T
    same = np.einsum("pm,pmie,pmje->mij", volumes * mu, gradients, gradients)
    energy = np.einsum("ij,mkl->mkilj", np.eye(kinematics.dim), same)
    dilatation = traces
    if kinematics.mean_dilatation:
        every = np.arange(len(slave))
        dilatation = np.broadcast_to(
            slave.divergence(every, np.zeros((len(slave), kinematics.dim))), traces.shape
        )
    energy += np.einsum("pm,pmki,pmlj->mkilj", volumes * lam, dilatation, dilatation)
    energy += np.einsum("pm,pmkj,pmli->mkilj", volumes * mu, gradients, gradients)
    if kinematics.revolved:
        hoop = traces - gradients
        energy += 2 * np.einsum("pm,pmki,pmlj->mkilj", volumes * mu, hoop, hoop)
    size = kinematics.dim * slave.dofs.shape[1]
    energy = energy.reshape(len(slave), size, size)
    x = slave.dof_points()
    x = x - x.mean(axis=1, keepdims=True)
    scale = np.abs(x).max(axis=(1, 2))[:, None, None]
    modes = kinematics.rigid_motions(x / scale)
    rigid = np.stack([mode.reshape(len(slave), size) for mode in modes], axis=1)
    weight = np.trace(energy, axis1=1, axis2=2) / size
    regular: Array = energy + weight[:, None, None] * rigid.transpose(0, 2, 1) @ rigid
    return regular


def normal_stress(slave: FacetSet, facet: Index, reference: Array, normals: Array) -> Array:
    """Coefficients (n, d, c) of n . sigma(u) . n at reference points of the slave's cells,
    MPa/mm."""
    _, gradient = slave.basis(facet, reference)
    trace = slave.divergence(facet, reference)
    lam, mu = slave.lame[facet].T[..., None, None]
    along = np.einsum("ndc,nc->nd", gradient, normals)
    return np.asarray(lam * trace + 2 * mu * along[:, :, None] * normals[:, None, :])
