"""Where a wheel stands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pose:
    """World point = origin (3,) + rotation (3, 3) @ wheel point; y is the wheel's axle."""

    rotation: Array
    origin: Array

    def outward(self, points: Array) -> Array:
        """The wheel's points (n, 3) in the world."""
        return np.asarray(self.origin + points @ self.rotation.T)

    def inward(self, points: Array) -> Array:
        """World points (n, 3) in the wheel's axes."""
        return np.asarray((points - self.origin) @ self.rotation)

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Pose:
        """The same attitude elsewhere, mm."""
        return Pose(self.rotation, self.origin + [x, y, z])


def upright(height: float, shift: float = 0.0) -> Pose:
    """An axle along y at that height, moved across by shift (mm)."""
    return Pose(np.eye(3), np.array([0.0, shift, height]))


def about_axle(turn: float) -> Array:
    """Rotation (3, 3) that brings the wheel's lowest line to the angle `turn` (rad)."""
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def turned(yaw: float, roll: float) -> Array:
    """Yaw about z after roll about x, rad: R = Rz(yaw) Rx(roll)."""
    c, s, p, q = np.cos(yaw), np.sin(yaw), np.cos(roll), np.sin(roll)
    about_z = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, p, -q], [0.0, q, p]])
    return np.asarray(about_z @ about_x)
