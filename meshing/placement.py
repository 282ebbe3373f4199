"""Where the wheel touches the rail when it is lowered onto it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from meshing.profiles import Profile

SAMPLES = 4001


class PlacementError(ValueError):
    """The two profiles cannot be brought into contact."""


@dataclass(frozen=True)
class Touch:
    """First contact of the undeformed bodies (mm, 1/mm).

    y, z: contact point; slope: dz/dy of the common tangent; axle_height: z of the axle;
    curvature_x, curvature_y: relative curvatures along and across (sum of both bodies);
    at_edge: the point lies at the end of a profile, so there is no common tangent.
    """

    y: float
    z: float
    slope: float
    axle_height: float
    curvature_x: float
    curvature_y: float
    at_edge: bool

    @property
    def angle(self) -> float:
        """Contact angle, rad."""
        return float(np.arctan(self.slope))


def lower(rail: Profile, wheel: Profile, rolling_radius: float, shift: float = 0.0) -> Touch:
    """Lower the wheel (axle along y, profile moved by `shift`) until it first touches the rail.

    The bodies touch where rail z(y) + wheel z(y - shift) is largest.
    """
    start = max(rail.domain[0], wheel.domain[0] + shift)
    end = min(rail.domain[1], wheel.domain[1] + shift)
    if end <= start:
        raise PlacementError(f"the profiles do not overlap with a shift of {shift:g} mm")

    def overlap(y: float) -> float:
        return float(rail.height(y) + wheel.height(y - shift))

    y = np.linspace(start, end, SAMPLES)
    values = rail.height(y) + wheel.height(y - shift)
    best = int(np.nanargmax(values))
    low, high = y[max(best - 1, 0)], y[min(best + 1, SAMPLES - 1)]
    result = minimize_scalar(
        lambda v: -overlap(v), bounds=(low, high), method="bounded", options={"xatol": 1e-10}
    )
    contact = float(result.x if -result.fun >= values[best] else y[best])
    contact = _polish(rail, wheel, shift, contact, low, high)
    slope = float(rail.slope(contact)) + 0.0  # no negative zero
    axle = overlap(contact) + rolling_radius
    radius = rolling_radius + float(wheel.height(contact - shift))
    return Touch(
        y=contact,
        z=float(rail.height(contact)),
        slope=slope,
        axle_height=axle,
        curvature_x=float(np.cos(np.arctan(slope))) / radius,
        curvature_y=float(rail.curvature(contact) + wheel.curvature(contact - shift)),
        at_edge=best in (0, SAMPLES - 1),
    )


def _polish(
    rail: Profile, wheel: Profile, shift: float, y: float, low: float, high: float
) -> float:
    """Newton's method on the slope of the overlap: digits a search for a maximum cannot see."""
    for _ in range(20):
        slope = float(rail.slope(y) + wheel.slope(y - shift))
        bend = float(rail._evaluate(y, 2) + wheel._evaluate(y - shift, 2))
        if not bend < 0:
            return y
        better = min(max(y - slope / bend, low), high)
        if abs(better - y) < 1e-14:
            return better
        y = better
    return y
