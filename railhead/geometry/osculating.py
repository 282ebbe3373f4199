"""The circle that touches a profile as closely as a circle can."""

from __future__ import annotations

import math

from railhead.geometry.profiles import Arc, Polynomial, Profile

FLAT = 1e-9  # 1/mm, curvature of what counts as straight


def osculating(profile: Profile, y: float) -> Profile:
    """The profile of one radius with the height, slope and curvature of another one at y."""
    start, end = profile.domain
    height, slope, curvature = (
        float(f(y)) for f in (profile.height, profile.slope, profile.curvature)
    )
    if abs(curvature) < FLAT:
        return Profile(profile.name, (Polynomial(start, end, (height - slope * y, slope)),))
    radius, stretch = 1 / curvature, math.hypot(1.0, slope)
    centre = (y + radius * slope / stretch, height - radius / stretch)
    reach = 0.95 * abs(radius)
    start, end = max(start, centre[0] - reach), min(end, centre[0] + reach)
    side = 1 if curvature > 0 else -1
    return Profile(profile.name, (Arc(start, end, *centre, abs(radius), side),))
