"""Where the pressure has a ridge: lines in a patch on which the relative curvature jumps.

The pressure is continuous there, its slope across is not bounded (K. L. Johnson, Contact Mechanics,
1985, section 5.1), and elements of one size flatten it.
"""

from __future__ import annotations

import math

from railhead.contact.solid import Contact
from railhead.planning.patch.forecast import Zone

JUMP = 0.2  # least jump of the relative curvature, over its larger side, that makes a ridge
BESIDE = 1e-6  # mm, distance from a joint at which the curvature of each side is taken


def ridges(contact: Contact, zone: Zone) -> list[Zone]:
    """Lines along the rail in a patch at which the relative curvature across jumps by more than 20
    % (JUMP), as zones without width (b = 0).
    """
    found = []
    for _, profile, shift in contact.cross_profiles:
        for joint in profile.joints:
            y = joint + shift
            across = (y - zone.centre[1]) / (zone.b * math.cos(zone.angle))
            if abs(across) < 1 and _jump(contact, y) > JUMP:
                z = float(contact.profiles["rail"][0].height(y))
                length = zone.a * math.sqrt(1 - across**2)
                found.append(Zone((zone.centre[0], y, z), length, 0.0, zone.angle))
    return found


def _jump(contact: Contact, y: float) -> float:
    """Jump of the relative curvature across at y (mm), over the larger of the curvatures on both
    sides.
    """
    (rail, _), (wheel, shift) = contact.profiles["rail"], contact.profiles["wheel"]
    left, right = (
        float(rail.curvature(beside) - wheel.curvature(beside - shift))
        for beside in (y - BESIDE, y + BESIDE)
    )
    return abs(right - left) / max(abs(left), abs(right), 1e-300)
