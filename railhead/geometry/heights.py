"""Heights that are added to a smooth surface, along and across the rail."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.interpolate import RectBivariateSpline

from railhead.theory.array_types import Array

Values = tuple[Array, Array, Array]
"""Height (n,) in mm, and its slopes (n,) along and across."""
FEWEST = 4  # places along a map, for cubic splines


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
    """Map of a file in mm: .npz with the arrays x (n,), y (m,) and height (n, m), or text with x, y
    and height in each row, a row for each place of a grid; lines that are no numbers are left out.
    Raises ValueError for anything else, and OSError where the file cannot be read.
    """
    if path.suffix.lower() == ".npz":
        with np.load(path, allow_pickle=False) as file:
            if missing := {"x", "y", "height"} - set(file.files):
                raise ValueError(f"{path.name} has no array {min(missing)}; give x, y and height")
            x, y, height = (np.asarray(file[key], dtype=float) for key in ("x", "y", "height"))
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
    rows = []
    for line in path.read_text(encoding="utf-8-sig").splitlines():
        try:
            rows.append([float(cell) for cell in re.split(r"[,;\s]+", line.strip())])
        except ValueError:  # a header
            continue
    if not rows or any(len(row) != 3 for row in rows):
        raise ValueError(f"{path.name} has no rows of three numbers; give x, y, height in mm")
    table = np.array(rows)
    (x, i), (y, j) = (np.unique(table[:, k], return_inverse=True) for k in (0, 1))
    height = np.full((len(x), len(y)), np.nan)
    height[i, j] = table[:, 2]
    if len(rows) != height.size or np.isnan(height).any():
        text = f"{len(rows)} rows are no grid of {len(x)} x by {len(y)} y; give each place once"
        raise ValueError(f"{path.name}: {text}")
    return x, y, height
