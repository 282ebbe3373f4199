"""Mirror images of what was cut off at symmetry planes.

A cut model lies at x >= 0 or at y >= 0. Its planes x = 0 or y = 0 are given by their unit normals,
as in `Fields.mirrors`. With k planes there are 2^k copies: the part itself, then its images.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from railhead.postprocess.findings import COLUMN, ROW, Array, Surface

if TYPE_CHECKING:
    import meshio

    from railhead.theory.friction.solution import FrictionSolution

Normal = tuple[float, float, float]
Planes = Sequence[Normal]
"""Unit normals, along x or y, of the symmetry planes through the origin."""
Scalar = TypeVar("Scalar", bound=np.generic)
ON_PLANE = 1e-9  # of the extent of a model, body or surface: its nodes on a symmetry plane
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
    "hexahedron27": [*(0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17)]
    + [22, 23, 20, 21, 24, 25, 26],
}
"""By VTK's name: the nodes of a cell whose image has the cell's own orientation."""


def _signs(normal: Normal) -> Array:
    """Factors (3,) of the components x, y, z of a vector in its mirror image, in a plane with a
    unit normal along one of these axes: -1 for the component along the normal, else 1.
    """
    return np.where(np.abs(normal) > 0.5, -1.0, 1.0)


def repeated(values: NDArray[Scalar], planes: Planes) -> NDArray[Scalar]:
    """Scalars (n, ...) of a part and, behind them, of its images in k planes: (2^k n, ...)."""
    return np.concatenate([values] * 2 ** len(planes))


def vectors(values: Array, planes: Planes) -> Array:
    """Vectors or points (n, 2 or 3) of a part and, behind them, of its images in k planes: (2^k n,
    2 or 3). The first of their axes is parallel to x, and with a plane y = 0 the second to y.
    Points are taken from an origin on the planes.
    """
    for normal in planes:
        values = np.concatenate([values, values * _signs(normal)[: values.shape[1]]])
    return values


def stresses(values: Array, planes: Planes) -> Array:
    """Stresses (n, 6) of a part and, behind them, of its images in k planes: (2^k n, 6). Of the
    components xx, yy, zz, xy, xz, yz those with one index along a plane's normal change their sign.
    """
    for normal in planes:
        values = np.concatenate([values, values * _signs(normal)[ROW] * _signs(normal)[COLUMN]])
    return values


def surface(part: Surface, planes: Planes) -> Surface:
    """A contact surface joined with its images, which do not share nodes with it. Triangles keep
    their orientation.
    """
    triangles = part.triangles
    for number in range(len(planes)):
        triangles = np.concatenate([triangles, triangles[:, ::-1] + 2**number * len(part.points)])
    return replace(
        part,
        points=vectors(part.points, planes),
        local=vectors(part.local, planes),
        triangles=triangles,
        pressure=repeated(part.pressure, planes),
        gap=repeated(part.gap, planes),
        displacement=vectors(part.displacement, planes),
    )


def tractions(part: FrictionSolution, planes: Planes) -> FrictionSolution:
    """Friction at n contact points joined with its images: all its arrays (n,) and vectors (n, 3).
    Weights sum up to the same area; forces and motions stay. Other solutions in it are left out.
    """
    values: dict[str, Any] = {
        name: vectors(value, planes) if value.ndim > 1 else repeated(value, planes)
        for name, value in vars(part).items()
        if isinstance(value, np.ndarray)
    }
    values["weights"] /= 2 ** len(planes)
    return replace(part, **values, without_creepage=None, misread=None, coarse=None)


def grid(part: meshio.Mesh, planes: Planes) -> meshio.Mesh:
    """A grid joined with its images. Nodes on a plane are shared. Arrays with 3 columns are
    reflected as vectors, with 9 as tensors; scalars and principal stresses are copied.
    """
    for normal in planes:
        part = _with_image(part, normal)
    return part


def _with_image(part: meshio.Mesh, normal: Normal) -> meshio.Mesh:
    """A grid joined with its image in the plane through the origin with this unit normal, along x
    or y. Nodes on the plane are shared, and cells keep their orientation. Vectors (3 columns) and
    tensors (9) are reflected; scalars and principal stresses are copied.
    """
    import meshio

    flip, across = _signs(normal), part.points @ np.array(normal)
    beside = np.abs(across) > ON_PLANE * np.ptp(across)
    count = len(part.points)
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
        np.concatenate([part.points, (part.points * flip)[beside]]),
        [
            (block.type, np.concatenate([block.data, image[block.data[:, _TURNED[block.type]]]]))
            for block in part.cells
        ],
        point_data={
            name: np.concatenate([values, reflected(name, values)[beside]])
            for name, values in part.point_data.items()
        },
        cell_data={
            name: [np.concatenate([each, reflected(name, each)]) for each in blocks]
            for name, blocks in part.cell_data.items()
        },
    )
