"""Measured profiles: points from a file, brought to the project's axes, smoothed.

What a file leaves open is found out from its shape and said: the unit by the width, up and down by
the convex crown or the flange, the gauge side by the flange, the lean of the head or its wear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from railhead.meshing import instruments, orientation, smoothing
from railhead.meshing.dialects import InstrumentError, Table
from railhead.meshing.orientation import Choices
from railhead.meshing.profiles import Profile, Spline
from railhead.meshing.smoothing import PointError, Smoothed

Array = NDArray[np.float64]
STEEP = 0.045  # of dy over ds: steeper faces than those of a standard rail's corners are cut off
SAMPLE = 0.1  # mm between the points of a profile's spline
AUTOMATIC = Choices()
SPIKE, APART = 20.0, 0.05  # times the noise, and mm, that a point stands off at least ...
BEND = 0.1  # ... and times the squared distance to its neighbours: 1/mm, an edge of R1.25
REPEATED = 0.75  # of the y in the middle half are different, at least, or y repeats ...
COARSE = 0.1  # mm: ... and is too coarse where the points at one y are farther apart in height
PASS = 20  # points between two turns of a gauge that goes there and back, at least
EDGE = 0.02  # of the width at either end that the report leaves out


@dataclass(frozen=True)
class Measured:
    """A profile from a file. said: how it was read and turned, in words; smoothed: the curve
    through its points; profile: its longest part that faces upwards."""

    path: Path
    body: str
    said: tuple[str, ...]
    smoothed: Smoothed
    profile: Profile

    @property
    def points(self) -> Array:
        """(n, 2) in the axes of profiles, mm."""
        return self.smoothed.points

    @property
    def facing(self) -> NDArray[np.bool_]:
        """Which points (n,) the profile holds, without the outermost at each end."""
        start, end = inner(self.profile)
        y = self.points[:, 0]
        return np.asarray((y > start) & (y < end))

    @property
    def sharpest(self) -> tuple[float, float]:
        """Largest curvature either way before and after smoothing, 1/mm."""
        within, smoothed = self.facing[1:-1], self.smoothed
        before = np.abs(smoothed.rough_curvature()[within])
        after = np.abs(smoothed.curvature(smoothed.s[1:-1][within]))
        return float(before.max()), float(after.max())

    def wavelength(self, y: float) -> float:
        """Of the smoothing at a place across, mm."""
        across = self.smoothed.curve(self.smoothed.places)[:, 0]
        return float(self.smoothed.wavelength[np.argmin(np.abs(across - y))])

    @property
    def wavelengths(self) -> tuple[float, float]:
        """The shortest and the longest of the profile, mm."""
        start, end = inner(self.profile)
        across = self.smoothed.curve(self.smoothed.places)[:, 0]
        within = self.smoothed.wavelength[(across > start) & (across < end)]
        return float(within.min()), float(within.max())

    def summary(self) -> dict[str, Any]:
        """As in summary.json."""
        before, after = self.sharpest
        return {
            "file": str(self.path),
            "read": list(self.said),
            "points": len(self.points),
            "noise_mm": self.smoothed.noise,
            "smoothing_mm": list(self.wavelengths),
            "largest_curvature_before_per_mm": before,
            "largest_curvature_after_per_mm": after,
        }


def inner(profile: Profile) -> tuple[float, float]:
    """Its domain without the outermost 2 % at each end, mm."""
    start, end = profile.domain
    margin = EDGE * (end - start)
    return start + margin, end - margin


def from_points(
    name: str, points: Array, wavelength: float | None = None, stretch: float = 1.0
) -> tuple[Smoothed, Profile]:
    """The curve through points (n, 2) in the axes of profiles, mm, in any order along it or by y,
    and its longest part that faces upwards.

    wavelength, stretch: as in `smoothing.smooth`. Raises ValueError for too few points, points that
    are not finite, and a curve that faces nowhere upwards; PointError for a gap between them and
    where they run over the same place twice.
    """
    points = np.asarray(points, dtype=float)
    if not np.isfinite(points).all():
        raise ValueError("holds points that are not finite; give finite numbers")
    smoothed = smoothing.smooth(_in_order(points), wavelength, stretch)
    s = np.linspace(0, smoothed.length, max(2, math.ceil(smoothed.length / SAMPLE)) + 1)
    tangent = smoothed.curve(s, 1)
    faces = tangent[:, 0] > STEEP * np.linalg.norm(tangent, axis=1)
    y, z = smoothed.curve(s[_longest(faces)]).T
    if len(y) < 4:
        raise ValueError("has no part that faces upwards; give points across the running surface")
    return smoothed, Profile(name, (Spline(float(y[0]), float(y[-1]), CubicSpline(y, z)),))


def read(
    path: Path,
    body: str,
    choices: Choices = AUTOMATIC,
    wavelength: float | None = None,
    slope: float = 0.0,
    stretch: float = 1.0,
) -> Measured:
    """The profile of a 'rail' or 'wheel' in a file.

    choices: what the person says of it; wavelength, stretch: as in `smoothing.smooth`; slope: that
    it is rolled by about the origin. Raises InstrumentError, ValueError, OSError.
    """
    changed = path.stat().st_mtime_ns
    return _read(path, changed, body, choices, wavelength, slope, stretch)


@lru_cache(maxsize=16)
def _read(
    path: Path, _: int, body: str, choices: Choices, wavelength: float | None,
    slope: float, stretch: float,
) -> Measured:  # fmt: skip
    table = instruments.read(path)
    if table.body and table.body != body:
        raise InstrumentError(path.name, 1, f"is a {table.body}'s; give one of a {body}")
    points = table.points
    try:
        points, found = orientation.turned(table, body, choices)
        kept = _once(points)
        cosine = math.cos(math.atan(slope))
        roll = cosine * np.array([[1.0, slope], [-slope, 1.0]])
        points = points @ roll
        smoothed, profile = from_points(path.stem, kept @ roll, wavelength, stretch)
    except PointError as error:
        line = _line(table, points, error.place)
        raise InstrumentError(path.name, line, str(error)) from None
    except ValueError as error:
        raise ValueError(f"{path.name} {error}") from None
    if len(kept) < len(points):
        found.append(f"points at the same y averaged to {len(kept)}")
    said = (f"{table.format}, {len(table.points)} points", *found, *table.remarks)
    measured = Measured(path, body, said, smoothed, profile)
    spikes = _spikes(measured, table, points)
    return replace(measured, said=(*said, *spikes))


def _line(table: Table, points: Array, place: Array) -> int:
    """Of the point nearest to a place; points: the table's, in the axes of the place."""
    nearest = int(np.argmin(np.abs(points - place).max(axis=1)))
    return table.lines[nearest] if table.lines else nearest + 1


