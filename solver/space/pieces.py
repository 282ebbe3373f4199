"""Contact quadrature on the pieces into which the facets of two surfaces cut each other.

A polynomial on each facet of the slave, and one on each facet of the master, have a smooth product
on a piece only. Forces on both surfaces are exact there, so that a constant pressure on flat
non-matching surfaces stays constant (the contact patch test).
"""

import basix
import numpy as np
from scipy.spatial import cKDTree

from railhead.solver.space.facets import FacetSet, facet_type, pair, project_on_corners
from railhead.theory.array_types import Array, Index

SIZE_CLASS = 2.0  # largest over smallest radius of the master's facets that are looked up together
FACING = -0.1  # largest product of the normals of two facets that face each other
COVERED = 0.02  # share of a facet that the pieces on it may lack, beside the end of a curved master
ON_LINE = 1e-9  # height over a line, in the reference facet, that is rounding
SKEW = np.array([0.61, 0.29, 0.74])  # a direction that edges of meshes hardly are normal to
SMALLEST = 1e-12  # area of a piece, in the reference facet


def quadrature(
    slave: FacetSet, master: FacetSet, degree: int
) -> tuple[tuple[Index, Array], Array, Index]:
    """Quadrature points on the pieces of the slave's facets, facet by facet, as
    `FacetSet.quadrature` gives them on whole facets, and the master's facet of the piece that each
    point lies on (n,), -1 on whole facets.

    slave: m facets. master: facets of the other surface, of all ranks.
    degree: degree of the quadrature on each piece.
    The master's facets are drawn straight between their corners and projected along the normal of
    each of the slave's facets. What they do not cover has no points. A facet on which the pieces
    lack a part that all its normals meet, far from a curved master, keeps its whole quadrature.
    """
    facet, corners, other = cut(slave, master)
    kind = getattr(basix.CellType, "triangle" if corners.shape[2] == 2 else "interval")
    local, share = basix.make_quadrature(kind, degree)
    edges = corners[:, 1:] - corners[:, :1]
    size = np.abs(np.linalg.det(edges))
    piece, areas = np.repeat(facet, len(share)), np.outer(size, share).ravel()
    inner = corners[:, None, 0] + np.einsum("qj,pjc->pqc", local, edges)
    inner = inner.reshape(len(piece), corners.shape[2])
    covered = np.bincount(piece, areas, minlength=len(slave))

    (whole, xi), weights = slave.quadrature(degree)
    full = 1.0 if facet_type(slave.cell) != "triangle" else 0.5
    kept = np.zeros(len(slave), dtype=bool)
    open_ = np.flatnonzero(np.isin(whole, np.flatnonzero(covered < (1 - COVERED) * full)))
    if len(open_):
        points, tangent = slave.tangents(whole[open_], xi[open_])
        met = pair(points, slave.normals(whole[open_], tangent), master)[0] >= 0
        hits = np.bincount(whole[open_], met, minlength=len(slave))
        kept = (hits == np.bincount(whole, minlength=len(slave))) | ((covered == 0) & (hits > 0))
    cuts, rest = ~kept[piece], kept[whole]
    index = np.concatenate([piece[cuts], whole[rest]])
    order = np.argsort(index, kind="stable")
    weights = np.append(areas[cuts] * slave.measure(piece[cuts], inner[cuts]), weights[rest])
    partner = np.append(np.repeat(other, len(share))[cuts], np.full(len(index) - cuts.sum(), -1))
    at = index[order], np.concatenate([inner[cuts], xi[rest]])[order]
    return at, weights[order], partner[order]


