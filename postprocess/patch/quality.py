"""Measures of quality: noise of the pressure, elements over the patch, distance from edges."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from railhead.postprocess.findings import Array, Frame, Patch
from railhead.solver.fields import Fields

BORDER_POINTS = 8  # on each edge of a facet
ON_PLANE = 1e-9  # of the surface's extent: nodes that lie on a symmetry plane


def noise(fields: Fields, recovered: Array) -> float:
    """Relative L2 difference of computed pressure p and smooth pressure p_s, ||p - p_s|| / ||p||,
    with the norms integrated over the contact points.

    recovered (q,): smooth pressure at the q contact points, MPa.
    """
    contact = fields.contact
    square = contact.weights @ (contact.pressure - recovered) ** 2
    return float(np.sqrt(square / (contact.weights @ contact.pressure**2)))


def elements_across(fields: Fields, frame: Frame, patch: Patch) -> tuple[float, float]:
    """Number of elements over the length (along x) and over the width (along s) of the most loaded
    patch.

    Each is the extent of the patch over the mean extent of the facets with pressure. It is 1 in the
    direction of a line contact.
    """
    contact = fields.contact
    used = np.unique(contact.facet[contact.pressure > 0])
    corners = fields.points[contact.facet_nodes[used]]
    local = frame.local(corners.reshape(-1, 3))[:, :2].reshape(len(used), -1, 2)
    middle = np.abs(local.mean(axis=1) - patch.centre)
    own = (middle <= 1.1 * np.array([patch.a, patch.b])).all(axis=1)
    size = np.ptp(local[own] if own.any() else local, axis=1).mean(axis=0)
    if fields.kinematics.revolved:
        size[:] = size.max()
    along, across = (
        float(2 * half / step) if step > 1e-9 * half else 1.0
        for half, step in zip((patch.a, patch.b), size, strict=True)
    )
    return along, across


def edge_distance(fields: Fields, patch: Patch, edges: Array) -> float:
    """Smallest distance of a point with pressure from an edge, over the smaller half length of the
    patch.

    Edges are the border of the contact surface and the sharp edges of both bodies. Cuts at symmetry
    planes are no edges. edges (n, 3): points on the sharp edges, mm. Infinite where there is no
    edge. In plane strain the half length is that in the section.
    """
    contact = fields.contact
    kinematics = fields.kinematics
    flat = kinematics.dim == 2
    count = 1 if flat else {3: 3, 6: 3, 10: 3}.get(contact.facet_nodes.shape[1], 4)
    ring = {1: [[0], [1]], 3: [[0, 1], [1, 2], [2, 0]], 4: [[0, 1], [1, 3], [3, 2], [2, 0]]}[count]
    sides = np.concatenate([contact.facet_nodes[:, side] for side in ring])
    unique, number = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    ends = fields.points[unique[number == 1]]
    for normal in fields.mirrors:
        off = np.abs(ends @ np.array(normal)).max(axis=1)
        ends = ends[off > ON_PLANE * np.ptp(fields.points)]
    share = np.linspace(0.0, 1.0, BORDER_POINTS)[:, None, None]
    border = np.concatenate(
        [(ends[:, 0] * (1 - share) + ends[:, -1] * share).reshape(-1, 3), edges]
    )
    if not len(border):
        return float("inf")
    distance = cKDTree(border).query(contact.points[contact.pressure > 0])[0]
    half = min(patch.a, patch.b)
    if flat and not kinematics.revolved:
        half = (patch.a, patch.b)[int(np.argmax(np.abs(kinematics.axes[0])))]
    return float(distance.min() / half)
