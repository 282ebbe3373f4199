"""All results of a solution in one call: patch, surface fields and stresses; and measures of their
quality: noise of the pressure, elements over the patch, distance from edges.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from railhead.postprocess.findings import Array, Findings, Frame, Patch
from railhead.postprocess.patch import patch, section
from railhead.postprocess.patch.separate_patches import contact_frame, separate_patches
from railhead.postprocess.stress import body_stresses
from railhead.postprocess.symmetry import ON_PLANE
from railhead.solver.system.fields import Fields

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
    flat = fields.kinematics.dim == 2
    separate = separate_patches(fields)
    frame = contact_frame(separate, frame)
    if flat:
        reading = section.read(fields, frame, parabolic=parabolic)
    else:
        reading = patch.read(fields, separate, frame, parabolic=parabolic)
    found, shape = reading.patch, reading.moments
    size = shape.a if flat else min(found.a, found.b)
    stress = body_stresses.read(fields, frame, found.centre, size, separate[1:], wanted=stresses)
    elements = elements_across(fields, frame, found)
    return Findings(
        frame=frame,
        patch=found,
        surface=reading.surfaces[0],
        opposite=reading.surfaces[1],
        depth=stress.axes,
        also=stress.other_axes,
        largest=stress.largest,
        misfit=stress.misfit,
        along=reading.along,
        across=reading.across,
        shape_error=shape.shape_error,
        hertzian=shape.hertzian and len(separate) < 2,
        noise=noise(fields, reading.recovered_pressure),
        elements_across=elements,
        edge_distance=edge_distance(fields, found, stress.edges),
    )


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
