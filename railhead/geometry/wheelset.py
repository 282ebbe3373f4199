"""A wheelset of two equal wheels on two rails: its roll and height follow from shift and yaw.

Each side has its own axes: origin at its crown centre, y to the field side. The left side is the
mirror image of the right one, with shift, yaw and roll of opposite sign.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from railhead.geometry.placement import ContactPoint, Pair, PlacementError
from railhead.geometry.pose import Pose, turned
from railhead.geometry.profiles import Profile

TAPE_CIRCLE = 70.0  # mm from the flange back to the nominal rolling radius
GAUGE_DEPTH = 14.0  # mm below the highest point of the rail
LARGEST_ROLL = 0.1  # rad


@dataclass(frozen=True)
class Track:
    """Distances that place a wheelset over its track.
    back_to_back: distance of the flange backs, mm.
    gauge: distance of the rails 14 mm below their tops, mm; None where the tape circles stand over
        the crown centres.
    """

    back_to_back: float = 1360.0
    gauge: float | None = None

    @property
    def tape(self) -> float:
        """Distance of the tape circle, 70 mm from the flange back, to the wheelset's centre, mm."""
        return self.back_to_back / 2 + TAPE_CIRCLE

    def crown(self, rail: Profile) -> float:
        """Distance of the rail's crown centre from the centre of the track, mm.
        Raises PlacementError where a gauge is given and the profile ends above the depth of the
        gauge.
        """
        return self.tape if self.gauge is None else self.gauge / 2 - gauge_face(rail)


def top(rail: Profile) -> tuple[float, float]:
    """y and z of the highest point of a rail's profile, mm."""
    y = np.linspace(*rail.domain, 20001)
    slope = rail.slope(y)
    best = int(np.nanargmax(rail.height(y)))
    before, after = max(best - 1, 0), min(best + 1, len(y) - 1)
    crest = y[best]
    if slope[before] > 0 > slope[after]:
        crest = brentq(lambda v: float(rail.slope(v)), y[before], y[after], xtol=1e-13)
    return float(crest), float(rail.height(crest))


def gauge_face(rail: Profile) -> float:
    """y (mm) where the rail's profile, between its first y and its highest point, is 14 mm below
    that point.
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
    side.
    pose: position of the wheel.
    touches: contact points, smallest gap first.
    """

    pose: Pose
    touches: list[ContactPoint]


@dataclass(frozen=True)
class Placed:
    """A wheelset that touches both rails.
    roll: roll angle of the wheelset, rad.
    height: height of its centre over the crown centres, mm.
    right: right wheel on its rail.
    left: left wheel on its rail, in mirrored axes.
    """

    roll: float
    height: float
    right: Side
    left: Side

    @property
    def rolling_radius_difference(self) -> float:
        """Radius of the wheel at the first contact, right minus left, mm."""
        return self.right.touches[0].radius - self.left.touches[0].radius


def place(
    pair: Pair, track: Track, shift: float = 0.0, yaw: float = 0.0, clearance: float = 0.0
) -> Placed:
    """Lower a wheelset, moved by shift (mm) to the right and turned by yaw (rad), onto the track;
    the roll follows from contact on both sides.
    clearance: height above the lowest contact point up to which further contact points are kept,
        mm.
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
