"""Where a wheel touches the rail when it is lowered onto it.

The rail is a prism along x, so what counts is the wheel's outline against it: the line on the wheel
on which its normal has no x component (the contact locus; S. Iwnicki, Handbook of Railway Vehicle
Dynamics, 2006, section 4.2). Contact points are minima of the height of that line over the rail.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from railhead.geometry.profiles import Profile
from railhead.theory.array_types import Array, Index, Mask

SAMPLES = 4001
TOGETHER = 256  # poses that are searched at once, for the memory
EXACT, ROUGH = 1e-13, 1e-9  # mm on the wheel's profile
STRIDE = 4  # of the samples that a rough search looks at
SAMPLING_ERROR = 1e-2  # mm, of the height at the sample nearest to a minimum, at most
TAPE_CIRCLE = 70.0  # mm from the flange back to the nominal rolling radius


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
    slope, rise: dz/dy and dz/dx of the rail there, which are those of the common tangent away from
        edges.
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
    rise: float = 0.0
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
        """Contact angle from the horizontal to the tangent across the rail, rad; positive where z
        rises towards the field side: the turn of the plane about its tangent ahead.
        """
        return float(np.arctan(self.slope / np.hypot(1.0, self.rise)))

    @property
    def lean(self) -> float:
        """Angle at which the tangent ahead rises, rad."""
        return float(np.arctan(self.rise))

    @property
    def upright(self) -> float:
        """Part of the unit normal that points up: the cosine of its angle to the vertical."""
        return 1 / float(np.sqrt(1 + self.slope**2 + self.rise**2))

    @property
    def axes(self) -> Array:
        """Unit vectors (3, 3), a row each: along the rail and across it in the common tangent
        plane, and its normal out of the rail.
        """
        return tangents(self.rise, self.slope)


def tangents(rise: float, slope: float) -> Array:
    """Unit vectors (3, 3), a row each, of a plane with slopes dz/dx and dz/dy: that with no y, the
    one at right angles to it towards larger y, and the normal, upwards.
    """
    ahead = np.array([1.0, 0.0, rise]) / np.hypot(1.0, rise)
    normal = np.array([-rise, -slope, 1.0]) / np.sqrt(1 + slope**2 + rise**2)
    return np.array([ahead, np.cross(normal, ahead), normal])


def principal(bends: Array, rise: float, slope: float) -> tuple[float, float, float]:
    """Principal curvatures in 1/mm of a gap in its tangent plane, as of `relative`.
    bends: (2, 2) second derivatives of the gap's height by x and y, 1/mm.
    rise, slope: dz/dx and dz/dy of the plane.
    """
    ahead, aside, normal = tangents(rise, slope)
    map_of = np.array([ahead[:2], aside[:2]])
    (xx, xs), (_, ss) = normal[2] * map_of @ bends @ map_of.T
    return _principal(float(xx), float(xs), float(ss))


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
    tape_circle: distance of the tape circle from the flange back, mm.
    """

    rail: Profile
    wheel: Profile
    rolling_radius: float
    tape_circle: float = TAPE_CIRCLE

    def outline(self, pose: Pose, tread: ArrayLike) -> Outline:
        """Contact locus of the wheel in a pose: the points on the wheel's circles at profile
        coordinates tread (n,) in mm whose normal has no x component. NaN where a circle has none.
        Of n poses the i-th point is that of the i-th pose.
        """
        tread = np.asarray(tread, dtype=float)
        height, rise = self.wheel.height(tread), self.wheel.slope(tread)
        points, radial, sine, cosine = _locus(pose, self.rolling_radius + height, tread, rise)
        y, z = (of - rise * pose.rotation[..., k, 1] for k, of in enumerate(radial[1:], 1))
        turn = np.arctan2(sine, cosine)
        return Outline(np.stack(points, axis=-1), -y / z, turn, self.rolling_radius + height)

    @cached_property
    def samples(self) -> tuple[Array, Array, Array]:
        """Coordinates y, heights and slopes (4001,) along the wheel's profile."""
        tread = np.linspace(*self.wheel.domain, SAMPLES, dtype=np.float64)
        return tread, self.wheel.height(tread), self.wheel.slope(tread)

    def touches(self, pose: Pose, clearance: float = 0.0) -> list[ContactPoint]:
        """The place where the wheel in a pose is lowest over the rail, and all minima of that
        height up to `clearance` mm above it; lowest first. The wheel is not moved: `gap` of the
        first place need not be 0.
        Raises PlacementError where no part of the wheel is over the rail.
        """
        (found,) = self.touches_of(Pose(pose.rotation[None], pose.origin[None]), clearance)
        if not found:
            raise PlacementError("no part of the wheel is over the rail")
        return found

    def touches_of(self, poses: Pose, clearance: float = 0.0) -> list[list[ContactPoint]]:
        """Contact points as of `touches` for each of several poses; none for a pose in which no
        part of the wheel is over the rail.
        """
        number, tread, at_edge = self._minima(poses, clearance)
        found: list[list[ContactPoint]] = [[] for _ in poses.origin]
        for each, touch in zip(number, self._touch(poses[number], tread, at_edge), strict=True):
            found[each].append(touch)
        for points in found:
            points.sort(key=lambda touch: touch.gap)
        return [[each for each in of if each.gap <= of[0].gap + clearance] for of in found]

    def lowest(self, poses: Pose, *, rough: bool) -> tuple[Array, Array, Array, Array]:
        """Where the wheel is lowest over the rail, for n poses: its height (n,) over the rail in
        mm, the point (n, 3), the slope (n,) of the rail there, and the distance (n,) from the axle
        in mm. NaN for a pose in which no part of the wheel is over the rail.
        rough: the wheel is looked at in steps that are four times as long, and its place is found
            to 1e-9 mm (ROUGH), not to 1e-13.
        """
        number, tread, _ = self._minima(poses, 0.0, rough=rough)
        outline = self.outline(poses[number], tread)
        gap = outline.points[:, 2] - self.rail.height(outline.points[:, 1])
        order = np.lexsort((gap, number))
        of, first = np.unique(number[order], return_index=True)
        found = np.full((len(poses.origin), 5), np.nan)
        found[of] = np.column_stack([gap, outline.points, outline.radius])[order[first]]
        return found[:, 0], found[:, 1:4], self.rail.slope(found[:, 2]), found[:, 4]

    def _minima(
        self, poses: Pose, clearance: float, *, rough: bool = False
    ) -> tuple[Index, Array, Mask]:
        """Minima of the height over the rail that are at most `clearance` (mm) above the lowest
        one of their pose, and some that are a little higher: number of the pose (m,), profile
        coordinate (m,) in mm, and whether it is an end of a profile (m,).

        Minima of samples are moved to where wheel and rail have the same slope. At an edge, and
        where the slopes do not cross between its neighbours, it is the sample itself.
        rough: as of `lowest`.
        """
        if len(poses.origin) > TOGETHER:
            starts = range(0, len(poses.origin), TOGETHER)
            parts = [self._minima(poses[n : n + TOGETHER], clearance, rough=rough) for n in starts]
            numbers = [part[0] + n for n, part in zip(starts, parts, strict=True)]
            at, at_edge = (np.concatenate([part[k] for part in parts]) for k in (1, 2))
            return np.concatenate(numbers), at, at_edge
        tread, height, rise = (each[:: STRIDE if rough else 1] for each in self.samples)
        (y, z), *_ = _locus(poses[:, None], self.rolling_radius + height, tread, rise, (1, 2))
        height = z - self.rail.height(y)
        wall = np.where(np.isfinite(height), height, np.inf)
        wall = np.pad(wall, ((0, 0), (1, 1)), constant_values=np.inf)
        before, here, after = wall[:, :-2], wall[:, 1:-1], wall[:, 2:]
        low = here.min(axis=1, keepdims=True) + clearance + SAMPLING_ERROR
        number, index = np.nonzero((here <= before) & (here < after) & (here <= low))
        at_edge = ~np.isfinite(before[number, index] + after[number, index])
        at, inner = tread[index], np.flatnonzero(~at_edge)
        start, end = tread[index[inner] - 1], tread[index[inner] + 1]

        def excess(at: Array, which: Index) -> Array:
            """Slope of the wheel minus that of the rail at profile coordinates (mm) of minima."""
            outline = self.outline(poses[number[which]], at)
            return outline.slope - self.rail.slope(outline.points[:, 1])

        first, last = excess(start, inner), excess(end, inner)
        meet = (first < 0) & (last > 0)
        which = inner[meet]
        ends = (start[meet], end[meet], first[meet], last[meet])
        at[which] = _crossing(partial(excess, which=which), *ends, ROUGH if rough else EXACT)
        return number, at, at_edge

    def _touch(self, poses: Pose, tread: Array, at_edge: Mask) -> Iterator[ContactPoint]:
        """Contact points on the wheel's circles at profile coordinates tread (n,) in mm, at the
        points of the contact locus (`outline`) in n poses, with the curvatures of both bodies and
        the gap there.
        at_edge: (n,) whether the point is the end of a profile.
        """
        outline = self.outline(poses, tread)
        y = outline.points[:, 1]
        slopes, around = self.rail.slope(y) + 0.0, np.cos(np.arctan(self.wheel.slope(tread)))
        values = np.column_stack(
            [
                outline.points,
                slopes,  # no negative zero
                outline.points[:, 2] - self.rail.height(y),
                tread,
                outline.turn,
                outline.radius,
                self.rail.curvature(y),
                around / outline.radius,
                self.wheel.curvature(tread),
            ]
        )
        for rotation, row, edge in zip(poses.rotation, values.tolist(), at_edge, strict=True):
            x, y, z, slope, gap, wheel_y, turn, radius, rail, around, across = row
            ahead = rotation @ np.array([np.cos(turn), 0.0, np.sin(turn)])  # along the circle
            tangent = np.array([0.0, 1.0, slope]) / np.hypot(1.0, slope)
            angle = np.arctan2(ahead @ tangent, ahead[0])
            curvature_x, curvature_y, orientation = relative(rail, around, across, angle)
            yield ContactPoint(
                x=x,
                y=y,
                z=z,
                slope=slope,
                gap=gap,
                wheel_y=wheel_y,
                axle_angle=turn,
                radius=radius,
                rail_curvature=rail,
                wheel_curvatures=(around, across),
                curvature_x=curvature_x,
                curvature_y=curvature_y,
                orientation=orientation,
                at_edge=bool(edge),
            )


