"""What is no whole profile as it lies: a table that goes up instead of across, and half a head.

By the shape alone one side of a rail may be a head whose columns are swapped, so that neither is
guessed: both are refused.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from railhead.meshing.scans import closes
from railhead.meshing.smoothing import PointError

Array = NDArray[np.float64]
UPRIGHT = 2.0  # times as far up or down as across goes no profile from end to end ...
FLAT = 0.1  # ... and as part of the height: an outline that closes tells nothing
WHOLE, MISSING = 3.0, 1.0  # mm that a head falls at one end, and at least must at the other


def check_across(points: Array) -> None:
    """Points (n, 2) in any unit. Raises PointError, of the first one, where they go up rather than
    across."""
    way = _way(points)
    across, up = np.abs(way[-1] - way[0])
    if up > max(UPRIGHT * across, FLAT * np.ptp(points[:, 1])):
        text = f"goes {across:.3g} across and {up:.3g} up or down from end to end"
        allowed = "give y before z, or name them in a header, and both sides of a head"
        raise PointError(f"{text}; {allowed}", points[0])


def check_head(points: Array, listed: Array) -> None:
    """Points (n, 2) of a rail, mm, and the same in other axes, listed (n, 2). Raises PointError, of
    the top in these other axes, where the head has one side; an outline that closes has both."""
    way = _way(points)
    if closes(way):
        return
    way = way - way[0]
    under = np.sum(way[:-1, 0] * way[1:, 1] - way[1:, 0] * way[:-1, 1]) * way[-1, 0]
    y, z = points[:, 0], points[:, 1] * (-1 if under > 0 else 1)  # above its chord
    top = int(np.argmax(z))
    left, right = (float(np.ptp(z[side])) for side in (y <= y[top], y >= y[top]))
    if max(left, right) > WHOLE and min(left, right) < MISSING:
        raise PointError(f"is half a head: it falls {left:.2g} mm to the left of its top and "
                         f"{right:.2g} mm to the right; give both sides, {MISSING:g} mm down at "
                         "least", listed[top])  # fmt: skip


def _way(points: Array) -> Array:
    """Points (n, 2) in their order, or in that of a column where that is the shorter way."""
    ways = (points, *(points[np.argsort(column, kind="stable")] for column in points.T))
    return min(ways, key=lambda way: float(np.hypot(*np.diff(way, axis=0).T).sum()))
