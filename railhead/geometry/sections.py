"""Rails that are given by sections along the way: their tables, and the heads in them.

A table is a .csv file with the columns x_mm and file, or a .slcs file of CONTACT (E. Vollebregt,
User guide for CONTACT): offset and scale of the places, numbers of sections and features, then a
place and a file a line, then, for two features or more, a place and the lengths along the section
at which they lie, -1 where one is absent.
"""

import csv
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from railhead.geometry.measured import formats, ordering, smoothing
from railhead.geometry.measured.formats import MM_OF_UNIT, FormatError
from railhead.geometry.measured.orientation import FROM_SHAPE, Orientation
from railhead.theory.array_types import Array, Index

CORNER, CHORD, SHARP = math.radians(12.0), 1.0, 0.5
"""A corner turns by so much within 1 mm to either side, and by half of that at a single point."""
STEEP = np.tan(np.radians([60.0, 30.0]))  # slopes where head and flank part, on either side
BENDS, EXACT = 16.0, 1e-5  # times a deviation over the distance squared; less is no curvature, 1/mm
APART = 0.5  # mm, of the valley between two heads at least
DEPTH = 30.0  # mm below its top that count of a head
FEWEST = 2  # sections


@dataclass(frozen=True, kw_only=True)
class Listed:
    """A line of a table of sections.

    x: place along the rail, mm.
    path: file of the section.
    features: lengths in mm along the section from its first point, NaN where one is absent; empty
        where the table gives none.
    """

    x: float
    path: Path
    features: tuple[float, ...] = ()


def named(path: Path) -> dict[Path, str]:
    """Names in a table of sections of the files beside it, by their paths; empty for another file,
    and for a table that cannot be read.
    """
    try:
        return {each.path: each.path.relative_to(path.parent).as_posix() for each in _listed(path)}
    except (ValueError, OSError):
        return {}


def _listed(path: Path) -> tuple[Listed, ...]:
    """The lines of a table of sections, ascending. Raises
    FormatError for a file that is no table.
    """
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    found = (_slices if path.suffix.lower() == ".slcs" else _rows)(path, lines)
    if len(found) < FEWEST:
        raise FormatError(path.name, len(lines), f"has {len(found)} sections; give 2 or more")
    for line, (here, after) in enumerate(zip(found, found[1:], strict=False), 1):
        if not after.x > here.x:
            raise FormatError(
                path.name,
                len(lines),
                f"section {line + 1} at {after.x:g} does not follow that at {here.x:g}; "
                "give rising places",
            )
    for each in found:
        if not each.path.is_file():
            raise FormatError(
                path.name,
                len(lines),
                f"names {each.path.name}, which is no file beside it; give files that exist",
            )
    return found


def _rows(path: Path, lines: list[str]) -> tuple[Listed, ...]:
    """Sections of a .csv file. Raises FormatError for one without the columns x_mm and file, and
    for a place that is no number.
    """
    kept = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and line[:1] != "#"]
    found = []
    rows = csv.DictReader((line for _, line in kept), skipinitialspace=True)
    if not {"x_mm", "file"} <= set(rows.fieldnames or ()):
        raise FormatError(path.name, 1, "has no columns x_mm and file; give both in its first line")
    for (number, _), row in zip(kept[1:], rows, strict=False):
        x = _number(path, number, row["x_mm"] or "")
        found.append(Listed(x=x, path=path.parent / (row["file"] or "").strip()))
    return tuple(found)


