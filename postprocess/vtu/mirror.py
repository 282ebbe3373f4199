"""Mirror images of a model that was cut at its symmetry planes.

The contact lies inside a whole model and on the border of one that was cut, so the cuts show in the
points themselves. A cut model lies at x >= 0 or at y >= 0, with the origin on the plane.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import meshio
import numpy as np

from railhead.postprocess.findings import Array, Surface

_TOLERANCE = 1e-9  # of the extent of the model
_NUMBERS = {"principal_stresses"}  # of point data three columns wide, that are no vectors
_TURNED = {
    "vertex": [0],
    "line": [1, 0],
    "triangle": [0, 2, 1],
    "triangle6": [0, 2, 1, 5, 4, 3],
    "quad": [0, 3, 2, 1],
    "quad9": [0, 3, 2, 1, 7, 6, 5, 4, 8],
    "tetra": [0, 2, 1, 3],
    "tetra10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
    "hexahedron": [0, 3, 2, 1, 4, 7, 6, 5],
    "hexahedron27": [
        0,
        3,
        2,
        1,
        4,
        7,
        6,
        5,
        11,
        10,
        9,
        8,
        15,
        14,
        13,
        12,
        16,
        19,
        18,
        17,
        22,
        23,
        20,
        21,
        24,
        25,
        26,
    ],
}
"""By VTK's name: the nodes of a cell whose image has the cell's own orientation."""


def cut_axes(local: Array) -> list[int]:
    """Axes (0: x, 1: s) along which points (n, 2 or 3) in the contact frame all have positive or
    zero coordinates: a model with these points was cut there at a symmetry plane.
    """
    return [axis for axis in (0, 1) if local[:, axis].min() > -_TOLERANCE * np.ptp(local[:, axis])]


def whole(surface: Surface) -> Surface:
    """A contact surface joined with its mirror images across x = 0 and s = 0, where all its points
    lie on one side; otherwise unchanged. The displacement is reflected.
    """
    for axis in cut_axes(surface.local):
        flip = np.where(np.arange(3) == axis, -1.0, 1.0)
        points, local = surface.points * flip, surface.local * flip[:2]
        image = surface.triangles[:, ::-1] + len(points)
        surface = replace(
            surface,
            points=np.concatenate([surface.points, points]),
            local=np.concatenate([surface.local, local]),
            triangles=np.concatenate([surface.triangles, image]),
            pressure=np.tile(surface.pressure, 2),
            gap=np.tile(surface.gap, 2),
            displacement=np.concatenate([surface.displacement, surface.displacement * flip]),
        )
    return surface


def whole_grid(grid: meshio.Mesh, normals: Iterable[tuple[float, float, float]]) -> meshio.Mesh:
    """A grid joined with its mirror images in planes x = 0 or y = 0, which are given by their
    normals. Nodes on a plane are shared. Vectors and tensors are reflected; principal stresses
    are copied.
    """
    for normal in normals:
        grid = _with_image(grid, int(np.argmax(np.abs(normal))))
    return grid


def _with_image(grid: meshio.Mesh, axis: int) -> meshio.Mesh:
    """A grid joined with its mirror image across x = 0 (axis 0) or y = 0 (axis 1). Arrays with 3
    columns are reflected as vectors, with 9 as tensors; scalars and principal stresses are
    copied.
    """
    flip = np.where(np.arange(3) == axis, -1.0, 1.0)
    count, across = len(grid.points), grid.points[:, axis]
    beside = np.abs(across) > _TOLERANCE * np.ptp(across)
    image = np.where(beside, count - 1 + np.cumsum(beside), np.arange(count))

    def reflected(name: str, values: Array) -> Array:
        """Point or cell data of the image: scalars (n,) and principal stresses as they are, vectors
        (n, 3) and tensors (n, 9) with the signs of the reflection.
        """
        if values.ndim == 1 or name in _NUMBERS:
            return values
        signs = flip if values.shape[1] == 3 else np.outer(flip, flip).ravel()
        return values * signs

    return meshio.Mesh(
        np.concatenate([grid.points, (grid.points * flip)[beside]]),
        [
            (block.type, np.concatenate([block.data, image[block.data[:, _TURNED[block.type]]]]))
            for block in grid.cells
        ],
        point_data={
            name: np.concatenate([values, reflected(name, values)[beside]])
            for name, values in grid.point_data.items()
        },
        cell_data={
            name: [np.concatenate([each, reflected(name, each)]) for each in blocks]
            for name, blocks in grid.cell_data.items()
        },
    )
