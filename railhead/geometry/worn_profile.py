"""Profiles from which a depth was worn, and what is measured of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from railhead.geometry.profiles import Profile, Spline
from railhead.theory.array_types import Array

DENSE = 20  # places between two of `along`, over which the length is summed
STEEP = 15.0  # deg: steeper parts with y < 0 are the gauge corner, or the flange
FLANGE_HEIGHT = 10.0  # mm over the tape circle, at which EN 13715 measures the flange
PARTS = {"rail": ("crown", "gauge_corner"), "wheel": ("tread", "flange")}


@dataclass(frozen=True, kw_only=True, eq=False)
class Places:
    """Places along a profile that is new, evenly spaced, at which a worn depth is given.

    profile: the new profile.
    points: (n, 2) of (y, z), mm.
    normals: (n, 2) unit normals out of the metal.
    step: length of the profile between two places, mm.
    """

    profile: Profile
    points: Array
    normals: Array
    step: float

    def worn(self, depth: Array) -> Array:
        """Points (n, 2), mm, at a depth (n,), mm, along the normals of the new profile."""
        return np.asarray(self.points - depth[:, None] * self.normals)

    def profile_at(self, depth: Array) -> Profile:
        """The profile after a depth (n,), mm. Raises ValueError where it folds: its y does not
        rise from place to place.
        """
        y, z = self.worn(depth).T
        back = np.flatnonzero(np.diff(y) <= 0)
        if back.size:
            raise ValueError(f"the worn profile folds at y = {y[back[0]]:.3f} mm")
        return Profile(self.profile.name, (Spline(float(y[0]), float(y[-1]), CubicSpline(y, z)),))

    def area(self, depth: Array) -> float:
        """Area of the section that a depth (n,), mm, takes, mm2."""
        return self.step * float(depth.sum())

    def parts(self, body: str, depth: Array) -> dict[str, float]:
        """Area as of `area` by part: gauge corner or flange, steeper than 15 deg (STEEP) with y <
        0, and the rest, crown or tread. body: 'rail' or 'wheel'.
        """
        steep = (self.points[:, 0] < 0) & (self.normals[:, 1] < np.cos(np.radians(STEEP)))
        halves = np.where(steep, 0.0, depth), np.where(steep, depth, 0.0)
        return dict(zip(PARTS[body], map(self.area, halves), strict=True))


@lru_cache(maxsize=8)
def along(profile: Profile, count: int) -> Places:
    """`count` places along a profile from its first to its last y, ends included."""
    y = np.linspace(*profile.domain, DENSE * count)
    lengths = np.hypot(np.diff(y), np.diff(profile.height(y)))
    s = np.concatenate([[0.0], np.cumsum(lengths)])
    y = np.interp(np.linspace(0.0, s[-1], count), s, y)
    normals = np.column_stack([-profile.slope(y), np.ones(count)])
    return Places(
        profile=profile,
        points=np.column_stack([y, profile.height(y)]),
        normals=normals / np.linalg.norm(normals, axis=1)[:, None],
        step=float(s[-1]) / (count - 1),
    )


def flange_thickness(points: Array, tape_circle: float) -> float | None:
    """Distance in mm from the flange back to the flank of a flange 10 mm (FLANGE_HEIGHT) over the
    tape circle, as of EN 13715; None where the profile is not so high there.

    points: (n, 2) of the wheel's profile, y = 0 at the tape circle, mm.
    tape_circle: its distance from the flange back, mm.
    """
    y, z = points.T
    high = np.flatnonzero((y < 0) & (z > np.interp(0.0, y, z) + FLANGE_HEIGHT))
    if not high.size or high[-1] + 1 == y.size:
        return None
    ends = slice(high[-1], high[-1] + 2)
    level = np.interp(0.0, y, z) + FLANGE_HEIGHT
    return tape_circle + float(np.interp(level, z[ends][::-1], y[ends][::-1]))