def _slices(path: Path, lines: list[str]) -> tuple[Listed, ...]:
    """Sections of a .slcs file. Raises FormatError for one that ends early or is none."""
    bare = [(n, line.split("%")[0].strip()) for n, line in enumerate(lines, 1)]
    head = [each for each in bare if each[1]]
    named = [each for each in head if re.search(r"['\"]", each[1])]
    if not named or len(head) < 4:
        raise FormatError(
            path.name,
            len(lines),
            "names no sections; give U_OFFSET, U_SCALE, NSLC, NFEAT, and 'files'",
        )
    offset, scale = (_number(path, head[0][0], text) for text in (head[0][1].split() + [""])[:2])
    count, features = (int(_number(path, n, line.split()[0])) for n, line in head[1:3])
    if len(named) != count:
        raise FormatError(
            path.name,
            named[-1][0],
            f"names {len(named)} sections, but NSLC = {count}; give as many",
        )
    behind = [each for each in head if each[0] > named[-1][0]] if features > 1 else []
    lengths: dict[float, tuple[float, ...]] = {}
    for number, line in behind:
        place, *values = (_number(path, number, text) for text in line.split())
        if len(values) != features:
            raise FormatError(
                path.name,
                number,
                f"has {len(values)} features, but NFEAT = {features}; give as many",
            )
        lengths[place] = tuple(each if each >= 0 else math.nan for each in values)
    found = []
    for number, line in named:
        text, file = re.split(r"['\"]", line)[:2]
        at = _number(path, number, text)
        if behind and at not in lengths:
            raise FormatError(path.name, number, f"features of {at:g} are missing; give them")
        found.append(
            Listed(x=scale * (at + offset), path=path.parent / file, features=lengths.get(at, ()))
        )
    return tuple(found[:: -1 if scale < 0 else 1])


