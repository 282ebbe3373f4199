"""Where a wheel touches the rail when it is lowered onto it; how a wheelset stands on its track.

The rail is a prism along x, so what counts is the wheel's outline against it: the line on the wheel
on which its normal has no x component (the contact locus; S. Iwnicki, Handbook of Railway Vehicle
Dynamics, 2006, section 4.2). Contact points are minima of the height of that line over the rail.

A wheelset has two equal wheels on two rails; its roll and height follow from shift and yaw. Each
side has its own axes: origin at its crown centre, y to the field side. The left side is the mirror
image of the right one, with shift, yaw and roll of opposite sign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from railhead.geometry.profiles import Profile
from railhead.theory.array_types import Array, Mask

SAMPLES = 4001
SAMPLING_ERROR = 1e-2  # mm, of the height at the sample nearest to a minimum, at most


class PlacementError(ValueError):
    """The two profiles cannot be brought into contact."""


@dataclass(frozen=True)
class Outline:
    """The contact locus of a wheel in a pose: points whose normal has no x component; (x, y, z) are
    those of space.

    points: (n, 3) of (x, y, z), mm. A row, with its slope and turn, is NaN beyond the ends of the
        profile. So it is where the profile is too steep for the yaw: no point of the circle has
        such a normal there.
    slope: (n,) dz/dy of the tangent across the rail.
    turn: (n,) angle about the axle from the wheel's lowest line, rad, positive ahead (towards +x).
    radius: (n,) distance from the axle, mm.
    """

    points: Array
    slope: Array
    turn: Array
    radius: Array


@dataclass(frozen=True, kw_only=True)
class ContactPoint:
    """A point where the undeformed bodies touch, or come closest. Axes are those of the rail of one
    side: x along it, y to the field side from the crown centre, z up.

    x, y, z: coordinates of the point on the wheel, mm; on the rail z is smaller by `gap`.
    slope: dz/dy of the rail there, which is the common tangent away from edges.
    gap: height of the wheel over the rail there, mm; negative where the wheel lies in the rail.
    wheel_y: y of the point in the wheel's profile, mm.
    axle_angle: angle about the axle from the wheel's lowest line, rad, positive ahead (towards +x).
    radius: distance from the axle, mm.
    rail_curvature: curvature of the rail across, 1/mm, positive where convex.
    wheel_curvatures: curvatures of the wheel, first along its circles, then across, 1/mm, positive
        where convex.
    curvature_x, curvature_y: relative principal curvatures, 1/mm, in the directions nearer to the
        rail's axis and nearer to across.
    orientation: angle in the tangent plane from the rail's axis to the direction of curvature_x,
        rad, positive towards the field side.
    at_edge: whether the point is the end of a profile, where the bodies have no common tangent.

    A point from `parabolic_contact` has nothing but its relative curvatures.
    """

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    slope: float = 0.0
    gap: float = 0.0
    wheel_y: float = 0.0
    axle_angle: float = 0.0
    radius: float = 0.0
    rail_curvature: float = 0.0
    wheel_curvatures: tuple[float, float] = (0.0, 0.0)
    curvature_x: float
    curvature_y: float
    orientation: float = 0.0
    at_edge: bool = False

    @property
    def angle(self) -> float:
        """Contact angle arctan(slope) from the horizontal to the tangent across the rail, rad;
        positive where z rises towards the field side.
        """
        return float(np.arctan(self.slope))


def parabolic_contact(curvature_x: float, curvature_y: float) -> ContactPoint:
    """Contact point at the origin (0, 0, 0) of two half-spaces whose gap is the parabola with
    relative curvatures curvature_x and curvature_y (1/mm).
    """
    return ContactPoint(curvature_x=curvature_x, curvature_y=curvature_y)


@dataclass(frozen=True)
class ProfilePair:
    """The profiles of a wheel and of the rail under the wheel.
    rail: z(y) as it stands, inclined, with the origin at the crown centre, mm.
    wheel: height over the nominal rolling radius, outwards, as a function of y, mm; y = 0 at the
        tape circle.
    rolling_radius: nominal rolling radius of the wheel, mm.
    """

    rail: Profile
    wheel: Profile
    rolling_radius: float

    def outline(self, pose: Pose, tread: ArrayLike) -> Outline:
        """Contact locus of the wheel in a pose: the points on the wheel's circles at profile
        coordinates tread (n,) in mm whose normal has no x component. NaN where a circle has none.
        """
        tread = np.asarray(tread, dtype=float)
        ahead, axle, up = pose.rotation.T
        radius = self.rolling_radius + self.wheel.height(tread)
        rise = self.wheel.slope(tread)
        # The normal cos(turn) down + sin(turn) ahead - rise axle has no x component.
        length, phase = np.hypot(ahead[0], up[0]), np.arctan2(-up[0], ahead[0])
        with np.errstate(invalid="ignore"):
            turn = np.arcsin(rise * axle[0] / length) - phase
        radial = np.sin(turn)[..., None] * ahead - np.cos(turn)[..., None] * up
        points = pose.origin + tread[..., None] * axle + radius[..., None] * radial
        normal = radial - rise[..., None] * axle
        return Outline(points, -normal[..., 1] / normal[..., 2], turn, radius)

    def touches(self, pose: Pose, clearance: float = 0.0) -> list[ContactPoint]:
        """The place where the wheel in a pose is lowest over the rail, and all minima of that
        height up to `clearance` mm above it; lowest first. The wheel is not moved: `gap` of the
        first place need not be 0.
        Raises PlacementError where no part of the wheel is over the rail.
        """
        tread = np.linspace(*self.wheel.domain, SAMPLES, dtype=np.float64)
        points = self.outline(pose, tread).points
        height = points[:, 2] - self.rail.height(points[:, 1])
        over = np.isfinite(height)
        if not over.any():
            raise PlacementError("no part of the wheel is over the rail")
        wall = np.concatenate([[np.inf], np.where(over, height, np.inf), [np.inf]])
        minimum = (wall[1:-1] <= wall[:-2]) & (wall[1:-1] < wall[2:])
        lowest = np.flatnonzero(minimum & (wall[1:-1] <= wall.min() + clearance + SAMPLING_ERROR))
        found = [self._polish(pose, tread, over, int(index)) for index in lowest]
        found.sort(key=lambda touch: touch.gap)
        return [touch for touch in found if touch.gap <= found[0].gap + clearance]

    def _polish(self, pose: Pose, tread: Array, over: Mask, index: int) -> ContactPoint:
        """The contact point at the minimum of height near sample `index` of the wheel coordinates
        tread (n,), where wheel and rail have the same slope. At an edge, and where the slopes do
        not cross between its neighbours, it is the sample itself.
        over: (n,) whether the sample is over the rail; a sample without two neighbours over the
            rail is an edge.
        """

        def excess(at: float) -> float:
            """Slope of the wheel minus that of the rail at profile coordinate `at` (mm)."""
            outline = self.outline(pose, at)
            return float(outline.slope - self.rail.slope(outline.points[1]))

        near = [i for i in (index - 1, index + 1) if 0 <= i < len(tread) and over[i]]
        at_edge = len(near) < 2
        at = tread[index]
        if not at_edge and excess(tread[near[0]]) < 0 < excess(tread[near[1]]):
            at = float(brentq(excess, tread[near[0]], tread[near[1]], xtol=1e-13, rtol=1e-15))
        return self._touch(pose, at, at_edge)

    def _touch(self, pose: Pose, tread: float, at_edge: bool) -> ContactPoint:
        """Contact point on the wheel's circle at profile coordinate tread (mm), at the point of the
        contact locus (`outline`), with the curvatures of both bodies and the gap there.
        at_edge: the point is the end of a profile.
        """
        outline = self.outline(pose, tread)
        x, y, z = (float(value) for value in outline.points)
        slope = float(self.rail.slope(y)) + 0.0  # no negative zero
        radius, turn = float(outline.radius), float(outline.turn)
        around = float(np.cos(np.arctan(self.wheel.slope(tread)))) / radius
        across = float(self.wheel.curvature(tread))
        rail = float(self.rail.curvature(y))
        ahead = pose.rotation @ np.array([np.cos(turn), 0.0, np.sin(turn)])  # along the circle
        tangent = np.array([0.0, 1.0, slope]) / np.hypot(1.0, slope)
        angle = np.arctan2(ahead @ tangent, ahead[0])
        curvature_x, curvature_y, orientation = relative(rail, around, across, angle)
        return ContactPoint(
            x=x,
            y=y,
            z=z,
            slope=slope,
            gap=z - float(self.rail.height(y)),
            wheel_y=float(tread),
            axle_angle=turn,
            radius=radius,
            rail_curvature=rail,
            wheel_curvatures=(around, across),
            curvature_x=curvature_x,
            curvature_y=curvature_y,
            orientation=orientation,
            at_edge=at_edge,
        )


def relative(rail: float, around: float, across: float, angle: float) -> tuple[float, float, float]:
    """Principal relative curvatures in 1/mm, the one nearer to x first, then the one nearer to s,
    and the angle of the first one's direction from x, rad.
    x is along the rail and s across it in the tangent plane.
    rail: curvature of the rail along s, 1/mm.
    around, across: principal curvatures of the wheel along its circle and across, 1/mm.
    angle: from x towards s to the direction of the wheel's circle, rad.
    """
    c, s = np.cos(angle), np.sin(angle)
    xx = around * c * c + across * s * s
    ss = around * s * s + across * c * c + rail
    xs = (around - across) * s * c
    mean, half = (xx + ss) / 2, np.hypot((xx - ss) / 2, xs)
    half = half if xx >= ss else -half
    turned = 0.5 * np.arctan2(xs, abs(xx - ss) / 2) * (1 if xx >= ss else -1)
    return float(mean + half), float(mean - half), float(turned) + 0.0


@dataclass(frozen=True)
class Pose:
    """Position and rotation of a wheel: point in space = origin + rotation @ point of the wheel;
    the wheel's own y axis is its axle. Meshed rails have one too (`upright(0.0)`).
    rotation: (3, 3) matrix whose columns are the wheel's axes in space.
    origin: (3,) position in space of the wheel's origin, which lies on the axle in the plane of the
        tape circle, mm.
    """

    rotation: Array
    origin: Array

    def outward(self, points: Array) -> Array:
        """Coordinates in space (n, 3) of points (n, 3), or (3,) of one, in the wheel's axes, mm."""
        return np.asarray(self.origin + points @ self.rotation.T)

    def inward(self, points: Array) -> Array:
        """Coordinates (n, 3) in the wheel's axes of points (n, 3) in space, mm."""
        return np.asarray((points - self.origin) @ self.rotation)

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Pose:
        """A pose with the same rotation whose origin is moved by (x, y, z), mm."""
        return Pose(self.rotation, self.origin + [x, y, z])


