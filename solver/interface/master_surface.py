"""The contact surface of the master: what a solution says at its nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railhead.solver.interface.jumps import Gap
from railhead.solver.space.cells import Array
from railhead.solver.space.facets import FacetSet, facet_closure
from railhead.solver.space.pairing import pair

ROUNDS = 4  # of following a normal
MISSED, FACETED = 0.1, 0.02  # of the gap and of a facet, by which a normal may miss its node


@dataclass(frozen=True)
class MasterSurface:
    """n nodes on f facets of the master at which normals of the slave end: facet_nodes (f, k), of
    each facet in `Fields.points`, corners first, basix order; nodes (n,) of all of them; gap (n,)
    mm between the deformed surfaces, along the slave's normal."""

    facet_nodes: NDArray[np.int64]
    nodes: NDArray[np.int64]
    gap: Array


def outer_nodes(facets: FacetSet) -> NDArray[np.int64]:
    """(m, k) nodes of each facet, corners first, basix order."""
    closure = facet_closure(facets.cell, facets.degree)
    return np.take_along_axis(facets.dofs, closure[facets.local_facet], axis=1)


def master_surface(
    slave: FacetSet, master: FacetSet, exact: Gap, points: Array, displacement: Array
) -> MasterSurface:
    """g0 + n . (u_master - u_slave) at the points of the slave whose normals end at the master's
    nodes; these are found by following the normal that the slave has there, until it meets.

    slave, master: facets of all ranks. points, displacement (n, 3) of all nodes, in space, mm.
    """
    faces = outer_nodes(master)
    nodes = np.unique(faces)
    kinematics = slave.kinematics
    placed = kinematics.flatten(points[nodes] - np.array(kinematics.offset))
    gap, normals = exact(points[nodes])
    for _ in range(ROUNDS):
        partner, xi = pair(placed, kinematics.flatten(normals), slave)
        seen = np.isfinite(gap) & (partner >= 0)
        nodes, placed, partner, xi = nodes[seen], placed[seen], partner[seen], xi[seen]
        below = slave.tangents(partner, xi)[0]
        gap, normals = exact(kinematics.lift(below))
    gap = np.where(np.isfinite(gap), gap, np.nan)
    missed = placed - below - gap[:, None] * kinematics.flatten(normals)
    size = np.linalg.norm(slave.vertices[partner, 1] - slave.vertices[partner, 0], axis=1)
    seen = np.linalg.norm(missed, axis=1) < MISSED * gap + FACETED * size
    nodes, gap, normals = nodes[seen], gap[seen], normals[seen]
    partner, xi = partner[seen], xi[seen]
    phi, _ = slave.basis(partner, slave.reference(partner, xi))
    other = np.einsum("nd,ndc->nc", phi, displacement[slave.dofs[partner]])
    moved = np.einsum("nc,nc->n", normals, displacement[nodes] - other)
    faces = faces[np.isin(faces, nodes).all(axis=1)]
    used = np.isin(nodes, faces)
    return MasterSurface(faces, nodes[used], (gap + moved)[used])