def _spikes(measured: Measured, table: Table, points: Array) -> list[str]:
    """Points that stand off where their neighbours are, in words: they are kept."""
    smoothed = measured.smoothed
    off = smoothing.standing_off(smoothed.points) * measured.facing
    spacing = smoothed.length / (len(smoothed.points) - 1)
    found = np.flatnonzero(off > max(SPIKE * smoothed.noise, APART, BEND * spacing**2))
    if not len(found):
        return []
    worst = smoothed.points[np.argmax(off)]
    count = "1 point stands" if len(found) == 1 else f"{len(found)} points stand"
    up_to = "" if len(found) == 1 else "up to "
    return [f"WARNING: {count} off by {up_to}{off.max():.2g} mm at y = {worst[0]:.1f}, "
            f"line {_line(table, points, worst)}: taken for shape"]  # fmt: skip


def _once(points: Array) -> Array:
    """Points (n, 2) with those that follow each other at the same y averaged if y repeats: in the
    middle half of the width, where no face is vertical, too few are different. Raises PointError
    where such points are far apart in height: y is rounded too coarsely."""
    y = points[:, 0]
    middle = y[np.abs(y - (y.min() + y.max()) / 2) < np.ptp(y) / 4]
    if len(np.unique(middle)) >= REPEATED * len(middle):
        return points
    starts = np.flatnonzero(np.concatenate([[True], np.diff(y) != 0]))
    counts = np.diff(np.append(starts, len(y)))
    high, low = (each.reduceat(points[:, 1], starts) for each in (np.maximum, np.minimum))
    if np.quantile(high - low, 0.9) > COARSE:
        text = "has rounded y: points at the same y are up to "
        worst = int(np.argmax(high - low))
        raise PointError(f"{text}{(high - low)[worst]:.2g} mm apart in height; give more digits",
                         points[starts[worst]])  # fmt: skip
    return np.asarray(np.add.reduceat(points, starts) / counts[:, None])


def _in_order(points: Array) -> Array:
    """As in the file, or by y where that is the shorter way; from left to right."""
    order = np.argsort(points[:, 0], kind="stable")
    ways = (points, points[order])
    lengths = [np.linalg.norm(np.diff(way, axis=0), axis=1).sum() for way in ways]
    if lengths[1] < lengths[0]:
        _refuse_passes(points, order)
    way = ways[int(lengths[1] < lengths[0])]
    return way if way[-1, 0] > way[0, 0] else way[::-1]


def _refuse_passes(points: Array, order: NDArray[np.intp]) -> None:
    """A gauge that went there and back: few turns, but most neighbours across are of two passes.
    Raises PointError."""
    y = points[:, 0]
    low, high = np.quantile(y, (0.25, 0.75))
    outer = np.flatnonzero((y < low) | (y > high))
    turns = outer[1:][np.diff(np.sign(y[outer] - (low + high) / 2)) != 0]
    mixed = np.mean(np.abs(np.diff(order)) > 1) > 0.5
    if mixed and 2 <= len(turns) <= len(y) / PASS:
        text = "runs over the same place twice, at the latest here; give one pass"
        raise PointError(text, points[turns[1]])


def _longest(faces: NDArray[np.bool_]) -> slice:
    """The longest run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], faces, [False]]).astype(int)))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return slice(0, 0)
    start, end = runs[np.argmax(runs[:, 1] - runs[:, 0])]
    return slice(int(start), int(end))


@dataclass(frozen=True)
class Smoothness:
    """curvatures: 5, 50 and 95 % of the profile lie below them, 1/mm, positive is convex; waves:
    changes between convex and concave; both without the outermost 2 % at each end."""

    curvatures: tuple[float, float, float]
    waves: int


def smoothness(profile: Profile) -> Smoothness:
    """What a contact will see of a measured profile: a wavy curvature scatters the pressure."""
    curvature = profile.curvature(np.linspace(*inner(profile), 2001))
    low, middle, high = (float(value) for value in np.quantile(curvature, (0.05, 0.5, 0.95)))
    return Smoothness((low, middle, high), int(np.sum(np.diff(np.sign(curvature)) != 0)))