def upright(height: float, shift: float = 0.0) -> Pose:
    """Pose without rotation: an axle along y at z = height, with its origin at x = 0 and y = shift,
    mm.
    """
    return Pose(np.eye(3), np.array([0.0, shift, height]))


def about_axle(turn: float) -> Array:
    """Rotation (3, 3) about y that moves the wheel's lowest line by the angle `turn` (rad) towards
    +x.
    """
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def turned(yaw: float, roll: float) -> Array:
    """Rotation (3, 3), roll about x first, then yaw about z, both in rad: R = Rz(yaw) Rx(roll)."""
    c, s, p, q = np.cos(yaw), np.sin(yaw), np.cos(roll), np.sin(roll)
    about_z = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, p, -q], [0.0, q, p]])
    return np.asarray(about_z @ about_x)


TAPE_CIRCLE = 70.0  # mm from the flange back to the nominal rolling radius, usually
GAUGE_DEPTH = 14.0  # mm below the highest point of the rail
LARGEST_ROLL = 0.1  # rad


@dataclass(frozen=True)
class Track:
    """Distances that place a wheelset over its track.
    back_to_back: distance of the flange backs, mm.
    gauge: distance of the rails 14 mm below their tops, mm; None where the tape circles stand over
        the crown centres.
    tape_circle: distance from the flange back to the nominal rolling radius, mm.
    """

    back_to_back: float = 1360.0
    gauge: float | None = None
    tape_circle: float = TAPE_CIRCLE

    @property
    def tape(self) -> float:
        """Distance of the tape circle to the wheelset's centre, mm."""
        return self.back_to_back / 2 + self.tape_circle

    def crown(self, rail: Profile) -> float:
        """Distance of the rail's crown centre from the centre of the track, mm: where no gauge is
        given, the distance of the wheel's tape circle from there.
        Raises PlacementError where a gauge is given and the profile ends above the depth of the
        gauge.
        """
        return self.tape if self.gauge is None else self.gauge / 2 - gauge_face(rail)


