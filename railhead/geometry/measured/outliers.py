"""Points that are no shape: heights that are rounded, points that stand off their neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from railhead.geometry.measured.ordering import DISTINCT, PointError, chord_lengths
from railhead.geometry.measured.smoothing import Smoothed

Array = NDArray[np.float64]
ROUNDED = 0.01  # mm: stairs of heights that are higher make contacts that do not exist
SAME, UNEVEN = 1e-9, 1e-3  # relative differences of equal heights, and of equal steps
WILD, STEEP = 0.3, 3.0  # mm, and times the distance to its neighbours: an outlier is refused
SPIKE, LEAST_SPIKE = 20.0, 0.05  # times the noise, and mm: an outlier is warned of ...
EDGE_CURVATURE = 0.1  # 1/mm: ... times the squared spacing, as an edge of R1.25 may stand off
WAVE, STRIDE, BENT = 4.0, 0.1, 10.0  # mm, mm and deg: sound profiles bend to and fro by 2 to 4


def offsets(points: Array) -> Array:
    """Distance (n,) in mm of points (n, 2) in the order of the curve from the cubic through their
    two neighbours on either side.
    Zero where another of these five points is farther off, as an outlier spoils the cubics of its
    neighbours, and for the outermost two at each end.
    """
    s, off = chord_lengths(points), np.zeros(len(points))
    for i in range(2, len(points) - 2):
        others = [i - 2, i - 1, i + 1, i + 2]
        apart = s[others][:, None] - s[others] + np.eye(4)
        reach = (s[i] - s[others])[None, :] * (1 - np.eye(4)) + np.eye(4)
        weights = reach.prod(axis=1) / apart.prod(axis=1)
        off[i] = np.linalg.norm(points[i] - weights @ points[others])
    return np.where(off == maximum_filter1d(off, 5), off, 0.0)


def check_digits(points: Array) -> None:
    """Raises PointError where the heights of points (n, 2), mm, are rounded to more than 0.01 mm
    (ROUNDED): stairs are no noise that could be smoothed away.
    """
    z = np.sort(points[:, 1])
    steps = np.diff(z)
    steps = steps[steps > SAME * max(float(np.ptp(z)), SAME)]
    if not len(steps) or len(steps) + 1 > DISTINCT * len(z):
        return
    least = float(steps.min())
    even = np.abs(steps / least - np.round(steps / least)).max() < UNEVEN
    if even and least > ROUNDED * (1 + UNEVEN):
        text = f"has heights rounded to {least:.2g} mm; give more digits, {ROUNDED:g} mm at least"
        raise PointError(text, points[0])


def check_wild(points: Array) -> None:
    """Raises PointError where one of points (n, 2), mm, in the order of the curve, five at least,
    is so far off its neighbours that the curve would turn back on itself.
    """
    off, beside = offsets(points), np.zeros(len(points))
    beside[1:-1] = np.linalg.norm(points[2:] - points[:-2], axis=1) / 2
    for end in (slice(0, 5), slice(-1, -6, -1)):
        off[end][:2], beside[end][:2] = _offsets_at_end(points[end]), beside[end][3]
    wild = np.where(off > np.maximum(WILD, STEEP * beside), off, 0.0)
    if wild.any():
        worst = int(np.argmax(wild))
        text = f"stands off its neighbours by {wild[worst]:.2g} mm; delete it, or give more points"
        raise PointError(text, points[worst])


def _offsets_at_end(points: Array) -> Array:
    """Distance (2,) in mm of the first two of five points (5, 2) from the line that the others lead
    to them: aside by more than 60 deg (less may be an edge), or the second beyond the first.
    """
    way = (points[2] - points[4]) / np.linalg.norm(points[2] - points[4])
    reach = np.linalg.norm(points[:2] - points[2], axis=1)
    off = np.linalg.norm(points[:2] - points[2] - reach[:, None] * way, axis=1)
    beyond = float((points[1] - points[0]) @ way)
    return np.maximum(np.where(off > reach, off, 0.0), [0.0, beyond])


def spikes(smoothed: Smoothed, inside: NDArray[np.bool_]) -> tuple[int, float, Array] | None:
    """Number of the points in `inside` (n,) that are off the cubic of their neighbours by more than
    noise and edges explain, the largest such distance (mm), and its place (2,); None without
    one.
    """
    off = offsets(smoothed.points) * inside
    spacing = smoothed.length / (len(smoothed.points) - 1)
    least = max(SPIKE * smoothed.noise, LEAST_SPIKE, EDGE_CURVATURE * spacing**2)
    count = np.count_nonzero(off > least)
    return (int(count), float(off.max()), smoothed.points[np.argmax(off)]) if count else None


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
