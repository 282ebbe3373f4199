"""Points that are no shape: those that stand off their neighbours, and bends to and fro."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from railhead.geometry.measured.ordering import PointError, chord_lengths
from railhead.geometry.measured.smoothing import Smoothed, turns

Array = NDArray[np.float64]
LEAST_OFFSET = 0.3  # mm from a refused point to either of its neighbours, at least
BACK, ASIDE = 143.0, 60.0  # deg that the way turns at a refused point, and beside one at an end
LONG = 2.0  # times the next step: the first or last step of a curve with a refused point at its end
WAVE, STRIDE, BENT = 4.0, 0.1, 10.0  # mm, mm and deg: sound profiles bend to and fro by 2 to 4


def refuse_outlier(points: Array) -> None:
    """Raises PointError where one of points (n, 2), mm, in the order of the curve, five at least,
    is an outlier.

    At an outlier the way through the points turns by more than 143 deg (BACK), more than 0.3 mm
    (LEAST_OFFSET) away from both neighbours. It is then three times as far from the line through
    its neighbours as half their distance. At either end a turn of 60 deg (ASIDE) suffices where the
    end's step is twice as long (LONG) as the next one.
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


def wave(smoothed: Smoothed, start: float, end: float) -> tuple[float, Array] | None:
    """Largest angle (deg) by which the curve bends one way and back within 4 mm (WAVE), between y =
    start and y = end (mm), and its place (2,); None where no angle is larger than 10 deg (BENT).
    """
    s = np.arange(0.0, smoothed.length, STRIDE)
    dy, dz = smoothed.curve(s, 1).T
    angle, curve = np.degrees(np.unwrap(np.arctan2(dz, dy))), smoothed.curve(s)
    angles = np.lib.stride_tricks.sliding_window_view(angle, round(WAVE / STRIDE) + 1)
    back = np.ptp(angles, axis=1) - np.abs(angles[:, -1] - angles[:, 0])
    middle = curve[round(WAVE / STRIDE) // 2 :][: len(back)]
    back = np.where((middle[:, 0] > start) & (middle[:, 0] < end), back, 0.0)
    worst = int(np.argmax(back))
    return (float(back[worst]), middle[worst]) if back[worst] > BENT else None
