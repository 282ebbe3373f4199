"""Where a wheel that comes straight down is lowest over a lofted surface: its first contacts.

Where the surface rises along the rail the wheel touches ahead of its axle, where it falls behind
it, so the least height is looked for along the rail and across it. Places are found on a grid of
points, and then by Newton's method, on the difference of the slopes of both surfaces.
Axes: x along the rail from the axle, y of the sections, z up.
"""

import math

import numpy as np
from scipy.ndimage import minimum_filter

from railhead.geometry.lofting import Lofted
from railhead.geometry.placement import ContactPoint, principal
from railhead.geometry.profiles import Profile
from railhead.geometry.surfaces import WheelSurface, along
from railhead.theory.array_types import Array

STEP = 1.5  # mm between the points at which the height is looked at first ...
COARSE = 0.1  # mm by which those may miss a lowest place
STEPS, LONGEST, FOUND = 40, 1.5, 1e-10  # of Newton's method, mm
DIFFERENCE = 0.02  # mm, of slopes that make curvatures
APART = 0.05  # mm: two lowest places as close are one
UP = np.array([0.0, 0.0, 1.0])


def grid(surface: Lofted, wheel: WheelSurface, reach: float, clearance: float) -> Array:
    """Places (n, 2) of x and y, mm, on a grid of points of a surface, at which the height of a
    wheel over it is less than beside it; without those that are higher than the lowest one by more
    than the clearance, mm, and what the grid may miss. Empty where the wheel is beside the surface.
    reach: largest distance along the rail from the axle, mm.
    """
    places, heights = [np.zeros((0, 2))], [np.zeros(0)]
    for strip in surface.strips:
        points = strip.points(STEP) - [surface.origin, 0.0, 0.0]
        flat = points.reshape(-1, 3)
        height = along(wheel, flat, np.tile(UP, (len(flat), 1))).reshape(points.shape[:2])
        height[np.abs(points[..., 0]) > reach] = np.inf
        low = (height == minimum_filter(height, 3, mode="nearest")) & np.isfinite(height)
        places.append(points[low][:, :2])
        heights.append(height[low])
    found, height = np.concatenate(places), np.concatenate(heights)
    return found[height <= height.min(initial=np.inf) + clearance + COARSE]


def refined(
    surface: Lofted, wheel: WheelSurface, places: Array, clearance: float
) -> list[ContactPoint]:
    """Contact points next to places (n, 2) of a surface, mm, lowest first, each once; without those
    that are higher than the lowest one by more than the clearance, mm.
    """
    touches = sorted((_point(wheel, surface, *place) for place in places), key=lambda at: at.gap)
    kept: list[ContactPoint] = []
    for each in touches:
        new = all(math.hypot(each.x - other.x, each.y - other.y) > APART for other in kept)
        if new and each.gap <= touches[0].gap + clearance:
            kept.append(each)
    return kept


def _slopes(wheel: WheelSurface, surface: Lofted, x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Height (n,) of a wheel over a surface at x, y (n,), mm, the wheel's slopes (2, n) along and
    across there, and the surface's.
    """
    z, *slopes = surface(x, y)
    points = np.column_stack([x, y, z])
    height = along(wheel, points, np.tile(UP, (len(x), 1)))
    with np.errstate(invalid="ignore"):  # the wheel may be missed
        gradient = wheel.implicit(points + height[:, None] * UP)[1]
    return height, -(gradient[:, :2] / gradient[:, 2:]).T, np.array(slopes)


def _bends(wheel: WheelSurface, surface: Lofted, x: float, y: float) -> tuple[Array, Array]:
    """Second derivatives (2, 2) of the heights of a wheel and of a surface at a place, 1/mm."""
    off = DIFFERENCE * np.array([[1, -1, 0, 0], [0, 0, 1, -1]])
    _, *both = _slopes(wheel, surface, x + off[0], y + off[1])
    upper, lower = ((each[:, ::2] - each[:, 1::2]) / (2 * DIFFERENCE) for each in both)
    return (upper + upper.T) / 2, (lower + lower.T) / 2


def _point(wheel: WheelSurface, surface: Lofted, x: float, y: float) -> ContactPoint:
    """The place close to x, y (mm) at which a wheel is lowest over a surface; the place itself,
    marked as an edge, where surfaces of a common tangent have none.
    """
    place = np.array([x, y])
    for _ in range(STEPS):
        _, upper, lower = _slopes(wheel, surface, place[:1], place[1:])
        first, second = _bends(wheel, surface, *place)
        values, axes = np.linalg.eigh(np.nan_to_num(first - second))
        step = -axes @ ((axes.T @ (upper - lower)[:, 0]) / np.maximum(values, 1e-6))
        step *= min(1.0, LONGEST / max(float(np.linalg.norm(step)), 1e-300))
        if not np.isfinite(step).all() or not values[0] > 0:
            return _edge(wheel, surface, x, y)
        place = place + step
        if np.abs(step).max() < FOUND:
            break
    else:
        return _edge(wheel, surface, x, y)
    return _at(wheel, surface, *place)


def _edge(wheel: WheelSurface, surface: Lofted, x: float, y: float) -> ContactPoint:
    """A place at which a wheel is lower over a surface than beside it, without a common tangent."""
    z = float(surface(np.array([x]), np.array([y]))[0][0])
    below = np.array([[x, y, z]])
    gap = float(along(wheel, below, UP[None])[0]) if math.isfinite(z) else math.inf
    return ContactPoint(
        x=x, y=y, z=z + gap, gap=gap, at_edge=True, curvature_x=0.0, curvature_y=0.0
    )


def _at(wheel: WheelSurface, surface: Lofted, x: float, y: float) -> ContactPoint:
    """Contact point of a wheel that has the tangent of a surface at a place, mm."""
    gap, _, (ahead, across) = _slopes(wheel, surface, np.array([x]), np.array([y]))
    upper, lower = _bends(wheel, surface, x, y)
    z = float(surface(np.array([x]), np.array([y]))[0][0] + gap[0])
    inward = wheel.pose.inward(np.array([[x, y, z]]))[0]
    radius, tread = math.hypot(inward[0], inward[2]), inward[1]
    slope, rise = float(across[0]), float(ahead[0])
    bend, tilt = wheel.shape(np.zeros(1), np.array([tread]))[2][0], math.hypot(1.0, slope)
    first, second, orientation = principal(upper - lower, rise, slope)
    return ContactPoint(
        x=x,
        y=y,
        z=z,
        slope=slope,
        rise=rise,
        gap=float(gap[0]),
        wheel_y=float(tread),
        axle_angle=math.atan2(inward[0], -inward[2]),
        radius=radius,
        rail_curvature=-float(lower[1, 1]) / tilt**3,
        wheel_curvatures=(math.cos(math.atan(bend)) / radius, _curvature(wheel, tread)),
        curvature_x=first,
        curvature_y=second,
        orientation=orientation,
    )


def _curvature(wheel: WheelSurface, tread: float) -> float:
    """Curvature across of a wheel that is a profile, 1/mm, at a coordinate of it, mm."""
    assert isinstance(wheel.shape, Profile)
    return float(wheel.shape.curvature(np.array([tread]))[0])
