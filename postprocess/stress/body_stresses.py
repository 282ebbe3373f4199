"""Stresses inside the bodies: on the axes below the patches, and the largest anywhere.

With friction the tangential strain has a cusp at the border between the zones of stick and slip: it
is smooth in the zone of stick and has an infinite slope in the zone of slip. For a line contact of
half width w, of which half the zone of stick is c, the stress at the border is
xx = -p - 2 mu p0 (1 - c/w) (Carter's tractions). A polynomial through both zones cuts the cusp off.
There the strain in the surface is that of elements that stick, next to the border, and the traction
is that of the slipping points beside them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from railhead.meshing.bodies import BODY_NAMES, RAIL
from railhead.postprocess.findings import (
    COLUMN,
    ROW,
    SYMMETRIC,
    Array,
    DepthAxis,
    Frame,
    Largest,
    Peak,
)
from railhead.postprocess.patch.separate_patches import SeparatePatch
from railhead.postprocess.stress.body_geometry import Solid
from railhead.postprocess.stress.peaks import Search
from railhead.postprocess.stress.recovery import Recovery
from railhead.solver.system.fields import Fields
from railhead.solver.system.solution import FrictionSolution
from railhead.theory.elastic.subsurface import max_shear, von_mises

DEPTH_POINTS = 121  # on an axis
DEPTH_REACH = 3.0  # largest depth over the smaller semi-axis
INNER = 0.6  # of the way from the middle of a facet to its nodes: where it sticks or slips


@dataclass(frozen=True, kw_only=True)
class BodyStresses:
    """Stresses inside all meshed bodies.

    axes: by body name, the stresses along the normal into the body from the centre of the most
        loaded patch.
    other_axes: the same from the centres of the other patches, in the rail, or in the wheel if the
        rail is rigid.
    largest: by body name, the largest stresses anywhere, with those near sharp edges apart.
    edges (n, 3): points in space on the sharp edges of all bodies, mm.
    misfit: largest relative difference of mean smooth and mean element stress around the places of
        the largest stresses, all components together.
    """

    axes: dict[str, DepthAxis]
    other_axes: tuple[DepthAxis, ...]
    largest: dict[str, Largest]
    edges: Array
    misfit: float


def read(
    fields: Fields,
    frame: Frame,
    centre: tuple[float, float],
    size: float,
    others: list[SeparatePatch],
    friction_solution: FrictionSolution | None,
) -> BodyStresses:
    """Smooth stresses in the bodies, below the patches and where they are largest.

    centre: (x, s) of the most loaded patch in the frame, mm. size: its smaller semi-axis, mm.
        others: the other patches. friction_solution: tractions, or None. With friction,
        stresses at the border of the stick zone replace lower peaks; a smooth field would cut off
        the cusp there.
    """
    bodies = {}
    for tag, name in BODY_NAMES.items():
        cells = np.flatnonzero(fields.body == tag)
        if len(cells):
            bodies[name] = Solid(fields, cells), Recovery(fields, cells)
    axes = {
        name: _below(*body, frame, centre, name, size * DEPTH_REACH)
        for name, body in bodies.items()
    }
    shown = next(iter(bodies))
    also = tuple(
        _below(*bodies[shown], part.frame, (0.0, 0.0), shown, min(part.a, part.b) * DEPTH_REACH)
        for part in others
    )
    edges = np.concatenate([solid.sharp_edges() for solid, _ in bodies.values()])
    largest = {
        name: _largest(Search(fields, *body, edges, size), axes[name])
        for name, body in bodies.items()
    }
    if friction_solution is not None:
        largest = {
            name: _or_border(each, *_border_stresses(fields, *bodies[name], friction_solution))
            for name, each in largest.items()
        }
    misfit = max(
        bodies[name][1].misfit(np.array(peak.place))
        for name, each in largest.items()
        for peak in (each.tau, each.von_mises)
    )
    return BodyStresses(axes=axes, other_axes=also, largest=largest, edges=edges, misfit=misfit)


def _below(
    solid: Solid,
    recovery: Recovery,
    frame: Frame,
    centre: tuple[float, float],
    name: str,
    reach: float,
) -> DepthAxis:
    """Stresses on the axis below a point of the tangent plane, in the frame, as deep as the body
    goes, at most to `reach`, mm.

    solid: cells of the body. recovery: smooth stresses of the body. centre: (x, s) of the point in
        the frame, mm. name: of the body, 'rail' or 'wheel'.
    """
    start, into = frame.place(*centre), frame.axes[2] * (-1.0 if name == "rail" else 1.0)
    depth = np.linspace(
        0.0, solid.extent(np.array(start), into, reach), DEPTH_POINTS, dtype=np.float64
    )
    stress = recovery.at(start + depth[:, None] * into)
    stress = (frame.axes @ np.take(stress, SYMMETRIC, axis=1) @ frame.axes.T)[:, ROW, COLUMN]
    return DepthAxis(name, depth, stress, (start, (float(into[0]), float(into[1]), float(into[2]))))


def _largest(search: Search, axis: DepthAxis) -> Largest:
    """Largest shear and von Mises stress of one body, by a search in its cells. If all of the body
    is near sharp edges, they are the largest ones on its depth axis.
    """
    spare = axis.largest
    tau = search.highest(max_shear, np.array([spare.tau.place])) or spare.tau
    mises = search.highest(von_mises, np.array([spare.von_mises.place])) or spare.von_mises
    edges = search.at_edges(max_shear, tau.value), search.at_edges(von_mises, mises.value)
    return Largest(tau, mises, edges)


def _or_border(largest: Largest, places: Array, stress: Array) -> Largest:
    """Largest stresses with each peak replaced by the largest stress at the border of stick where
    that is higher; the depth is then zero.

    places (n, 3): points at the border, mm. stress (n, 6): there, MPa.
    """

    def higher(peak: Peak, values: Array) -> Peak:
        """The peak, or the largest of values (n,) in MPa at the border where it is higher."""
        if values.max(initial=0.0) <= peak.value:
            return peak
        x, y, z = (float(each) for each in places[np.argmax(values)])
        return Peak(float(values.max()), 0.0, (x, y, z))

    tau, mises = max_shear(stress), von_mises(stress)
    return replace(
        largest, tau=higher(largest.tau, tau), von_mises=higher(largest.von_mises, mises)
    )


def _border_stresses(
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
    places, nodes, cells = _border_facets(fields, solid)
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
    return friction_solution.points[slipping], _at_border(
        fields, solid, recovery, cells[facet], friction_solution, slipping
    )


def _border_facets(fields: Fields, solid: Solid) -> tuple[Array, Array, NDArray[np.int64]]:
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


def _at_border(
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