def top(rail: Profile) -> tuple[float, float]:
    """y and z of the highest point of a rail's profile as it stands, mm; of an inclined or worn
    rail that is not the crown centre.
    """
    y = np.linspace(*rail.domain, 20001)
    slope = rail.slope(y)
    best = int(np.nanargmax(rail.height(y)))
    before, after = max(best - 1, 0), min(best + 1, len(y) - 1)
    crest = y[best]
    if slope[before] > 0 > slope[after]:
        crest = brentq(lambda v: float(rail.slope(v)), y[before], y[after], xtol=1e-13)
    return float(crest), float(rail.height(crest))


def gauge_face(rail: Profile) -> float:
    """y (mm), on the gauge side, where the rail's profile, between its first y and its highest
    point, is 14 mm below that point.
    Raises PlacementError where the profile ends above this depth.
    """
    start = rail.domain[0]
    crest, height = top(rail)
    if not float(rail.height(start)) < height - GAUGE_DEPTH:
        raise PlacementError(
            f"profile {rail.name} ends {height - float(rail.height(start)):.3g} mm below its top, "
            f"the gauge is measured {GAUGE_DEPTH:g} mm below"
        )
    return float(brentq(lambda y: float(rail.height(y)) - height + GAUGE_DEPTH, start, crest))


