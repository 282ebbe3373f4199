"""Two boxes on each other whose meshes do not match, for the solver without scenes."""

from typing import Any

import numpy as np
from dolfinx import mesh as dmesh
from mpi4py import MPI

from railhead.solver import compat

LOWER, UPPER = 1, 2  # cells; facets between the boxes are 10 + body, opposite ones 20 + body
KINDS = {"triangle": 2, "quadrilateral": 2, "tetrahedron": 3, "hexahedron": 3}


def two_boxes(
    cell: str,
    counts: tuple[tuple[int, ...], tuple[int, ...]],
    ends: tuple[Any, Any],
    bend: float = 0.0,
    interface: float = 0.0,
) -> tuple[Any, Any, Any]:
    """Mesh, cell tags and facet tags of two boxes that meet at the last coordinate `interface`.

    counts: cells along each axis of the lower and the upper box. ends: their two opposite corners.
    bend: inner nodes are moved beside, by up to this share of the box. Facets at the sides have
    the tags 30 (least first coordinate), 31 (largest), 32 and 33 (second).
    """
    dim, kind = KINDS[cell], getattr(dmesh.CellType, cell)
    nodes, points = [], []
    for count, corners in zip(counts, ends, strict=True):
        make = dmesh.create_box if dim == 3 else dmesh.create_rectangle
        box = make(MPI.COMM_SELF, [np.array(c, float) for c in corners], list(count), kind)
        x, (low, high) = box.geometry.x[:, :dim].copy(), np.array(corners, float)
        wave = np.sin(np.pi * ((x - low) / (high - low))[:, : dim - 1]).prod(axis=1)
        x[:, 0] += bend * (high - low)[0] * wave
        nodes.append(compat.cell_nodes(box) + sum(map(len, points)))
        points.append(x)
    cells, x = np.concatenate(nodes), np.concatenate(points)
    if MPI.COMM_WORLD.rank > 0:
        cells, x = np.empty((0, cells.shape[1])), np.empty((0, dim))
    both = compat.cells_mesh(MPI.COMM_WORLD, cells, x, cell)
    index = both.topology.index_map(dim)
    every = np.arange(index.size_local + index.num_ghosts, dtype=np.int32)
    middle = dmesh.compute_midpoints(both, dim, every)
    body = np.where(middle[:, dim - 1] < interface, LOWER, UPPER).astype(np.int32)
    both.topology.create_connectivity(dim - 1, dim)
    outer = dmesh.exterior_facet_indices(both.topology)
    link = both.topology.connectivity(dim - 1, dim)
    owner = body[[link.links(facet)[0] for facet in outer]]
    x = dmesh.compute_midpoints(both, dim - 1, outer)[:, :dim]
    low, high = (np.array([each[end] for each in ends])[owner - 1] for end in (0, 1))
    tags = np.zeros(len(outer), dtype=np.int32)
    for axis in range(dim - 1):
        tags[abs(x[:, axis] - low[:, axis]) < 1e-9] = 30 + 2 * axis
        tags[abs(x[:, axis] - high[:, axis]) < 1e-9] = 31 + 2 * axis
    facing = np.where(owner == LOWER, high[:, -1], low[:, -1])
    behind = np.where(owner == LOWER, low[:, -1], high[:, -1])
    tags = np.where(abs(x[:, -1] - facing) < 1e-9, 10 + owner, tags)
    tags = np.where(abs(x[:, -1] - behind) < 1e-9, 20 + owner, tags)
    return (
        both,
        dmesh.meshtags(both, dim, every, body),
        dmesh.meshtags(both, dim - 1, outer, tags.astype(np.int32)),
    )
