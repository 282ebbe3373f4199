"""Points before they are smoothed: their order along the curve, and the head of a whole section.

Outliers, rounded coordinates and scans there and back are refused.
"""

import numpy as np

from railhead.theory.array_types import Array

LARGEST_GAP, WIDEST_GAP = 5.0, 10.0  # mm between neighbours: usual, and bridged, at most
LOOSE = 0.1  # share of the width beyond a gap, at most
HEAD_DEPTH = 45.0  # mm below its top: what is deeper is web or foot
ROUNDED = 0.01  # mm: stairs of heights that are higher make contacts that do not exist
DISTINCT = 0.75  # share of different numbers among the points; with fewer they are rounded
COARSE, TURNS = 20, 4  # of so many points of a scan there and back, few turn; of mixed ones many
LEAST_OFFSET = 0.5  # mm from a refused point to either of its neighbours, at least
BACK, ASIDE = 143.0, 60.0  # deg that the way turns at a refused point, and beside one at an end
STEEP = 2.0  # slope of the walls of a groove, at least
LONG = 2.0  # times the next step: the first or last step of a curve with a refused point at its end


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


def cross(one: Array, other: Array) -> Array:
    """Cross products (n,) one_y other_z - one_z other_y of vectors (n, 2)."""
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def turns(points: Array) -> Array:
    """Angles (n - 2,) in rad by which the way through points (n, 2) turns at the inner ones, never
    negative.
    """
    one, two = np.diff(points, axis=0)[:-1], np.diff(points, axis=0)[1:]
    return np.asarray(np.arctan2(np.abs(cross(one, two)), np.einsum("nd,nd->n", one, two)))


def closes(points: Array) -> bool:
    """Whether the last of points (n, 2), in their order along a curve, mm, is within 5 mm
    (LARGEST_GAP) of the first.
    """
    return bool(np.linalg.norm(points[-1] - points[0]) < LARGEST_GAP)


