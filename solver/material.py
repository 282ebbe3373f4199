"""Isotropic solids in small strain: elastic constants and the stiffness matrix, flow curves and
von Mises plasticity at points.

Stress and strain at points are vectors in Mandel's notation (n, m): the normal components 11, 22,
33 first, shears times sqrt(2) after them, so that a : b is a sum of products. The stress is
s = C (eps - eps_p), the yield function |dev s - alpha| - sqrt(2/3) kappa(q), with the equivalent
plastic strain q, and backward Euler over a load step (Simo and Hughes, Computational Inelasticity,
1998, boxes 3.1 and 3.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import dolfinx.fem.petsc  # noqa: F401
import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.space.cells import Bulk, quadrature_degree
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.space.operators import weighted_product
from railhead.theory.array_types import Array, Index

ROOT = np.sqrt(2.0 / 3.0)


@dataclass(frozen=True)
class Hardening:
    """Curve of uniaxial true stress over plastic strain, linear between its k points.

    strain: plastic strain of the points (k,), ascending, the first 0.
    stress: stress of the points (k,), MPa; the first is the initial yield stress.
    kinematic: share of the hardening, 0 to 1, by which the yield surface moves instead of growing
        (Prager's rule).
    final_hardening_modulus: slope d stress / d plastic strain after the last point, MPa.
    """

    strain: tuple[float, ...]
    stress: tuple[float, ...]
    kinematic: float = 0.0
    final_hardening_modulus: float = 0.0

    @classmethod
    def linear(cls, stress: float, modulus: float = 0.0, kinematic: float = 0.0) -> Hardening:
        """Curve with the initial yield stress `stress` (MPa) and the constant slope `modulus`, d
        stress / d plastic strain (MPa); kinematic: share of the hardening by which the yield
        surface moves.
        """
        return cls((0.0,), (stress,), kinematic, modulus)

    @property
    def initial_yield_stress(self) -> float:
        """Stress at which plastic strain begins, MPa."""
        return self.stress[0]

    @cached_property
    def segments(self) -> tuple[Array, Array, Array]:
        """Plastic strain and stress (MPa) of the points (k,), and the slope after each, MPa."""
        strain, stress = np.array(self.strain), np.array(self.stress)
        slopes = np.append(np.diff(stress) / np.diff(strain), self.final_hardening_modulus)
        return strain, stress, slopes

    def stress_and_slope(self, plastic: Array) -> tuple[Array, Array]:
        """Stress of the curve and its slope (n,), MPa, at equivalent plastic strains (n,)."""
        strain, stress, slopes = self.segments
        segment = np.searchsorted(strain, plastic, side="right") - 1
        return stress[segment] + slopes[segment] * (plastic - strain[segment]), slopes[segment]


@dataclass(frozen=True)
class History:
    """Plastic state of n points after a load step, with m components in Mandel's notation.

    plastic: plastic strain (n, m).
    back: back stress (n, m), MPa, by which the yield surface has moved.
    equivalent: equivalent plastic strain (n,).
    """

    plastic: Array
    back: Array
    equivalent: Array

    @classmethod
    def virgin(cls, count: int, size: int) -> History:
        """State of `count` points without plastic strain or back stress; size: number m of
        components.
        """
        return cls(np.zeros((count, size)), np.zeros((count, size)), np.zeros(count))

    def at(self, points: Index) -> History:
        """State of the points with the given numbers (k,), a copy."""
        return History(self.plastic[points], self.back[points], self.equivalent[points])

    def extrapolated(self, earlier: History, factor: float, points: Index) -> History:
        """This state, moved on by `factor` times its change since an earlier one at the points with
        the given numbers (k,).
        """
        out = self.at(np.arange(len(self.plastic)))
        now, before = self.at(points), earlier.at(points)
        out.plastic[points] += factor * (now.plastic - before.plastic)
        out.back[points] += factor * (now.back - before.back)
        out.equivalent[points] += factor * (now.equivalent - before.equivalent)
        return out


@dataclass(frozen=True, kw_only=True)
class TangentReduction:
    """Difference between the elastic tangent C and the consistent tangent C_ep, at the k points
    that yield:

        C - C_ep = 2 mu (shear (I - 1x1/3) + along n x n)

    points: numbers (k,) of these points among all.
    shear: factor of the deviatoric projection (k,).
    along: factor of the dyad of the flow direction (k,).
    normal: flow direction n (k, m), a unit vector in Mandel's notation.
    mu: shear modulus (k,), MPa.
    """

    points: Index
    shear: Array
    along: Array
    normal: Array
    mu: Array

    @classmethod
    def none(cls, size: int) -> TangentReduction:
        """Reduction at no point; size: number m of components."""
        empty = np.zeros(0)
        points, normal = np.zeros(0, dtype=np.int64), np.zeros((0, size))
        return cls(points=points, shear=empty, along=empty, normal=normal, mu=empty)

    @classmethod
    def joined(cls, reductions: Sequence[TangentReduction]) -> TangentReduction:
        """One tangent reduction that holds the points of several reductions, in their order."""
        parts = {each.name: [getattr(one, each.name) for one in reductions] for each in fields(cls)}
        return cls(**{name: np.concatenate(values) for name, values in parts.items()})

    def stress(self, strain: Array) -> Array:
        """Stress (C - C_ep) : strain (k, m), MPa, from strains (k, m) at the k points, in Mandel's
        notation.
        """
        along = np.einsum("km,km->k", self.normal, strain) * self.along
        sheared = self.shear[:, None] * deviator(strain)
        return 2 * self.mu[:, None] * (sheared + along[:, None] * self.normal)


def deviator(tensors: Array) -> Array:
    """Deviatoric part (n, m) of tensors (n, m) in Mandel's notation, whose first three components
    are the normal ones.
    """
    out = tensors.copy()
    out[:, :3] -= tensors[:, :3].mean(axis=1, keepdims=True)
    return out


def yield_radius(state: History, hardening: Hardening) -> Array:
    """Norm |dev s - alpha| (n,) beyond which points yield, MPa; state: state of the points."""
    first = hardening.initial_yield_stress
    curve, _ = hardening.stress_and_slope(state.equivalent)
    radius = first + (1 - hardening.kinematic) * (curve - first)
    return np.asarray(ROOT * radius * (1 + 1e-12))


def radial_return(
    strain: Array, mu: Array, before: History, hardening: Hardening
) -> tuple[History, TangentReduction]:
    """State at n points after a load step, and the reduction of the tangent at the points that
    yield.

    strain: total strain at the end of the step (n, m), in Mandel's notation.
    mu: shear modulus (n,), MPa.
    before: state at the start of the step.
    hardening: flow curve of all points.
    The trial stress returns along the radius to the yield surface (Simo and Hughes 1998, box 3.2).
    The growth of the equivalent plastic strain solves a scalar equation, linear in pieces.
    """
    trial = 2 * mu[:, None] * (deviator(strain) - before.plastic) - before.back
    size = np.sqrt(np.einsum("nm,nm->n", trial, trial))
    share = hardening.kinematic
    first = hardening.initial_yield_stress
    yielding = np.flatnonzero(size > yield_radius(before, hardening))
    mu, size = mu[yielding], size[yielding]
    normal = trial[yielding] / size[:, None]
    start = before.equivalent[yielding]
    curve, _ = hardening.stress_and_slope(start)
    # 2 mu q / ROOT + ROOT k(q) = reached, whose left side is linear in pieces and grows with q.
    strain_at, stress_at, slopes = hardening.segments
    reached = size + 2 * mu * start / ROOT + ROOT * share * (curve - first)
    at_points = 2 * mu[:, None] * strain_at / ROOT + ROOT * stress_at
    segment = np.maximum((at_points <= reached[:, None]).sum(axis=1) - 1, 0)
    slope = slopes[segment]
    excess = reached - 2 * mu * strain_at[segment] / ROOT - ROOT * stress_at[segment]
    growth = strain_at[segment] + excess / (2 * mu / ROOT + ROOT * slope) - start
    growth = np.maximum(growth, 0.0)
    step, now = growth / ROOT, hardening.stress_and_slope(start + growth)[0]
    plastic, back = before.plastic.copy(), before.back.copy()
    equivalent = before.equivalent.copy()
    plastic[yielding] += step[:, None] * normal
    back[yielding] += (ROOT * share * (now - curve))[:, None] * normal
    equivalent[yielding] += growth
    shear = 2 * mu * step / size
    along = 1 / (1 + slope / (3 * mu)) - shear
    return History(plastic, back, equivalent), TangentReduction(
        points=yielding, shear=shear, along=along, normal=normal, mu=mu
    )


@dataclass(frozen=True)
class Material:
    """Isotropic solid.

    young_modulus: Young's modulus E, MPa; math.inf: the body is rigid.
    poisson_ratio: Poisson's ratio nu, in [0, 0.5).
    hardening: flow curve; None: the body stays elastic.
    """

    young_modulus: float
    poisson_ratio: float
    hardening: Hardening | None = None

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's constants (lambda, mu), MPa."""
        e, nu = self.young_modulus, self.poisson_ratio
        return e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))