def cut(slave: FacetSet, master: FacetSet) -> tuple[Index, Array, Index]:
    """Pieces that the facets of two surfaces have in common: the slave's facet of each piece (p,),
    the corners of the piece, an interval or a triangle, in the reference facet (p, c, c - 1), and
    the master's facet (p,).
    """
    one, two = _neighbours(slave, master)
    corners = master.vertices[two]
    count, points = corners.shape[1], corners.reshape(-1, corners.shape[2])
    normals = np.repeat(slave.flat_normals[one], count, axis=0)
    xi = project_on_corners(points, normals, slave, np.repeat(one, count))
    polygons = xi.reshape(len(one), count, xi.shape[1])
    if polygons.shape[2] == 1:
        ends = np.clip(np.sort(polygons, axis=1), 0.0, 1.0)
        used = ends[:, 1, 0] - ends[:, 0, 0] > SMALLEST
        return one[used], ends[used], two[used]
    polygons = polygons[:, [0, 1, 3, 2] if count == 4 else [0, 1, 2]]
    triangle = facet_type(slave.cell) == "triangle"
    planes = [([1.0, 0.0], 0.0), ([0.0, 1.0], 0.0)]
    planes += [([-1.0, -1.0], 1.0)] if triangle else [([-1.0, 0.0], 1.0), ([0.0, -1.0], 1.0)]
    for normal, offset in planes:
        polygons = _clipped(polygons, polygons @ np.array(normal) + offset)
    # From a corner that is chosen in space: neither the order of corners nor ranks change anything.
    sides = slave.vertices[one, 1:3] - slave.vertices[one, :1]
    first = (polygons @ (sides @ SKEW)[..., None])[..., 0].argmax(axis=1)
    edges = np.stack([polygons, np.roll(polygons, -1, axis=1)], axis=2)
    apex = polygons[np.arange(len(one)), first][:, None, None]
    apex = np.broadcast_to(apex, (*edges.shape[:2], 1, 2))
    triangles = np.concatenate([apex, edges], axis=2)
    used = np.abs(np.linalg.det(triangles[..., 1:, :] - triangles[..., :1, :])) > SMALLEST
    times = used.sum(axis=1)
    return np.repeat(one, times), triangles[used], np.repeat(two, times)


def _clipped(polygons: Array, height: Array) -> Array:
    """Parts of convex polygons (p, v, 2) on the side of a line where the height (p, v) of their
    corners above it is not negative: (p, w, 2) with w corners, the last ones repeated.
    """
    count = polygons.shape[1]
    height = np.where(np.abs(height) < ON_LINE, 0.0, height)
    after, above = np.roll(polygons, -1, axis=1), np.roll(height, -1, axis=1)
    crosses = height * above < 0
    share = height / np.where(crosses, height - above, 1.0)
    met = polygons + share[..., None] * (after - polygons)
    every = np.stack([polygons, met], axis=2).reshape(len(polygons), 2 * count, 2)
    valid = np.stack([height >= 0, crosses], axis=2).reshape(len(polygons), 2 * count)
    width = int(valid.sum(axis=1).max(initial=3))
    order = np.argsort(~valid, axis=1, kind="stable")[:, :width]
    last = np.maximum(valid.sum(axis=1) - 1, 0)[:, None]
    order = np.where(np.arange(width) <= last, order, np.take_along_axis(order, last, axis=1))
    out = np.take_along_axis(every, order[..., None], axis=1)
    out[~valid.any(axis=1)] = 0.0
    return out


def _neighbours(slave: FacetSet, master: FacetSet) -> tuple[Index, Index]:
    """Numbers of the slave's and of the master's facets of all pairs that may have a piece in
    common: they face each other, and their circles overlap along the normal of the slave's facet.
    """
    sets = [(each.vertices.mean(axis=1), each.vertices) for each in (slave, master)]
    (middle, radius), (other, reach) = (
        (x, np.linalg.norm(corners - x[:, None], axis=2).max(axis=1, initial=0))
        for x, corners in sets
    )
    if not len(middle) or not len(other):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    nearest = cKDTree(other).query(middle)[0]
    one, two = [], []
    level = np.floor(np.log(reach) / np.log(SIZE_CLASS)).astype(int)
    for each in np.unique(level):
        members = np.flatnonzero(level == each)
        near = cKDTree(other[members]).query_ball_point(
            middle, nearest + radius + reach[members].max()
        )
        one.append(np.repeat(np.arange(len(middle)), [len(found) for found in near]))
        two.append(members[np.concatenate(near).astype(np.int64)])
    i, j = np.concatenate(one), np.concatenate(two)
    normals, both = slave.flat_normals[i], radius[i] + reach[j]
    apart = other[j] - middle[i]
    along = np.einsum("nc,nc->n", apart, normals)
    beside = np.linalg.norm(apart - along[:, None] * normals, axis=1)
    facing = np.einsum("nc,nc->n", normals, master.flat_normals[j])
    kept = (facing < FACING) & (beside < both) & (along > -both)
    return i[kept], j[kept]
