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
from railhead.solver.material.elasticity import quadrature_degree
from railhead.solver.space.cells import Array, Index
from railhead.solver.space.facets import FacetSet
from railhead.solver.space.operators import assemble_rows
from railhead.solver.space.pairing import pair

SECTION_RULE = 15  # degree of the contact quadrature in a section, where points cost nothing: it
# integrates across the master's element edges, and the error of the pressure falls tenfold
LAYERED = 2.0  # times the trace bound in hexahedra and quadrilaterals: where Poisson's ratio is
# small, a layer of them, stretched as one against what touches it, attains the bound in each cell
# and costs nothing. Tetrahedra around a facet share their corners with some that have none.
Gap = Callable[[Array], tuple[Array, Array]]
"""Exact surfaces: points in space (n, 3) on the slave -> (initial gap (n,), its normal (n, 3))."""


@dataclass(frozen=True)
class Interface:
    """n local quadrature points of the contact surface, and the two operators on all dofs.

    points (n, c) mm, weights (n,) mm2, initial_gap (n,) mm, normals (n, c), with c coordinates;
    trace_bound (n,): sharp bound of a cell's normal stress on the facet, MPa/mm; layered: whether
    cells lie in layers; facet (n,) and xi (n, c - 1): place on the slave facets; master: None where
    it is rigid.
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
        """(n,) what the law's parameter is a multiple of, MPa/mm: for Nitsche's method the smallest
        stable one. A penalty is stable at any, and twice as much makes its pressure waver more."""
        return LAYERED * self.trace_bound if self.layered and law.sigma else self.trace_bound


def build(
    slave: FacetSet,
    master: FacetSet | None,
    exact: Gap,
    local_dofs: int,
    comm: MPI.Intracomm,
    degree: int | None = None,
) -> Interface:
    """Pair the surfaces and build N and S; master None is a rigid counterface.

    local_dofs: owned dofs of the displacement space on this rank. Points whose normal misses the
    master surface cannot touch it and are left out.
    """
    flat = slave.kinematics.dim == 2
    order = degree or (SECTION_RULE if flat else 2 * slave.degree + 1)
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
        slave, master, points, weights, initial_gap, normals, bound,
        slave.cell in ("hexahedron", "quadrilateral"), facet, xi,
        assemble_rows(blocks, len(facet), local_dofs, total, comm),
        assemble_rows([(dofs, traction)], len(facet), local_dofs, total, comm),
    )  # fmt: skip


def _exact(slave: FacetSet, exact: Gap, points: Array) -> tuple[Array, Array]:
    """The exact gap and normal at points (n, c) of the mesh."""
    gap, normals = exact(slave.kinematics.lift(points))
    return gap, slave.kinematics.flatten(normals)


def trace_bound(slave: FacetSet, exact: Gap, degree: int) -> Array:
    """(m,) smallest stable tau of each facet F of cell K, MPa/mm: the largest eigenvalue of

        int_F (n . sigma(v) . n)^2 = tau a_K(v, v)   over the shape functions v of K.

    The trace-inverse constant (Warburton and Hesthaven 2003 bound it by
    (k+1)(k+3)/3 A/V (lambda + 2 mu) on straight tetrahedra) computed for the cell as it is: any
    shape, order, curvature and material. A cell with several contact facets shares its energy.
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
    """(m, cd, cd) stiffness of each cell, made regular on rigid motions (which carry no stress)."""
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
    """(n, d, c) coefficients of n . sigma(u) . n at reference points of the slave's cells."""
    _, gradient = slave.basis(facet, reference)
    trace = slave.divergence(facet, reference)
    lam, mu = slave.lame[facet].T[..., None, None]
    along = np.einsum("ndc,nc->nd", gradient, normals)
    return np.asarray(lam * trace + 2 * mu * along[:, :, None] * normals[:, None, :])
