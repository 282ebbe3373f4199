"""A surface z(x, y) through sections of a rail: smooth where they are, with their kinks.

Sections are divided at the places that belong to each other (`Section.anchors`). Between two of
them points at the same share of the length are joined, beyond the outermost ones points at the same
length from it, so that a head that shifts, widens or turns keeps its arcs. Along the rail cubic
splines run through the sections; they end at kinks and where the distance of sections jumps.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import InterpolatedUnivariateSpline, RectBivariateSpline

from railhead.geometry.sections import STEEP, Head
from railhead.theory.array_types import Array

SAMPLE = 0.1  # mm along a section between two points of a strip, about
BESIDE = 3  # sections beyond a stretch that shape it
KINK, ALONE = (
    2e-3,
    4.0,
)  # slope that jumps, at least, and times as much as at the sections beside it
JUMP = 3.0  # ratio of two distances of sections over which nothing smooth is known
STEPS, SOLVED = 30, 1e-8  # of Newton's method, and of the share of a strip's width
EDGE = 1e-9  # of a strip's width
FACE, FAR = 0.05, 1600  # mm, and as often to either side
LEAST = 1e-3  # mm: shorter strips are none


@dataclass(frozen=True, kw_only=True, eq=False)
class Strip:
    """Part of a surface between two lines along the rail, v = 0 and v = 1, and two sections.

    first, last: places of the sections, mm.
    edges: splines of x, the y of both lines, mm.
    y, z: splines of x and v, mm.
    """

    first: float
    last: float
    edges: tuple[InterpolatedUnivariateSpline, InterpolatedUnivariateSpline]
    y: RectBivariateSpline
    z: RectBivariateSpline

    def __call__(self, x: Array, y: Array) -> tuple[Array, Array, Array]:
        """Height (n,) in mm and slopes (n,) along and across at x, y (n,), mm; NaN beyond the strip
        and where it faces down.
        """
        found = np.full((3, len(x)), np.nan)
        low, high = (edge(x) for edge in self.edges)
        room = EDGE * (1 + np.abs(high - low))
        inside = (x >= self.first) & (x <= self.last) & (y >= low - room) & (y <= high + room)
        if inside.any():
            near = np.flatnonzero(inside)
            start = (y[near] - low[near]) / np.maximum(high[near] - low[near], EDGE)
            found[:, near] = self._solved(x[near], y[near], np.clip(start, 0.0, 1.0))
        return found[0], found[1], found[2]

    def _solved(self, x: Array, y: Array, v: Array) -> Array:
        """Height and slopes (3, n) as of `__call__` at places of the strip, by Newton's method from
        a first guess v (n,).
        """
        for _ in range(STEPS):
            rate = self.y.ev(x, v, dy=1)
            step = (self.y.ev(x, v) - y) / np.where(rate > 0, rate, np.inf)
            before, v = v, np.clip(v - step, 0.0, 1.0)
            if not np.any(np.abs(v - before) > SOLVED):  # the next step is below rounding
                break
        across = self.z.ev(x, v, dy=1) / np.where(rate > 0, rate, np.nan)
        along = self.z.ev(x, v, dx=1) - across * self.y.ev(x, v, dx=1)
        return np.array([np.where(rate > 0, self.z.ev(x, v), np.nan), along, across])

    def points(self, step: float) -> Array:
        """Points (n, m, 3) of the strip about `step` mm apart along the rail, and across."""
        count = max(2, 1 + int(np.ceil((self.last - self.first) / step)))
        x = np.linspace(self.first, self.last, count)
        ends = (np.array([self.y(x, [v]), self.z(x, [v])]) for v in (0.0, 1.0))
        wide = float(np.abs(np.subtract(*ends)).max())
        v = np.linspace(0.0, 1.0, max(3, 1 + int(np.ceil(wide / step))))
        y, z = self.y(x, v), self.z(x, v)
        return np.stack([np.broadcast_to(x[:, None], y.shape), y, z], axis=-1)


@dataclass(frozen=True, eq=False)
class Lofted:
    """Surface z(x, y) of a stretch of a head, the highest of its strips; NaN beyond them.
    strips: parts between anchors, and between kinks, along the x of the sections.
    origin: place of x = 0 along the sections, mm.
    """

    strips: tuple[Strip, ...]
    origin: float = 0.0

    def __call__(self, x: Array, y: Array) -> tuple[Array, Array, Array]:
        """Height (n,) in mm and slopes (n,) along and across at x, y (n,), mm; NaN beyond it."""
        found, x = np.full((3, len(x)), np.nan), x + self.origin
        for strip in self.strips:
            values = np.array(strip(x, y))
            higher = ~(values[0] <= found[0]) & np.isfinite(values[0])
            found[:, higher] = values[:, higher]
        return found[0], found[1], found[2]

    @property
    def stretch(self) -> tuple[float, float]:
        """First and last x, mm."""
        x = [end for strip in self.strips for end in (strip.first, strip.last)]
        return min(x) - self.origin, max(x) - self.origin

    def ends(self, x: float) -> list[tuple[float, float]]:
        """First and last point (y, z) of the section at x, mm."""
        at = np.array([x + self.origin])
        here = [strip for strip in self.strips if strip.first <= at[0] <= strip.last]
        low, high = ([float(strip.edges[side](at)[0]) for strip in here] for side in (0, 1))
        found = np.array([min(low), max(high)])
        return list(zip(found, self(np.full(2, x), found)[0], strict=True))

    def face(self, x: float, y: float, slope: float = 0.0) -> tuple[float, float]:
        """First and last y around a place (mm) up to which the section there is turned by less than
        60 deg (STEEP) against a slope, to 0.05 mm (FACE); twice y where the place itself is not.
        """
        across = y + FACE * np.arange(-FAR, FAR + 1)
        turned = np.arctan(self(np.full_like(across, x), across)[2]) - np.arctan(slope)
        beyond = ~(np.abs(turned) < np.arctan(STEEP[0]))
        if beyond[FAR]:
            return y, y
        ends = np.flatnonzero(np.concatenate([[True], beyond, [True]])) - 1
        after = int(np.searchsorted(ends, FAR))
        return float(across[ends[after - 1] + 1]), float(across[ends[after] - 1])


def loft(head: Head, low: float, high: float, *, smooth: bool = True, every: int = 1) -> Lofted:
    """Surface of a head for x from low to high, mm, as far as it has sections there.

    smooth: whether sections are smooth curves; else straight lines through their points.
    every: 2 leaves out every second section, which shows what their distance does.
    """
    strips: list[Strip] = []
    for run in _runs(head, every):
        x = head.x[run]
        near = np.flatnonzero((x >= low) & (x <= high))
        around = np.flatnonzero((x[:-1] <= high) & (x[1:] >= low))
        if not (near.size or around.size):
            continue
        inside = np.concatenate([near, around, around + 1])
        kept = run[max(inside.min() - BESIDE, 0) : inside.max() + BESIDE + 1]
        if len(kept) > 1:
            strips += _strips(head, kept, smooth)
    return Lofted(tuple(each for each in strips if each.last >= low and each.first <= high))


def _runs(head: Head, every: int) -> list[Array]:
    """Indices of the sections between two ends of a head, a row for each."""
    after = sorted(each + 1 for each in head.ends)
    whole = (run for run in np.split(np.arange(len(head.x)), after) if len(run) > 1)
    return [np.union1d(run[::every], run[-1:]) for run in whole]


def _strips(head: Head, run: Array, smooth: bool) -> list[Strip]:
    """Strips through the sections of a run (n,) of indices."""
    sections, x = [head.load(int(index)) for index in run], head.x[run]
    anchors = np.array([each.anchors for each in sections])
    anchors = anchors[:, np.isfinite(anchors).all(axis=0)]
    length = np.array([each.s[-1] for each in sections])
    if anchors.shape[1]:
        before, behind = anchors[:, 0].min(), (length - anchors[:, -1]).min()
        anchors = np.column_stack([anchors[:, 0] - before, anchors, anchors[:, -1] + behind])
    else:
        anchors = np.column_stack([0 * length, length])
    strips = []
    for first, last in zip(anchors.T, anchors.T[1:], strict=False):
        longest = float((last - first).max())
        if longest < LEAST:
            continue
        v = np.linspace(0.0, 1.0, max(5, 1 + int(np.ceil(longest / SAMPLE))))
        places = first[:, None] + np.multiply.outer(last - first, v)
        places = np.minimum(places, length[:, None])
        points = np.array(
            [
                (each if smooth else each.straight)(s)
                for each, s in zip(sections, places, strict=True)
            ]
        )
        ends = [0, *_kinks(x, points), len(x) - 1]
        for a, b in zip(ends, ends[1:], strict=False):
            at, on = x[a : b + 1], points[a : b + 1]
            if b - a == 1:  # of a straight line FITPACK gives no slopes
                at, on = (
                    at[0] + (at[1] - at[0]) * np.arange(3) / 2,
                    np.array([on[0], on.mean(axis=0), on[1]]),
                )
            degree = min(3, len(at) - 1)
            y, z = (RectBivariateSpline(at, v, on[:, :, k], kx=degree) for k in (0, 1))
            edges = (InterpolatedUnivariateSpline(at, on[:, k, 0], k=degree) for k in (0, -1))
            found = Strip(first=float(x[a]), last=float(x[b]), edges=(*edges,), y=y, z=z)
            strips.append(found)
    return strips


def _kinks(x: Array, points: Array) -> list[int]:
    """Indices of inner sections at which lines along the rail have a kink, or their distance jumps.
    x: (n,) places, mm. points: (n, m, 2) on the m lines, mm.
    """
    step = np.diff(x)
    slope = np.diff(points, axis=0) / step[:, None, None]
    jump = np.sqrt(np.mean(np.diff(slope, axis=0) ** 2, axis=(1, 2)))
    beside = np.pad(jump, 1)
    beside = np.maximum(beside[:-2], beside[2:])
    ratio = np.exp(np.abs(np.diff(np.log(step))))
    return (1 + np.flatnonzero((jump > KINK) & (jump > ALONE * beside) | (ratio > JUMP))).tolist()
