"""The heads of a crossing as half-spaces under one wheel.

Each head is a half-space of its own, in the common tangent plane of its first contact, which may
rise along the rail. They share the sink of the wheel, and do not displace each other: their planes
lie beside each other at a distance at which nothing is felt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from railhead.contact.crossing import CrossingContact
from railhead.geometry.placement import ContactPoint
from railhead.geometry.surfaces import RailSurface, between
from railhead.half_spaces.surface import Span
from railhead.theory.array_types import Array, Index

APART = 1e5  # mm from plane to plane
BESIDE, LEAST = 1.6, 4.0  # half sizes of the search over those of paraboloids; mm, at least
ALONG, ACROSS = 41, 61  # places of the search on each head


@dataclass(frozen=True)
class Heads:
    """Tangent planes (x, s) of the heads of a contact: x along the rail, ahead of the axle at each
    contact, s across it, at the contact of the k-th head k times 1e5 mm (APART).
    contact: wheel and heads.
    """

    contact: CrossingContact

    @cached_property
    def touches(self) -> list[ContactPoint]:
        """First contact of each head."""
        crossing = self.contact.crossing
        return [crossing.placed(name)[0] for name in crossing.heads]

    @cached_property
    def _frames(self) -> tuple[Array, Array, Array]:
        """Contact points (k, 3) on the rail, mm, axes (k, 3, 3) of the planes, and the angle (k,)
        of their normals to the vertical, with the sign of the slope across, rad.
        """
        origins = [[each.x, each.y, each.z - each.gap] for each in self.touches]
        angles = [math.copysign(math.acos(each.upright), each.slope) for each in self.touches]
        return np.array(origins), np.array([each.axes for each in self.touches]), np.array(angles)

    def _of(self, s: Array) -> Index:
        """Number (n,) of the head of places s (n,), mm."""
        return np.clip(np.rint(s / APART).astype(int), 0, len(self.touches) - 1)

    @cached_property
    def spans(self) -> list[Span]:
        """A `Span` for each head, up to where it turns down, or its corner."""
        found, heads = [], self.contact.crossing.heads.values()
        for number, (head, touch) in enumerate(zip(heads, self.touches, strict=True)):
            low, high = head.surface.face(touch.x, touch.y)
            found.append(Span(number * APART, (low - touch.y, high - touch.y), touch))
        return found

    def angle(self, s: Array) -> Array:
        """Angle (n,) of the planes' normals to the vertical at s (n,) in mm, rad."""
        return np.asarray(self._frames[2][self._of(s)])

    def points(self, x: Array, s: Array) -> Array:
        """Points (n, 3) in space, in mm, of the planes at x, s (n,) in mm."""
        (origins, axes, _), of = self._frames, self._of(s)
        ahead, aside = x - origins[of, 0], s - of * APART
        return origins[of] + ahead[:, None] * axes[of, 0] + aside[:, None] * axes[of, 1]

    def gap(self, x: Array, s: Array) -> Array:
        """Undeformed gap (n,) along the planes' normals at x, s (n,), in mm; infinite where a
        normal misses the wheel or its head.
        """
        points, of, gap = self.points(x, s), self._of(s), np.full(len(x), np.inf)
        wheel = self.contact.surfaces()[1]
        for number, head in enumerate(self.contact.crossing.heads.values()):
            here = np.flatnonzero(of == number)
            normals = np.tile(self._frames[1][number, 2], (len(here), 1))
            gap[here] = between(RailSurface(head.surface), wheel, points[here], normals)
        return gap

    def locus(self, closure: float) -> tuple[Array, Array, Array]:
        """Grid of places x, s (n, m) of all heads, and the vertical height (n, m) of the wheel over
        them there, mm, that holds all places that can touch after a closure (mm).
        """
        grids = []
        for number, name in enumerate(self.contact.crossing.heads):
            near = self.contact.crossing.placed(name)
            first = near[0]
            halves = [
                max(LEAST, BESIDE * math.sqrt(2 * closure / max(curvature, 1e-4)))
                for curvature in (first.curvature_x, first.curvature_y)
            ]
            reach = max(halves)  # principal axes may be turned
            x, y = ([getattr(each, key) for each in near] for key in ("x", "y"))
            grid = np.meshgrid(
                np.linspace(min(x) - reach, max(x) + reach, ALONG),
                np.linspace(min(y) - reach, max(y) + reach, ACROSS) - first.y + number * APART,
                indexing="ij",
            )
            grids.append(grid)
        x, s = (np.concatenate([grid[k] for grid in grids], axis=1) for k in (0, 1))
        height = self.gap(x.ravel(), s.ravel()) / np.cos(self.angle(s.ravel()))
        return x, s, height.reshape(x.shape)
