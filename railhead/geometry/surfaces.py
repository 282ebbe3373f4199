"""The exact undeformed surfaces near the contact, with heights that are added to them along and
across the rail, and the gap between them.
"""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np
from scipy.interpolate import RectBivariateSpline

from railhead.geometry import tables
from railhead.geometry.placement import Pose
from railhead.theory.array_types import Array, read_arrays

NEWTON_STEPS = 20
CONVERGED = 1e-9  # mm, of the last step: a line that misses the surface takes long ones for ever
SMALL = 1e-11  # mm
Values = tuple[Array, Array, Array]
"""Height (n,) in mm, and its slopes (n,) along and across."""
FEWEST = 4  # places along a map, for cubic splines
ROW = (
    tables.Column(name="x", named="(x|along)( .*)?", unit="mm", factor=tables.mm_of),
    tables.Column(name="y", named="(y|across|lateral)( .*)?", unit="mm", factor=tables.mm_of),
    tables.Column(name="height", named="(z|h|height)( .*)?", unit="mm", factor=tables.mm_of),
)
"""Columns of a map of text."""


class Over(Protocol):
    """A surface over (x, y): a profile, the same at every x; a height that is added to one; or what
    is lofted through sections.
    """

    def __call__(self, x: Array, y: Array) -> Values:
        """Height and slopes at places x along and y across, (n,) each, mm; NaN beyond it."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Height:
    """A height over a smooth surface, outwards, mm, the same everywhere across.
    length: over which the height changes, mm.
    position: place of the origin of x in the height's own coordinate along, mm.
    """

    length: float
    position: float = 0.0

    def __call__(self, x: Array, y: Array) -> Values:
        """Height and slopes at places x along the surface and y across it, (n,) each, mm."""
        return *self._along(x + self.position), np.zeros_like(x)

    @property
    def range(self) -> float:
        """Largest less smallest height, mm: of those at the middle and the ends of its length."""
        return float(np.ptp(self._along(self.length * np.array([-0.5, 0.0, 0.5]))[0]))

    def _along(self, x: Array) -> tuple[Array, Array]:
        """Height and its slope along at places (n,) in the height's own coordinate, mm: none."""
        return np.zeros_like(x), np.zeros_like(x)


@dataclass(frozen=True, kw_only=True, eq=False)
class Cosine(Height):
    """Waves amplitude cos(2 pi x / length), with a crest at x = 0; amplitude in mm."""

    amplitude: float

    def _along(self, x: Array) -> tuple[Array, Array]:
        wave = 2 * np.pi / self.length
        return self.amplitude * np.cos(wave * x), -self.amplitude * wave * np.sin(wave * x)


@dataclass(frozen=True, kw_only=True, eq=False)
class RoundedFlat(Height):
    """A hollow -depth/2 (1 + cos(2 pi x / length)) within |x| < length/2, else 0; depth in mm."""

    depth: float

    def _along(self, x: Array) -> tuple[Array, Array]:
        wave, at = 2 * np.pi / self.length, np.clip(x, -self.length / 2, self.length / 2)
        return -self.depth / 2 * (1 + np.cos(wave * at)), self.depth / 2 * wave * np.sin(wave * at)


@dataclass(frozen=True, kw_only=True, eq=False)
class FreshFlat(Height):
    """A plane cut off a circle, R cos(length/2R) / cos(x/R) - R within |x| < length/2, else 0.
    radius: R of the circle, mm; x is the length of arc along it.
    """

    radius: float

    def _along(self, x: Array) -> tuple[Array, Array]:
        turn = np.clip(x, -self.length / 2, self.length / 2) / self.radius
        distance = np.cos(self.length / 2 / self.radius) / np.cos(turn)
        slope = np.where(np.abs(x) < self.length / 2, distance * np.tan(turn), 0.0)
        return self.radius * (distance - 1), slope


@dataclass(frozen=True, kw_only=True, eq=False)
class Map(Height):
    """Heights on a grid, with cubic splines between; beyond it those of its border.
    x: along, (n,), ascending, mm. y: across, (m,), ascending, mm. height: (n, m), mm.
    With a single y the height is the same everywhere across. NaN at places that are NaN.
    """

    x: Array = field(repr=False)
    y: Array = field(repr=False)
    height: Array = field(repr=False)

    def __call__(self, x: Array, y: Array) -> Values:
        """Height and slopes at places (n,), mm; a slope is 0 where its coordinate is beyond."""
        x = x + self.position
        at, across = np.clip(x, *self.x[[0, -1]]), np.clip(y, *self.y[[0, -1]])
        value, along, beside = (
            self._spline.ev(at, across, dx, dy) for dx, dy in ((0, 0), (1, 0), (0, 1))
        )
        return value, np.where(at == x, along, 0.0), np.where(across == y, beside, 0.0)

    @property
    def range(self) -> float:
        """Largest less smallest height on the grid, mm."""
        return float(np.ptp(self.height))

    @cached_property
    def _spline(self) -> RectBivariateSpline:
        """Spline through the grid."""
        y, height = self.y, self.height
        if len(y) == 1:
            y, height = np.arange(float(FEWEST)), np.repeat(height, FEWEST, axis=1)
        return RectBivariateSpline(self.x, y, height, ky=min(3, len(y) - 1))


