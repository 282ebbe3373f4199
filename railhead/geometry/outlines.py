"""Closed cross-sections (y, z) of rail and wheel, as lines, arcs and splines for gmsh."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from railhead.geometry.profiles import Arc, Piece, Polynomial, Profile, data

Array = NDArray[np.float64]
SPACING, SAMPLES = 1.0, 20001  # mm between points of splines, and y where their length is taken


@dataclass(frozen=True)
class Curve:
    """A line (2 points), a circular arc (2 points and its centre) or a spline (more points).

    points: (n, 2) of (y, z) in mm. role: 'contact', 'support', 'symmetry' or 'free'.
    """

    points: Array
    role: str
    centre: Array | None = None

    @property
    def radius(self) -> float:
        """Of an arc in mm; infinite for others."""
        return math.inf if self.centre is None else math.dist(self.points[0], self.centre)

    def sampled(self) -> Array:
        """Points (n, 2) along the curve: 500 of an arc, else its own."""
        if self.centre is None:
            return self.points
        first, last = (np.arctan2(*(point - self.centre)[::-1]) for point in self.points[[0, -1]])
        angle = first + np.linspace(0, (last - first + np.pi) % (2 * np.pi) - np.pi, 500)
        return np.asarray(
            self.centre + self.radius * np.column_stack([np.cos(angle), np.sin(angle)])
        )

    def mirrored(self) -> Curve:
        """Reflected at y = 0, with its direction kept around the section."""
        flip = np.array([-1.0, 1.0])
        centre = None if self.centre is None else self.centre * flip
        return Curve(self.points[::-1] * flip, self.role, centre)

    def moved(self, rotation: Array, shift: Array) -> Curve:
        """Rotated (2, 2), then shifted (2,)."""
        centre = None if self.centre is None else rotation @ self.centre + shift
        return replace(self, points=self.points @ rotation.T + shift, centre=centre)


def _line(start: Array, end: Array, role: str) -> Curve:
    return Curve(np.array([start, end]), role)


def rail_section(name: str, extent: str, *, half: bool) -> list[Curve]:
    """54E1 or 60E1, whole ('section') or cut where the web begins ('head'); crown centre at (0, 0).

    half: only y >= 0, closed by a symmetry line. The order runs clockwise from the crown.
    """
    segments = data("rails.json")[name]["half_section"]
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
    """The same closed section with a sharp corner in place of each arc between two lines that has a
    smaller radius (mm).

    A corner of radius r that turns by t gains the area r^2 (tan(t/2) - t/2).
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
    """Depth of the cut below the crown of 54E1 or 60E1 where the web begins, mm."""
    segments = data("rails.json")[name]["half_section"]
    web = next(segment for segment in segments if segment["name"].startswith("web"))
    return float(segments[0]["start"][1] - web["start"][1])


def profile_curves(profile: Profile, start: float, end: float, *, outwards: int) -> list[Curve]:
    """The contact line z = outwards * profile between two y, piece by piece."""
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
    """y of points that are about SPACING apart along a piece, its ends included."""
    y = np.linspace(first, last, SAMPLES, dtype=np.float64)
    s = np.cumsum(np.hypot(np.diff(y, prepend=y[0]), np.diff(piece.derivative(y, 0), prepend=0.0)))
    s -= s[0]
    return np.interp(np.linspace(0, s[-1], max(5, math.ceil(s[-1] / SPACING)) + 1), s, y)


def block_section(
    profile: Profile, start: float, end: float, base: float, *, outwards: int, half: bool
) -> list[Curve]:
    """A block between the contact line and z = base; rail: outwards 1, wheel: outwards -1."""
    top = profile_curves(profile, start, end, outwards=outwards)
    first, last = top[0].points[0], top[-1].points[-1]
    right, left = np.array([last[0], base]), np.array([first[0], base])
    sides = [
        _line(last, right, "free"),
        _line(right, left, "support"),
        _line(left, first, "symmetry" if half else "free"),
    ]
    return [*top, *(line for line in sides if np.ptp(line.points, axis=0).max() > 1e-6)]
