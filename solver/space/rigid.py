"""Rigid surfaces that bodies on a mesh may touch."""

from dataclasses import dataclass

import numpy as np

from railhead.solver.space.vectors import Direction, finite, unit
from railhead.theory.array_types import Array


@dataclass(frozen=True, eq=False)
class Plane:
    """Rigid plane through a point; normal: towards the body that may touch it."""

    point: Direction
    normal: Direction

    def distance(self, points: Array, normals: Array) -> tuple[Array, Array]:
        """Distance (n,) from points (n, c) along unit normals (n, c), infinite where they miss, and
        unit normals (n, c) of the plane.
        """
        up = unit("normal", self.normal)
        down = -normals @ up
        far = np.where(down > 0, (points - self.point) @ up / np.where(down > 0, down, 1), np.inf)
        return far, np.tile(up, (len(points), 1))

    def curvature(self, normals: Array) -> Array:
        """Change of the unit normals (n, c) over the way along the surface, zero (n, c, c)."""
        return np.zeros((*normals.shape, normals.shape[1]))


@dataclass(frozen=True, eq=False)
class _Round:
    """Rigid surface at one distance from its middle."""

    centre: Direction
    radius: float

    def __post_init__(self) -> None:
        """Raises ValueError for a radius that is not positive and finite."""
        if finite(type(self).__name__, "radius", self.radius) <= 0:
            raise ValueError(f"radius must be positive, not {self.radius!r}")

    def distance(self, points: Array, normals: Array) -> tuple[Array, Array]:
        """Distance (n,) from points (n, c) along unit normals (n, c), infinite where they miss, and
        unit normals (n, c) of the surface there.
        """
        apart, ahead = self._across(np.asarray(self.centre) - points), self._across(normals)
        along, steep = np.einsum("nc,nc->n", apart, ahead), np.einsum("nc,nc->n", ahead, ahead)
        square = along**2 - steep * (np.einsum("nc,nc->n", apart, apart) - self.radius**2)
        hit = (square >= 0) & (along > 0)
        steep = np.where(hit, steep, 1.0)
        far = np.where(hit, (along - np.sqrt(np.maximum(square, 0))) / steep, np.inf)
        return far, (np.where(hit, far, along)[:, None] * ahead - apart) / self.radius

    def curvature(self, normals: Array) -> Array:
        """Change of the unit normals (n, c) over the way along the surface (n, c, c)."""
        every = self._across(np.eye(normals.shape[1]))
        return np.asarray((every - normals[:, :, None] * normals[:, None]) / self.radius)

    def _across(self, vectors: Array) -> Array:
        """Part of vectors (n, c) that the shape does not go on along."""
        return vectors


class Sphere(_Round):
    """Rigid sphere, in a section a cylinder or, on the axis, a sphere."""


@dataclass(frozen=True, eq=False)
class Cylinder(_Round):
    """Rigid cylinder without ends, in space; centre: any point of its axis."""

    axis: Direction

    def _across(self, vectors: Array) -> Array:
        """Part of vectors (n, 3) across the axis."""
        axis = unit("axis", self.axis)
        return np.asarray(vectors - (vectors @ axis)[:, None] * axis)


RigidSurface = Plane | Sphere | Cylinder
