"""Transverse profiles z(y) of rail heads and wheel treads, new and worn.

y is lateral (positive to the field side), z up for a rail (0 at the crown centre) and outwards from
the axle for a wheel (0 at the nominal rolling radius; positive makes the wheel larger).
A profile is a chain of pieces, each a circular arc or a polynomial or spline in y.
"""

import json
import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from importlib import resources
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline, make_interp_spline

from railhead.theory.array_types import Array, Mask

STANDARD_RAILS = ("54E1", "60E1")  # EN 13674-1

FACES_UP = 0.999  # of the radius: as far from its centre an arc faces upwards
CONES = {"cylinder": 0.0, "cone20": 1 / 20, "cone40": 1 / 40}
DENSE = 20  # places between two of `places_along`, over which the length is summed
STEEP = 15.0  # deg: steeper parts with y < 0 are the gauge corner, or the flange
FLANGE_HEIGHT = 10.0  # mm over the tape circle, at which EN 13715 measures the flange
PARTS = {"rail": ("crown", "gauge_corner"), "wheel": ("tread", "flange")}


class Piece(Protocol):
    """One smooth part of a profile, for start <= y <= end.
    start, end: first and last y, mm.
    """

    @property
    def start(self) -> float:
        """First y of the piece, mm."""
        ...

    @property
    def end(self) -> float:
        """Last y of the piece, mm."""
        ...

    def derivative(self, y: Array, order: int) -> Array:
        """z in mm (order 0), dz/dy (order 1) or d2z/dy2 in 1/mm (order 2) at y (n,) in mm."""
        ...


@dataclass(frozen=True)
class Arc:
    """Circular arc z = centre_z + side sqrt(radius^2 - (y - centre_y)^2).
    start, end: first and last y, mm.
    centre_y, centre_z: centre of the circle, mm.
    radius: radius of the circle, mm, positive.
    side: +1 for the upper half of the circle, -1 for the lower one.
    """

    start: float
    end: float
    centre_y: float
    centre_z: float
    radius: float
    side: int

    def derivative(self, y: Array, order: int) -> Array:
        """z in mm (order 0), dz/dy (order 1) or d2z/dy2 in 1/mm (order 2) at y (n,) in mm; the root
        stays positive beyond the circle.
        """
        offset = y - self.centre_y
        root = np.sqrt(np.maximum(self.radius**2 - offset**2, 1e-12 * self.radius**2))
        if order == 0:
            return self.centre_z + self.side * root
        return -self.side * (offset / root if order == 1 else self.radius**2 / root**3)


@dataclass(frozen=True)
class Polynomial:
    """Polynomial z = sum of c_k y^k, in mm.
    start, end: first and last y, mm.
    coefficients: c_0, c_1, ... of the powers of y.
    """

    start: float
    end: float
    coefficients: tuple[float, ...]

    @cached_property
    def _derivatives(self) -> tuple[Array, ...]:
        """Coefficients of the polynomial, of its first and of its second derivative."""
        poly = np.polynomial.Polynomial(self.coefficients)
        return poly.coef, poly.deriv(1).coef, poly.deriv(2).coef

    def derivative(self, y: Array, order: int) -> Array:
        """z in mm (order 0), dz/dy (order 1) or d2z/dy2 in 1/mm (order 2) at y (n,) in mm."""
        return np.asarray(np.polynomial.polynomial.polyval(y, self._derivatives[order]))


@dataclass(frozen=True)
class Spline:
    """Spline z(y), in mm.
    start, end: first and last y, mm.
    spline: scipy spline, called with y and the order of the derivative `nu`.
    """

    start: float
    end: float
    spline: Any

    def derivative(self, y: Array, order: int) -> Array:
        """z in mm (order 0), dz/dy (order 1) or d2z/dy2 in 1/mm (order 2) at y (n,) in mm."""
        return np.asarray(self.spline(y, nu=order), dtype=float)


