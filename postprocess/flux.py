"""The load that recovered stresses carry through a horizontal plane through a body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from railhead.meshing.tags import RAIL
from railhead.postprocess.findings import Array
from railhead.postprocess.solid import Solid
from railhead.postprocess.stress import nodal
from railhead.solver.gather import Fields

BESIDE = 1e-7  # of the height of a body
_SIMPLICES = {  # through the nodes of a cell in basix order; cubic cells by their corners
    ("triangle", 1): [[0, 1, 2]],
    ("triangle", 2): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    ("quadrilateral", 1): [[0, 1, 2], [1, 3, 2]],
    ("tetrahedron", 1): [[0, 1, 2, 3]],
    ("tetrahedron", 2): [
        [0, 9, 8, 7], [9, 1, 6, 5], [8, 6, 2, 4], [7, 5, 4, 3],
        [9, 8, 7, 5], [9, 8, 6, 5], [8, 7, 5, 4], [8, 6, 5, 4],
    ],
    ("hexahedron", 1): [
        [0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7],
    ],
}  # fmt: skip
_CUT = {  # edges of a simplex whose corners are sorted by height, by how many lie below the plane
    3: {1: [(0, 1), (0, 2)], 2: [(0, 2), (1, 2)]},
    4: {
        1: [(0, 1), (0, 2), (0, 3)],
        2: [(0, 2), (0, 3), (1, 3), (1, 2)],
        3: [(0, 3), (1, 3), (2, 3)],
    },
}


def through_plane(fields: Fields, body: int, distance: float) -> float:
    """-int sigma_zz over the plane z = const of one body, N, of the whole model.

    It lies `distance` (mm) below the lowest point with pressure in the rail, above the highest one
    in the wheel, or half way through a body that is thinner there than twice that. What a body with
    free sides carries through it is the load.
    """
    pressure, points = fields.contact.pressure, fields.contact.points
    touching, mine = points[pressure > 0, 2], fields.body == body
    height = float(np.ptp(fields.points[np.unique(fields.cells[mine]), 2]))
    into = np.array([0.0, 0.0, -1.0 if body == RAIL else 1.0])
    solid = Solid(fields, np.flatnonzero(mine))
    depth = min(distance, 0.5 * solid.extent(points[np.argmax(pressure)], into, height))
    start = touching.min() if body == RAIL else touching.max()
    # A plane through a layer of nodes would cut no cell.
    height = start + depth * into[2] + BESIDE * height
    z = fields.points[fields.cells, 2]
    crossing = mine & (z.min(axis=1) < height) & (z.max(axis=1) > height)
    simplices = _simplices(fields, fields.cells[crossing])
    stress = _zz(fields, crossing)
    total = 0.0
    rise = fields.points[simplices, 2] - height
    below = (rise < 0).sum(axis=1)
    for count, edges in _CUT[simplices.shape[1]].items():
        chosen = simplices[below == count]
        order = np.argsort(fields.points[chosen, 2], axis=1)
        chosen = np.take_along_axis(chosen, order, axis=1)
        total += _integral(fields, chosen, edges, stress, height)
    parts = 1 if fields.kinematics.revolved else 2 ** len(fields.mirrors)
    return -parts * total


def _simplices(fields: Fields, cells: NDArray[np.int64]) -> NDArray[np.int64]:
    pattern = _SIMPLICES.get((fields.cell, fields.degree)) or _SIMPLICES[fields.cell, 1]
    return np.concatenate([cells[:, corners] for corners in pattern])


def _zz(fields: Fields, crossing: NDArray[np.bool_]) -> Array:
    """sigma_zz at the nodes of these cells, averaged over all cells around each node."""
    wanted = np.zeros(len(fields.points), dtype=bool)
    wanted[fields.cells[crossing]] = True
    some = fields.among(wanted[fields.cells].any(axis=1))
    with np.errstate(invalid="ignore"):  # nodes of no cell
        return nodal(some)[:, 2]


def _integral(
    fields: Fields,
    simplices: NDArray[np.int64],
    edges: list[tuple[int, int]],
    stress: Array,
    height: float,
) -> float:
    """int sigma_zz over the cuts of simplices through edges (start, end), sigma linear in each."""
    start, end = (simplices[:, list(side)] for side in zip(*edges, strict=True))
    low, high = fields.points[start, 2], fields.points[end, 2]
    t = (height - low) / (high - low)
    corners = fields.points[start] + t[..., None] * (fields.points[end] - fields.points[start])
    values = stress[start] + t * (stress[end] - stress[start])
    if len(edges) == 2 and fields.kinematics.dim == 2:
        length = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
        values = values * fields.kinematics.measure(fields.kinematics.flatten(corners))
        return float(length @ values.mean(axis=1))
    total = 0.0
    for k in range(1, len(edges) - 1):
        fan = [0, k, k + 1]
        u, v = (corners[:, j] - corners[:, 0] for j in fan[1:])
        area = 0.5 * np.linalg.norm(np.cross(u, v), axis=1)
        total += float(area @ values[:, fan].mean(axis=1))
    return total
