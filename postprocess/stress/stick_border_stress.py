"""Stresses at the border between the zones of stick and slip of a contact with friction.

The tangential strain has a cusp there: it is smooth in the zone of stick and has an infinite slope
in the zone of slip. For a line contact of half width w, of which half the zone of stick is c, the
stress at the border is xx = -p - 2 mu p0 (1 - c/w) (Carter's tractions). A polynomial through
both zones cuts the cusp off. Here the strain in the surface is that of elements that stick, next to
the border, and the traction is that of the slipping points beside them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from railhead.meshing.bodies import RAIL
from railhead.postprocess.findings import COLUMN, ROW, SYMMETRIC, Array
from railhead.postprocess.stress.body_geometry import Solid
from railhead.postprocess.stress.recovery import Recovery
from railhead.solver.system.fields import Fields
from railhead.solver.system.solution import FrictionSolution

INNER = 0.6  # of the way from the middle of a facet to its nodes: where it sticks or slips


def stresses(
    fields: Fields, solid: Solid, recovery: Recovery, friction_solution: FrictionSolution
) -> tuple[Array, Array]:
    """Places (n, 3) on the surface of one body at the border of stick and slip, mm, and stresses
    (n, 6) there, MPa. Components are xx, yy, zz, xy, xz, yz in global axes, tension positive. The
    places are contact points that slip beside facets that stick.

    solid: cells of the body. recovery: stresses at their Gauss points. friction_solution:
        tractions. Both arrays are empty where all points stick or all slip, or where a body has
        yielded.
    """
    slips = (friction_solution.pressure > 0) & ~friction_solution.sticks
    places, nodes, cells = _facets(fields, solid)
    if fields.plastic_strain is not None or not (slips.any() and len(cells)):
        return np.zeros((0, 3)), np.zeros((0, 6))
    nearest = cKDTree(friction_solution.points).query(places)[1]
    whole = friction_solution.sticks[nearest].all(axis=1)
    places, cells, nodes = places[whole], cells[whole], nodes[whole]
    points = np.flatnonzero(slips)
    distance, beside = cKDTree(friction_solution.points[points]).query(places)
    facet = np.flatnonzero(distance.min(axis=1, initial=np.inf) < np.ptp(nodes, axis=1).max(axis=1))
    sample = distance[facet].argmin(axis=1)
    slipping = points[beside[facet, sample]]
    return friction_solution.points[slipping], _assembled(
        fields, solid, recovery, cells[facet], friction_solution, slipping
    )


def _facets(fields: Fields, solid: Solid) -> tuple[Array, Array, NDArray[np.int64]]:
    """Points, nodes and cells of the f facets of a body on the slave's contact surface, or on the
    part of the master's that faces it. Each facet has k nodes, those on its edges included.

    Points (f, k, 3), mm: at 0.6 (INNER) of the way from the facet's middle to each node. Nodes (f,
    k, 3), mm. Cells (f,): rows in the solid. All are empty where the body has no meshed
    contact surface.
    """
    own = fields.body[solid.cells[0]] == fields.slave
    surface = fields.contact if own else fields.master_surface
    if surface is None:
        return np.zeros((0, 1, 3)), np.zeros((0, 1, 3)), np.zeros(0, dtype=np.int64)
    on = np.isin(solid.nodes, surface.facet_nodes)
    cells = np.flatnonzero(on.sum(axis=1) == surface.facet_nodes.shape[1])
    nodes = fields.points[solid.nodes[cells][on[cells]].reshape(len(cells), -1)]
    middle = nodes.mean(axis=1, keepdims=True)
    return middle + INNER * (nodes - middle), nodes, cells


def _assembled(
    fields: Fields,
    solid: Solid,
    recovery: Recovery,
    cells: Array,
    friction_solution: FrictionSolution,
    slipping: Array,
) -> Array:
    """Stress (n, 6), MPa, at slipping points beside cells that stick, from the stress s_e of the
    cell, and the pressure p and the traction t on the rail at the point:

        s = P s_e P + nu/(1 - nu) (-p - n.s_e.n) P - p n n + t n + n t,   P = 1 - n n

    n is the outward normal of the rail, nu Poisson's ratio. The second term changes the stress in
    the surface, P s_e P, to the pressure p at the same strain in the surface. The pressure is the
    mean over the contact points as near as the cell is large.

    cells (n,): rows in the solid. slipping (n,): rows of the contact points in `friction_solution`.
    """
    contact, at = fields.contact, friction_solution.points[slipping]
    normal = contact.normals[cKDTree(contact.points).query(at)[1]]
    normal = normal if fields.slave == RAIL else -normal
    touching = np.flatnonzero(friction_solution.pressure > 0)
    tree = cKDTree(friction_solution.points[touching])
    around = tree.query_ball_point(friction_solution.points[slipping], solid.sizes[cells])
    p = np.array([friction_solution.pressure[touching[each]].mean() for each in around])
    traction = (
        friction_solution.traction[slipping] * (p / friction_solution.pressure[slipping])[:, None]
    )
    gauss, own = recovery.points[cells], recovery.stress[cells]
    middle, mean = gauss.mean(axis=1, keepdims=True), own.mean(axis=1, keepdims=True)
    slope = np.linalg.pinv(gauss - middle, rcond=1e-9) @ (own - mean)
    own = (mean + (at[:, None] - middle) @ slope)[:, 0]
    tensor = np.take(own, SYMMETRIC, axis=1)
    nn = normal[:, :, None] * normal[:, None, :]
    plane = np.eye(3) - nn
    lam, mu = fields.lame[solid.cells[cells]].T
    ratio = lam / (lam + 2 * mu)  # nu/(1 - nu)
    more = ratio * (-p - np.einsum("ni,nij,nj->n", normal, tensor, normal))
    shear = traction[:, :, None] * normal[:, None, :]
    tensor = plane @ tensor @ plane + more[:, None, None] * plane - p[:, None, None] * nn
    return np.asarray((tensor + shear + shear.transpose(0, 2, 1))[:, ROW, COLUMN])