def _number(path: Path, line: int, text: str) -> float:
    """The finite number of a text. Raises FormatError for anything else."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FormatError(path.name, line, f"{text.strip()[:40]!r} is no number; give one")
    return value


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """A head at one place along the rail.

    points: (n, 2) of (y, z), mm, in their order along it, from smaller to larger y.
    resolution: last digit of their coordinates, mm.
    features: lengths along the points, mm, that are joined with those of other sections, NaN where
        one is absent; empty: places of two slopes on either side of the top.
    """

    points: Array
    resolution: float
    features: tuple[float, ...] = ()

    @cached_property
    def s(self) -> Array:
        """Lengths (n,) along the straight lines through the points, mm."""
        return ordering.chord_lengths(self.points)

    @cached_property
    def corners(self) -> list[int]:
        """Indices of the points at which the section has a corner, and of its ends."""
        turn, s = ordering.turns(self.points), self.s
        before, after = (
            np.column_stack([np.interp(at, s, axis) for axis in self.points.T])
            for at in (s[1:-1] - CHORD, s[1:-1] + CHORD)
        )
        here = self.points[1:-1]
        one, two = here - before, after - here
        wide = np.arctan2(np.abs(ordering.cross(one, two)), np.einsum("nd,nd->n", one, two))
        sharp = np.flatnonzero((wide > CORNER) & (turn > SHARP * wide) & (turn > CORNER * SHARP))
        return [0, *(sharp + 1).tolist(), len(s) - 1]

    @cached_property
    def anchors(self) -> Array:
        """Lengths (k,) along the section, mm, that belong to those of other sections: the features
        that are given, else where it is as steep as 60 and 30 deg on either side of its top, first;
        NaN where it is not. A corner that turns through such a slope is its place.
        """
        if self.features:
            return np.array(self.features)
        step, middle = np.diff(self.points, axis=0), (self.s[1:] + self.s[:-1]) / 2
        top = int(np.argmax(self.points[:, 1]))
        found = []
        for side in (-1, 1):
            way = np.arange(top - 1, -1, -1) if side < 0 else np.arange(top, len(step))
            for steep in STEEP if side < 0 else STEEP[::-1]:
                falls = -side * step[way, 1] - steep * np.abs(step[way, 0]) > 0
                at = int(np.argmax(falls)) if falls.any() else 0
                found.append(self._between(middle, way, at, steep) if at else math.nan)
        return np.array(found)

    def _between(self, middle: Array, way: Index, at: int, steep: float) -> float:
        """Length, mm, between the middles of two lines, way[at - 1] and way[at], at which the slope
        is `steep`, or that of a corner between them.
        """
        ends = way[at - 1 : at + 1]
        corner = int(ends.max())
        if corner in self.corners:
            return float(self.s[corner])
        slopes = [abs(np.arctan2(*np.diff(self.points[k : k + 2], axis=0)[0, ::-1])) for k in ends]
        return float(np.interp(math.atan(steep), slopes, middle[ends]))

    def __call__(self, s: Array) -> Array:
        """Points (n, 2), mm, of the smooth curves between corners, at lengths s (n,), mm."""
        found, ends = np.empty((len(s), 2)), self.corners
        for first, last in zip(ends, ends[1:], strict=False):
            inside = (s >= self.s[first]) & (s <= self.s[last])
            if inside.any():
                found[inside] = self._curve(first, last)(s[inside] - self.s[first])
        return found

    def straight(self, s: Array) -> Array:
        """Points (n, 2), mm, on the straight lines through the points, at lengths s (n,), mm."""
        return np.column_stack([np.interp(s, self.s, axis) for axis in self.points.T])

    def _curve(self, first: int, last: int) -> Callable[[Array], Array]:
        """Curve between two corners, of the length from the first one, mm."""
        if (first, last) not in self._curves:
            self._curves[first, last] = _curve(self.points[first : last + 1], self.resolution)
        return self._curves[first, last]

    @cached_property
    def _curves(self) -> dict[tuple[int, int], Callable[[Array], Array]]:
        """Curves that were made, by the indices of their corners."""
        return {}


def _curve(points: Array, resolution: float) -> Callable[[Array], Array]:
    """Curve along points (n, 2), mm, of the length along their straight lines, mm: through them
    where their rounding (mm) makes no curvature, else smooth within their noise.
    """
    s = ordering.chord_lengths(points)
    few, apart = len(points) < smoothing.LEAST_POINTS, float(np.median(np.diff(s)))
    level = 0.0 if few else smoothing.drawn_to(smoothing.noise(points), resolution, apart)
    if few or 0 < BENDS * level < EXACT * apart**2:
        return CubicSpline(s, points) if len(points) > 2 else lambda at: _line(at, s, points)
    smoothed = smoothing.smooth(points, resolution=resolution)
    return lambda at: np.asarray(smoothed.curve(at * (smoothed.length / s[-1])))


def _line(at: Array, s: Array, points: Array) -> Array:
    """Points (n, 2) at lengths `at` (n,) on the line through two points (2, 2) at lengths s."""
    return np.column_stack([np.interp(at, s, axis) for axis in points.T])


@dataclass(frozen=True, kw_only=True, eq=False)
class Head:
    """One head of a rail that is given by sections.

    x: (n,) places of its sections, ascending, mm.
    ends: indices behind which it is interrupted, as no section follows at the next place.
    load: returns the section of an index; raises FormatError for a file that is none.
    """

    x: Array
    ends: frozenset[int]
    load: Callable[[int], Section]


def heads(path: Path, given: Orientation = FROM_SHAPE, *, split: bool = True) -> tuple[Head, ...]:
    """The heads of a rail in a table of sections: one, or two from smaller to larger y.
    given: unit, mirror, flip and shift of the files; z of a .csv table's files points up.
    split: whether a section may have two heads, divided by a valley.
    Raises FormatError for a file that is no table, or no section.
    """
    return _heads(path, path.stat().st_mtime_ns, given, split)


@lru_cache(maxsize=8)
def _heads(path: Path, _: int, given: Orientation, split: bool) -> tuple[Head, ...]:
    """Heads as of `heads`; `_`: time of the last change of the table."""
    listed = _listed(path)
    down = path.suffix.lower() == ".slcs"
    x = np.array([each.x for each in listed])

    @cache
    def load(index: int) -> Section:
        """The section of an index."""
        points, digit = _points(listed[index].path, given, down)
        return Section(points=points, resolution=digit, features=listed[index].features)

    if not split:
        return (Head(x=x, ends=frozenset(), load=load),)
    whole = [load(index) for index in range(len(x))]
    cuts = [_valley(each.points) for each in whole]
    two = [index for index, cut in enumerate(cuts) if cut]
    if not two:
        return (Head(x=x, ends=frozenset(), load=whole.__getitem__),)
    parts: tuple[dict[int, Section], dict[int, Section]] = {}, {}
    for index in sorted(range(len(x)), key=lambda at: min(abs(at - each) for each in two)):
        section, cut = whole[index], cuts[index]
        if cut:
            parts[0][index], parts[1][index] = _cut(section, cut)
            continue
        beside = index + (1 if min(two, key=lambda at: abs(at - index)) > index else -1)
        known = [part for part in parts if beside in part]
        same = min(known, key=lambda part: abs(_middle(part[beside]) - _middle(section)))
        same[index] = section
    return tuple(_part(x, part) for part in parts)


def _part(x: Array, part: dict[int, Section]) -> Head:
    """Head with sections by index of their places x (n,), mm."""
    at = np.array(sorted(part))
    ends = frozenset(np.flatnonzero(np.diff(at) > 1).tolist())
    return Head(x=x[at], ends=ends, load=[part[index] for index in at].__getitem__)


def _middle(section: Section) -> float:
    """y halfway between the ends of a section, mm."""
    return float(section.points[[0, -1], 0].mean())


def _cut(section: Section, cut: int) -> list[Section]:
    """Both parts of a section, each with the point at which it is cut, without what is 30 mm
    (DEPTH) below its top; features are given to none.
    """
    found = []
    for points in (section.points[: cut + 1], section.points[cut:]):
        high = np.flatnonzero(points[:, 1] > points[:, 1].max() - DEPTH)
        points = points[high[0] : high[-1] + 1]
        found.append(Section(points=points, resolution=section.resolution))
    return found


def _valley(points: Array) -> int:
    """Index of the lowest of points (n, 2), mm, between the two tops that stand out most; 0 where
    there is one top.
    """
    from scipy.signal import find_peaks  # loads scipy.stats, which takes 0.3 s

    z = np.pad(points[:, 1], 1, constant_values=points[:, 1].min() - DEPTH)
    peaks, found = find_peaks(z, prominence=APART, plateau_size=(None, None))
    if len(peaks) < 2:
        return 0
    first, last = sorted(peaks[np.argsort(found["prominences"])[-2:]] - 1)
    return int(first + np.argmin(points[first : last + 1, 1]))


def _points(path: Path, given: Orientation, down: bool) -> tuple[Array, float]:
    """Points (n, 2) of a section's file in mm, y rising from the first to the last and z up, and
    their last digit, mm.
    down: whether z may point down, so that the shape is asked.
    """
    table = formats.read(path, unit_is_given=given.unit != "auto")
    unit = table.unit if given.unit == "auto" else given.unit
    points = table.points
    unit = unit or ("mm" if float(np.ptp(points[:, 0])) > 1 else "m")
    signs = {"on": -1.0, "off": 1.0}
    up = signs.get(given.flip, float(table.outward or 0)) or (_up(points) if down else 1.0)
    side = signs.get(given.mirror, float(table.field or 1))
    points = points * MM_OF_UNIT[unit] * [side, up] + given.shift
    if points[0, 0] > points[-1, 0]:
        points = points[::-1]
    repeated = np.linalg.norm(np.diff(points, axis=0, prepend=np.nan), axis=1) == 0
    return points[~repeated], MM_OF_UNIT[unit] * table.resolution


def _up(points: Array) -> float:
    """1 where points (n, 2), y rising from the first to the last, lie above the line between these
    two on the whole, as steel lies below a rail, else -1.
    """
    (y, z), (dy, dz) = points[:-1].T - points[:1].T, np.diff(points, axis=0).T
    return 1.0 if np.sum(y * dz - z * dy) < 0 else -1.0
