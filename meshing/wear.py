"""Wear of a measured profile: what it lacks of the nearest standard one.

Metal is lost and never gained, so the standard profile is laid over the measured one where nothing
stands out of it and the least is lost: a least-squares fit in which points outside weigh more and
large losses less (the soft l1 loss). A rail may be canted and is turned too; gauges of wheels hold
on to the flange back. A loss all over, as of a crown ground flat, is partly taken for a
displacement.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

from railhead.meshing import outlines, profiles

Array = NDArray[np.float64]
STANDARDS = {"rail": profiles.STANDARD_RAILS, "wheel": ("S1002",)}
STEP = 0.25  # mm between places that are compared
FINE = 0.02  # mm between points of the standard
SCALE = 0.05  # mm of loss from which on it weighs less than its square
OUTSIDE = 5.0  # times as much weighs what stands out
FAR = 6.0  # mm: seven other rails are off theirs by up to 3.3, and wear takes 3
LAID = 0.8  # of the width, along the standard, at least; a wheel without flange slips off it
FLATTEST, CROWN = 1500.0, 10.0  # mm: radius of a crown over half the width, and its depth
COMPARED = 20.0  # mm across that are laid on each other, at least
UNWORN, STANDS_OUT = 0.05, 0.15  # mm: of a side that is the standard's, and of the whole, at most
CLEAR, LEANS = 2.0, 0.005  # mm2 and rad: less says nothing of the side


@dataclass(frozen=True)
class Wear:
    """standard: its name; outline (m, 2): the standard's, laid on the measured profile, mm; y (n,)
    and loss (n,) normal to the standard, mm, NaN beyond its ends and below the head; largest, at:
    the largest loss and its y, mm; area: of what is lost, mm2; misfit: least of the nearest."""

    standard: str
    outline: Array
    y: Array
    loss: Array
    largest: float
    at: float
    area: float
    misfit: float
    turn: float

    @property
    def sides(self) -> list[NDArray[np.bool_]]:
        """Which points (n,) lie at y < 0 and y > 0 of the standard's middle and have a loss."""
        known, middle = np.isfinite(self.loss), self.outline[len(self.outline) // 2, 0]
        return [known & (self.y < middle), known & (self.y >= middle)]

    @property
    def kept(self) -> float:
        """How far (rms, mm) the side that is more alike is off the standard."""
        squares = (self.loss[side] ** 2 for side in self.sides if side.any())
        return min((float(np.sqrt(square.mean())) for square in squares), default=np.inf)


def gauge_side(points: Array) -> tuple[bool, str]:
    """Whether that of a rail, points (n, 2) as for `nearest`, lies at y > 0, and by what; '' where
    nothing tells.

    It is the side that has lost more, else that to which the head leans; but only where the other
    side is a standard's, which lies arbitrarily on a profile that is none.
    """
    laid = min(_all(points, "rail"), key=lambda each: each.kept)
    if laid.kept > UNWORN or np.nanmin(laid.loss) < -STANDS_OUT:
        return False, ""
    left, right = (STEP * float(np.maximum(laid.loss[side], 0).sum()) for side in laid.sides)
    wears, leans = abs(right - left) > CLEAR, abs(laid.turn) > LEANS
    if wears and leans and (right > left) is (laid.turn > 0):
        return False, ""
    if wears:
        return right > left, "by its worn side"
    return (laid.turn < 0, leaning(laid.turn)) if leans else (False, "")


def leaning(slope: float) -> str:
    """In words."""
    return f"its head leans 1:{1 / abs(slope):.0f} to the gauge side"


def nearest(points: Array, body: str) -> Wear:
    """Of points (n, 2) of a 'rail' or 'wheel', STEP apart from left to right, mm, against the
    standard profile that fits best."""
    return min(_all(points, body), key=lambda each: each.misfit)


def unlike(points: Array, body: str) -> str:
    """How a rail or wheel, points (n, 2) as for `nearest`, is none that looks like a standard one,
    in words; '' where it does."""
    laid = nearest(points, body)
    width = STEP * np.count_nonzero(np.isfinite(laid.loss))
    if width < LAID * np.ptp(points[:, 0]) or laid.largest > FAR:
        return f"is far from {laid.standard}, the nearest standard {body}"
    y, z = points[np.abs(points[:, 0] - _middle(points)) < np.ptp(points[:, 0]) / 4].T
    y, z = y[z > z.max() - CROWN], z[z > z.max() - CROWN]
    if body == "rail" and abs(2 * np.polyfit(y - y.mean(), z, 2)[0]) < 1 / FLATTEST:
        return f"has a crown flatter than R{FLATTEST:g}"
    return ""


def _all(points: Array, body: str) -> list[Wear]:
    return [_against(name, points, _outline(name), body == "rail") for name in STANDARDS[body]]


def _against(name: str, points: Array, outline: Array, turns: bool) -> Wear:
    tree = cKDTree(outline)
    tangent = np.gradient(outline, axis=0)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]

    def loss(move: Array, beyond: float = 0.0) -> Array:
        moved = _moved(points, move)
        _, index = tree.query(moved)
        depth = -np.einsum("nd,nd->n", moved - outline[index], normal[index])
        inside = (index > 0) & (index < len(outline) - 1) & (normal[index, 1] > 0)
        return np.where(inside, depth, beyond)

    def asymmetric(move: Array) -> Array:
        depth = loss(move) / SCALE
        soft = np.sqrt(2 * (np.hypot(1, depth) - 1))
        return np.where(depth > 0, soft, OUTSIDE * depth)

    start = [_middle(outline) - _middle(points), outline[:, 1].max() - points[:, 1].max(), 0.0]
    start = start if turns else start[:2]
    rough = least_squares(loss, start, loss="soft_l1", f_scale=SCALE)
    fit = least_squares(asymmetric, rough.x)
    depth = loss(fit.x, np.nan)
    lost = np.nan_to_num(np.maximum(depth, 0.0))
    known = points[np.isfinite(depth), 0]
    compared = len(known) and np.ptp(known) > COMPARED
    worst = int(np.argmax(lost))
    laid = (outline - fit.x[:2]) @ _turn(fit.x).T
    return Wear(
        name, laid, points[:, 0], depth,
        float(lost[worst]), float(points[worst, 0]), float(lost.sum() * STEP),
        float(fit.cost) / len(points) if compared else np.inf, -float(fit.x[2]) if turns else 0.0,
    )  # fmt: skip


