"""How a wheel creeps where its wheelset stands: rigid kinematics, to first order in yaw.

The axle moves along the track and turns once in 2 pi r0, r0 = wheel.rolling_radius, both wheels
alike. Where a wheel touches on a larger radius r, its surface runs backward; an axle yawed by psi
pushes it aside; the part of the turning that is about the normal, which leans by the contact angle
delta less the roll phi against the axle, is spin:

    along = (r0 - r)/r0     across = -psi/cos(delta)     spin = -sin(delta - phi)/r0
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhead.geometry.solid import Contact
from railhead.meshing.placement import Touch
from railhead.scene.scene import SceneError
from railhead.theory.rolling import Creepage

KEY = "rolling.from_wheelset"
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rolls:
    """The wheel of a scene. radius: of its circle at the contact, mean: of both wheels', mm."""

    radius: float
    mean: float
    nominal: float
    yaw: float
    roll: float
    angle: float
    creepage: Creepage

    @property
    def why(self) -> str:
        """What the creepage comes from."""
        r0, found = self.nominal, self.creepage
        return (
            f"along (r0 - r)/r0 = {found.along:.4g} (r {self.radius:.6g}, r0 {r0:.6g} mm; "
            f"{self.free:.4g} on an axle without torque, which turns by the mean radius "
            f"{self.mean:.6g} mm), across -yaw/cos(angle) = {found.across:.4g}, spin "
            f"-sin(angle - roll)/r0 = {found.spin:.4g} 1/mm (yaw {1e3 * self.yaw:.4g}, angle "
            f"{1e3 * self.angle:.4g}, roll {1e3 * self.roll:.4g} mrad)"
        )

    @property
    def free(self) -> float:
        """Creepage along of an axle that turns by the mean of both rolling radii."""
        return (self.mean - self.radius) / self.mean

    def summary(self) -> dict[str, Any]:
        """As in summary.json."""
        return {
            "rolling_radius_mm": self.radius,
            "nominal_radius_mm": self.nominal,
            "yaw_rad": self.yaw,
            "roll_rad": self.roll,
            "contact_angle_rad": self.angle,
            "creepage_along": self.creepage.along,
            "creepage_across": self.creepage.across,
            "spin_per_mm": self.creepage.spin,
            "creepage_along_without_torque": self.free,
        }


def creepage(touch: Touch, nominal: float, yaw: float, roll: float) -> Creepage:
    """At a contact of either wheel in its own axes; nominal rolling radius, mm; yaw and roll of
    that side, rad."""
    return Creepage(
        (nominal - touch.radius) / nominal,
        0.0 - yaw / math.cos(touch.angle),  # no negative zero
        0.0 - math.sin(touch.angle - roll) / nominal,
    )


def of(contact: Contact) -> Rolls:
    """The wheel of a scene. SceneError without a wheelset."""
    placed = contact.placed
    if placed is None:
        kind = "half-spaces have" if contact.half_space else "a section has"
        text = f"true is not allowed: {kind} no wheelset; give creepages, spin or forces"
        raise SceneError(KEY, text)
    scene, touch = contact.scene, contact.touch
    nominal, yaw = scene.wheel.rolling_radius, scene.wheelset.yaw
    found = creepage(touch, nominal, yaw, placed.roll)
    mean = (placed.right.touches[0].radius + placed.left.touches[0].radius) / 2
    return Rolls(touch.radius, mean, nominal, yaw, placed.roll, touch.angle, found)


def off_plane(contact: Contact, points: Array) -> Array:
    """What places (n, 3), mm, creep along beyond a motion and its spin in the tangent plane of the
    first contact (n,): a height h above that plane is a smaller radius, h cos(angle - roll)/r0."""
    angle, roll = contact.touch.angle, contact.placed.roll if contact.placed else 0.0
    normal = np.array([0.0, -math.sin(angle), math.cos(angle)])
    height = (points - np.array(contact.origin)) @ normal
    return np.asarray(height * math.cos(angle - roll) / contact.scene.wheel.rolling_radius)
