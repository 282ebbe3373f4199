"""The exact undeformed surfaces near the contact, and the gap between them.

Both bodies are height fields z = f(x, y) there: x along the rail, y across, z up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from meshing.profiles import Profile

Array = NDArray[np.float64]


class Surface(Protocol):
    """A height field with the side its solid lies on."""

    @property
    def outward(self) -> int:
        """+1 where the solid lies below the surface, -1 where it lies above."""
        ...

    def height(self, x: Array, y: Array) -> Array:
        """z in mm; NaN outside the surface."""
        ...

    def gradient(self, x: Array, y: Array) -> tuple[Array, Array]:
        """dz/dx and dz/dy."""
        ...


@dataclass(frozen=True)
class RailSurface:
    """A straight rail, solid below."""

    profile: Profile
    outward: int = 1

    def height(self, x: Array, y: Array) -> Array:
        return self.profile.height(y)

    def gradient(self, x: Array, y: Array) -> tuple[Array, Array]:
        return np.zeros_like(x), self.profile.slope(y)


@dataclass(frozen=True)
class WheelSurface:
    """A surface of revolution about the axle y -> (0, y, axle_height), solid above.

    The local radius is rolling_radius + profile(y - shift).
    """

    profile: Profile
    rolling_radius: float
    shift: float
    axle_height: float
    outward: int = -1

    def radius(self, y: Array) -> Array:
        """Distance of the surface from the axle, mm."""
        return self.rolling_radius + self.profile.height(y - self.shift)

    def height(self, x: Array, y: Array) -> Array:
        with np.errstate(invalid="ignore"):
            return np.asarray(self.axle_height - np.sqrt(self.radius(y) ** 2 - x**2))

    def gradient(self, x: Array, y: Array) -> tuple[Array, Array]:
        radius = self.radius(y)
        with np.errstate(invalid="ignore"):
            root = np.sqrt(radius**2 - x**2)
        return x / root, -radius * self.profile.slope(y - self.shift) / root


@dataclass(frozen=True)
class ExactGap:
    """Gap from `slave` along its outward normal to `master`."""

    slave: Surface
    master: Surface

    def __call__(self, points: Array) -> tuple[Array, Array]:
        """points (n, 3) near the slave, only x and y are used -> (gap (n,), normal (n, 3)).

        Solves f_master(x + t n) = z + t n_z for t by Newton's method; the gap is infinite where
        the normal misses the master.
        """
        x, y = points[:, 0], points[:, 1]
        z = self.slave.height(x, y)
        dx, dy = self.slave.gradient(x, y)
        up = np.column_stack([-dx, -dy, np.ones_like(x)])
        normal = np.asarray(up * float(self.slave.outward), dtype=float)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        t = (self.master.height(x, y) - z) * normal[:, 2]
        for _ in range(12):
            xt, yt = x + t * normal[:, 0], y + t * normal[:, 1]
            mx, my = self.master.gradient(xt, yt)
            miss = self.master.height(xt, yt) - z - t * normal[:, 2]
            rate = mx * normal[:, 0] + my * normal[:, 1] - normal[:, 2]
            step = miss / rate
            t = t - step
            if not np.any(np.abs(step) > 1e-14):
                break
        t[~np.isfinite(t)] = np.inf
        return t, np.where(np.isfinite(normal), normal, 0.0)


@dataclass(frozen=True)
class ParabolicGap:
    """Hertz's own gap, curvature_x x^2/2 + curvature_y y^2/2, between two flat half-spaces.

    outward: +1 if the slave is the lower body.
    """

    curvature_x: float
    curvature_y: float
    outward: int

    def __call__(self, points: Array) -> tuple[Array, Array]:
        """points (n, 3) -> (gap (n,), normal (n, 3))."""
        gap = 0.5 * (self.curvature_x * points[:, 0] ** 2 + self.curvature_y * points[:, 1] ** 2)
        return gap, np.tile([0.0, 0.0, float(self.outward)], (len(points), 1))