def _locus(
    pose: Pose, radius: Array, tread: Array, rise: Array, axes: Sequence[int] = (0, 1, 2)
) -> tuple[list[Array], list[Array], Array, Array]:
    """Points of a wheel whose normal has no x component, NaN where there is none: coordinates in
    mm, components of the unit vectors from the axle to them, and sine and cosine of their angles
    about the axle, from the wheel's lowest line, positive ahead. Shapes: to which poses and circles
    broadcast.
    radius, tread, rise: of the wheel's circles: radius (mm), coordinate (mm) and slope of the
        profile.
    axes: of the coordinates and components that are returned.
    """
    ahead, axle, up = np.moveaxis(pose.rotation, -1, 0)
    # The normal cosine down + sine ahead - rise axle has no x component.
    length = np.hypot(ahead[..., 0], up[..., 0])
    along, across = ahead[..., 0] / length, -up[..., 0] / length
    share = rise * (axle[..., 0] / length)
    with np.errstate(invalid="ignore"):
        rest = np.sqrt(1 - share * share)
    sine, cosine = share * along - rest * across, rest * along + share * across
    radial = [sine * ahead[..., k] - cosine * up[..., k] for k in axes]
    points = [
        pose.origin[..., k] + tread * axle[..., k] + radius * of
        for k, of in zip(axes, radial, strict=True)
    ]
    return points, radial, sine, cosine


