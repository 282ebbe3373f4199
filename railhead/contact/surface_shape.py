"""What is added to the smooth surfaces of rail and wheel, and how high the wheel then stands.

The bodies keep their smooth shape and place; the gap is that of the true surfaces. The wheel comes
down straight from its smooth first contact until the true surfaces touch, which may be ahead of
that place or behind it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.ndimage import minimum_filter

from railhead.geometry.placement import ContactPoint, Pose, ProfilePair
from railhead.geometry.surfaces import (
    Cosine,
    FreshFlat,
    Height,
    RailSurface,
    RoundedFlat,
    WheelSurface,
    between,
    read_map,
)
from railhead.scene.scene import Scene, SceneError
from railhead.theory.array_types import Array

LEAST, MOST = 201, 100_000  # samples along the rail, and of a whole grid
PER_LENGTH = 8  # samples in the length over which a height changes
BEST = 24  # lowest samples around which the lowest point is looked for
ZOOMS, CLOSER = 12, 4  # steps towards a lowest point, and how much finer each is
EVEN = 1e-6  # of the range of the heights, largest difference of mirrored ones


@dataclass(frozen=True, kw_only=True)
class SurfaceShape:
    """Heights that are added to the surfaces of a contact, in its axes.
    rail, wheel: height, with x along from the smooth first contact (the wheel's from its lowest
        line); None: nothing is added.
    pose: of the wheel whose true surface touches the rail's.
    first: place (x, y) where it does so, mm.
    odd: whether the heights differ at x and -x, and at y and -y.
    """

    rail: Height | None
    wheel: Height | None
    pose: Pose
    first: tuple[float, float] = (0.0, 0.0)
    odd: tuple[bool, bool] = (False, False)

    @property
    def range(self) -> float:
        """Sum of the ranges of both heights, mm."""
        return sum(each.range for each in (self.rail, self.wheel) if each is not None)

    def surfaces(self, pair: ProfilePair) -> tuple[RailSurface, WheelSurface]:
        """True surfaces of rail and wheel in space; pair: their smooth profiles."""
        wheel = WheelSurface(pair.wheel, pair.rolling_radius, self.pose, self.wheel)
        return RailSurface(pair.rail, self.rail), wheel

    def at(self, pair: ProfilePair, points: Array) -> tuple[Array, dict[str, Array]]:
        """Sum of both heights (n,) at points (n, 3) in space near the surfaces, mm, and by body
        ('rail', 'wheel') the slope (n,) of its height. pair: smooth profiles.
        """
        height, slopes = np.zeros(len(points)), {}
        x, y, z = self.pose.inward(points).T
        around = pair.rolling_radius * np.arctan2(x, -z)
        for body, added, places in (
            ("rail", self.rail, (points[:, 0], points[:, 1])),
            ("wheel", self.wheel, (around, y)),
        ):
            if added is not None:
                value, ahead, aside = added(*places)
                height, slopes[body] = height + value, np.hypot(ahead, aside)
        return height, slopes

    def grid(self, pair: ProfilePair, closure: float) -> tuple[Array, Array]:
        """Places x (n,) along and y (m,) across the rail, evenly spaced, mm, that hold all points
        at which the bodies can touch after a closure (mm) from their first contact. pair: smooth
        profiles.
        """
        reach = math.sqrt(2 * pair.rolling_radius * (self.range + closure))
        _, y, z = pair.outline(self.pose, pair.samples[0]).points.T
        height = z - pair.rail.height(y)
        near = y[height <= np.nanmin(height) + self.range + closure]
        low, high = float(near.min()), float(near.max())
        lengths = [each.length for each in (self.rail, self.wheel) if each is not None]
        step = max(min(lengths) / PER_LENGTH, math.sqrt(2 * reach * (high - low) / MOST))
        widths = reach, (high - low) / 2
        n, m = (max(LEAST, 1 + 2 * math.ceil(width / step)) for width in widths)
        return np.linspace(-reach, reach, n), np.linspace(low, high, m)


def shape(scene: Scene, pair: ProfilePair, pose: Pose, touch: ContactPoint) -> SurfaceShape | None:
    """What a scene adds to the surfaces of rail and wheel; None where that is nothing.
    pair, pose, touch: smooth profiles, pose of the wheel, and first contact, which is at x = 0.
    Raises SceneError for a map that cannot be read, and for heights that change too quickly.
    """
    rail, wheel = height(scene, "rail"), height(scene, "wheel")
    if rail is None and wheel is None:
        return None
    if wheel is not None:
        turned = pair.rolling_radius * touch.axle_angle
        wheel = replace(wheel, position=wheel.position - turned)
    smooth = SurfaceShape(rail=rail, wheel=wheel, pose=pose)
    x, y = smooth.grid(pair, 0.0)
    for body, each in (("rail", rail), ("wheel", wheel)):
        if each is not None and each.length < 2 * (step := x[1] - x[0]):
            text = f"its height changes within {each.length:.3g} mm, as roughness does"
            raise SceneError(f"{body}.surface", f"{text}; give at least {2 * step:.2g} mm")
    gap, first = _lowest(partial(_over_rail, *smooth.surfaces(pair)), x, y)
    lowered = replace(smooth, pose=pose.moved(z=-gap), first=first)
    return replace(lowered, odd=_odd(lowered, pair, x, y))


def height(scene: Scene, body: str) -> Height | None:
    """What a scene adds to the surface of a body, 'rail' or 'wheel'; None where its height is the
    same everywhere. Raises SceneError for a map that cannot be read.
    """
    given = scene.bodies[body].surface
    if given is None:
        return None
    at: Any = {"length": given.length, "position": given.position}
    found: Height
    if given.file is not None:
        try:
            found = read_map(Path(given.file), given.position)
        except (ValueError, OSError) as error:
            raise SceneError(f"{body}.surface.file", str(error)) from None
    elif given.amplitude is not None:
        found = Cosine(**at, amplitude=given.amplitude)
    elif given.depth is not None:
        found = RoundedFlat(**at, depth=given.depth)
    else:
        found = FreshFlat(**at, radius=scene.wheel.rolling_radius)
    return found if found.range > 0 else None


def _over_rail(rail: RailSurface, wheel: WheelSurface, x: Array, y: Array) -> Array:
    """Vertical height (n,) of the wheel's true surface over the rail's at x and y (n,), all in mm;
    infinite where one of them ends.
    """
    points = np.column_stack([x, y, np.zeros_like(x)])
    return between(rail, wheel, points, np.tile([0.0, 0.0, 1.0], (len(x), 1)))


def _lowest(
    above: Callable[[Array, Array], Array], x: Array, y: Array
) -> tuple[float, tuple[float, float]]:
    """Least value of a function of x and y, in mm, and its place, over a grid x (n,), y (m,), and
    around the lowest of its samples; these are looked at more and more closely.
    """
    places = np.meshgrid(x, y, indexing="ij")
    values = above(*(each.ravel() for each in places)).reshape(places[0].shape)
    low = (values == minimum_filter(values, 3)) & np.isfinite(values)
    dx, dy = (float(axis[1] - axis[0]) for axis in (x, y))
    order = np.argsort(values[low])[:BEST]
    at, beside = (each[low][order] for each in places)
    ticks = np.linspace(-1.0, 1.0, 2 * CLOSER + 1)
    u, v = (each.ravel() for each in np.meshgrid(ticks, ticks))
    for _ in range(ZOOMS):
        near = at[:, None] + dx * u, beside[:, None] + dy * v
        values = above(*(each.ravel() for each in near)).reshape(len(at), -1)
        best = np.arange(len(at)), np.argmin(values, axis=1)
        at, beside = (each[best] for each in near)
        dx, dy = dx / CLOSER, dy / CLOSER
    at_best = np.argmin(values[best])
    return float(values[best][at_best]), (float(at[at_best]), float(beside[at_best]))


def _odd(shape: SurfaceShape, pair: ProfilePair, x: Array, y: Array) -> tuple[bool, bool]:
    """Whether the heights differ at x and -x, and at y and -y, on a grid twice as wide as x (n,),
    y (m,), mm.
    """
    x, y = (each.ravel() for each in np.meshgrid(2 * x, 2 * np.abs(y)))
    z = pair.rail.height(y)
    here, ahead, aside = (
        shape.at(pair, np.column_stack([p * x, q * y, z]))[0] for p, q in ((1, 1), (-1, 1), (1, -1))
    )
    along_rail, across = (
        bool(np.nanmax(np.abs(each - here)) > EVEN * shape.range) for each in (ahead, aside)
    )
    return along_rail, across