@dataclass(frozen=True)
class Profile:
    """A transverse profile z(y), a chain of pieces in ascending y, of a rail or a wheel; NaN
    outside of the pieces.
    name: name of the profile, used in messages.
    pieces: arcs, polynomials or splines, each from its start to its end.
    face: points (y, z), mm, of an upright or undercut face below its first place, from there down.
    """

    name: str
    pieces: tuple[Piece, ...]
    face: tuple[tuple[float, float], ...] = ()

    @property
    def domain(self) -> tuple[float, float]:
        """First and last y of the profile, mm."""
        return self.pieces[0].start, self.pieces[-1].end

    @property
    def joints(self) -> list[float]:
        """y where two pieces meet, in ascending order, mm."""
        return [piece.start for piece in self.pieces[1:]]

    def _evaluate(self, y: ArrayLike, order: int) -> Array:
        """z (order 0), dz/dy (1) or d2z/dy2 (2) at y of any shape, mm; NaN beyond the profile. At a
        joint the later piece counts.
        """
        y = np.asarray(y, dtype=float)
        out = np.full(y.shape, np.nan)
        first = np.fmin.reduce(y, axis=None, initial=np.inf)
        last = np.fmax.reduce(y, axis=None, initial=-np.inf)
        for piece in self.pieces:
            if first <= piece.end and piece.start <= last:
                inside = (y >= piece.start) & (y <= piece.end)
                out[inside] = piece.derivative(y[inside], order)
        return out

    def height(self, y: ArrayLike) -> Array:
        """z at y of any shape, mm; NaN beyond the profile."""
        return self._evaluate(y, 0)

    def slope(self, y: ArrayLike) -> Array:
        """dz/dy at y (mm) of any shape; NaN beyond the profile."""
        return self._evaluate(y, 1)

    def __call__(self, x: Array, y: Array) -> tuple[Array, Array, Array]:
        """Height and slopes along and across at x, y (n,), mm, of the profile as a surface that is
        the same at every x; NaN beyond it.
        """
        return self.height(y), np.zeros_like(x), self.slope(y)

    def curvature(self, y: ArrayLike) -> Array:
        """Curvature -z'' / (1 + z'^2)^(3/2) at y (mm), in 1/mm: positive where the solid below z is
        convex; NaN beyond the profile.
        """
        return np.asarray(-self._evaluate(y, 2) / (1 + self.slope(y) ** 2) ** 1.5)


@lru_cache
def json_data(file: str) -> dict[str, Any]:
    """Content of a JSON file ('rails.json') in the data folder of railhead.geometry; cached, so it
    must not be changed.
    """
    path = resources.files("railhead.geometry") / "data" / file
    content: dict[str, Any] = json.loads(path.read_text())
    return content


def single_radius(radius: float, half_width: float, name: str = "arc") -> Profile:
    """Profile of one radius (mm; negative is concave, infinite is flat) through (0, 0), level
    there, for |y| <= half_width; at most 0.95 of the radius.
    """
    if math.isinf(radius):
        return Profile(name, (Polynomial(-half_width, half_width, (0.0,)),))
    reach = min(half_width, 0.95 * abs(radius))
    side = 1 if radius > 0 else -1
    return Profile(name, (Arc(-reach, reach, 0.0, -radius, abs(radius), side),))


def cone(slope: float, half_width: float, name: str) -> Profile:
    """Conical tread z = -slope * y for |y| <= half_width, in mm, z outwards from the axle: with a
    positive slope the wheel is larger on its flange side, y < 0.
    """
    return Profile(name, (Polynomial(-half_width, half_width, (0.0, -slope)),))


def s1002() -> Profile:
    """Profile of the S1002 wheel from its zones A to H, each an arc or a polynomial; the flange is
    at y < 0.
    """
    pieces: list[Piece] = []
    for zone in json_data("s1002.json")["zones"].values():
        start, end = zone["range"]
        if zone["kind"] == "arc":
            pieces.append(Arc(start, end, zone["yc"], zone["zc"], zone["r"], zone["sign"]))
        else:
            pieces.append(Polynomial(start, end, tuple(zone["c"])))
    return Profile("S1002", tuple(sorted(pieces, key=lambda piece: piece.start)))


def rail_head(name: str, inclination: float = 0.0) -> Profile:
    """Crown of a standard rail: an arc of R300 in the middle, then R80 and R13 on each side, turned
    about the crown centre, which is at y = z = 0, as of `rolled`.
    name: "54E1" or "60E1" (STANDARD_RAILS); KeyError for another.
    inclination: slope by which the rail leans towards the track's centre (y < 0), as 1/20.
    """
    segments = json_data("rails.json")[name]["half_section"][:3]
    top = np.array(segments[0]["start"])
    pieces: list[Arc] = []
    for mirror in (-1, 1):
        for segment in segments[::mirror]:
            y, z = (np.array(segment["centre"]) - top) * [mirror, 1]
            ends = (np.array([segment["start"], segment["end"]]) - top) * [mirror, 1]
            start, end = sorted(ends[:, 0])
            if mirror == 1 and segment is segments[0]:  # the other half of the crown's arc
                pieces[-1] = replace(pieces[-1], end=end)
            else:
                radius = float(np.hypot(*(ends[0] - [y, z])))
                pieces.append(Arc(start, end, y, z, radius, 1))
    return rolled(Profile(name, tuple(pieces)), inclination)


def head_side(name: str) -> float:
    """Length of the straight side of the head of a standard rail, below the end of `rail_head`, mm;
    0 for another rail.
    """
    if name not in STANDARD_RAILS:
        return 0.0
    side = json_data("rails.json")[name]["half_section"][3]
    return math.dist(side["start"], side["end"])


