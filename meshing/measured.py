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
from scipy.spatial import cKDTree

from railhead.meshing import instruments, orientation, scans, smoothing, wear
from railhead.meshing.dialects import InstrumentError, Table
from railhead.meshing.orientation import Choices
from railhead.meshing.profiles import Profile, Spline
from railhead.meshing.smoothing import PointError, Smoothed

Array = NDArray[np.float64]
STEEP = 0.045  # of dy over ds: steeper faces than those of a standard rail's corners are cut off
SAMPLE = 0.1  # mm between the points of a profile's spline
LOOSE = 1.0  # mm beyond half a step between points, or two usual ones: no curve through them
FOLD, LOST = 20.0, 2.0  # mm along a part that turns back, at most, and across that it cuts off
AUTOMATIC = Choices()
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

    def evenly(self, step: float) -> Array:
        """Points (n, 2) of the smoothed curve that far apart, mm."""
        return np.asarray(self.smoothed.curve(np.arange(step / 2, self.smoothed.length, step)))

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
    smoothed = smoothing.smooth(scans.in_order(points), wavelength, stretch)
    s = np.linspace(0, smoothed.length, max(2, math.ceil(smoothed.length / SAMPLE)) + 1)
    tangent = smoothed.curve(s, 1)
    faces = tangent[:, 0] > STEEP * np.linalg.norm(tangent, axis=1)
    runs = _runs(faces)
    if np.diff(runs).max(initial=0) < 4:
        raise ValueError("has no part that faces upwards; give points across the running surface")
    curve, spacing = smoothed.curve(s), np.diff(smoothing.chord_lengths(smoothed.points))
    off = cKDTree(smoothed.points).query(curve)[0]
    if off.max() > max(spacing.max() / 2, 2 * float(np.median(spacing))) + LOOSE:
        raise smoothing.folded(smoothed.points)
    longest = int(np.argmax(np.diff(runs)))
    _refuse_folds(curve, float(s[1]), runs, longest, smoothed.points)
    y, z = curve[slice(*runs[longest])].T
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
    path: Path, changed: int, body: str, choices: Choices, wavelength: float | None,
    slope: float, stretch: float,
) -> Measured:  # fmt: skip
    table, points, kept, found = _turned(path, changed, body, choices)
    cosine = math.cos(math.atan(slope))
    roll = cosine * np.array([[1.0, slope], [-slope, 1.0]])
    points = points @ roll
    try:
        smoothed, profile = from_points(path.stem, kept @ roll, wavelength, stretch)
    except PointError as error:
        raise _refused(path, table, points, error) from None
    except ValueError as error:
        raise ValueError(f"{path.name} {error}") from None
    said = (f"{table.format}, {len(table.points)} points", *found, *table.remarks)
    measured = Measured(path, body, said, smoothed, profile)
    return replace(measured, said=(*said, *_warnings(measured, table, points)))


@lru_cache(maxsize=16)
def _turned(
    path: Path, _: int, body: str, choices: Choices
) -> tuple[Table, Array, Array, tuple[str, ...]]:
    """What a file holds, its points in the axes of profiles, those that are kept of them, and what
    was done to them: the same for all smoothing."""
    table = instruments.read(path, overruled=choices.unit != "auto")
    if table.body and table.body != body:
        raise InstrumentError(path.name, 1, f"is a {table.body}'s; give one of a {body}")
    points = table.points
    try:
        points, found = orientation.turned(table, body, choices)
        part = orientation.part(points, body)
        kept = scans.once(part)
    except PointError as error:
        raise _refused(path, table, points, error) from None
    if len(part) < len(points):
        found.append(f"cut off {scans.DEEP:g} mm below its top")
    if len(kept) < len(part):
        found.append(f"points at the same y averaged to {len(kept)}")
    if unlike := wear.unlike(scans.evenly(scans.in_order(kept), wear.STEP), body):
        found.append(f"WARNING: {unlike}; look at its picture, its columns and their units")
    return table, points, kept, tuple(found)


def _refused(path: Path, table: Table, points: Array, error: PointError) -> InstrumentError:
    """Points (n, 2): the table's, in the axes of the error's place."""
    return InstrumentError(path.name, _line(table, points, error.place), str(error))


def _line(table: Table, points: Array, place: Array) -> int:
    """Of the point nearest to a place; points: the table's, in the axes of the place."""
    nearest = int(np.argmin(np.abs(points - place).max(axis=1)))
    return table.lines[nearest] if table.lines else nearest + 1


def _warnings(measured: Measured, table: Table, points: Array) -> list[str]:
    """Points that stand off where their neighbours are, in words: they are kept."""
    found = []
    if spikes := scans.spikes(measured.smoothed, measured.facing):
        count, off, place = spikes
        stand = "1 point stands off by" if count == 1 else f"{count} points stand off by up to"
        found.append((f"{stand} {off:.2g} mm", place))
    if bend := scans.bend(measured.smoothed, *inner(measured.profile)):
        found.append((f"it bends by {bend[0]:.0f} deg and back within {scans.WAVE:g} mm", bend[1]))
    return [
        f"WARNING: {what} at y = {place[0]:.1f}, "
        f"line {_line(table, points, place)}: taken for shape"
        for what, place in found
    ]


def _runs(faces: NDArray[np.bool_]) -> NDArray[np.intp]:
    """First and behind the last (k, 2) of the runs of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], faces, [False]]).astype(int)))
    return edges.reshape(-1, 2)


def _refuse_folds(
    curve: Array, step: float, runs: NDArray[np.intp], longest: int, points: Array
) -> None:
    """Points of a curve (n, 2) that far apart, mm: what faces upwards beside the longest run is not
    cut off by a fold, as points (m, 2) that stand off make one. Raises PointError of the one where
    they turn most."""
    start, end = runs[longest]
    for first, behind in runs:
        gap = (behind, start) if behind <= start else (end, first)
        near = first != start and step * (gap[1] - gap[0] + 1) < FOLD
        if near and np.ptp(curve[first:behind, 0]) > LOST:
            raise smoothing.folded(points)


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
