"""Curved plane meshes from gmsh for the solver without scenes: sections of quadratic triangles."""

from collections.abc import Callable
from typing import Any

import gmsh
from mpi4py import MPI

from railhead.solver import compat


def meshed(
    make: Callable[[Any], list[int]],
    tag_of: Callable[[int, tuple[float, float, float, float]], int],
    size: str,
    order: int = 2,
) -> tuple[Any, Any, Any]:
    """Mesh, cell tags and facet tags of surfaces.

    make: makes surfaces in gmsh's `occ` and returns their numbers: bodies 1, 2, ...
    tag_of: (body, (least x, least y, largest x, largest y) of a curve) -> its tag, 0: none.
    size: formula of the element size in x and y.
    """
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        surfaces = make(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        groups: dict[int, list[int]] = {}
        for body, surface in enumerate(surfaces, 1):
            gmsh.model.addPhysicalGroup(2, [surface], body)
            for _, curve in gmsh.model.getBoundary([(2, surface)], oriented=False):
                low_x, low_y, _, high_x, high_y, _ = gmsh.model.getBoundingBox(1, curve)
                tag = tag_of(body, (low_x, low_y, high_x, high_y))
                groups.setdefault(tag, []).append(curve)
        for tag, curves in groups.items():
            if tag:
                gmsh.model.addPhysicalGroup(1, curves, tag)
        field = gmsh.model.mesh.field.add("MathEval")
        gmsh.model.mesh.field.setString(field, "F", size)
        gmsh.model.mesh.field.setAsBackgroundMesh(field)
        for option in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
            gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        return compat.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 2)
    finally:
        gmsh.finalize()