def in_order(points: Array) -> Array:
    """Points (n, 2), mm, in the order of the file, or sorted by y where the way through them is
    then shorter.
    They run from left to right; those of a closed outline do so on its upper side. Raises
    PointError where they go to and fro over the profile a few times, as in several passes of a
    scan; with many turns they count as points without an order, which are sorted.
    """
    order = np.argsort(points[:, 0], kind="stable")
    way = points
    if chord_lengths(points[order])[-1] < chord_lengths(points)[-1]:
        coarse = np.arange(0, len(points), max(1, len(points) // COARSE))
        turns = coarse[2:][np.diff(np.sign(np.diff(points[coarse, 0]))) != 0]
        mixed = np.mean(np.abs(np.diff(order)) > 1) > 0.5
        if mixed and 1 <= len(turns) <= TURNS:
            text = "runs over the same place twice, at the latest here; give one pass"
            raise PointError(text, points[turns[-1]])
        way = points[order]
    y, z = way.T
    if closes(way):
        return way if np.dot(y, np.roll(z, -1) - np.roll(z, 1)) < 0 else way[::-1]
    return way if y[-1] > y[0] else way[::-1]


def head(way: Array) -> Array:
    """Points (m, 2) of a rail's head, down to 45 mm (HEAD_DEPTH) below its top, of points (n, 2),
    mm, in their order, crown upwards; an outline that closes is opened at its lowest point.
    """
    deep = way[:, 1] < way[:, 1].max() - HEAD_DEPTH
    if closes(way):
        lowest = int(np.argmin(way[:, 1]))
        way, deep = np.roll(way, -lowest, axis=0), np.roll(deep, -lowest)
    top, below = int(np.argmax(way[:, 1])), np.flatnonzero(deep)
    start = max(below[below < top], default=-1) + 1
    return way[start : min(below[below > top], default=len(way))]


def without_loose_ends(way: Array) -> Array:
    """Points (m, 2) in the piece with the highest of points (n, 2), mm, in their order, between
    gaps of more than 5 mm (LARGEST_GAP); all of them where more than a tenth (LOOSE) of the width
    would be lost, so that a gap in the running surface stays.
    """
    cuts = 1 + np.flatnonzero(np.linalg.norm(np.diff(way, axis=0), axis=1) > LARGEST_GAP)
    top = int(np.argmax(way[:, 1]))
    piece = way[max(cuts[cuts <= top], default=0) : min(cuts[cuts > top], default=len(way))]
    return way if np.ptp(piece[:, 0]) < (1 - LOOSE) * np.ptp(way[:, 0]) else piece


def without_grooves(way: Array) -> tuple[Array, list[int]]:
    """Points (m, 2) without those in grooves, of points (n, 2), mm, in their order, and the indices
    of points with a gap behind: a groove, or more than 5 mm (LARGEST_GAP).
    A groove is at most 10 mm (WIDEST_GAP) wide, 5 mm from either end and at least 0.5 mm
    (LEAST_OFFSET) deep. Its walls have a slope of 2 (STEEP) or more, the line over it one below 1.
    """
    s, (across, rise) = chord_lengths(way), np.diff(way, axis=0).T
    middle = (s > LARGEST_GAP) & (s < s[-1] - LARGEST_GAP)
    down, up = (side * rise > STEEP * np.abs(across) for side in (-1, 1))
    last, inside = -1, np.zeros(len(way), bool)
    for first in np.flatnonzero(down & middle[:-1]):
        y, z = np.abs(way[first + 1 :] - way[first]).T
        over = (np.hypot(y, z) <= WIDEST_GAP) & (z < y)
        ends = first + 1 + np.flatnonzero(up[first:] & middle[first + 1 :] & over)
        if first >= last and len(ends):
            last = int(ends[-1])
            depth = min(way[[first, last], 1]) - way[first:last, 1].min()
            inside[first + 1 : last] = depth > LEAST_OFFSET
    kept = np.flatnonzero(~inside)
    wide = np.linalg.norm(np.diff(way[kept], axis=0), axis=1) > LARGEST_GAP
    return way[kept], [int(i) for i in np.flatnonzero(wide | (np.diff(kept) > 1))]


def resampled(points: Array, step: float) -> Array:
    """Points (m, 2) that are `step` mm apart on the straight lines through points (n, 2), mm; the
    first lies half a step from the first point.
    """
    s = chord_lengths(points)
    places = np.arange(step / 2, s[-1], step)
    return np.column_stack([np.interp(places, s, column) for column in points.T])


def refuse_rounded(points: Array) -> None:
    """Raises PointError where coordinates of points (n, 2), mm, in their order, are rounded.
    Heights are where fewer than three quarters of them are different, and those by more than
    0.01 mm (ROUNDED). y is where more than a quarter of the neighbours have the same one, in the
    middle half of the width, where no face is vertical.
    """
    y, heights = points[:, 0], np.unique(np.round(points[:, 1], 6))
    steps = np.diff(heights)
    if 1 < len(heights) < DISTINCT * len(points) and steps.min() > 1.01 * ROUNDED:
        text = f"has heights rounded to {steps.min():.2g} mm; give more digits, {ROUNDED:g} mm at "
        raise PointError(f"{text}least", points[0])
    middle = points[np.abs(y - (y.min() + y.max()) / 2) < np.ptp(y) / 4]
    same, apart = np.diff(middle, axis=0).T
    if np.count_nonzero((same == 0) & (apart != 0)) > (1 - DISTINCT) * len(middle):
        text = "has rounded y: points at the same y have different heights; give more digits"
        raise PointError(text, middle[np.argmax((same == 0) & (apart != 0))])


def refuse_outlier(points: Array) -> None:
    """Raises PointError where one of points (n, 2), mm, in the order of the curve, five at least,
    is an outlier.

    At an outlier the way through the points turns by more than 143 deg (BACK), more than 0.5 mm
    (LEAST_OFFSET) away from both neighbours. Midway between them it is then three times as far from
    the line through them as half their distance. At either end a turn of 60 deg (ASIDE) suffices
    where the end's step is twice as long (LONG) as the next one.
    """
    steps = np.diff(chord_lengths(points))
    angle = np.degrees(turns(points))
    limit = np.full(len(angle), BACK)
    limit[[0, -1]] = np.where(steps[[0, -1]] > LONG * steps[[1, -2]], ASIDE, BACK)
    off = np.minimum(steps[1:], steps[:-1])
    off[[0, -1]] = steps[[0, -1]]
    off = np.where((angle > limit) & (off > LEAST_OFFSET), off, 0.0)
    if off.any():
        worst = int(np.argmax(off))
        text = f"stands off its neighbours by {off[worst]:.2g} mm; delete it, or give more points"
        raise PointError(text, points[worst + 1])
