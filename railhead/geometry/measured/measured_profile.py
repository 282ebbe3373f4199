"""Measured profiles: points from a file, brought to the axes of the project, smoothed."""

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from railhead.geometry.measured import formats, ordering, orientation, smoothing
from railhead.geometry.measured.smoothing import Smoothed
from railhead.geometry.profiles import Profile, Spline
from railhead.geometry.wheelset import GAUGE_HEIGHT, GaugeError, gauge_face, top
from railhead.theory.array_types import Array

STEEPEST = 0.045  # dy over ds: steeper faces than those of a standard rail's corners are cut off
SAMPLE, SHARP = 0.1, 0.02  # mm between the points of a profile's spline; of one that is drawn
LOOSE = 1.0  # mm beyond half a step between points, or two usual ones: no curve through them
CUT = 2.5  # mm across that undercut sides take of the width of a sound profile, at most
EDGE = 0.02  # share of the width at either end that reports leave out


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A profile from a file.
    path: the file.
    body: 'rail' or 'wheel'.
    remarks: how the file was read and turned.
    oriented: how its points were brought to the axes of profiles, without the inclination.
    roll: (2, 2) rotation of points as rows by the inclination.
    smoothed: the smooth curve along its points, in the axes of profiles, turned by the inclination.
    profile: the longest part of the curve that faces upwards, z(y).
    gaps: y (mm) of the points before and behind each gap or groove (`ordering.without_grooves`),
        over which the curve runs straight on.
    """

    path: Path
    body: str
    remarks: tuple[str, ...]
    oriented: orientation.Oriented
    roll: Array
    smoothed: Smoothed
    profile: Profile
    gaps: tuple[tuple[float, float], ...]

    @property
    def points(self) -> Array:
        """Measured points (n, 2) of (y, z), mm, in the axes of profiles and in their order along
        the curve, not smoothed; without web and foot.
        """
        return self.smoothed.points

    @property
    def places(self) -> dict[str, Array]:
        """Reference places (y, z) by name, mm, in the axes of profiles: flange back and tape circle
        of a wheel, crown centre and gauge point of a rail that reaches down to it.
        """
        if self.body == "wheel":
            return {
                "flange back": np.array([-self.oriented.tape_circle, 0.0]),
                "tape circle": np.zeros(2),
            }
        try:
            y = gauge_face(self.profile)
        except GaugeError:
            return {"crown": np.zeros(2)}
        point = np.array([y, top(self.profile)[1] - GAUGE_HEIGHT])
        return {"crown": np.zeros(2), "gauge point": point}

    @property
    def origin(self) -> dict[str, Any]:
        """The `places` in the axes of the file, mm: y of those of a wheel, (y, z) of those of a
        rail, None for a gauge point that is missing.
        """
        found = {
            f"{name.replace(' ', '_')}_mm": self.oriented.in_file(place @ self.roll.T)
            for name, place in self.places.items()
        }
        if self.body == "wheel":
            return {key: y for key, (y, _) in found.items()}
        return found | {"gauge_point_mm": found.get("gauge_point_mm")}

    def resampled(self, step: float) -> Array:
        """Points (m, 2) of the smoothed curve that are `step` mm of arc length apart, mm; the first
        lies half a step from the start.
        """
        return np.asarray(self.smoothed.curve(np.arange(step / 2, self.smoothed.length, step)))

    @property
    def wavelengths(self) -> tuple[float, float]:
        """Shortest and longest smoothing wavelength of the profile, mm, without the outermost 2 %
        at each end.
        """
        start, end = inner(self.profile)
        across = self.smoothed.curve(self.smoothed.places)[:, 0]
        within = self.smoothed.wavelength[(across > start) & (across < end)]
        return float(within.min()), float(within.max())

    def summary(self) -> dict[str, Any]:
        """Entries of summary.json: file, remarks ('read'), origin and sides, number of points,
        their median distance in mm, the last digit in mm of points that are taken as drawn (else
        0), noise in mm, and shortest and longest smoothing wavelength in mm (0 for points as
        drawn).
        """
        return {
            "file": self.path.name,
            "read": list(self.remarks),
            "origin": self.origin,
            "sides": self.oriented.sides,
            "points": len(self.points),
            "apart_mm": float(np.median(np.diff(self.smoothed.s))),
            "rounded_to_mm": self.smoothed.rounding,
            "noise_mm": self.smoothed.noise,
            "smoothing_mm": list(self.wavelengths),
        }


def inner(profile: Profile) -> tuple[float, float]:
    """First and last y of a profile without the outermost 2 % of the width at each end, mm."""
    start, end = profile.domain
    margin = EDGE * (end - start)
    return start + margin, end - margin


def from_points(
    name: str,
    points: Array,
    wavelength: float | None = None,
    stretch: float = 1.0,
    resolution: float = 0.0,
) -> tuple[Smoothed, Profile]:
    """The smooth curve along points (n, 2), and its longest part that faces upwards, as a profile
    with the given name. points: in the axes of profiles, mm, in either order along the curve or by
    y.
    wavelength: of waves that keep half of their height, mm, or None to choose by the noise.
    stretch, resolution: as of `smoothing.smooth`.
    Raises ValueError for too few points and a curve that faces nowhere upwards. Raises PointError
    for a gap between points, where they run over the same place twice, and where the curve bends
    back or, unless stretch is below 1, leaves its points or ends far from their ends.
    """
    smoothed = smoothing.smooth(ordering.in_order(points), wavelength, stretch, resolution)
    step = SHARP if smoothed.rounding else SAMPLE
    s = np.linspace(0, smoothed.length, max(2, math.ceil(smoothed.length / step)) + 1)
    tangent = smoothed.curve(s, 1)
    faces = tangent[:, 0] > STEEPEST * np.linalg.norm(tangent, axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], faces, [False]]).astype(int)))
    runs = edges.reshape(-1, 2)  # first index and index behind the last one of each run
    if np.diff(runs).max(initial=0) < 4:
        raise ValueError("has no part that faces upwards; give points across the running surface")
    curve, spacing = smoothed.curve(s), np.diff(ordering.chord_lengths(smoothed.points))
    off = cKDTree(smoothed.points).query(curve)[0]
    loose = off.max() > max(spacing.max() / 2, 2 * float(np.median(spacing))) + LOOSE
    longest = runs[np.argmax(np.diff(runs))]
    y, z = curve[slice(*longest)].T
    if stretch >= 1 and (loose or max(y[0] - curve[:, 0].min(), curve[:, 0].max() - y[-1]) > CUT):
        raise smoothing.folded(smoothed.points)
    face = tuple((float(at), float(down)) for at, down in curve[: longest[0]][::-1])
    return smoothed, Profile(name, (Spline(float(y[0]), float(y[-1]), CubicSpline(y, z)),), face)


def read(
    path: Path,
    body: str,
    given: orientation.Orientation = orientation.FROM_SHAPE,
    wavelength: float | None = None,
    slope: float = 0.0,
    stretch: float = 1.0,
) -> Measured:
    """The profile of a 'rail' or 'wheel' in a file; cached until the file changes.
    given: what the user says of the axes of the file.
    wavelength: of waves that keep half of their height, mm, or None to choose by the noise.
    slope: tangent of the angle by which the profile is turned about the origin, positive towards y
        < 0, as a rail leans.
    stretch: factor on the wavelengths, given or chosen.
    Raises FormatError, with the line of the file, for one that is no profile of this body, and for
    points that make none. Raises ValueError for a curve that faces nowhere upwards, OSError where
    the file cannot be read.
    """
    changed = path.stat().st_mtime_ns
    return _read(path, changed, body, given, wavelength, slope, stretch)


@lru_cache(maxsize=16)
def _read(
    path: Path,
    changed: int,
    body: str,
    given: orientation.Orientation,
    wavelength: float | None,
    slope: float,
    stretch: float,
) -> Measured:
    """The profile of a file that was last changed at `changed` (ns), for the same arguments as
    `read`; cached. Raises FormatError and ValueError as `read`.
    """
    table, oriented, kept, wide, remarks = _in_axes(path, changed, body, given)
    cosine = math.cos(math.atan(slope))
    roll = cosine * np.array([[1.0, slope], [-slope, 1.0]])
    listed = oriented.of_file(table.points) @ roll
    try:
        smoothed, profile = from_points(
            path.stem, kept @ roll, wavelength, stretch, table.resolution
        )
    except ordering.PointError as error:
        raise _refused(path, table, listed, error) from None
    except ValueError as error:
        raise ValueError(f"{path.name} {error}") from None
    y = (kept @ roll)[:, 0]
    gaps = tuple((float(y[i]), float(y[i + 1])) for i in wide)
    said = (f"a gap or groove from y = {one:.4g} to {other:.4g} mm" for one, other in gaps)
    return Measured(
        path=path,
        body=body,
        remarks=(*remarks, *said),
        gaps=gaps,
        oriented=oriented,
        roll=roll,
        smoothed=smoothed,
        profile=profile,
    )


@lru_cache(maxsize=16)
def _in_axes(
    path: Path, _: int, body: str, given: orientation.Orientation
) -> tuple[formats.Table, orientation.Oriented, Array, list[int], tuple[str, ...]]:
    """Table of a file in mm, its points in the axes of profiles, the points (m, 2) that are
    smoothed, indices of those before a gap, and remarks; cached, as it holds for all smoothing.
    The number `_` is the time of the last change, so that a changed file is read again. Raises
    FormatError for a file that is no profile of this body, where nothing tells its unit or axes,
    and for points with outliers or rounded coordinates.
    """
    table = formats.read(path, unit_is_given=given.unit != "auto")
    if table.body and table.body != body:
        raise formats.FormatError(path.name, 1, f"is a {table.body}'s; give one of a {body}")
    listed = table.points
    try:
        table, unit = orientation.in_mm(table, body, given.unit)
        listed = table.points
        way = ordering.in_order(listed)
        ordering.refuse_outlier(way)
        found = orientation.oriented(way, body, table, given)
        listed = found.of_file(table.points)
        head = ordering.head(found.points) if body == "rail" else found.points
        kept = ordering.without_loose_ends(head)
        ordering.refuse_rounded(kept)
    except ordering.PointError as error:
        raise _refused(path, table, listed, error) from None
    cut = [f"cut off {ordering.HEAD_DEPTH:g} mm below its top"] * (len(head) < len(listed))
    cut += [f"left out {len(head) - len(kept)} points beyond a gap"] * (len(kept) < len(head))
    read = (f"{table.format}, {len(listed)} points", unit, *found.done, *cut)
    return table, found, *ordering.without_grooves(kept), read


def _refused(
    path: Path, table: formats.Table, points: Array, error: ordering.PointError
) -> formats.FormatError:
    """The error at a point as an error of the line of the file, that of the nearest of points (n,
    2) of the table, in the axes of the error's place.
    """
    nearest = int(np.argmin(np.abs(points - error.place).max(axis=1)))
    return formats.FormatError(path.name, table.lines[nearest], str(error))
