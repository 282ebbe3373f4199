"""Sections meshed as they are: outlines in the plane along the rail, and gmsh surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railhead.geometry.outlines import Curve
from railhead.geometry.profiles import Profile
from railhead.meshing.bodies import Body, Options
from railhead.meshing.tags import CONTACT, SUPPORT, SYMMETRY_X, SYMMETRY_Y

Array = NDArray[np.float64]


def wire(body: Body, *, flat: bool = False) -> list[int]:
    """Closed chain of gmsh curves of the body's section; flat: in gmsh's plane z = 0."""
    import gmsh

    occ = gmsh.model.occ

    def point(yz: Array) -> int:
        x, y, z = body.pose.outward(np.array([0.0, *yz]))
        return int(occ.addPoint(y, z, 0.0) if flat else occ.addPoint(x, y, z))

    section = body.section
    corners = [point(curve.points[0]) for curve in section]
    tags = []
    for index, curve in enumerate(section):
        start, end = corners[index], corners[(index + 1) % len(corners)]
        if curve.centre is not None:
            tags.append(occ.addCircleArc(start, point(curve.centre), end))
        elif len(curve.points) == 2:
            tags.append(occ.addLine(start, end))
        else:
            inner = [point(yz) for yz in curve.points[1:-1]]
            tags.append(occ.addSpline([start, *inner, end]))
    return tags


def surface(body: Body, options: Options, groups: dict[tuple[int, int], list[int]]) -> None:
    """Add the section of a body in gmsh's plane z = 0, with the tags of its edges."""
    import gmsh

    curves = wire(body, flat=True)
    loop = gmsh.model.occ.addCurveLoop(curves)
    groups.setdefault((2, body.tag), []).append(gmsh.model.occ.addPlaneSurface([loop]))
    symmetry = SYMMETRY_X if options.plane == "xz" else SYMMETRY_Y
    tags = {"contact": CONTACT + body.tag, "support": SUPPORT + body.tag, "symmetry": symmetry}
    for curve, number in zip(body.section, curves, strict=True):
        if curve.role in tags:
            groups.setdefault((1, tags[curve.role]), []).append(number)


def disc(radius: float, depth: float, reach: float, height: float, *, half: bool) -> list[Curve]:
    """The lowest part of a wheel in the plane x, z, with its lowest point at (0, height).

    A ring segment of the given depth, +-reach long on its contact arc and held on the inner one;
    where the depth is the radius, half a disc held on its diametral plane.
    """
    axle = np.array([0.0, height + radius])
    whole = depth >= radius
    end = np.pi / 2 if whole else reach / radius

    def at(distance: float, angle: float) -> Array:
        return axle + distance * np.array([np.sin(angle), -np.cos(angle)])

    def arcs(distance: float, angles: list[float], role: str) -> list[Curve]:
        pairs = zip(angles[:-1], angles[1:], strict=True)
        return [Curve(np.array([at(distance, a), at(distance, b)]), role, axle) for a, b in pairs]

    angles = [0.0, end] if half else [-end, 0.0, end]
    outer = arcs(radius, angles, "contact")
    first, last = outer[0].points[0], outer[-1].points[1]
    if whole:
        left = axle if half else at(radius, -end)
        curves = [*outer, Curve(np.array([last, left]), "support")]
    else:
        inner = arcs(radius - depth, angles[::-1], "support")
        left = inner[-1].points[1]
        curves = [*outer, Curve(np.array([last, inner[0].points[0]]), "free"), *inner]
    if half:
        return [*curves, Curve(np.array([left, first]), "symmetry")]
    return curves if whole else [*curves, Curve(np.array([left, first]), "free")]


def flipped(section: list[Curve]) -> list[Curve]:
    """Upside down."""
    flip = np.array([1.0, -1.0])
    return [
        Curve(c.points * flip, c.role, None if c.centre is None else c.centre * flip)
        for c in section
    ]


@dataclass(frozen=True)
class StraightTread:
    """A wheel of infinite rolling radius: the same profile everywhere along the rail, solid above.

    lift: height of the nominal rolling radius, mm; shift: y of its profile's origin, mm.
    """

    profile: Profile
    lift: float
    shift: float = 0.0

    def implicit(self, points: Array) -> tuple[Array, Array]:
        """See `geometry.surfaces.Surface`."""
        y = points[:, 1] - self.shift
        one = np.ones_like(y)
        gradient = np.column_stack([0.0 * one, -self.profile.slope(y), -one])
        return self.lift - self.profile.height(y) - points[:, 2], gradient
