"""Closed cross-sections (y, z) of rail and wheel, as lines, arcs and splines for gmsh."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from railhead.geometry.profiles import Arc, Piece, Polynomial, Profile, json_data
from railhead.theory.array_types import Array

SPACING, SAMPLES = 1.0, 20001  # mm between points of splines, and y where their length is taken


@dataclass(frozen=True)
class Curve:
    """A line, a circular arc or a spline; one part of a closed section in the (y, z) plane.

    points: (n, 2) of (y, z) in mm; two ends for a line or an arc, more points for a spline.
    role: of the face that it becomes: 'contact' may touch the other body, 'support' is held or
        loaded, 'symmetry' lies in a plane of symmetry, 'free' carries nothing.
    centre: (y, z) of the centre of an arc, mm, which takes the shorter way between its ends; None
        for a line or a spline.
    """

    points: Array
    role: str
    centre: Array | None = None

    @property
    def radius(self) -> float:
        """Radius of an arc, mm; infinite for a line or a spline."""
        return math.inf if self.centre is None else math.dist(self.points[0], self.centre)

    def sampled(self) -> Array:
        """Points (n, 2) of (y, z) along the curve, mm: 500 on an arc, from its first to its last
        point; else the points that define the curve.
        """
        if self.centre is None:
            return self.points
        first, last = (np.arctan2(*(point - self.centre)[::-1]) for point in self.points[[0, -1]])
        angle = first + np.linspace(0, (last - first + np.pi) % (2 * np.pi) - np.pi, 500)
        return np.asarray(
            self.centre + self.radius * np.column_stack([np.cos(angle), np.sin(angle)])
        )

    def mirrored(self) -> Curve:
        """The curve reflected at y = 0, with its points in reverse order, so that the direction
        around the section is kept.
        """
        flipped = self.moved(np.diag([-1.0, 1.0]), np.zeros(2))
        return replace(flipped, points=flipped.points[::-1])

    def moved(self, rotation: Array, shift: Array) -> Curve:
        """The curve rotated about the origin by a matrix (2, 2), then shifted by (y, z) in mm."""
        centre = None if self.centre is None else rotation @ self.centre + shift
        return replace(self, points=self.points @ rotation.T + shift, centre=centre)


def _line(start: Array, end: Array, role: str) -> Curve:
    """A straight curve from start to end, each (y, z) in mm. role: as `Curve.role`."""
    return Curve(np.array([start, end]), role)


def rail_section(name: str, extent: str, *, half: bool) -> list[Curve]:
    """Closed outline of the standard rail 54E1 or 60E1, upright, with the crown centre at (0, 0).
    extent: 'section' for the whole rail, 'head' for the part above the start of the web.
    half: whether only y >= 0 is returned, closed by a symmetry line.
    The order runs from the crown to y > 0 and around (clockwise with y to the right and z up). The
    contact curves are the three arcs on each half of the crown, the support is the bottom of the
    foot, or the cut of the head.
    """
    segments = json_data("rails.json")[name]["half_section"]
    top = np.array(segments[0]["start"])
    curves = []
    for index, segment in enumerate(segments):
        if extent == "head" and segment["name"].startswith("web"):
            break
        role = "contact" if index < 3 else "free"
        if segment["name"] == "foot bottom":
            role = "support"
        centre = np.array(segment["centre"]) - top if segment["kind"] == "arc" else None
        ends = np.array([segment["start"], segment["end"]]) - top
        curves.append(Curve(ends, role, centre))
    last = curves[-1].points[1]
    axis = np.array([0.0, last[1]])
    if extent == "head":
        curves.append(_line(last, axis, "support"))
    if half:
        return [*curves, _line(axis, np.zeros(2), "symmetry")]
    return [*curves, *(curve.mirrored() for curve in reversed(curves))]


def sharpened(section: list[Curve], radius: float) -> list[Curve]:
    """The closed section, of lines and arcs, with a sharp corner in place of each arc between two
    lines whose radius is below the given one (mm). Both lines keep their roles. A corner of radius
    r that turns by t gains the area r^2 (tan(t/2) - t/2).
    """
    made = list(section)
    for index, curve in enumerate(section):
        if curve.centre is None or curve.radius >= radius:
            continue
        before, after = index - 1, (index + 1) % len(section)
        if made[before].centre is None and made[after].centre is None:
            middle = curve.points.mean(axis=0) - curve.centre
            corner = curve.centre + middle * curve.radius**2 / (middle @ middle)
            made[before] = _line(made[before].points[0], corner, made[before].role)
            made[after] = _line(corner, made[after].points[1], made[after].role)
            made[index] = replace(curve, points=np.empty((0, 2)))
    return [curve for curve in made if len(curve.points)]


def head_depth(name: str) -> float:
    """Vertical distance from the crown of 54E1 or 60E1 to the start of the web, where a head alone
    is cut, mm. KeyError: another name.
    """
    segments = json_data("rails.json")[name]["half_section"]
    web = next(segment for segment in segments if segment["name"].startswith("web"))
    return float(segments[0]["start"][1] - web["start"][1])


def profile_curves(profile: Profile, start: float, end: float, *, outwards: int) -> list[Curve]:
    """Contact curves z = outwards * profile(y) from y = start to y = end (mm), one for each piece
    of the profile.
    outwards: 1 for a rail (z up), -1 for a wheel, whose profile counts outwards from the axle,
        downwards here.
    Arcs stay arcs, straight pieces stay lines; other pieces become splines with points about 1 mm
    apart.
    """
    curves: list[Curve] = []
    for piece in profile.pieces:
        first, last = max(start, piece.start), min(end, piece.end)
        if last - first < 1e-6:
            continue
        centre = None
        straight = isinstance(piece, Polynomial) and len(piece.coefficients) <= 2
        if isinstance(piece, Arc):
            centre = np.array([piece.centre_y, outwards * piece.centre_z])
        y = np.array([first, last])
        if not straight and centre is None:
            y = _even(piece, first, last)
        points = np.column_stack([y, outwards * piece.derivative(y, 0)])
        if curves:
            points[0] = curves[-1].points[-1]
        curves.append(Curve(points, "contact", centre))
    return curves


def _even(piece: Piece, first: float, last: float) -> Array:
    """y (n,) of points that are about 1 mm (SPACING) apart in arc length along a piece between y =
    first and y = last (mm), both included; at least six points.
    """
    y = np.linspace(first, last, SAMPLES, dtype=np.float64)
    s = np.cumsum(np.hypot(np.diff(y, prepend=y[0]), np.diff(piece.derivative(y, 0), prepend=0.0)))
    s -= s[0]
    return np.interp(np.linspace(0, s[-1], max(5, math.ceil(s[-1] / SPACING)) + 1), s, y)


def block_section(
    profile: Profile, start: float, end: float, base: float, *, outwards: int, half: bool
) -> list[Curve]:
    """Closed section of a block between the contact line z = outwards * profile(y), from y = start
    to end, and the level z = base, mm.
    outwards: 1 for a rail, -1 for a wheel, as in `profile_curves`.
    half: whether the side at y = start is a symmetry line, else a free one.
    The side at z = base is the support; sides shorter than 1e-6 mm are left out.
    """
    top = profile_curves(profile, start, end, outwards=outwards)
    first, last = top[0].points[0], top[-1].points[-1]
    right, left = np.array([last[0], base]), np.array([first[0], base])
    sides = [
        _line(last, right, "free"),
        _line(right, left, "support"),
        _line(left, first, "symmetry" if half else "free"),
    ]
    return [*top, *(line for line in sides if np.ptp(line.points, axis=0).max() > 1e-6)]


def disc(radius: float, depth: float, reach: float, *, half: bool) -> list[Curve]:
    """Closed outline of the lowest part of a wheel in the plane x, z, with points (x, z) in mm; its
    lowest point is (0, 0).
    radius: of the rolling circle, mm.
    depth: radial thickness of the ring segment, mm; from the radius on, the result is half a disc
        supported on its horizontal diameter.
    reach: length of the contact arc to each side, mm; no effect on half a disc.
    half: whether only x >= 0 is returned, with a curve of symmetry at x = 0.
    The outer arc has the role 'contact', the inner arc 'support', the ends 'free'.
    """
    axle = np.array([0.0, radius])
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
