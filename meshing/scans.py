"""What gauges do that is no shape: places scanned twice, y too coarse, points that stand off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from railhead.meshing.smoothing import GAP, PointError, Smoothed, chord_lengths, standing_off

Array = NDArray[np.float64]
SPIKE, APART = 20.0, 0.05  # times the noise, and mm, that a point stands off at least ...
BEND = 0.1  # ... and times the squared distance to its neighbours: 1/mm, an edge of R1.25
ROUNDED = 0.01  # mm: heights in steps above it make contacts that are not there
EXACT, UNEVEN = 1e-9, 1e-3  # relative: heights that are the same, and steps that are not
WILD, STEEP = 0.3, 3.0  # mm, and times the way to its neighbours: a point that far off is none
WAVE, STRIDE, BENT = 4.0, 0.1, 10.0  # mm, mm and deg: sound profiles bend to and fro by 2 to 4
REPEATED = 0.75  # of the y in the middle half are different, at least, or y repeats ...
COARSE = 0.1  # mm: ... and is too coarse where the points at one y are farther apart in height
DEEP = 45.0  # mm below the top at which a head ends
PASS = 20  # points between two turns of a gauge that goes there and back, at least


def once(points: Array) -> Array:
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


def in_order(points: Array) -> Array:
    """As in the file, or by y where that is the shorter way; from left to right, above where it
    closes."""
    order = np.argsort(points[:, 0], kind="stable")
    ways = (points, points[order])
    lengths = [np.linalg.norm(np.diff(way, axis=0), axis=1).sum() for way in ways]
    if lengths[1] < lengths[0]:
        _refuse_passes(points, order)
    way = ways[int(lengths[1] < lengths[0])]
    y, z = way.T
    if closes(way):
        return way if np.dot(y, np.roll(z, -1) - np.roll(z, 1)) < 0 else way[::-1]
    return way if y[-1] > y[0] else way[::-1]


def closes(way: Array) -> bool:
    """Whether points (n, 2) in their order along a curve, mm, come back to where they begin."""
    return bool(np.linalg.norm(way[-1] - way[0]) < GAP)


def head(points: Array) -> Array:
    """Points (n, 2) of a rail, mm, its head upwards: those of the head (m, 2), in their order along
    the curve where there is a web or a foot too, or where it closes."""
    way, least = in_order(points), points[:, 1].max() - DEEP
    if closes(way):
        way = np.roll(way, -int(np.argmin(way[:, 1])), axis=0)
    elif points[:, 1].min() >= least:
        return points
    top, low = int(np.argmax(way[:, 1])), np.flatnonzero(way[:, 1] < least)
    start = max(low[low < top], default=-1) + 1
    return way[start : min(low[low > top], default=len(way))]


def evenly(points: Array, step: float) -> Array:
    """Points (m, 2) that far apart on the straight lines through points (n, 2), mm."""
    s = chord_lengths(points)
    places = np.arange(step / 2, s[-1], step)
    return np.column_stack([np.interp(places, s, column) for column in points.T])


def check_digits(points: Array) -> None:
    """Points (n, 2) mm. Raises PointError, of the first one, where heights repeat because they are
    rounded: their stairs are no noise that could be smoothed away."""
    z = np.sort(points[:, 1])
    steps = np.diff(z)
    steps = steps[steps > EXACT * max(float(np.ptp(z)), EXACT)]
    if not len(steps) or len(steps) + 1 > REPEATED * len(z):
        return
    least = float(steps.min())
    if (
        least > ROUNDED * (1 + UNEVEN)
        and np.abs(steps / least - np.round(steps / least)).max() < UNEVEN
    ):
        text = f"has heights rounded to {least:.2g} mm; give more digits, {ROUNDED:g} mm at least"
        raise PointError(text, points[0])


def check_wild(points: Array) -> None:
    """Points (n, 2) in the order of the curve, mm, five at least. Raises PointError of one that
    stands so far off its neighbours that the curve would turn back on itself."""
    off, beside = standing_off(points), np.zeros(len(points))
    beside[1:-1] = np.linalg.norm(points[2:] - points[:-2], axis=1) / 2
    for end in (slice(0, 5), slice(-1, -6, -1)):
        off[end][:2], beside[end][:2] = _off_end(points[end]), beside[end][3]
    wild = np.where(off > np.maximum(WILD, STEEP * beside), off, 0.0)
    if wild.any():
        worst = int(np.argmax(wild))
        text = f"stands off its neighbours by {wild[worst]:.2g} mm; delete it, or give more points"
        raise PointError(text, points[worst])


def _off_end(points: Array) -> Array:
    """How far (2,) the first two of five points (5, 2) are off the way that the others lead to
    them, mm: by more than 60 deg aside, less may be an edge, or the second beyond the first."""
    way = (points[2] - points[4]) / np.linalg.norm(points[2] - points[4])
    reach = np.linalg.norm(points[:2] - points[2], axis=1)
    off = np.linalg.norm(points[:2] - points[2] - reach[:, None] * way, axis=1)
    beyond = float((points[1] - points[0]) @ way)
    return np.maximum(np.where(off > reach, off, 0.0), [0.0, beyond])


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


def bend(smoothed: Smoothed, start: float, end: float) -> tuple[float, Array] | None:
    """The largest angle (deg) by which the curve bends one way and back within WAVE between two y,
    and where (2,), if that is no running surface's any more."""
    s = np.arange(0.0, smoothed.length, STRIDE)
    dy, dz = smoothed.curve(s, 1).T
    angle, curve = np.degrees(np.unwrap(np.arctan2(dz, dy))), smoothed.curve(s)
    angles = np.lib.stride_tricks.sliding_window_view(angle, round(WAVE / STRIDE) + 1)
    back = np.ptp(angles, axis=1) - np.abs(angles[:, -1] - angles[:, 0])
    middle = curve[round(WAVE / STRIDE) // 2 :][: len(back)]
    back = np.where((middle[:, 0] > start) & (middle[:, 0] < end), back, 0.0)
    worst = int(np.argmax(back))
    return (float(back[worst]), middle[worst]) if back[worst] > BENT else None


def spikes(smoothed: Smoothed, facing: NDArray[np.bool_]) -> tuple[int, float, Array] | None:
    """How many of the points that take part, `facing` (n,), stand off where their neighbours are,
    by how much at most (mm), and where that one is (2,); None where none does."""
    off = standing_off(smoothed.points) * facing
    spacing = smoothed.length / (len(smoothed.points) - 1)
    count = np.count_nonzero(off > max(SPIKE * smoothed.noise, APART, BEND * spacing**2))
    if not count:
        return None
    return int(count), float(off.max()), smoothed.points[np.argmax(off)]
