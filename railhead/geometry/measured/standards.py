"""The nearest standard profile, laid on a measured one: its axes, and what is worn off.

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
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

from railhead.geometry import outlines, profiles
from railhead.theory.array_types import Array, Index, Mask

STANDARDS = {"rail": profiles.STANDARD_RAILS, "wheel": ("S1002",)}
STEP = 0.25  # mm between the places that are compared
OUTLINE_STEP = 0.02  # mm between the points of a standard's outline
SOFT = 0.05  # mm of loss from which on it weighs less than its square
OUTSIDE = 5.0  # weight of what stands out of the standard
STANDS_OUT = 0.15  # mm that a profile of this kind stands out of its standard, at most
UNWORN, LEAST_UNWORN = 0.1, 0.3  # mm off the standard; share of the points that are not worn
ITERATIONS = 100  # of the fit, at most
COMPARED = 20.0  # mm across that are laid on each other at least, for a standard to be the nearest


@dataclass(frozen=True, kw_only=True)
class LaidStandard:
    """A standard profile laid on a measured one; lengths in mm, in the axes of the measured one.
    name: 54E1, 60E1 or S1002.
    outline: (m, 2) points of the standard.
    origin: (2,) where the origin of the standard lies: crown centre, or tape circle.
    y: (n,) y of the measured points.
    loss: (n,) depth of the measured points below the standard, normal to it; negative where they
        stand out of it, NaN beyond its ends and below the head.
    misfit: half the mean square of the fit's residuals, without dimension. A residual is the depth
        over 0.05 mm (SOFT), less for large losses and five times as much outside. Infinite where
        at most 20 mm of the width are compared.
    distance: mean distance of all points to the outline.
    slope: angle (rad) by which the head leans, positive to y > 0; 0 for wheels.
    """

    name: str
    outline: Array
    origin: Array
    y: Array
    loss: Array
    misfit: float
    distance: float
    slope: float

    @property
    def worst(self) -> int:
        """Index of the measured point with the largest loss; 0 where nothing is lost."""
        return int(np.argmax(self._lost))

    @property
    def largest_loss(self) -> float:
        """Largest loss, normal to the standard, mm."""
        return float(self._lost[self.worst])

    @property
    def lost_area(self) -> float:
        """Area of the section that is lost, mm2: 0.25 mm (STEP) times the sum of the positive
        losses, true for points that are 0.25 mm apart.
        """
        return STEP * float(self._lost.sum())

    @property
    def _lost(self) -> Array:
        """Loss (n,) in mm, with zero for negative values and NaN."""
        return np.nan_to_num(np.maximum(self.loss, 0.0))

    @property
    def fits(self) -> bool:
        """Whether the measured profile is a worn one of this standard: it covers half of its width,
        stands out by at most 0.15 mm (STANDS_OUT), and 0.3 (LEAST_UNWORN) of its points are within
        0.1 mm (UNWORN) of it.
        """
        known = np.isfinite(self.loss)
        unworn = np.count_nonzero(np.abs(self.loss[known]) < UNWORN) / len(self.loss)
        covered = np.ptp(self.y[known]) > np.ptp(self.outline[:, 0]) / 2 if known.any() else False
        return covered and unworn > LEAST_UNWORN and float(np.nanmin(self.loss)) > -STANDS_OUT

    @property
    def sides(self) -> tuple[Mask, Mask]:
        """Masks (n,) of the points that have a loss and lie left, and right, of the standard's
        middle.
        """
        known, middle = np.isfinite(self.loss), self.outline[len(self.outline) // 2, 0]
        return known & (self.y < middle), known & (self.y >= middle)


def nearest(points: Array, body: str) -> LaidStandard:
    """The standard with the least misfit, whether or not it fits (`fits`), for points (n, 2), mm,
    0.25 mm (STEP) apart from left to right, of a 'rail' or 'wheel'.
    """
    return min(all_laid(points, body), key=lambda each: each.misfit)


def all_laid(points: Array, body: str) -> list[LaidStandard]:
    """Every standard of a 'rail' or 'wheel' laid on points (n, 2), mm, 0.25 mm (STEP) apart from
    left to right.
    """
    return [_laid(name, points, body == "rail") for name in STANDARDS[body]]


def _laid(name: str, points: Array, turns: bool) -> LaidStandard:
    """The standard `name` laid on points (n, 2), mm, by a least-squares fit.
    turns: the standard may be turned, as a rail is, else only displaced.
    A move is a displacement (dy, dz) in mm of the points, and, where it turns, an angle in rad.
    """
    outline, normal, tree = _outline(name)
    places: dict[bytes, Index] = {}

    def place(move: Array) -> tuple[Array, Index, Mask]:
        """Points (n, 2) displaced by move, indices (n,) of the nearest ones of the outline, and
        whether (n,) they lie within its ends and on the head. The indices of the last move are
        cached.
        """
        moved, key = _moved(points, move), move.tobytes()
        if key not in places:
            places.clear()
            places[key] = tree.query(moved)[1]
        index = places[key]
        return moved, index, (index > 0) & (index < len(outline) - 1) & (normal[index, 1] > 0)

    def loss(move: Array, beyond: float = 0.0) -> Array:
        """Depth (n,) in mm of the points, displaced by move, below the standard; `beyond` outside
        of its ends or below the head.
        """
        moved, index, inside = place(move)
        depth = -np.einsum("nd,nd->n", moved - outline[index], normal[index])
        return np.where(inside, depth, beyond)

    def slopes(move: Array) -> Array:
        """Derivatives (n, 2 or 3) of `loss` by the move; to first order the nearest points stay."""
        moved, index, inside = place(move)
        inwards = np.where(inside[:, None], -normal[index], 0.0)
        x, y = (moved - move[:2]).T
        by_turn = [-y * inwards[:, 0] + x * inwards[:, 1]] if turns else []
        return np.column_stack([inwards, *by_turn])

    def asymmetric(move: Array) -> Array:
        """Residuals (n,) in which losses count less and parts outside count more."""
        depth = loss(move) / SOFT
        soft = depth * np.sqrt(2 / (1 + np.hypot(1, depth)))
        return np.where(depth > 0, soft, OUTSIDE * depth)

    def slopes_of_asymmetric(move: Array) -> Array:
        """Derivatives (n, 2 or 3) of `asymmetric` by the move."""
        depth = loss(move) / SOFT
        root = np.hypot(1, depth)
        rate = np.where(depth > 0, np.sqrt((1 + root) / 2) / root, OUTSIDE)
        return rate[:, None] / SOFT * slopes(move)

    def distance(move: Array) -> float:
        """Mean distance in mm of the displaced points to the outline."""
        return float(tree.query(_moved(points, move))[0].mean())

    up = outline[:, 1].max() - points[:, 1].max()
    starts = [[_middle(outline) - _middle(points), up, 0.0]]
    if not turns:  # a wheel: without turning, and by the tip of its flange too
        tips = outline[np.argmax(outline[:, 1]), 0] - points[np.argmax(points[:, 1]), 0]
        starts = [[starts[0][0], up], [tips, up]]
    rough = (
        least_squares(loss, start, slopes, loss="soft_l1", f_scale=SOFT, max_nfev=ITERATIONS).x
        for start in starts
    )
    move = min(rough, key=distance)
    fit = least_squares(asymmetric, move, slopes_of_asymmetric, max_nfev=ITERATIONS).x
    move = fit if distance(fit) < 2 * distance(move) + 1 else move  # it may slip off the points
    depth, turn = loss(move, np.nan), _turn(move).T
    known = points[np.isfinite(depth), 0]
    compared = len(known) > 0 and np.ptp(known) > COMPARED
    return LaidStandard(
        name=name,
        outline=(outline - move[:2]) @ turn,
        origin=-move[:2] @ turn,
        y=points[:, 0],
        loss=depth,
        misfit=0.5 * float((asymmetric(move) ** 2).mean()) if compared else np.inf,
        distance=distance(move),
        slope=float(move[2]) if turns else 0.0,
    )


def _moved(points: Array, move: Array) -> Array:
    """Points (n, 2) turned by move[2] (rad), if there is one, then displaced by move[:2] (mm)."""
    return np.asarray(points @ _turn(move) + move[:2])


def _turn(move: Array) -> Array:
    """Rotation (2, 2) by move[2] (rad), for points as rows; the identity for two numbers."""
    angle = move[2] if len(move) > 2 else 0.0
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s], [-s, c]])


def _middle(points: Array) -> float:
    """y midway between the leftmost and the rightmost of points (n, 2)."""
    return float((points[:, 0].min() + points[:, 0].max()) / 2)


@lru_cache
def _outline(name: str) -> tuple[Array, Array, cKDTree]:
    """Points (m, 2) of a standard profile from left to right, about 0.02 mm (OUTLINE_STEP) apart,
    mm, their outward unit normals (m, 2), and a KD tree of the points.
    Rails are heads without the line of the cut.
    """
    if name in profiles.STANDARD_RAILS:
        curves = outlines.rail_section(name, "head", half=False)
        half = len(curves) // 2
        free = [curve for curve in (*curves[half:], *curves[:half]) if curve.role != "support"]
        points = np.concatenate([curve.sampled() for curve in free])
    else:
        profile = profiles.s1002()
        y = np.linspace(*profile.domain, 40001)
        points = np.column_stack([y, profile.height(y)])
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate([[True], apart > 0])]
    s = np.concatenate([[0.0], np.cumsum(apart[apart > 0])])
    even = np.linspace(0, s[-1], int(s[-1] / OUTLINE_STEP))
    outline = np.column_stack([np.interp(even, s, column) for column in points.T])
    tangent = np.gradient(outline, axis=0)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return outline, normal, cKDTree(outline, leafsize=32, compact_nodes=False)  # quick far off too