def _moved(points: Array, move: Array) -> Array:
    """Turned by move[2] (rad), where there is one, then displaced by move[:2] (mm)."""
    return np.asarray(points @ _turn(move) + move[:2])


def _turn(move: Array) -> Array:
    angle = move[2] if len(move) > 2 else 0.0
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s], [-s, c]])


def _middle(points: Array) -> float:
    return float((points[:, 0].min() + points[:, 0].max()) / 2)


@lru_cache
def _outline(name: str) -> Array:
    """Points (m, 2) of a standard profile from left to right, FINE apart, mm."""
    if name in profiles.STANDARD_RAILS:
        curves = outlines.rail_section(name, "head", half=False)
        half = len(curves) // 2
        free = [curve for curve in (*curves[half:], *curves[:half]) if curve.role != "support"]
        points = np.concatenate([_sampled(curve) for curve in free])
    else:
        profile = profiles.s1002()
        y = np.linspace(*profile.domain, 40001)
        points = np.column_stack([y, profile.height(y)])
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate([[True], apart > 0])]
    s = np.concatenate([[0.0], np.cumsum(apart[apart > 0])])
    even = np.linspace(0, s[-1], int(s[-1] / FINE))
    return np.column_stack([np.interp(even, s, column) for column in points.T])


def _sampled(curve: outlines.Curve) -> Array:
    start, end = curve.points
    if curve.centre is None:
        return curve.points
    first, last = (np.arctan2(*(point - curve.centre)[::-1]) for point in (start, end))
    angle = first + np.linspace(0, (last - first + np.pi) % (2 * np.pi) - np.pi, 500)
    radius = np.linalg.norm(start - curve.centre)
    return np.asarray(curve.centre + radius * np.column_stack([np.cos(angle), np.sin(angle)]))
