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
    """Add the section of a body to gmsh's current model; returns the tags of its curves, a closed
    chain in the order of `body.section`.

    flat: whether the section is drawn in gmsh's plane z = 0, with y and z as gmsh's x and y,
        instead of in its place in space. A curve with a centre becomes a circular arc, one with two
        points a line, any other a spline.
    """
    import gmsh

    occ = gmsh.model.occ

    def point(yz: Array) -> int:
        """gmsh tag of a new point at (y, z) in the body's coordinates, mm."""
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
    """Add the section of a body to gmsh's current model as a surface in gmsh's plane z = 0.

    groups: (dimension, physical tag) -> gmsh entities; the surface and its contact, support and
        symmetry edges are added to it.
    """
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
    """Outline of the lowest part of a wheel in the plane x, z: a closed chain of curves with points
    (x, z), mm.

    radius: of the rolling circle, mm.
    depth: radial thickness of the ring segment, mm; from the radius on, the result is half a disc
        supported on its horizontal diameter.
    reach: length of the contact arc to each side, mm.
    height: z of the lowest point, which has x = 0, mm.
    half: whether only x >= 0 is returned, with a curve of symmetry at x = 0.
    The outer arc has the role 'contact', the inner arc 'support', the ends 'free'.
    """
    axle = np.array([0.0, height + radius])
    whole = depth >= radius
    end = np.pi / 2 if whole else reach / radius

    def at(distance: float, angle: float) -> Array:
        """Point (x, z) at a distance from the axle (mm) and an angle from the downward vertical
        (rad).
        """
        return axle + distance * np.array([np.sin(angle), -np.cos(angle)])

    def arcs(distance: float, angles: list[float], role: str) -> list[Curve]:
        """Circular arcs about the axle between successive angles (rad), at a distance from it
        (mm).
        """
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
    """The section mirrored upside down: z of all points and centres changes its sign; the roles
    stay.
    """
    flip = np.array([1.0, -1.0])
    return [
        Curve(c.points * flip, c.role, None if c.centre is None else c.centre * flip)
        for c in section
    ]


@dataclass(frozen=True)
class StraightTread:
    """A wheel of infinite rolling radius: the same profile at every x, and solid above it.

    profile: profile of the wheel; its height counts downwards from the nominal rolling radius, mm.
    lift: z of the nominal rolling radius, mm.
    shift: y of the origin of the profile, mm.
    """

    profile: Profile
    lift: float
    shift: float = 0.0

    def implicit(self, points: Array) -> tuple[Array, Array]:
        """Function that is zero on the tread and grows downwards out of the wheel, and its
        gradient.

        points: (n, 3) mm. Returns lift - height(y - shift) - z (n,) in mm, negative inside the
            wheel, and its gradient (n, 3).
        """
        y = points[:, 1] - self.shift
        one = np.ones_like(y)
        gradient = np.column_stack([0.0 * one, -self.profile.slope(y), -one])
        return self.lift - self.profile.height(y) - points[:, 2], gradient