def _crossing(
    rising: Callable[[Array], Array],
    low: Array,
    high: Array,
    below: Array,
    above: Array,
    error: float,
) -> Array:
    """Places (n,) between low and high (n,) where a function is zero, to some error, by the
    Illinois method (M. Dowell and P. Jarratt, BIT 11, 1971).
    rising: values (n,) at n places; below (negative) and above (positive): those at low and high.
    """
    for _ in range(200):
        at = high - above * (high - low) / (above - below)
        moved, value = np.abs(at - high), rising(at)
        same = np.sign(value) == np.sign(above)
        low, below = np.where(same, low, high), np.where(same, below / 2, above)
        high, above = at, value
        if not (moved > error).any():
            break
    return high


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
    return _principal(xx, xs, ss)


def _principal(xx: float, xs: float, ss: float) -> tuple[float, float, float]:
    """Principal values of a symmetric matrix, that nearer to x first, and the angle of its
    direction from x, rad.
    """
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
    Several poses have one more axis, or more, in front in both arrays; an index picks some of them.
    """

    rotation: Array
    origin: Array

    def __getitem__(self, index: Any) -> Pose:
        """Those of several poses that an index of numpy picks."""
        return Pose(self.rotation[index], self.origin[index])

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


def turned(yaw: float, roll: ArrayLike) -> Array:
    """Rotation (3, 3), roll about x first, then yaw about z, both in rad: R = Rz(yaw) Rx(roll); of
    n rolls (n, 3, 3).
    """
    c, s, p, q = np.cos(yaw), np.sin(yaw), np.cos(roll), np.sin(roll)
    one = np.ones_like(p)
    rows = [[c * one, -s * p, s * q], [s * one, c * p, -c * q], [0 * one, q, p]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
