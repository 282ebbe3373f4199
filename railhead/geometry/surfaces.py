"""The exact undeformed surfaces near the contact, and the gap between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from railhead.geometry.heights import Height
from railhead.geometry.placement import Pose
from railhead.geometry.profiles import Profile
from railhead.theory.array_types import Array

NEWTON_STEPS = 20
CONVERGED = 1e-9  # mm, of the last step: a line that misses the surface takes long ones for ever


@dataclass(frozen=True)
class RailSurface:
    """Straight rail along x, the zero set of z - profile(y) - height(x, y), in the axes x, y, z of
    space.
    profile: z(y) of the rail, mm.
    height: added to the profile, mm; None: nothing is added.
    """

    profile: Profile
    height: Height | None = None

    def implicit(self, points: Array) -> tuple[Array, Array]:
        """Values (n,) of z - profile(y) - height(x, y) in mm, positive above the rail, and
        gradients (n, 3) at points (n, 3) in mm; NaN beyond the profile.
        """
        y = points[:, 1]
        gradient = np.column_stack([np.zeros_like(y), -self.profile.slope(y), np.ones_like(y)])
        value = points[:, 2] - self.profile.height(y)
        if self.height is not None:
            added, along, across = self.height(points[:, 0], y)
            value = value - added
            gradient -= np.column_stack([along, across, np.zeros_like(y)])
        return value, gradient


@dataclass(frozen=True)
class WheelSurface:
    """Surface of revolution, the zero set of distance from the axle - (rolling_radius +
    profile(y) + height(x, y)), with x the arc length rolling_radius times the angle about the axle
    from the wheel's lowest line, positive ahead.
    profile: height over the nominal rolling radius, outwards, mm.
    rolling_radius: nominal rolling radius, mm.
    pose: position and rotation of the wheel in space.
    height: added to the profile, mm; None: nothing is added.
    """

    profile: Profile
    rolling_radius: float
    pose: Pose
    height: Height | None = None

    def implicit(self, points: Array) -> tuple[Array, Array]:
        """Values (n,) of distance from the axle - (rolling_radius + profile(y) + height(x, y)) in
        mm, positive outside the wheel, and gradients (n, 3), at points (n, 3) in mm. Both are in
        the axes of space. NaN beyond the profile.
        """
        x, y, z = self.pose.inward(points).T
        distance = np.hypot(x, z)
        gradient = np.column_stack([x / distance, -self.profile.slope(y), z / distance])
        value = distance - self.rolling_radius - self.profile.height(y)
        if self.height is not None:
            added, along, across = self.height(self.rolling_radius * np.arctan2(x, -z), y)
            value = value - added
            along = along * self.rolling_radius / distance**2
            gradient -= np.column_stack([-z * along, across, x * along])
        return value, gradient @ self.pose.rotation.T


@dataclass(frozen=True)
class StraightTread:
    """A wheel of infinite rolling radius: the same profile at every x, and solid above it.

    profile: profile of the wheel; its height counts downwards from the nominal rolling radius, mm.
    lift: z of the nominal rolling radius, mm.
    shift: y of the origin of the profile, mm.
    """

    profile: Profile
    lift: float
    shift: float = 0.0

    def implicit(self, points: Array) -> tuple[Array, Array]:
        """Values (n,) of lift - height(y - shift) - z in mm, positive below the tread, outside the
        wheel, and gradients (n, 3), at points (n, 3) in mm; NaN beyond the profile.
        """
        y = points[:, 1] - self.shift
        one = np.ones_like(y)
        gradient = np.column_stack([0.0 * one, -self.profile.slope(y), -one])
        return self.lift - self.profile.height(y) - points[:, 2], gradient


Surface = RailSurface | WheelSurface | StraightTread
"""A surface as the zero set of a function that is positive outside the solid."""


def along(surface: Surface, points: Array, directions: Array) -> Array:
    """Distance t (n,) with points + t directions on the surface, by Newton's method from t = 0; it
    may be negative.

    points: (n, 3), mm.
    directions: (n, 3), not zero; t is in mm where these have unit length.

    Infinite where Newton's method does not converge: the line misses the surface, its profile ends,
    or a point is not finite.
    """
    t, step = np.zeros(len(points)), np.zeros(len(points))
    with np.errstate(invalid="ignore"):
        for _ in range(NEWTON_STEPS):
            value, gradient = surface.implicit(points + t[:, None] * directions)
            step = value / np.einsum("nd,nd->n", gradient, directions)
            t = t - step
            if not np.any(np.abs(step) > 1e-14):
                break
    return np.where(np.abs(step) < CONVERGED, t, np.inf)


def nearest(surface: Surface, points: Array) -> tuple[Array, Array]:
    """Places (n, 3) on a surface close to points (n, 3) beside it, mm, and its outward unit normals
    (n, 3) at these places.

    Each place lies on the line through its point along the gradient at the point, not at the place:
    to first order it is the nearest one. NaN beyond the profile, and not finite where that line
    misses the surface.
    """
    direction = _unit(surface.implicit(points)[1])
    with np.errstate(invalid="ignore"):
        places = points + along(surface, points, direction)[:, None] * direction
        return places, _unit(surface.implicit(places)[1])


@dataclass(frozen=True)
class ExactGap:
    """Gap from one undeformed surface along its outward normal to the other surface, mm.

    slave: surface from which the gap is measured.
    master: surface that the normal meets.
    """

    slave: Surface
    master: Surface

    def __call__(self, points: Array) -> tuple[Array, Array]:
        """Gap (n,) in mm and outward unit normals (n, 3) of the slave, at points (n, 3) near the
        slave in mm.
        The points are moved onto the slave first. The gap is negative where the surfaces overlap,
        and infinite where the normal misses the master and beyond the profile of the slave, where
        the normal is zero.
        """
        places, normal = nearest(self.slave, points)
        return along(self.master, places, normal), np.where(np.isfinite(normal), normal, 0.0)

    def off_surface(self, points: Array) -> Array:
        """Distance (n,) of points (n, 3) from the slave surface, mm, never negative, to the places
        of `nearest`; not finite where that finds none.
        """
        return np.asarray(np.linalg.norm(nearest(self.slave, points)[0] - points, axis=1))


def _unit(vectors: Array) -> Array:
    """Vectors (n, 3), each divided by its length."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1)[:, None])


@dataclass(frozen=True)
class ParabolicGap:
    """Hertz's own gap, curvature_x x^2/2 + curvature_y y^2/2, between two flat half-spaces that
    touch at the origin.
    curvature_x, curvature_y: relative curvatures along x and y, 1/mm.
    outward: +1 if the slave is the lower body, else -1.
    """

    curvature_x: float
    curvature_y: float
    outward: int

    def __call__(self, points: Array) -> tuple[Array, Array]:
        """Gap (n,) in mm and outward unit normals (n, 3) of the slave, (0, 0, outward), at points
        (n, 3) in mm, of which z has no effect.
        """
        gap = 0.5 * (self.curvature_x * points[:, 0] ** 2 + self.curvature_y * points[:, 1] ** 2)
        return gap, np.tile([0.0, 0.0, float(self.outward)], (len(points), 1))