@dataclass(frozen=True)
class Side:
    """One wheel on its rail, in the axes of its side: origin at the crown centre, y to the field
    side, z up; x = 0 in the plane of the wheelset's centre.
    pose: position of the wheel, touching its rail.
    touches: contact points, smallest gap first, at least one.
    """

    pose: Pose
    touches: list[ContactPoint]


@dataclass(frozen=True)
class Placed:
    """A wheelset that touches both rails.
    roll: roll angle of the wheelset, rad, about x in the axes of the right side.
    height: height of the middle of its axle over the crown centres, mm.
    right: right wheel on its rail.
    left: left wheel on its rail, pose and contact points, in the mirrored axes of the left side,
        whose y points to the field side of the left rail.
    """

    roll: float
    height: float
    right: Side
    left: Side

    @property
    def rolling_radius_difference(self) -> float:
        """Rolling radius of the right wheel less that of the left one, mm, each at its contact with
        the smallest gap.
        """
        return self.right.touches[0].radius - self.left.touches[0].radius


def equivalent_conicity(amplitude: float, shifts: Array, differences: Array) -> float:
    """Equivalent conicity of a free wheelset that swings by an amplitude a (mm) to both sides: the
    conicity of cones whose motion has the same wavelength (EN 15302). NaN where the wheelset is not
    turned back, without amplitude, and where the shifts do not reach a to both sides.

    The motion is y'' = -D(y)/(e r): D is the rolling radius difference at the shift y, e the
    distance of the contacts, r the rolling radius. Its wavelength is 2 J sqrt(e r), where J is the
    integral of dy/sqrt(2 (G(a) - G(y))) from -a to a, and G the integral of D from 0. That of cones
    (D = 2 c y) is pi sqrt(2 e r/c) (Klingel), so c = pi^2/(2 J^2).

    shifts, differences (n,): rising lateral shifts and D at them, mm; D is taken as odd.
    """
    if not 0 < amplitude <= min(-shifts[0], shifts[-1]) * (1 + 1e-9):
        return math.nan
    y = amplitude * np.linspace(0.0, 1.0, 2001)
    odd = (np.interp(y, shifts, differences) - np.interp(-y, shifts, differences)) / 2
    above = np.concatenate([[0.0], np.cumsum((odd[1:] + odd[:-1]) / 2) * y[1]])
    angles = (np.arange(400) + 0.5) / 400 * math.pi / 2  # y = amplitude sin(angle): no pole
    left = above[-1] - np.interp(amplitude * np.sin(angles), y, above)
    if (left <= 0).any():
        return math.nan
    half = math.pi / 2 * float(np.mean(amplitude * np.cos(angles) / np.sqrt(2 * left)))
    return math.pi**2 / (2 * (2 * half) ** 2)


def place(
    pair: ProfilePair, track: Track, shift: float = 0.0, yaw: float = 0.0, clearance: float = 0.0
) -> Placed:
    """Lower a wheelset, moved by shift (mm) to the right and turned by yaw (rad, about z), onto the
    track; the roll follows from contact on both sides.
    clearance: height above the lowest contact point up to which further contact points of a side
        are kept, mm.
    Raises PlacementError where a wheel misses its rail, no roll lets both wheels touch, or the
    rail's profile does not reach the gauge.
    """
    offset = track.crown(pair.rail)

    def pose(side: int, roll: float, height: float = 0.0) -> Pose:
        """Pose of the right (side 1) or left (side -1) wheel in the axes of its side, for a roll in
        rad and a height of the wheelset's centre in mm.
        """
        rotation = turned(side * yaw, side * roll)
        centre = np.array([0.0, side * shift - offset, height])
        return Pose(rotation, centre + track.tape * rotation[:, 1])

    @cache
    def height(side: int, roll: float) -> float:
        """Height of the wheelset's centre at which the wheel of that side touches its rail at a
        roll in rad, mm.
        """
        return -pair.touches(pose(side, roll))[0].gap

    def tilt(roll: float) -> float:
        """Height of the centre for contact on the right minus that on the left, at a roll in rad,
        mm.
        """
        return height(1, roll) - height(-1, roll)

    roll = 0.0
    if shift or yaw:
        if not tilt(-LARGEST_ROLL) * tilt(LARGEST_ROLL) < 0:
            raise PlacementError("no roll lets both wheels touch their rails")
        roll = float(brentq(tilt, -LARGEST_ROLL, LARGEST_ROLL, xtol=1e-14))
    level = height(1, roll)
    right, left = (
        Side(pose(side, roll, level), pair.touches(pose(side, roll, level), clearance))
        for side in (1, -1)
    )
    return Placed(roll, level, right, left)