def read_map(path: Path, position: float) -> Map:
    """Map of a file: .npz with the arrays x (n,), y (m,) and height (n, m) in mm, or text with x, y
    and height in each row, a row for each place of a grid, in the order and the units of its header
    (without one in this order, in mm).
    Raises ValueError for anything else, and OSError where the file cannot be read.
    """
    if path.suffix.lower() == ".npz":
        found = read_arrays(path)
        if missing := {"x", "y", "height"} - {*found}:
            raise ValueError(f"{path.name} has no array {min(missing)}; give x, y and height")
        x, y, height = (np.asarray(found[key], dtype=float) for key in ("x", "y", "height"))
    else:
        x, y, height = _grid(path)
    wrong = height.shape != (x.size, y.size) or x.ndim != 1 or y.ndim != 1
    if wrong or not all(np.isfinite(each).all() for each in (x, y, height)):
        raise ValueError(f"{path.name} is no map; give finite x (n), y (m) and height (n, m)")
    if len(x) < FEWEST or len(y) == 2 or any((np.diff(k) <= 0).any() for k in (x, y)):
        text = f"{path.name} has {len(x)} places along and {len(y)} across; give {FEWEST} or more"
        raise ValueError(f"{text} along and 1, 3 or more across, ascending")
    steps = [np.diff(each).min() for each in (x, y) if len(each) > 1]
    return Map(length=FEWEST * float(min(steps)), position=position, x=x, y=y, height=height)


def _grid(path: Path) -> tuple[Array, Array, Array]:
    """x (n,), y (m,) and height (n, m) of the rows of a text file. Raises ValueError for rows that
    are no grid.
    """
    found = tables.read(path.name, tables.lines_of(path), ROW)
    table = np.array([*tables.in_units(path.name, found, ROW)])
    (x, i), (y, j) = (np.unique(table[:, k], return_inverse=True) for k in (0, 1))
    height = np.full((len(x), len(y)), np.nan)
    height[i, j] = table[:, 2]
    if len(table) != height.size or np.isnan(height).any():
        text = f"{len(table)} rows of numbers are no grid of {len(x)} x by {len(y)} y"
        raise ValueError(f"{path.name}: {text}; give each place once, with a finite height")
    return x, y, height


@dataclass(frozen=True)
class RailSurface:
    """Upper surface of a rail, the zero set of z - shape(x, y) - added(x, y), in the axes x, y, z
    of space.
    shape: of the rail: its profile where it is straight, or a surface through sections.
    added: height on top of it; None: nothing is added.
    """

    shape: Over
    added: Over | None = None

    def implicit(self, points: Array) -> tuple[Array, Array]:
        """Values (n,) of z - shape(x, y) - added(x, y) in mm, positive above the rail, and
        gradients (n, 3) at points (n, 3) in mm; NaN beyond the shape.
        """
        height, along, across = _sum(self.shape, self.added, points[:, 0], points[:, 1])
        return points[:, 2] - height, np.column_stack([-along, -across, np.ones_like(along)])


def _sum(shape: Over, added: Over | None, x: Array, y: Array) -> Values:
    """Height and slopes of two surfaces over x, y (n,), mm, laid on each other."""
    found = shape(x, y)
    if added is None:
        return found
    first, second, third = (one + more for one, more in zip(found, added(x, y), strict=True))
    return first, second, third


@dataclass(frozen=True)
class WheelSurface:
    """Surface of a wheel, the zero set of distance from the axle - (rolling_radius + shape(x, y) +
    added(x, y)), with x the arc length rolling_radius times the angle about the axle from the
    wheel's lowest line, positive ahead.
    shape: height over the nominal rolling radius, outwards, mm: the profile of a body of
        revolution.
    rolling_radius: nominal rolling radius, mm.
    pose: position and rotation of the wheel in space.
    added: height on top of the shape; None: nothing is added.
    """

    shape: Over
    rolling_radius: float
    pose: Pose
    added: Over | None = None

    def implicit(self, points: Array) -> tuple[Array, Array]:
        """Values (n,) of distance from the axle - (rolling_radius + shape(x, y) + added(x, y)) in
        mm, positive outside the wheel, and gradients (n, 3), at points (n, 3) in mm. Both are in
        the axes of space. NaN beyond the shape.
        """
        x, y, z = self.pose.inward(points).T
        distance = np.hypot(x, z)
        around = self.rolling_radius * np.arctan2(x, -z)
        height, along, across = _sum(self.shape, self.added, around, y)
        along = along * self.rolling_radius / distance**2
        gradient = np.column_stack([x / distance + z * along, -across, z / distance - x * along])
        value = distance - self.rolling_radius - height
        return value, gradient @ self.pose.rotation.T


Surface = RailSurface | WheelSurface
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
            # After so small a step the next one is below rounding: each squares the error.
            if not np.any(np.abs(step) > SMALL):
                break
    return np.where(np.abs(step) < CONVERGED, t, np.inf)


def between(lower: Surface, upper: Surface, points: Array, directions: Array) -> Array:
    """Distance (n,) in mm from one surface to another along unit directions (n, 3) through points
    (n, 3) near both; infinite where one of them is missed.
    """
    first = along(lower, points, directions)
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(first), along(upper, points, directions) - first, np.inf)


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
