"""Quarters of two crossed cylinders as blocks of 40 x 40 x 60 mm, the meshes that the codes are
given: the rail below z = 0, the wheel above, their arcs exact at every node."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
WIDTH, DEPTH = 40.0, 60.0  # mm
FINE = (5.6, 4.6, 1.6)  # mm along x, y and down that have the given size
WHEEL_COARSER = 1.15  # the meshes do not match
LAYER_GROWTH = 1.25  # of hexahedra, from layer to layer
GRADIENT = 0.25  # of the size of tetrahedra
FACES = {
    "hexahedron": [
        [0, 1, 2, 3],
        [4, 5, 6, 7],
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
    ],
    "tetrahedron": [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]],
}
"""Corners of the faces of a cell, in the numbering of Abaqus and CalculiX."""


def write(path: Path, case: Mapping[str, float], cell: str, size: float) -> None:
    """Both bodies as `<body>_<what>` in an npz file: points (n, 3) mm; cells, linear hexahedra
    (m, 8) or quadratic tetrahedra (m, 10), VTK's node order; x0, y0, far, contact: points of the
    symmetry planes, the far end and the arc; sides (f, 2): cell and face (from 0) on the arc;
    corners (f, 4 or 3) of them, outwards."""
    make = {"hexahedron": _hexahedra, "tetrahedron": _tetrahedra}[cell]
    arrays: dict[str, Any] = {}
    for body, sign, coarser in (("rail", -1, 1.0), ("wheel", 1, WHEEL_COARSER)):
        flat, cells = make(size * coarser, sign)
        sides, corners = _faces(flat, cells, cell)
        arrays |= {
            f"{body}_points": _bent(flat, body, case),
            f"{body}_cells": cells,
            f"{body}_sides": sides,
            f"{body}_corners": corners,
        }
        for name, axis, place in (("x0", 0, 0), ("y0", 1, 0), ("far", 2, DEPTH), ("contact", 2, 0)):
            off = np.abs(np.abs(flat[:, axis]) - place)
            arrays[f"{body}_{name}"] = np.flatnonzero(off < 1e-7)
    np.savez(path, **arrays)


def _bent(flat: Array, body: str, case: Mapping[str, float]) -> Array:
    """A flat block with its face at z = 0 pulled onto the arc, less and less towards the end."""
    x, y, z = flat.T
    if body == "rail":
        arc = np.sqrt(case["rail_radius"] ** 2 - y**2) - case["rail_radius"]
    else:
        arc = case["wheel_radius"] - np.sqrt(case["wheel_radius"] ** 2 - x**2)
    return np.column_stack([x, y, z + arc * (1 - np.abs(z) / DEPTH)])


def _faces(flat: Array, cells: Array, cell: str) -> tuple[Array, Array]:
    """Cell and face of every side at z = 0, and its corners, counter-clockwise from outside."""
    upper = flat[:, 2].max() < 1e-7
    sides, corners = [], []
    for number, face in enumerate(FACES[cell]):
        for owner in np.flatnonzero((np.abs(flat[cells[:, face], 2]) < 1e-7).all(axis=1)):
            found = cells[owner, face]
            (ax, ay), (bx, by) = (flat[found[1:3]] - flat[found[0]])[:, :2]
            sides.append((owner, number))
            corners.append(found if (ax * by - ay * bx > 0) == upper else found[::-1])
    return np.array(sides), np.array(corners)


def _layers(size: float, fine: float, end: float) -> Array:
    """Places from 0 to `end`: steps of `size` over `fine`, then growing ones."""
    even = size * np.arange(np.ceil(fine / size) + 1)
    rest = end - even[-1]
    count = np.ceil(np.log1p(rest / size * (1 - 1 / LAYER_GROWTH)) / np.log(LAYER_GROWTH))
    growing = np.cumsum(size * LAYER_GROWTH ** np.arange(1, count + 1))
    return np.concatenate([even, even[-1] + growing * rest / growing[-1]])


def _hexahedra(size: float, sign: int) -> tuple[Array, Array]:
    """Points (n, 3), mm, and cells (m, 8) of linear hexahedra in a flat block; sign: 1 above z = 0,
    -1 below."""
    x, y, z = (
        _layers(size, fine, end) for fine, end in zip(FINE, (WIDTH, WIDTH, DEPTH), strict=True)
    )
    z = z if sign > 0 else -z[::-1]
    points = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(len(x), len(y), len(z))
    low, high = slice(None, -1), slice(1, None)
    ring = ((low, low), (high, low), (high, high), (low, high))
    corners = [number[(*at, level)].ravel() for level in (low, high) for at in ring]
    return points, np.stack(corners, axis=1)


def _tetrahedra(size: float, sign: int) -> tuple[Array, Array]:
    """Points (n, 3), mm, and cells (m, 10) of quadratic tetrahedra of gmsh in a flat block; sign: 1
    above z = 0, -1 below."""
    import gmsh

    def wanted(dim: int, tag: int, x: float, y: float, z: float, lc: float) -> float:
        beside = FINE[1] * max(0.0, np.hypot(x / FINE[0], y / FINE[1]) - 1)
        return size + GRADIENT * float(np.hypot(beside, z))

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for source in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
            gmsh.option.setNumber(f"Mesh.MeshSize{source}", 0)
        gmsh.model.occ.addBox(0, 0, min(0, sign * DEPTH), WIDTH, WIDTH, DEPTH)
        gmsh.model.occ.synchronize()
        gmsh.model.mesh.setSizeCallback(wanted)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        _, owners = gmsh.model.mesh.getElementsByType(11)  # tetrahedra of 10 nodes
    finally:
        gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, int)
    number[tags.astype(int)] = np.arange(len(tags))
    cells = number[owners.astype(int)].reshape(-1, 10)
    return places.reshape(-1, 3), cells[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]  # gmsh ends in 8, 9
