"""The deformed contact surface of the master, at its nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railhead.solver.interface.jumps import Gap
from railhead.solver.space.cells import Array
from railhead.solver.space.facets import FacetSet, facet_closure
from railhead.solver.space.pairing import pair

ITERATIONS = 4  # of the search for the normal that ends at a node
MISS_PER_GAP, MISS_PER_FACET = 0.1, 0.02  # by which that normal may miss, of gap and facet length


@dataclass(frozen=True)
class MasterSurface:
    """Gap at n nodes of the master's contact surface at which normals of the slave end.

    facet_nodes: (f, k) nodes of the facets of which all nodes are such, as row numbers of
        `Fields.points`, corners first, basix order.
    nodes: (n,) all nodes of these facets, as row numbers of `Fields.points`.
    gap: gap between the deformed surfaces along the slave's normal (n,), mm, negative where they
        overlap.
    """

    facet_nodes: NDArray[np.int64]
    nodes: NDArray[np.int64]
    gap: Array


def outer_nodes(facets: FacetSet) -> NDArray[np.int64]:
    """Global block dofs (m, k) that lie on each of m facets, corners first, basix order."""
    closure = facet_closure(facets.cell, facets.degree)
    return np.take_along_axis(facets.dofs, closure[facets.local_facet], axis=1)


def master_surface(
    slave: FacetSet, master: FacetSet, exact: Gap, points: Array, displacement: Array
) -> MasterSurface:
    """Gap g0 + n . (u_master - u_slave) at the nodes of the master that face the slave; n is the
    slave's normal.

    The point of the slave that faces a node is searched by following the normal that the slave has
    at the last guess, `ITERATIONS` times. Nodes for which the normal still misses are left out.

    slave, master: contact facets of all ranks.
    exact: exact initial gap and its normals.
    points: position of all nodes of the mesh in space (n, 3), mm.
    displacement: displacement of these nodes in space (n, 3), mm.
    """
    faces = outer_nodes(master)
    nodes = np.unique(faces)
    kinematics = slave.kinematics
    placed = kinematics.flatten(points[nodes] - np.array(kinematics.offset))
    gap, normals = exact(points[nodes])
    for _ in range(ITERATIONS):
        partner, xi = pair(placed, kinematics.flatten(normals), slave)
        seen = np.isfinite(gap) & (partner >= 0)
        nodes, placed, partner, xi = nodes[seen], placed[seen], partner[seen], xi[seen]
        below = slave.tangents(partner, xi)[0]
        gap, normals = exact(kinematics.lift(below))
    gap = np.where(np.isfinite(gap), gap, np.nan)
    missed = placed - below - gap[:, None] * kinematics.flatten(normals)
    size = np.linalg.norm(slave.vertices[partner, 1] - slave.vertices[partner, 0], axis=1)
    seen = np.linalg.norm(missed, axis=1) < MISS_PER_GAP * gap + MISS_PER_FACET * size
    nodes, gap, normals = nodes[seen], gap[seen], normals[seen]
    partner, xi = partner[seen], xi[seen]
    phi, _ = slave.basis(partner, slave.reference(partner, xi))
    other = np.einsum("nd,ndc->nc", phi, displacement[slave.dofs[partner]])
    moved = np.einsum("nc,nc->n", normals, displacement[nodes] - other)
    faces = faces[np.isin(faces, nodes).all(axis=1)]
    used = np.isin(nodes, faces)
    return MasterSurface(faces, nodes[used], (gap + moved)[used])
