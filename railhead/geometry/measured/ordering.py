"""Order of points along their curve, merging of repeated ones, the head of a whole section."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LARGEST_GAP = 5.0  # mm between neighbours
HEAD_DEPTH = 45.0  # mm below its top: what is deeper is web or foot
DISTINCT = 0.75  # share of different y in the middle half of the width; with fewer, y is repeated
COARSE = 0.1  # mm: heights of points at one y may differ by this much
PASS = 20  # points between two turns of a gauge that goes there and back, at least


class PointError(ValueError):
    """Points are no profile. The message says why.
    place: (2,) point at which this shows, in the axes of the points, mm.
    """

    def __init__(self, text: str, place: Array) -> None:
        """Error with a message and the point (2,) that it refers to."""
        super().__init__(text)
        self.place = place


def chord_lengths(points: Array) -> Array:
    """Lengths (n,) along the straight lines through points (n, 2), from the first point on, in mm
    for points in mm.
    """
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def closes(points: Array) -> bool:
    """Whether the last of points (n, 2), in their order along a curve, mm, is within 5 mm
    (LARGEST_GAP) of the first.
    """
    return bool(np.linalg.norm(points[-1] - points[0]) < LARGEST_GAP)


def in_order(points: Array) -> Array:
    """Points (n, 2), mm, in the order of the file, or sorted by y where the way through them is
    then shorter.
    They run from left to right; those of a closed outline do so on its upper side. Raises
    PointError where the points run over the same place twice.
    """
    order = np.argsort(points[:, 0], kind="stable")
    way = points
    if chord_lengths(points[order])[-1] < chord_lengths(points)[-1]:
        _refuse_second_pass(points, order)
        way = points[order]
    y, z = way.T
    if closes(way):
        return way if np.dot(y, np.roll(z, -1) - np.roll(z, 1)) < 0 else way[::-1]
    return way if y[-1] > y[0] else way[::-1]


def _refuse_second_pass(points: Array, order: NDArray[np.intp]) -> None:
    """Raises PointError where points (n, 2) run over the same place twice.
    order: (n,) indices that sort them by y. A gauge that goes there and back turns few times, but
        most neighbours across belong to two passes.
    """
    y = points[:, 0]
    low, high = np.quantile(y, (0.25, 0.75))
    outer = np.flatnonzero((y < low) | (y > high))
    turns = outer[1:][np.diff(np.sign(y[outer] - (low + high) / 2)) != 0]
    mixed = np.mean(np.abs(np.diff(order)) > 1) > 0.5
    if mixed and 2 <= len(turns) <= len(y) / PASS:
        text = "runs over the same place twice, at the latest here; give one pass"
        raise PointError(text, points[turns[1]])


def head(points: Array) -> Array:
    """Points (m, 2) of a rail's head without web and foot, of points (n, 2), mm, crown upwards.
    They are in their order along the curve where the outline is deeper than the head, or closes.
    """
    way, lowest = in_order(points), points[:, 1].max() - HEAD_DEPTH
    if closes(way):
        way = np.roll(way, -int(np.argmin(way[:, 1])), axis=0)
    elif points[:, 1].min() >= lowest:
        return points
    top, deep = int(np.argmax(way[:, 1])), np.flatnonzero(way[:, 1] < lowest)
    start = max(deep[deep < top], default=-1) + 1
    return way[start : min(deep[deep > top], default=len(way))]


def resampled(points: Array, step: float) -> Array:
    """Points (m, 2) that are `step` mm apart on the straight lines through points (n, 2), mm."""
    s = chord_lengths(points)
    places = np.arange(step / 2, s[-1], step)
    return np.column_stack([np.interp(places, s, column) for column in points.T])


def merged(points: Array) -> Array:
    """Points (m, 2), mm, with neighbours at the same y averaged, where y is rounded so that it
    repeats; else the points (n, 2) unchanged.
    Only the middle half of the width tells, where no face is vertical. Raises PointError where such
    points are farther apart in height than 0.1 mm (COARSE).
    """
    y = points[:, 0]
    middle = y[np.abs(y - (y.min() + y.max()) / 2) < np.ptp(y) / 4]
    if len(np.unique(middle)) >= DISTINCT * len(middle):
        return points
    starts = np.flatnonzero(np.concatenate([[True], np.diff(y) != 0]))
    counts = np.diff(np.append(starts, len(y)))
    high, low = (each.reduceat(points[:, 1], starts) for each in (np.maximum, np.minimum))
    if np.quantile(high - low, 0.9) > COARSE:
        worst = int(np.argmax(high - low))
        text = f"points at the same y are up to {(high - low)[worst]:.2g} mm apart in height"
        raise PointError(f"has rounded y: {text}; give more digits", points[starts[worst]])
    return np.asarray(np.add.reduceat(points, starts) / counts[:, None])
