"""How a wheelset stands on its track.

A wheelset has two wheels on two rails; its roll and height follow from shift and yaw. Each side has
its own axes: origin at its crown centre, y to the field side. The axes of the left side are the
mirror image of those of the right one, so shift, yaw and roll have the opposite sign there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from railhead.geometry.placement import (
    ContactPoint,
    PlacementError,
    Pose,
    ProfilePair,
    turned,
)
from railhead.geometry.profiles import Profile
from railhead.theory.array_types import Array

GAUGE_HEIGHT = 14.0  # mm below the highest point of the rail
FLANGE = 10.0  # mm over the tape circle: a higher crest beside the tread is a flange
LARGEST_ROLL = 0.1  # rad
ROLL_STEP = 2e-3  # rad, longest step of the search: of several rolls it finds the smallest
EXACT, ROUGH = 1e-14, 1e-10  # rad
MOST_STEPS = 200  # beyond, rolls of contacts at corners are as exact as rounding lets them be


class GaugeError(PlacementError):
    """The gauge is measured where a rail has no profile."""


@dataclass(frozen=True)
class Track:
    """Distances that place a wheelset over its track.
    back_to_back: distance of the flange backs, mm.
    gauge: distance of the rails `gauge_height` below their tops, mm; None where the tape circles
        stand over the crown centres.
    gauge_height: mm below the highest point of a rail.
    """

    back_to_back: float = 1360.0
    gauge: float | None = None
    gauge_height: float = GAUGE_HEIGHT

    def tape(self, pair: ProfilePair) -> float:
        """Distance of a wheel's tape circle from the wheelset's centre, mm."""
        return self.back_to_back / 2 + pair.tape_circle

    def crown(self, pair: ProfilePair) -> float:
        """Distance of the rail's crown centre from the centre of the track, mm: where no gauge is
        given, the distance of the wheel's tape circle from there.
        Raises GaugeError where a gauge is given and the profile ends above its height.
        """
        if self.gauge is None:
            return self.tape(pair)
        return self.gauge / 2 - gauge_face(pair.rail, self.gauge_height)


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


def gauge_face(rail: Profile, depth: float = GAUGE_HEIGHT) -> float:
    """y (mm) of the place on the gauge side, nearest to the rail's highest point, where the profile
    is `depth` (mm) below that point.
    Raises GaugeError where the profile ends above this depth.
    """
    crest, height = top(rail)
    y = np.linspace(rail.domain[0], crest, 20001)
    below = np.flatnonzero(rail.height(y) < height - depth)
    if not len(below):
        end = height - float(rail.height(y).min())
        text = f"is not reached by profile {rail.name}, which ends {end:.3g} mm below its top"
        raise GaugeError(f"{depth:g} mm {text}; give less, or no gauge")
    ends = y[below[-1]], y[below[-1] + 1]
    return float(brentq(lambda y: float(rail.height(y)) - height + depth, *ends))


@dataclass(frozen=True)
class Side:
    """One wheel on its rail, in the axes of its side: origin at the crown centre, y to the field
    side, z up; x = 0 in the plane of the wheelset's centre.
    pair: profiles of the wheel and of its rail.
    pose: position of the wheel, touching its rail.
    height: height of the middle of the axle, mm.
    touches: contact points, smallest gap first, at least one.
    """

    pair: ProfilePair
    pose: Pose
    height: float
    touches: list[ContactPoint]


@dataclass(frozen=True)
class Placed:
    """A wheelset that touches both rails.
    shift: lateral displacement to the right, mm.
    roll: roll angle of the wheelset, rad, about x in the axes of the right side.
    right: right wheel on its rail.
    left: left wheel on its rail, pose and contact points, in the mirrored axes of the left side,
        whose y points to the field side of the left rail. Its height is that of the right side, but
        for rounding and where a roll was given.
    """

    shift: float
    roll: float
    right: Side
    left: Side

    @property
    def rolling_radius_difference(self) -> float:
        """Rolling radius of the right wheel less that of the left one, mm, each at its contact with
        the smallest gap.
        """
        return self.right.touches[0].radius - self.left.touches[0].radius


@dataclass(frozen=True)
class _HangingWheel:
    """A wheel of a wheelset whose middle is at z = 0, in the axes of the wheel's side.
    pair: profiles of the wheel and of its rail.
    sign: of shift, yaw and roll in these axes: 1 on the right, -1 on the left.
    tape: distance of the tape circle from the middle of the wheelset, mm.
    crown: distance of the rail's crown centre from the centre of the track, mm.
    yaw: rad, in the axes of the right side.
    """

    pair: ProfilePair
    sign: int
    tape: float
    crown: float
    yaw: float

    def poses(self, shifts: Array, rolls: Array) -> Pose:
        """Poses at n shifts (mm) and rolls (rad), both in the axes of the right side."""
        rotation = turned(self.sign * self.yaw, self.sign * rolls)
        return Pose(rotation, self._middle(shifts) + self.tape * rotation[..., 1])

    def _middle(self, shifts: Array) -> Array:
        """The middle of the wheelset (n, 3) at n shifts, mm."""
        return np.outer(self.sign * shifts - self.crown, [0.0, 1.0, 0.0])

    def heights(self, shifts: Array, rolls: Array, *, rough: bool) -> tuple[Array, Array, Array]:
        """Height (n,) to which the middle is lifted where the wheel touches its rail, mm, its
        derivative by the roll, and the rolling radius, mm, at n shifts and rolls as of `poses`; NaN
        where the wheel misses its rail. rough: as of `ProfilePair.lowest`.

        The lowest point of the wheel, whose arm from the middle is a, moves by w x a, where w =
        (cos yaw, sin yaw, 0) is the axis of the roll. Over the rail, of slope s, it rises by
        (w x a)_z - s (w x a)_y; that another point becomes the lowest has no part in first order.
        """
        gap, points, slope, radius = self.pair.lowest(self.poses(shifts, rolls), rough=rough)
        x, y, z = (points - self._middle(shifts)).T
        c, s = math.cos(self.sign * self.yaw), math.sin(self.sign * self.yaw)
        return -gap, -self.sign * (c * y - s * x + slope * c * z), radius

    @cached_property
    def _flange(self) -> tuple[float, float] | None:
        """y of the crest of the flange in the wheel's profile and y at which the rail begins: its
        gauge face 14 mm below the top, or the end of its profile. None for a wheel whose profile
        has no crest over 10 mm (FLANGE) high beside the tread.
        """
        tread, height, _ = self.pair.samples
        crest = int(np.nanargmax(height))
        if height[crest] < FLANGE or not tread[0] < tread[crest] < 0:
            return None
        try:
            return float(tread[crest]), gauge_face(self.pair.rail)
        except GaugeError:
            return float(tread[crest]), self.pair.rail.domain[0]

    def lowered(self, pose: Pose, touches: list[ContactPoint]) -> Side:
        """The wheel on its rail, from its pose and the contact points of that. Raises
        PlacementError where it does not stay there: it has no contact, it touches with an end of
        its profile, or the crest of its flange has come over the rail.
        """
        name = "right" if self.sign > 0 else "left"
        if not touches:
            raise PlacementError(f"no part of the {name} wheel is over the rail")
        first = touches[0]
        if first.at_edge and first.wheel_y in self.pair.wheel.domain:
            text = f"touches with an end of its profile (y = {first.wheel_y:g} mm)"
            raise PlacementError(f"the {name} wheel {text}")
        if self._flange is not None:
            crest, inner = self._flange
            over = float(self.pair.outline(pose, crest).points[1]) - inner
            if over > 0:
                text = f"stands on its flange, whose crest is {over:.3g} mm over the rail"
                raise PlacementError(f"the {name} wheel {text}")
        down = [replace(each, z=each.z - first.gap, gap=each.gap - first.gap) for each in touches]
        return Side(self.pair, pose.moved(z=-first.gap), -first.gap, down)


@dataclass(frozen=True, kw_only=True)
class WheelsetOnTrack:
    """A wheelset, its rails, and how it is turned.
    right, left: profiles of both sides.
    track: distances of wheels and rails.
    yaw: rad, about z.
    roll: rad, about x in the axes of the right side; each wheel then touches its rail at a height
        of its own. None: both rails are equally high, and the roll follows.
    """

    right: ProfilePair
    left: ProfilePair
    track: Track = Track()
    yaw: float = 0.0
    roll: float | None = None

    @cached_property
    def _wheels(self) -> tuple[_HangingWheel, _HangingWheel]:
        """The right wheel and the left one. Raises GaugeError as `Track.crown`."""
        right, left = (
            _HangingWheel(pair, sign, self.track.tape(pair), self.track.crown(pair), self.yaw)
            for sign, pair in ((1, self.right), (-1, self.left))
        )
        return right, left

    def place(self, shift: float = 0.0, clearance: float = 0.0) -> Placed:
        """Lower the wheelset, moved by shift (mm) to the right, onto the track.
        clearance: height above the lowest contact point up to which further contact points of a
            side are kept, mm.
        Raises PlacementError where a wheel misses its rail or does not stay on it, no roll lets
        both wheels touch, or a rail's profile does not reach the gauge.
        """
        (placed,) = self.place_all(np.array([shift]), clearance)
        if isinstance(placed, PlacementError):
            raise placed
        return placed

    def place_all(
        self, shifts: Array, clearance: float = 0.0, start: Array | float = 0.0
    ) -> list[Placed | PlacementError]:
        """The wheelset as of `place` at each of the shifts (n,), mm, or the reason why it cannot
        stand there. start: rolls (n,), rad, from which the search goes.
        """
        start, _ = self.rolling(shifts, start + np.zeros(len(shifts)), rough=True)
        rolls, _ = self.rolling(shifts, start)
        poses = [wheel.poses(shifts, rolls) for wheel in self._wheels]
        touches = [
            wheel.pair.touches_of(of, clearance)
            for wheel, of in zip(self._wheels, poses, strict=True)
        ]
        found: list[Placed | PlacementError] = []
        for number, (shift, roll) in enumerate(zip(shifts.tolist(), rolls.tolist(), strict=True)):
            try:
                if abs(roll) >= LARGEST_ROLL:
                    raise PlacementError("no roll lets both wheels touch their rails")
                right, left = (
                    wheel.lowered(of[number], points[number])
                    for wheel, of, points in zip(self._wheels, poses, touches, strict=True)
                )
                found.append(Placed(shift, roll, right, left))
            except PlacementError as error:
                found.append(error)
        return found

    def rolling(self, shifts: Array, start: Array, *, rough: bool = False) -> tuple[Array, Array]:
        """Rolls (n,), in rad, and rolling radii (2, n) on the right and on the left, in mm, at
        shifts (n,), mm; nothing says whether the wheelset can stand there.
        start: rolls (n,) from which they are searched, by Newton's method within a bracket that
            shrinks; 0.1 (LARGEST_ROLL) or -0.1 is found where there is none.
        rough: to 1e-10 rad (ROUGH), not to 1e-14, and as of `ProfilePair.lowest`.
        """
        error = ROUGH if rough else EXACT
        rolls = start.copy() if self.roll is None else np.full(len(shifts), self.roll)
        radii, left = np.empty((2, len(rolls))), np.arange(len(rolls))
        low, high = np.full((2, len(rolls)), [[-LARGEST_ROLL], [LARGEST_ROLL]])
        for _ in range(MOST_STEPS):
            at = rolls[left]
            (height, rate, right_radius), (other, other_rate, left_radius) = (
                wheel.heights(shifts[left], at, rough=rough) for wheel in self._wheels
            )
            radii[:, left] = right_radius, left_radius
            if self.roll is not None or not len(left):
                break
            tilt, rate = height - other, rate - other_rate
            low[left] = np.where(tilt >= 0, at, low[left])
            high[left] = np.where(tilt <= 0, at, high[left])
            step = np.where(rate < 0, -tilt / rate, np.copysign(ROLL_STEP, tilt))
            after = at + np.clip(step, -ROLL_STEP, ROLL_STEP)
            within = (after > low[left]) & (after < high[left])
            after = np.where(within, after, (low[left] + high[left]) / 2)
            rolls[left] = np.where(np.abs(step) > error, after, at)
            left = left[np.abs(rolls[left] - at) > error]
        return rolls, radii