def assemble(
    mesh: Any,
    cell_tags: Any,
    materials: dict[int, Material],
    degree: int,
    kinematics: Kinematics = SOLID,
    rule: int | None = None,
) -> tuple[Bulk, PETSc.Mat]:
    """Displacement space, and stiffness matrix K of a(u, v) = int sigma(u) : eps(v) dx
    (collective).

        sigma = lambda tr(eps) I + 2 mu eps

    mesh: dolfinx mesh, mm.
    cell_tags: MeshTags of the cells.
    materials: cell tag of each body -> its material.
    degree: polynomial degree of the displacement.
    kinematics: meaning of the mesh coordinates: a solid, plane strain, or a section that is
        revolved.
    rule: degree of the quadrature; None: that which suits `degree`.
    Raises ValueError for a cell that belongs to no body, and for mean dilatation in hexahedra or
    quadrilaterals of degree 2, whose divergence at the centroid is not the mean.
    K has one block a node (BAIJ), in N/mm, and no boundary condition is applied. It is that of the
    meshed part: of a plane section times its thickness, of a meridian section of the whole turn.
    """
    cells = mesh.topology.index_map(mesh.topology.dim)
    lame = np.zeros((cells.size_local + cells.num_ghosts, 2))
    for tag, material in materials.items():
        lame[cell_tags.find(tag)] = material.lame
    none = mesh.comm.allreduce(int(np.count_nonzero(lame[: cells.size_local, 1] == 0)))
    if none:
        raise ValueError(f"{none} cells belong to no body: the bodies' tags are {[*materials]}")
    pointwise = kinematics.mean_dilatation and not kinematics.averaged
    if pointwise and degree > 1 and compat.cell_type(mesh) in ("hexahedron", "quadrilateral"):
        raise ValueError("mean dilatation needs triangles or tetrahedra, or cells of degree 1")
    lam = compat.cellwise_constant(mesh, lame[:, 0])
    mu = compat.cellwise_constant(mesh, lame[:, 1])

    space = compat.vector_space(mesh, degree)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    order = rule or quadrature_degree(compat.cell_type(mesh), degree, kinematics)
    form = compat.form(kinematics.energy(u, v, lam, mu, mesh, order), mesh)
    stiffness = fem.petsc.create_matrix(form, "aij" if kinematics.averaged else "baij")
    fem.petsc.assemble_matrix(stiffness, form)
    stiffness.assemble()
    if kinematics.averaged:
        part = _mean_dilatation(space, lam, order)
        stiffness.axpy(1.0, part, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
        stiffness.setBlockSize(kinematics.dim)
        stiffness = stiffness.convert("baij")
    stiffness.scale(kinematics.thickness)
    stiffness.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return Bulk(space, lame, degree, kinematics), stiffness


def _mean_dilatation(space: Any, lam: Any, degree: int) -> PETSc.Mat:
    """Matrix B^T (lambda/V) B of a meridian section: lambda V times the squared mean dilatation of
    each cell. B holds the integrals of the trace of the strain over each cell, and V is the
    volume, both with the weight 2 pi r.

    space: displacement space. lam: lambda in each cell, MPa. degree: degree of the quadrature.
    """
    mesh, dx = space.mesh, ufl.dx(metadata={"quadrature_degree": degree})
    r = ufl.SpatialCoordinate(mesh)[0]
    cell = 2 * np.pi * r * ufl.TestFunction(lam.function_space)
    dilatation = Kinematics.dilatation(ufl.TrialFunction(space), r)
    integrals = fem.petsc.assemble_matrix(compat.form(dilatation * cell * dx, mesh))
    integrals.assemble()
    volume = fem.petsc.assemble_vector(compat.form(cell * dx, mesh))
    stiff = fem.petsc.assemble_vector(compat.form(lam * cell * dx, mesh))
    return weighted_product(integrals, stiff.array / volume.array**2, integrals)
