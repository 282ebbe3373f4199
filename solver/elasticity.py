"""The bulk: small-strain isotropic linear elasticity, assembled once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import dolfinx.fem.petsc  # noqa: F401
import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray
from petsc4py import PETSc

from solver import compat


@dataclass(frozen=True)
class Material:
    """Isotropic linear elastic solid. E in MPa (math.inf: rigid), nu in [0, 0.5)."""

    young_modulus: float
    poisson_ratio: float

    @property
    def lame(self) -> tuple[float, float]:
        """(lambda, mu) in MPa."""
        e, nu = self.young_modulus, self.poisson_ratio
        return e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))


@dataclass(frozen=True)
class Bulk:
    """Displacement space and stiffness of all bodies of one mesh.

    lame: (cells, 2) lambda and mu of every local cell, MPa.
    """

    space: Any
    stiffness: PETSc.Mat
    lame: NDArray[np.float64]
    degree: int


def quadrature_degree(cell: str, degree: int) -> int:
    """Degree of the rule for K: exact on straight-sided tetrahedra and on boxes."""
    return max(2 * (degree - 1), 1) if cell == "tetrahedron" else 2 * degree


def assemble(mesh: Any, cell_tags: Any, materials: dict[int, Material], degree: int) -> Bulk:
    """K of a(u, v) = int sigma(u) : eps(v) dx, sigma = lambda tr(eps) I + 2 mu eps.

    materials: by the cell tag of the body. No boundary condition is applied.
    """
    cells = mesh.topology.index_map(3)
    lame = np.zeros((cells.size_local + cells.num_ghosts, 2))
    for tag, material in materials.items():
        lame[cell_tags.find(tag)] = material.lame
    lam = compat.cellwise_constant(mesh, lame[:, 0])
    mu = compat.cellwise_constant(mesh, lame[:, 1])

    space = compat.vector_space(mesh, degree)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    order = quadrature_degree(compat.cell_type(mesh), degree)
    dx = ufl.dx(metadata={"quadrature_degree": order})

    def eps(w: Any) -> Any:
        return ufl.sym(ufl.grad(w))

    a = (lam * ufl.tr(eps(u)) * ufl.tr(eps(v)) + 2 * mu * ufl.inner(eps(u), eps(v))) * dx
    stiffness = fem.petsc.assemble_matrix(compat.form(a))
    stiffness.assemble()
    stiffness.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return Bulk(space, stiffness, lame, degree)
