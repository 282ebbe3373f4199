"""Where a wheel stands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pose:
    """Position and rotation of a wheel: world point = origin + rotation @ wheel point; the wheel's
    own y axis is its axle.
    rotation: (3, 3) matrix whose columns are the wheel's axes in the world.
    origin: (3,) position of the wheel's origin, which lies on the axle, mm.
    """

    rotation: Array
    origin: Array

    def outward(self, points: Array) -> Array:
        """World coordinates (n, 3) of points (n, 3) that are given in the wheel's axes, mm."""
        return np.asarray(self.origin + points @ self.rotation.T)

    def inward(self, points: Array) -> Array:
        """Coordinates (n, 3) in the wheel's axes of world points (n, 3), mm."""
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