def rolled(profile: Profile, slope: float) -> Profile:
    """The profile turned about the origin by the angle arctan(slope), from y to z, so that its top
    leans to y < 0. Arcs stay arcs, without ends that no longer face upwards; else the result is a
    cubic spline through 2001 points.
    """
    if not slope:
        return profile
    c, s = _cos_sin(slope)
    arcs = [piece for piece in profile.pieces if isinstance(piece, Arc)]
    if len(arcs) == len(profile.pieces):
        return Profile(profile.name, tuple(_turned(arc, c, s) for arc in arcs))
    y = np.linspace(*profile.domain, 2001)
    z = profile.height(y)
    turned_y, turned_z = y * c - z * s, y * s + z * c
    spline = make_interp_spline(turned_y, turned_z, k=3)
    return Profile(profile.name, (Spline(turned_y[0], turned_y[-1], spline),))


def _turned(arc: Arc, c: float, s: float) -> Arc:
    """An arc turned about the origin by the angle with this cosine and sine, as far as it faces
    upwards.
    """
    ends = np.array([arc.start, arc.end])
    first, last = ends * c - arc.derivative(ends, 0) * s
    y, z = arc.centre_y * c - arc.centre_z * s, arc.centre_y * s + arc.centre_z * c
    reach = FACES_UP * arc.radius
    start, end = max(float(first), y - reach), min(float(last), y + reach)
    return Arc(start, end, y, z, arc.radius, arc.side)


def _cos_sin(slope: float) -> tuple[float, float]:
    """Cosine and sine of the angle whose tangent is the slope."""
    angle = math.atan(slope)
    return math.cos(angle), math.sin(angle)


@dataclass(frozen=True, kw_only=True, eq=False)
class Places:
    """Places along a profile that is new, evenly spaced, at which a worn depth is given.

    profile: the new profile.
    points: (n, 2) of (y, z), mm.
    normals: (n, 2) unit normals out of the metal.
    step: length of the profile between two places, mm.
    """

    profile: Profile
    points: Array
    normals: Array
    step: float

    def worn(self, depth: Array) -> Array:
        """Points (n, 2), mm, at a depth (n,), mm, along the normals of the new profile."""
        return np.asarray(self.points - depth[:, None] * self.normals)

    def profile_at(self, depth: Array) -> Profile:
        """The profile after a depth (n,), mm. Raises ValueError where it folds: its y does not
        rise from place to place.
        """
        y, z = self.worn(depth).T
        back = np.flatnonzero(np.diff(y) <= 0)
        if back.size:
            raise ValueError(f"the worn profile folds at y = {y[back[0]]:.3f} mm")
        return replace(self.profile, pieces=(Spline(float(y[0]), float(y[-1]), CubicSpline(y, z)),))

    def area(self, depth: Array) -> float:
        """Area of the section that a depth (n,), mm, takes, mm2."""
        return self.step * float(depth.sum())

    @property
    def steep(self) -> Mask:
        """Which places (n,) are steeper than 15 deg (STEEP) with y < 0."""
        return (self.points[:, 0] < 0) & (self.normals[:, 1] < np.cos(np.radians(STEEP)))

    def parts(self, body: str, depth: Array) -> dict[str, float]:
        """Area as of `area` by part: gauge corner or flange, steeper than 15 deg (STEEP) with y <
        0, and the rest, crown or tread. body: 'rail' or 'wheel'.
        """
        halves = np.where(self.steep, 0.0, depth), np.where(self.steep, depth, 0.0)
        return dict(zip(PARTS[body], map(self.area, halves), strict=True))


@lru_cache(maxsize=8)
def places_along(profile: Profile, count: int) -> Places:
    """`count` places along a profile from its first to its last y, ends included."""
    y = np.linspace(*profile.domain, DENSE * count)
    lengths = np.hypot(np.diff(y), np.diff(profile.height(y)))
    s = np.concatenate([[0.0], np.cumsum(lengths)])
    y = np.interp(np.linspace(0.0, s[-1], count), s, y)
    normals = np.column_stack([-profile.slope(y), np.ones(count)])
    return Places(
        profile=profile,
        points=np.column_stack([y, profile.height(y)]),
        normals=normals / np.linalg.norm(normals, axis=1)[:, None],
        step=float(s[-1]) / (count - 1),
    )


def flange_thickness(points: Array, tape_circle: float) -> float | None:
    """Distance in mm from the flange back to the flank of a flange 10 mm (FLANGE_HEIGHT) over the
    tape circle, as of EN 13715; None where the profile is not so high there.

    points: (n, 2) of the wheel's profile, y = 0 at the tape circle, mm.
    tape_circle: its distance from the flange back, mm.
    """
    y, z = points.T
    high = np.flatnonzero((y < 0) & (z > np.interp(0.0, y, z) + FLANGE_HEIGHT))
    if not high.size or high[-1] + 1 == y.size:
        return None
    ends = slice(high[-1], high[-1] + 2)
    level = np.interp(0.0, y, z) + FLANGE_HEIGHT
    return tape_circle + float(np.interp(level, z[ends][::-1], y[ends][::-1]))
