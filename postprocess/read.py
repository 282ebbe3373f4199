"""All results of a solution in one call: patch, surface fields and stresses, on the axes below the
patches and where they are largest; and measures of their quality: noise of the pressure, elements
over the patch, distance from edges.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import (
    COLUMN,
    ROW,
    SYMMETRIC,
    Array,
    DepthAxis,
    Findings,
    Frame,
    Largest,
    Patch,
)
from railhead.postprocess.patch import patch
from railhead.postprocess.patch.moments import moments
from railhead.postprocess.patch.separate_patches import (
    SeparatePatch,
    contact_frame,
    separate_patches,
)
from railhead.postprocess.stress.body_geometry import Solid
from railhead.postprocess.stress.peaks import Search
from railhead.postprocess.stress.recovery import Recovery
from railhead.postprocess.symmetry import ON_PLANE
from railhead.solver.system.fields import Fields
from railhead.theory.elastic.subsurface import max_shear, von_mises

DEPTH_POINTS = 121  # on an axis
DEPTH_REACH = 3.0  # largest depth over the smaller semi-axis
BORDER_POINTS = 8  # on each edge of a facet
FACET_SIDES = {
    "tetrahedron": [[0, 1], [1, 2], [2, 0]],
    "hexahedron": [[0, 1], [1, 3], [3, 2], [2, 0]],
}
"""By cell of a solid: corners of a facet at the ends of its sides; of a section its own ends."""


def findings(
    fields: Fields,
    frame: Frame,
    *,
    parabolic: bool = False,
    stresses: bool = True,
) -> Findings:
    """Read the patch, the smooth fields on the contact surfaces and the stresses in every meshed
    body out of a solution.

    fields: the solution, in which some contact points carry pressure.
    frame: axes at the first contact; those of the most loaded patch are used instead where it has a
        plane of its own (`contact_frame`).
    parabolic: whether Hertz's theory is exact, that is for elastic half-spaces whose gap is
        quadratic; second moments of the pressure then give the semi-axes.
    stresses: whether stresses in the bodies are read.
    Subject, notes and dissipated energy of the findings are left at their defaults.
    """
    separate = separate_patches(fields)
    frame = contact_frame(separate, frame)
    found = patch.read(fields, separate, frame, parabolic=parabolic)
    solids = {
        name: Solid(fields, np.flatnonzero(fields.body == tag))
        for tag, name in BODY_NAMES.items()
        if np.any(fields.body == tag)
    }
    edges = np.concatenate([solid.sharp_edges() for solid in solids.values()])
    found = replace(
        found,
        elements_across=elements_across(fields, frame, found.patch),
        edge_distance=edge_distance(fields, found.patch, edges),
    )
    return with_stresses(found, fields, solids, edges, separate[1:]) if stresses else found


def elements_across(fields: Fields, frame: Frame, patch: Patch) -> tuple[float, float]:
    """Number of elements over the length (along x) and over the width (along s) of the most loaded
    patch.

    Each is the extent of the patch over the mean extent of the facets with pressure around it. It
    is 1 across a plane section; both are equal in a meridian section.
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
    ring = FACET_SIDES.get(fields.cell, [[0], [1]])
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
    half = min((patch.a, patch.b)[axis] for axis in fields.kinematics.varying)
    return float(distance.min() / half)


def with_stresses(
    found: Findings,
    fields: Fields,
    solids: Mapping[str, Solid],
    edges: Array,
    others: list[SeparatePatch],
) -> Findings:
    """Findings with the smooth stresses in the bodies, below the patches and where they are
    largest.

    solids: by body name. edges (n, 3): points on the sharp edges of all bodies, mm. others: the
        patches but the most loaded one.
    """
    frame, patch = found.frame, found.patch
    flat = fields.kinematics.dim == 2
    size = moments(fields, frame).a if flat else min(patch.a, patch.b)
    bodies = {name: (solid, Recovery(fields, solid.cells)) for name, solid in solids.items()}
    axes = {
        name: _below(*body, frame, patch.centre, name, size * DEPTH_REACH)
        for name, body in bodies.items()
    }
    shown = next(iter(bodies))
    also = tuple(
        _below(*bodies[shown], part.frame, (0.0, 0.0), shown, min(part.a, part.b) * DEPTH_REACH)
        for part in others
    )
    largest = {
        name: _largest(Search(fields, *body, edges, size), axes[name])
        for name, body in bodies.items()
    }
    misfit = max(
        bodies[name][1].misfit(np.array(peak.place))
        for name, each in largest.items()
        for peak in (each.tau, each.von_mises)
    )
    return replace(found, depth=axes, also=also, largest=largest, misfit=misfit)


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
