"""Separate patches of a contact, each in its own tangent plane."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from railhead.meshing.bodies import RAIL
from railhead.postprocess.findings import Array, Frame, has_own_plane

if TYPE_CHECKING:
    from railhead.solver.system.fields import Fields

SMALLEST = 0.002  # share of the force: less is a few points that open and close, no patch


@dataclass(frozen=True, kw_only=True)
class SeparatePatch:
    """One connected contact patch of a solid, with its images in the symmetry planes that it
    touches.

    fields: the solution, with only the contact points of this patch and only the symmetry planes
        that it touches; cells, nodes and contact facets are all there.
    frame: tangent plane of the patch, with its origin at the centre of pressure.
    a, b: largest distances of its contact points from that centre along x and s, mm.
    force: integral of the pressure over the patch, images included, N.
    share: that force over the force on all patches and their images in all planes. An image in a
        plane that its patch does not touch counts in the second force alone.
    """

    fields: Fields
    frame: Frame
    a: float
    b: float
    force: float
    share: float

    @property
    def centre(self) -> tuple[float, float, float]:
        """Centre of pressure in space (x, y, z), mm."""
        return self.frame.origin


def separate_patches(fields: Fields) -> list[SeparatePatch]:
    """Split the contact points with pressure into connected patches, most loaded first.

    Facets with pressure that share a node belong to one patch. A patch beside a symmetry plane that
    does not touch it is listed once, without its image. Patches with at most 0.2 % (SMALLEST) of
    the force are left out. Empty for a section.
    """
    if fields.kinematics.dim == 2:
        return []
    contact = fields.contact
    force = contact.weights * np.maximum(contact.pressure, 0.0)
    of_facet = _components(contact.facet_nodes, np.unique(contact.facet[force > 0]))
    of_point = np.where(force > 0, of_facet[contact.facet], -1)
    found = [_part(fields, of_point == number, force) for number in range(of_facet.max() + 1)]
    found = [part for part in found if part.share > SMALLEST]
    return sorted(found, key=lambda part: -part.force)


def contact_frame(separate: list[SeparatePatch], first: Frame) -> Frame:
    """Axes of the results: those of the most loaded patch where it has a plane of its own
    (`has_own_plane`), else `first`, those at the first contact. separate: patches, most loaded
    first; empty for a section.
    """
    own = has_own_plane([each.frame.angle for each in separate], first.angle)
    return separate[0].frame if own else first


def _components(facet_nodes: NDArray[np.int64], used: NDArray[np.int64]) -> NDArray[np.int64]:
    """(f,) number of the connected set of facets that each facet belongs to, -1 for facets not in
    `used`. Facets that share a node are connected. facet_nodes (f, k): nodes of each facet.
    used: rows of the facets with pressure.
    """
    nodes = facet_nodes[used]
    rows = np.repeat(np.arange(len(used)), nodes.shape[1])
    shape = (len(used), facet_nodes.max() + 1)
    incidence = sp.csr_matrix((np.ones(nodes.size), (rows, nodes.ravel())), shape=shape)
    numbers = np.full(len(facet_nodes), -1, dtype=np.int64)
    numbers[used] = connected_components(incidence @ incidence.T, directed=False)[1]
    return numbers


def _part(fields: Fields, members: NDArray[np.bool_], force: Array) -> SeparatePatch:
    """The patch with those contact points that `members` (q,) marks. force (q,): normal force at
    all contact points, N.
    """
    contact, own = fields.contact, force[members]
    names = ("points", "weights", "pressure", "indicator", "gap", "normals", "facet", "xi")
    contact = replace(contact, **{name: getattr(contact, name)[members] for name in names})
    # A plane touches the patch that has points less than 0.2 times as far as its farthest one.
    away = {plane: np.abs(contact.points @ np.array(plane)) for plane in fields.mirrors}
    mirrors = tuple(plane for plane, each in away.items() if each.min() < 0.2 * each.max())
    outward = 1.0 if fields.slave == RAIL else -1.0
    normal = outward * np.average(contact.normals, axis=0, weights=own)
    centre = np.average(contact.points, axis=0, weights=own)
    for plane in mirrors:
        keep = 1.0 - np.abs(plane)
        normal, centre = normal * keep, centre * keep
    frame = Frame(
        (float(centre[0]), float(centre[1]), float(centre[2])),
        float(np.arctan2(-normal[1], normal[2])),
    )
    a, b = (float(reach) for reach in np.abs(frame.local(contact.points)[:, :2]).max(axis=0))
    total, whole = own.sum() * 2 ** len(mirrors), force.sum() * 2 ** len(fields.mirrors)
    return SeparatePatch(
        fields=replace(fields, contact=contact, mirrors=mirrors),
        frame=frame,
        a=a,
        b=b,
        force=float(total),
        share=float(total / whole),
    )
