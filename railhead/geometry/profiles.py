"""Transverse profiles z(y) of rail heads and wheel treads.

y is lateral (positive to the field side), z up for a rail (0 at the crown centre) and outwards from
the axle for a wheel (0 at the nominal rolling radius; positive makes the wheel larger).
A profile is a chain of pieces, each a circular arc or a polynomial or spline in y.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib import resources
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import make_interp_spline

STANDARD_RAILS = ("54E1", "60E1")  # EN 13674-1

Array = NDArray[np.float64]
STRAIGHT = 1e-9  # 1/mm, curvature of what counts as straight
CONES = {"cylinder": 0.0, "cone20": 1 / 20, "cone40": 1 / 40}


class Piece(Protocol):
    """One smooth part of a profile, for start <= y <= end."""

    @property
    def start(self) -> float:
        """First y, mm."""
        ...

    @property
    def end(self) -> float:
        """Last y, mm."""
        ...

    def derivative(self, y: Array, order: int) -> Array:
        """z (order 0), dz/dy (1) or d2z/dy2 (2)."""
        ...


@dataclass(frozen=True)
class Arc:
    """z = centre_z + side sqrt(r^2 - (y - centre_y)^2), side +1 (upper half) or -1."""

    start: float
    end: float
    centre_y: float
    centre_z: float
    radius: float
    side: int

    def derivative(self, y: Array, order: int) -> Array:
        offset = y - self.centre_y
        root = np.sqrt(np.maximum(self.radius**2 - offset**2, 1e-12 * self.radius**2))
        if order == 0:
            return self.centre_z + self.side * root
        return -self.side * (offset / root if order == 1 else self.radius**2 / root**3)


@dataclass(frozen=True)
class Polynomial:
    """z = sum c_k y^k."""

    start: float
    end: float
    coefficients: tuple[float, ...]

    @cached_property
    def _derivatives(self) -> tuple[np.polynomial.Polynomial, ...]:
        poly = np.polynomial.Polynomial(self.coefficients)
        return poly, poly.deriv(1), poly.deriv(2)

    def derivative(self, y: Array, order: int) -> Array:
        return np.asarray(self._derivatives[order](y), dtype=float)


@dataclass(frozen=True)
class Spline:
    """A scipy spline in y."""

    start: float
    end: float
    spline: Any

    def derivative(self, y: Array, order: int) -> Array:
        return np.asarray(self.spline(y, nu=order), dtype=float)


@dataclass(frozen=True)
class Profile:
    """A chain of pieces in ascending y; NaN outside of it."""

    name: str
    pieces: tuple[Piece, ...]

    @property
    def domain(self) -> tuple[float, float]:
        """First and last y, mm."""
        return self.pieces[0].start, self.pieces[-1].end

    @property
    def joints(self) -> list[float]:
        """y where two pieces meet, mm."""
        return [piece.start for piece in self.pieces[1:]]

    def _evaluate(self, y: ArrayLike, order: int) -> Array:
        y = np.asarray(y, dtype=float)
        out = np.full(y.shape, np.nan)
        for piece in self.pieces:
            inside = (y >= piece.start) & (y <= piece.end)
            if inside.any():
                out[inside] = piece.derivative(y[inside], order)
        return out

    def height(self, y: ArrayLike) -> Array:
        """z(y), mm."""
        return self._evaluate(y, 0)

    def slope(self, y: ArrayLike) -> Array:
        """dz/dy."""
        return self._evaluate(y, 1)

    def curvature(self, y: ArrayLike) -> Array:
        """1/mm, positive where the solid below z is convex: -z'' / (1 + z'^2)^(3/2)."""
        return np.asarray(-self._evaluate(y, 2) / (1 + self.slope(y) ** 2) ** 1.5)


@lru_cache
def data(name: str) -> dict[str, Any]:
    """A JSON file of this room's data folder."""
    file = resources.files("railhead.geometry") / "data" / name
    content: dict[str, Any] = json.loads(file.read_text())
    return content


def single_radius(radius: float, half_width: float, name: str = "arc") -> Profile:
    """A crown of one radius (mm; negative is concave, infinite is flat) with its top at y = 0."""
    if math.isinf(radius):
        return Profile(name, (Polynomial(-half_width, half_width, (0.0,)),))
    reach = min(half_width, 0.95 * abs(radius))
    side = 1 if radius > 0 else -1
    return Profile(name, (Arc(-reach, reach, 0.0, -radius, abs(radius), side),))


def cone(slope: float, half_width: float, name: str) -> Profile:
    """A conical tread: the wheel is larger on its flange side, y < 0."""
    return Profile(name, (Polynomial(-half_width, half_width, (0.0, -slope)),))


def s1002() -> Profile:
    """The S1002 wheel, zones A to H; flange at y < 0."""
    pieces: list[Piece] = []
    for zone in data("s1002.json")["zones"].values():
        start, end = zone["range"]
        if zone["kind"] == "arc":
            pieces.append(Arc(start, end, zone["yc"], zone["zc"], zone["r"], zone["sign"]))
        else:
            pieces.append(Polynomial(start, end, tuple(zone["c"])))
    return Profile("S1002", tuple(sorted(pieces, key=lambda piece: piece.start)))


def rail_head(name: str, inclination: float = 0.0) -> Profile:
    """Top of 54E1 or 60E1 (R300-R80-R13 on both sides), rolled about the crown centre.

    inclination: slope towards the track's centre (y < 0), as 1/20.
    """
    segments = data("rails.json")[name]["half_section"][:3]
    top = np.array(segments[0]["start"])
    c, s = _cos_sin(inclination)
    pieces: list[Piece] = []
    for mirror in (-1, 1):
        for segment in segments[::mirror]:
            centre = (np.array(segment["centre"]) - top) * [mirror, 1]
            ends = (np.array([segment["start"], segment["end"]]) - top) * [mirror, 1]
            radius = float(np.hypot(*(ends[0] - centre)))
            cy, cz = centre[0] * c - centre[1] * s, centre[0] * s + centre[1] * c
            start, end = sorted(ends[:, 0] * c - ends[:, 1] * s)
            # Keep what still faces upwards.
            start, end = max(start, cy - 0.999 * radius), min(end, cy + 0.999 * radius)
            pieces.append(Arc(start, end, cy, cz, radius, 1))
    return Profile(name, tuple(_join(pieces)))


def rolled(profile: Profile, slope: float) -> Profile:
    """The profile rolled about the origin by a slope; exact for a single arc, else resampled."""
    if not slope:
        return profile
    c, s = _cos_sin(slope)
    start, end = profile.domain
    if len(profile.pieces) == 1 and isinstance(profile.pieces[0], Arc):
        arc = profile.pieces[0]
        centre = (arc.centre_y * c - arc.centre_z * s, arc.centre_y * s + arc.centre_z * c)
        ends = np.array([start, end])
        first, last = ends * c - profile.height(ends) * s
        turned = Arc(float(first), float(last), *centre, arc.radius, arc.side)
        return Profile(profile.name, (turned,))
    y = np.linspace(start, end, 2001)
    z = profile.height(y)
    turned_y, turned_z = y * c - z * s, y * s + z * c
    spline = make_interp_spline(turned_y, turned_z, k=3)
    return Profile(profile.name, (Spline(turned_y[0], turned_y[-1], spline),))


def osculating(profile: Profile, y: float) -> Profile:
    """The circle of curvature of a profile at y (mm), as a profile; a straight line where the
    curvature is below STRAIGHT. Height, slope and curvature at y are the same."""
    start, end = profile.domain
    height, slope, curvature = (
        float(f(y)) for f in (profile.height, profile.slope, profile.curvature)
    )
    if abs(curvature) < STRAIGHT:
        return Profile(profile.name, (Polynomial(start, end, (height - slope * y, slope)),))
    radius, stretch = 1 / curvature, math.hypot(1.0, slope)
    centre = (y + radius * slope / stretch, height - radius / stretch)
    reach = 0.95 * abs(radius)
    start, end = max(start, centre[0] - reach), min(end, centre[0] + reach)
    side = 1 if curvature > 0 else -1
    return Profile(profile.name, (Arc(start, end, *centre, abs(radius), side),))


def _cos_sin(slope: float) -> tuple[float, float]:
    angle = math.atan(slope)
    return math.cos(angle), math.sin(angle)


def _join(pieces: list[Piece]) -> list[Piece]:
    """The two crown arcs of the halves are one arc."""
    joined: list[Piece] = []
    for piece in pieces:
        last = joined[-1] if joined else None
        if (
            isinstance(last, Arc)
            and isinstance(piece, Arc)
            and (abs(last.centre_y - piece.centre_y) + abs(last.centre_z - piece.centre_z) < 1e-9)
        ):
            joined[-1] = Arc(last.start, piece.end, last.centre_y, last.centre_z, last.radius, 1)
        else:
            joined.append(piece)
    return joined
