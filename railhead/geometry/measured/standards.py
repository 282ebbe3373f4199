"""The nearest standard profile, laid on a measured one: what is worn off, and at which side.

Metal is lost and never gained, so the standard profile is laid over the measured one where nothing
stands out of it and the least is lost: a least-squares fit in which points outside weigh more and
large losses less (the soft l1 loss). A rail may be canted and is turned too; gauges of wheels hold
on to the flange back. A loss all over, as of a crown ground flat, is partly taken for a
displacement.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

from railhead.geometry import outlines, profiles
from railhead.geometry.measured.ordering import resampled
from railhead.theory.array_types import Array, Mask

STANDARDS = {"rail": profiles.STANDARD_RAILS, "wheel": ("S1002",)}
STEP = 0.25  # mm between the places that are compared
OUTLINE_STEP = 0.02  # mm between the points of a standard's outline
SOFT = 0.05  # mm of loss from which on it weighs less than its square
OUTSIDE = 5.0  # weight of what stands out of the standard
STANDS_OUT = 0.15  # mm that a profile of this kind stands out of its standard, at most
UNWORN, LEAST_UNWORN = 0.1, 0.3  # mm off the standard; share of the points that are not worn
UNWORN_SIDE = 0.05  # mm off the standard of a side that is not worn, root mean square, at most
CLEAR_LOSS, CLEAR_SLOPE = 2.0, 0.005  # mm2 and slope: less tells no gauge side
ITERATIONS = 100  # of the fit, at most
COMPARED = 20.0  # mm across that are laid on each other at least, for a standard to be the nearest


@dataclass(frozen=True, kw_only=True)
class LaidStandard:
    """A standard profile laid on a measured one; lengths in mm, in the axes of the measured one.
    name: 54E1, 60E1 or S1002.
    outline: (m, 2) points of the standard.
    y: (n,) y of the measured points.
    loss: (n,) depth of the measured points below the standard, normal to it; negative where they
        stand out of it, NaN beyond its ends and below the head.
    misfit: half the mean square of the fit's residuals, without dimension. A residual is the depth
        over 0.05 mm (SOFT), less for large losses and five times as much outside. Infinite where
        at most 20 mm of the width are compared.
    slope: angle (rad) by which the head leans, positive to y > 0; 0 for wheels.
    """

    name: str
    outline: Array
    y: Array
    loss: Array
    misfit: float
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
    def halves(self) -> tuple[Mask, Mask]:
        """Masks (n,) of the points that have a loss and lie left, and right, of the standard's
        middle.
        """
        right, known = self.y >= self.outline[len(self.outline) // 2, 0], np.isfinite(self.loss)
        return known & ~right, known & right

    @property
    def off_less_worn_half(self) -> float:
        """Root mean square distance in mm of the less worn half to the standard. A half without
        points does not count; infinite where neither has any.
        """
        squares = (self.loss[half] ** 2 for half in self.halves if half.any())
        return min((float(np.sqrt(square.mean())) for square in squares), default=np.inf)


def field_side(points: Array) -> tuple[float, str]:
    """Sign of the y that points away from the gauge side of a rail, and why; 0 where nothing tells.
    The gauge side is the one that has lost more, else that to which the head leans; but only where
    the other side is a standard's, and wear and lean do not contradict each other.
    points: (n, 2), mm, 0.25 mm (STEP) apart from left to right, upright.
    """
    all_laid = [laid(name, points) for name in STANDARDS["rail"]]
    best = min(all_laid, key=lambda each: each.off_less_worn_half)
    if best.off_less_worn_half > UNWORN_SIDE or np.nanmin(best.loss) < -STANDS_OUT:
        return 0.0, "no side is a standard rail's"
    left, right = (STEP * float(np.maximum(best.loss[half], 0).sum()) for half in best.halves)
    worn, leans = abs(right - left) > CLEAR_LOSS, abs(best.slope) > CLEAR_SLOPE
    if worn and leans and (right - left) * best.slope < 0:
        return 0.0, "worn at one side, leaning to the other"
    if worn:
        return -float(np.sign(right - left)), "by its worn side"
    if leans:
        text = f"its head leans 1:{1 / abs(best.slope):.0f} to the gauge side"
        return -float(np.sign(best.slope)), text
    return 0.0, "no side is worn, the head does not lean"


def nearest(points: Array, body: str) -> LaidStandard:
    """The standard with the least misfit, whether or not it fits (`fits`), for points (n, 2), mm,
    0.25 mm (STEP) apart from left to right, of a 'rail' or 'wheel'.
    """
    return min((laid(name, points) for name in STANDARDS[body]), key=lambda each: each.misfit)


def laid(name: str, points: Array) -> LaidStandard:
    """The standard `name` laid on points (n, 2), mm, 0.25 mm (STEP) apart, by a least-squares fit.
    A move is a displacement (dy, dz) in mm of the points, and of those of a rail an angle in rad.
    """
    outline, normal, tree = _outline(name)

    def depth(move: Array) -> Array:
        """Depth (n,) in mm of the moved points below the standard, NaN beyond its ends and below
        the head.
        """
        moved = _moved(points, move)
        index = tree.query(moved)[1]
        below = -np.einsum("nd,nd->n", moved - outline[index], normal[index])
        inside = (index > 0) & (index < len(outline) - 1) & (normal[index, 1] > 0)
        return np.where(inside, below, np.nan)

    def residuals(move: Array) -> Array:
        """Residuals (n,): large losses count less, and parts outside more; 0 where the depth is not
        known.
        """
        off = np.nan_to_num(depth(move)) / SOFT
        return np.where(off > 0, off * np.sqrt(2 / (1 + np.hypot(1, off))), OUTSIDE * off)

    up = outline[:, 1].max() - points[:, 1].max()
    starts = [[_middle(outline) - _middle(points), up, 0.0]]
    if name not in profiles.STANDARD_RAILS:  # without turning, and by the tip of its flange too
        tips = outline[np.argmax(outline[:, 1]), 0] - points[np.argmax(points[:, 1]), 0]
        starts = [[starts[0][0], up], [tips, up]]
    fits = [least_squares(residuals, start, max_nfev=ITERATIONS) for start in starts]
    best = min(fits, key=lambda fit: float(fit.cost))
    move = best.x
    found = depth(move)
    known = points[np.isfinite(found), 0]
    compared = len(known) > 0 and np.ptp(known) > COMPARED
    return LaidStandard(
        name=name,
        outline=(outline - move[:2]) @ _turn(move).T,
        y=points[:, 0],
        loss=found,
        misfit=float(best.cost) / len(points) if compared else np.inf,
        slope=float(move[2]) if len(move) > 2 else 0.0,
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
    """Points (m, 2) of a standard profile from left to right, 0.02 mm (OUTLINE_STEP) apart, mm,
    their outward unit normals (m, 2), and a KD tree of the points.
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
    outline = resampled(points, OUTLINE_STEP)
    tangent = np.gradient(outline, axis=0)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return outline, normal, cKDTree(outline, leafsize=32, compact_nodes=False)  # quick far off too
