"""From the axes of a file to those of the project, by the standard profile laid on the points.

The unit follows from the width, up and down and the flange side of a wheel from the orientation in
which a standard fits best. The gauge side of a rail is the one that is worn more, or to which the
head leans. A profile that fits no standard is refused unless its orientation is given by keys.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from railhead.geometry.measured import ordering, standards
from railhead.geometry.measured.formats import Table
from railhead.geometry.measured.ordering import PointError
from railhead.geometry.measured.standards import LaidStandard
from railhead.theory.array_types import Array

MM_OF_UNIT = {"mm": 1.0, "m": 1000.0, "inch": 25.4, "cm": 10.0, "um": 1e-3, "ft": 304.8}
WIDTHS = 7.5, 300.0  # mm of any profile, ...
USUAL_WIDTHS = {"rail": (25.0, 100.0), "wheel": (60.0, 150.0)}  # ... and where no unit is stated
GUESSED_UNITS = ("mm", "inch", "m")  # no number is a usual width in two of them
COARSE_STEP = 1.0  # mm between the points by which orientations are compared
CLEARER, CLEARLY = 2.0, 0.02  # times, and mm: another orientation is farther from the standard
UNWORN, STANDS_OUT = 0.05, 0.15  # mm: of a side that is the standard's, and of the whole, at most
CLEAR_LOSS, CLEAR_SLOPE = 2.0, 0.005  # mm2 and slope: less tells no gauge side
FALLS, LEAST_FALL = 3.0, 1.0  # mm: a head falls at one side of its top, and must at the other
FLANGE_TIP, BEYOND_TIP = -55.0, 1.0  # mm: y of the flange's tip, and what a wheel has beyond it
NEAR_TOP, NEAR_ZERO, NEAR_SIDE = 2.0, 5.0, 8.0  # mm: the file's origin is that of the project


@dataclass(frozen=True, kw_only=True)
class Orientation:
    """What the user says of a file; 'auto' leaves it to the file and its shape.
    unit: unit of the file, 'mm', 'm' or 'inch'; 'auto': the one that the file states, else the one
        in which its width is usual.
    mirror: whether left and right are exchanged, 'on' or 'off'.
    flip: whether up and down are exchanged, 'on' or 'off'.
    origin: 'file' keeps the origin of the file; 'auto' moves it where it is not that of the
        project.
    """

    unit: str = "auto"
    mirror: str = "auto"
    flip: str = "auto"
    origin: str = "auto"


def oriented(points: Array, body: str, given: Orientation) -> tuple[Array, list[str]]:
    """Points (n, 2) of a 'rail' or 'wheel', mm, brought to the axes of profiles, and remarks on
    what was done. There y points to the field side, z up for a rail and outwards for a wheel.
    given: what the user says.
    Raises PointError, with a place in the axes of `points`, for half a head. It is also raised
    where no standard fits well enough to tell what `given` leaves open of mirror, flip and origin.
    With mirror and flip given, points that fit no standard are not moved, and a remark warns.
    """
    signs = _signs(points, body, given)
    done = ["turned upside down"] if signs[1] < 0 else []
    even = _even(points * signs, body, standards.STEP)
    laid = standards.all_laid(even, body)
    nearest = min(laid, key=lambda each: each.misfit)
    open_ways = "auto" in (given.flip, given.mirror)
    if body == "rail" and (open_ways or nearest.fits):
        _refuse_half_head(even, signs)
    if not nearest.fits:
        text = f"is farther than {standards.FARTHEST:g} mm from {nearest.name}, the nearest "
        text += f"standard {body}, or beside it"
        if open_ways:
            keys = "profile_unit, profile_flip and profile_mirror"
            raise PointError(f"{text}; check its columns, or give its {keys}", points[0])
        mirrored = ["mirrored"] if signs[0] < 0 else []
        return points * signs, [*done, *mirrored, f"WARNING: {text}"]
    origin = nearest.origin
    if body == "rail" and given.mirror == "auto":
        right, why = gauge_side(laid)
        if right:
            signs, origin = signs * [-1, 1], origin * [-1, 1]
        done.append(f"mirrored ({why})" if right else f"sides as in the file ({why})")
    elif signs[0] < 0:
        done.append("mirrored")
    turned = points * signs
    if given.origin == "auto":
        move = _move(ordering.head(turned) if body == "rail" else turned, body, origin, points)
        if move.any():
            turned = turned + move
            place = "crown centre" if body == "rail" else "tape circle"
            done.append(f"moved by {move[0]:.2f}, {move[1]:.2f} mm to the {place}")
    return turned, done


def _even(points: Array, body: str, step: float) -> Array:
    """Points (m, 2), `step` mm apart, of the head of a rail, or of a wheel, from upright points (n,
    2); of an outline that closes, those of its upper side.
    """
    part = ordering.in_order(ordering.head(points) if body == "rail" else points)
    # Noise of dense points makes the way through them many times as long as the profile.
    part = part[:: max(1, int(step * len(part) / (8 * np.ptp(part, axis=0).sum())))]
    even = ordering.resampled(part, step)
    return even[np.gradient(even[:, 0]) > 0] if ordering.closes(part) else even


def _signs(points: Array, body: str, given: Orientation) -> Array:
    """Signs (2,) of y and z with which a standard fits best, those that `given` fixes being kept;
    y of a rail keeps its sign where mirror is 'auto', as standard heads are symmetric.
    Raises PointError where a standard fits about as well with others.
    """
    signs = {"auto": (1.0, -1.0), "off": (1.0,), "on": (-1.0,)}
    symmetric = body == "rail" and given.mirror == "auto"  # as standard heads are
    mirrors = (1.0,) if symmetric else signs[given.mirror]
    ways = [np.array([mirror, flip]) for flip in signs[given.flip] for mirror in mirrors]
    if len(ways) == 1:
        return ways[0]
    laid = [standards.roughly_laid(_even(points * way, body, COARSE_STEP), body) for way in ways]
    apart = [
        each.distance if abs(each.slope) < standards.LARGEST_SLOPE else np.inf for each in laid
    ]
    first, second = np.argsort(apart)[:2]
    if apart[second] < CLEARER * apart[first] + CLEARLY and laid[second].fits:
        keys = np.array(["profile_mirror", "profile_flip"])[ways[first] != ways[second]]
        text = f"fits {laid[first].name} as well when turned; give its {' and '.join(keys)}"
        raise PointError(text, points[0])
    return ways[first]


def _refuse_half_head(even: Array, signs: Array) -> None:
    """Raises PointError where the head has one side only: the rail that is solved would end there.
    even: (n, 2) points, mm, upright; signs: (2,) signs that turn them back into the axes of the
        file, in which the error's place is.
    """
    y, z = even.T
    top = int(np.argmax(z))
    left, right = (float(np.ptp(z[side])) for side in (y <= y[top], y >= y[top]))
    if max(left, right) > FALLS and min(left, right) < LEAST_FALL:
        text = f"is half a head: it falls {left:.2g} mm to the left of its top and {right:.2g} mm "
        text += f"to the right; give both sides, {LEAST_FALL:g} mm down at least"
        raise PointError(text, even[top] * signs)


def gauge_side(all_laid: Sequence[LaidStandard]) -> tuple[bool, str]:
    """Whether the gauge side of a rail lies at y > 0, and why.
    all_laid: every standard rail, laid on the profile.
    The gauge side is the one that has lost more, else that to which the head leans; but only where
    the other side is a standard's. False is both the answer y < 0 and the one where nothing tells:
    no side is a standard's, wear and lean contradict each other, or there is neither. The text
    says which.
    """
    laid = min(all_laid, key=_distance_of_less_worn_side)
    if _distance_of_less_worn_side(laid) > UNWORN or np.nanmin(laid.loss) < -STANDS_OUT:
        return False, "no side is a standard rail's"
    left, right = (
        standards.STEP * float(np.maximum(laid.loss[side], 0).sum()) for side in laid.sides
    )
    wears, leans = abs(right - left) > CLEAR_LOSS, abs(laid.slope) > CLEAR_SLOPE
    if wears and leans and (right > left) is (laid.slope < 0):
        return False, "worn at one side, leaning to the other"
    if wears:
        return right > left, "by its worn side"
    if leans:
        return laid.slope > 0, f"its head leans 1:{1 / abs(laid.slope):.0f} to the gauge side"
    return False, "no side is worn, the head does not lean"


def _distance_of_less_worn_side(laid: LaidStandard) -> float:
    """Root mean square distance in mm of the less worn side to the standard. A side without points
    does not count; infinite where neither has any.
    """
    squares = (laid.loss[side] ** 2 for side in laid.sides if side.any())
    return min((float(np.sqrt(square.mean())) for square in squares), default=np.inf)


def _move(points: Array, body: str, origin: Array, listed: Array) -> Array:
    """Displacement (2,) in mm that brings the crown centre or the tape circle of the standard to
    (0, 0); zero along each axis in which the points already have it there.
    points: (n, 2), mm; origin: (2,) of the standard.
    Raises PointError, in the axes of the points `listed`, for a wheel that begins in its flange.
    """
    y, z = points.T

    def height(at: float) -> float:
        """z of the point nearest to y = at, mm."""
        return float(z[np.argmin(np.abs(y - at))])

    move = np.zeros(2)
    if body == "rail":
        kept = y.min() < 0 < y.max() and height(0.0) > z.max() - NEAR_TOP
    else:
        kept = abs(origin[0]) < NEAR_SIDE
        if not kept and y.min() - origin[0] > FLANGE_TIP - BEYOND_TIP:
            text = "begins in its flange, so that nothing tells where the tape circle is; give "
            text += "points from the flange back on, or its profile_origin"
            raise PointError(text, listed[np.argmin(y)])
    if not kept:
        move[0] = -origin[0]
    if abs(level := height(-move[0])) > NEAR_ZERO:
        move[1] = -level
    return move


def in_mm(table: Table, body: str, given: str) -> tuple[Array, str]:
    """Points (n, 2) of a 'rail' or 'wheel' in mm, and a remark on their unit and its source.
    given: the unit, or 'auto' for the file's unit, else the one in which the width is usual.
    Raises PointError, at the outermost point in the axes of the table, where no unit, or not the
    given or stated one, fits the width.
    """
    stated = table.unit if given == "auto" else given
    units, y = (stated,) if stated else GUESSED_UNITS, table.points[:, 0]
    width, (least, most) = float(np.ptp(y)), WIDTHS if stated else USUAL_WIDTHS[body]
    unit = next((each for each in units if least <= width * MM_OF_UNIT[each] <= most), None)
    if unit is None:
        text = f"is {width:.4g} wide, no {body} of {least:g} to {most:g} mm in {', '.join(units)}; "
        text += "give its profile_unit, or name it in a header, y before z"
        raise PointError(text, table.points[np.argmax(np.abs(y - np.median(y)))])
    if given == "auto":
        source = f" ({'as the file says' if stated else 'by its width'})"
    else:
        overruled = table.unit not in ("", unit)
        source = f" as given (the file says {table.unit})" * overruled
    return MM_OF_UNIT[unit] * table.points, f"in {unit}{source}"
