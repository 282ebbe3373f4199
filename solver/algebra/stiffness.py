"""The stiffness matrix of isotropic elastic solids, of straight bodies and of sections."""

from typing import Any

import dolfinx.fem.petsc  # noqa: F401
import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from railhead.solver import compat
from railhead.solver.material import Material
from railhead.solver.space.cells import Bulk, quadrature_degree
from railhead.solver.space.kinematics import SOLID, Kinematics
from railhead.solver.space.operators import weighted_product


def assemble(
    mesh: Any,
    cell_tags: Any,
    materials: dict[int, Material],
    degree: int,
    kinematics: Kinematics = SOLID,
    rule: int | None = None,
    space: Any = None,
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
    space: displacement space; None: a new one.
    Raises ValueError for a cell that belongs to no body, and for mean dilatation in hexahedra or
    quadrilaterals of degree 2, whose divergence at the centroid is not the mean.
    K has one block a node (BAIJ), in N/mm, and no boundary condition is applied. It is that of the
    meshed part: of a plane section times its thickness, of a meridian section of the whole turn.
    """
    cells = mesh.topology.index_map(mesh.topology.dim)
    lame = np.zeros((cells.size_local + cells.num_ghosts, 2))
    for tag, material in materials.items():
        lame[cell_tags.find(tag)] = np.column_stack(material.lame)
    none = mesh.comm.allreduce(int(np.count_nonzero(lame[: cells.size_local, 1] == 0)))
    if none:
        raise ValueError(f"{none} cells belong to no body: the bodies' tags are {[*materials]}")
    pointwise = kinematics.mean_dilatation and not kinematics.averaged
    if pointwise and degree > 1 and compat.cell_type(mesh) in ("hexahedron", "quadrilateral"):
        raise ValueError("mean dilatation needs triangles or tetrahedra, or cells of degree 1")
    lam = compat.cellwise_constant(mesh, lame[:, 0])
    mu = compat.cellwise_constant(mesh, lame[:, 1])

    space = compat.vector_space(mesh, degree) if space is None else space
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
