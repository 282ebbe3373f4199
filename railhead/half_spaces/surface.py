"""The surface on which the half-spaces of a contact meet, developed into a plane.

x runs along the rail from the first contact and s along the rail's profile from there. The gap is
along the rail's normals, the wheel comes down as a whole, and distances between patches are taken
along the surface, through the rail: that is exact within a plane and an approximation around a
bend, whose weight falls with the distance.

Each head of a crossing is a half-space of its own, developed along its section at right angles to
the tangent ahead at its first contact, which may rise along the rail. Heads share the sink of the
wheel and displace each other as on one half-space: their contacts lie as far apart as in space.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from railhead.contact import closed_forms, wheelset_kinematics
from railhead.contact.crossing import CrossingContact
from railhead.contact.solid import Contact
from railhead.contact.wheelset_kinematics import RigidSlip
from railhead.geometry.placement import ContactPoint
from railhead.geometry.surfaces import RailSurface, along, between
from railhead.meshing.bodies import WHEEL
from railhead.theory.array_types import Array, Index
from railhead.theory.friction.rolling import plane_modes

SAMPLES = 4001  # points on each profile
HEAD = 2001  # points on the section of a head
BESIDE, LEAST = 1.6, 4.0  # half sizes of the search over those of paraboloids; mm, at least
ALONG, ACROSS = 41, 61  # places of the search on each head


@dataclass(frozen=True)
class Span:
    """Part of a developed surface that is one body.

    middle: s of its first contact, mm.
    ends: s of its ends from there, mm.
    touch: the first contact.
    """

    middle: float
    ends: tuple[float, float]
    touch: ContactPoint


@dataclass(frozen=True)
class Developed:
    """The rail's surface developed into a plane (x, s): x along the rail, s along the profile from
    the first contact.
    contact: bodies and first contact.
    s: (n,) arc lengths, ascending, mm.
    y: (n,) y on the rail at each s, mm.
    """

    contact: Contact
    s: Array
    y: Array

    @cached_property
    def _rigid(self) -> RigidSlip:
        """Rigid slip of the wheel on the pressed surface: of the gap between the bodies the wheel's
        displacement closes its share of the compliance.
        """
        scene = self.contact.scene
        modulus = closed_forms.contact_modulus(scene)
        share = modulus / closed_forms.plane_strain_modulus(scene, WHEEL)
        return wheelset_kinematics.rigid_slip(self.contact, share)

    @property
    def angular(self) -> Array:
        """Angular velocity (4, 3) of each mode of rigid slip, 1/mm, as of `RigidSlip`."""
        return self._rigid.angular

    @property
    def spans(self) -> list[Span]:
        """The whole profile."""
        return [Span(0.0, (float(self.s[0]), float(self.s[-1])), self.contact.touch)]

    def angle(self, s: Array) -> Array:
        """Angle (n,) of the rail's surface to the horizontal at s (n,) in mm, in rad; positive
        where z rises with y. Beyond the profile it is that of its end.
        """
        return np.asarray(np.arctan(self.contact.profiles["rail"][0].slope(self._across(s))))

    def lean(self, s: Array) -> Array:
        """Angle (n,) at which the rail rises ahead at s (n,), mm, rad: none."""
        return np.zeros_like(s)

    def upright(self, s: Array) -> Array:
        """Part (n,) of the surface's normal at s (n,), mm, that points up."""
        return np.cos(self.angle(s))

    def friction_coefficient(self, s: Array) -> Array:
        """Coefficient of friction (n,) at s (n,) in mm; beyond the profile that of its end."""
        return self.contact.friction_coefficient(self._across(s))

    def points(self, x: Array, s: Array) -> Array:
        """Points (n, 3) in space, in mm, on the rail's surface at x, s (n,) in mm; NaN beyond the
        profile.
        """
        y = self._across(s, math.nan)
        return np.column_stack([x, y, self.contact.profiles["rail"][0].height(y)])

    def slip(self, x: Array, s: Array) -> Array:
        """Modes of rigid slip (4, 2, nx, ns) along the rail and along the profile of the pressed
        surfaces at x (nx,), s (ns,) in mm (`wheelset_kinematics.RigidSlip`); 0 beyond the profile.
        """
        slip = self._rigid
        _, y, z = slip.places(self.points(0 * s, s)).T
        slope = np.arctan2(np.gradient(z), np.gradient(y))
        grid = (each.ravel() for each in np.meshgrid(x, s, indexing="ij"))
        velocity = slip(self.points(*grid)).reshape(4, x.size, s.size, 3)
        aside = np.cos(slope) * velocity[..., 1] + np.sin(slope) * velocity[..., 2]
        return np.nan_to_num(np.stack([velocity[..., 0], aside], axis=1))

    def gap(self, x: Array, s: Array) -> Array:
        """Undeformed gap (n,) along the rail's normals at x, s (n,), in mm; infinite where a normal
        misses the wheel and beyond the rail's profile. Normals are those of the smooth rail.
        """
        angle, (rail, wheel) = self.angle(s), self.contact.surfaces()
        normals = np.column_stack([np.zeros_like(angle), -np.sin(angle), np.cos(angle)])
        if rail.added is None:  # the points lie on it
            return along(wheel, self.points(x, s), normals)
        return between(rail, wheel, self.points(x, s), normals)

    def locus(self, closure: float) -> tuple[Array, Array, Array]:
        """x, s and vertical height over the rail (n,), in mm, of the wheel's contact locus, where
        its points are over the rail. Of surfaces with a shape it is a grid (n, m) instead, which
        holds all places that can touch after a closure (mm).
        """
        pair, pose, shape = self.contact.pair, self.contact.pose, self.contact.shape
        assert pair is not None and pose is not None
        if shape is not None:
            along_rail, across = shape.grid(pair, closure)
            x, s = np.meshgrid(along_rail, np.interp(across, self.y, self.s), indexing="ij")
            height = self.gap(x.ravel(), s.ravel()) / self.upright(s.ravel())
            return x, s, height.reshape(x.shape)
        points = pair.outline(pose, np.linspace(*pair.wheel.domain, SAMPLES)).points
        x, y, z = points[np.isfinite(points).all(axis=1)].T
        over = (y > self.y[0]) & (y < self.y[-1])
        x, y, z = x[over], y[over], z[over]
        return x, np.interp(y, self.y, self.s), z - pair.rail.height(y)

    def _across(self, s: Array, beyond: float | None = None) -> Array:
        """y (mm) on the rail at arc lengths s (n,) in mm; `beyond` outside the profile, or its end
        where that is None.
        """
        return np.interp(s, self.s, self.y, beyond, beyond)


@dataclass(frozen=True)
class Plane:
    """The plane z = 0 between half-spaces and of a line, with places x, s as of `Developed`.
    contact: bodies and first contact.
    """

    contact: Contact
    angular: ClassVar[Array] = np.array([[0.0] * 3, [0.0] * 3, [0.0, 0.0, 1.0], [0.0] * 3])
    """Angular velocity (4, 3) of each mode of rigid slip, 1/mm: about z for unit spin, else 0."""

    def friction_coefficient(self, s: Array) -> Array:
        """Coefficient of friction (n,) at s (n,) in mm."""
        scene = self.contact.scene
        return scene.friction.at(np.full(s.shape, self.contact.touch.angle), scene.heat.bulk)

    def points(self, x: Array, s: Array) -> Array:
        """Points (n, 3) in space, in mm, at x, s (n,) in mm."""
        return np.column_stack([x, s, np.zeros_like(x)])

    def slip(self, x: Array, s: Array) -> Array:
        """Modes of rigid slip (4, 2, nx, ns) at x (nx,), s (ns,) in mm."""
        return plane_modes(x, s)


@dataclass(frozen=True)
class Heads:
    """Developed surfaces (x, s) of the heads of a contact: x along the tangent ahead, from below
    the axle, and s along the section, from the contact of each head, which is as far from that of
    the first as in space.
    contact: wheel and heads.
    """

    contact: CrossingContact

    @cached_property
    def touches(self) -> list[ContactPoint]:
        """First contact of each head."""
        crossing = self.contact.crossing
        return [crossing.placed(name)[0] for name in crossing.heads]

    @cached_property
    def _frames(self) -> tuple[Array, Array]:
        """Contact points (k, 3) on the rail, mm, and axes (k, 3, 3) there."""
        origins = [[each.x, each.y, each.z - each.gap] for each in self.touches]
        return np.array(origins), np.array([each.axes for each in self.touches])

    @cached_property
    def _middles(self) -> Array:
        """s (k,) of the contacts of the heads, mm."""
        _, y, z = (self._frames[0] - self._frames[0][0]).T
        return np.asarray(np.copysign(np.hypot(y, z), y))

    @cached_property
    def _sections(self) -> list[Array]:
        """Of each head rows (4, n): s from its contact, mm, ascending; a point's distance from the
        contact along the tangent across and along the normal, mm; and how far the surface's normal
        is turned about the tangent ahead, rad.
        """
        found = []
        each = zip(self.contact.crossing.heads.values(), self.touches, *self._frames, strict=True)
        for head, touch, origin, (_, across, normal) in each:
            low, high = head.surface.face(touch.x, touch.y, touch.slope)
            t = np.linspace(low - touch.y, high - touch.y, HEAD) / across[1]
            line, rail = origin + t[:, None] * across, RailSurface(head.surface)
            h = along(rail, line, np.tile(normal, (len(t), 1)))
            t, h, line = (of[np.isfinite(h)] for of in (t, h, line))
            upwards = rail.implicit(line + h[:, None] * normal)[1]
            s = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(t), np.diff(h)))])
            turn = np.arctan2(-upwards @ across, upwards @ normal)
            found.append(np.array([s - np.interp(0.0, t, s), t, h, turn]))
        return found

    def _of(self, s: Array) -> Index:
        """Number (n,) of the head of places s (n,), mm."""
        return np.asarray(np.abs(s[:, None] - self._middles).argmin(axis=1))

    def _at(self, s: Array, beyond: float | None = None) -> Array:
        """Rows (3, n) as of `_sections`, without s, at places s (n,), mm; those of the end beyond
        it, or `beyond`.
        """
        of, found = self._of(s), np.zeros((3, len(s)))
        for number, (places, *rows) in enumerate(self._sections):
            here = of == number
            local = s[here] - self._middles[number]
            found[:, here] = [np.interp(local, places, row, beyond, beyond) for row in rows]
        return found

    @cached_property
    def _rigid(self) -> RigidSlip:
        """Rigid slip of the wheel."""
        return wheelset_kinematics.rigid_slip(self.contact)

    @property
    def angular(self) -> Array:
        """Angular velocity (4, 3) of each mode of rigid slip, 1/mm, as of `RigidSlip`."""
        return self._rigid.angular

    @property
    def spans(self) -> list[Span]:
        """A `Span` for each head, up to where it is turned by 60 deg against its contact."""
        each = zip(self._middles, self._sections, self.touches, strict=True)
        return [Span(float(s), (of[0, 0], of[0, -1]), touch) for s, of, touch in each]

    def angle(self, s: Array) -> Array:
        """Angle (n,) of the surface's normal about the tangent ahead at s (n,), mm, rad; that of a
        plain rail where this tangent is level.
        """
        first = np.array([each.angle for each in self.touches])
        return np.asarray(first[self._of(s)] + self._at(s)[2])

    def lean(self, s: Array) -> Array:
        """Angle (n,) at which the tangent ahead rises, at s (n,), mm, rad."""
        return np.array([each.lean for each in self.touches])[self._of(s)]

    def upright(self, s: Array) -> Array:
        """Part (n,) of the surface's normal at s (n,), mm, that points up."""
        return np.cos(self.angle(s)) * np.cos(self.lean(s))

    def friction_coefficient(self, s: Array) -> Array:
        """Coefficient of friction (n,) at s (n,) in mm."""
        scene, names = self.contact.scene, np.array([*self.contact.crossing.heads])
        own = scene.wing and scene.wing.friction_coefficient
        found = scene.friction.at(self.angle(s), scene.heat.bulk)
        return np.where(names[self._of(s)] == "wing", own, found) if own else found

    def points(self, x: Array, s: Array) -> Array:
        """Points (n, 3) in space, in mm, at x, s (n,) in mm, on the section moved ahead."""
        (origins, axes), of, (t, h, _) = self._frames, self._of(s), self._at(s, math.nan)
        away = np.column_stack([x - origins[of, 0], t, h])
        return np.asarray(origins[of] + np.einsum("nk,nkd->nd", away, axes[of]))

    def gap(self, x: Array, s: Array) -> Array:
        """Undeformed gap (n,) along the normals of the section at x, s (n,), in mm; infinite where
        a normal misses the wheel or its head.
        """
        points, of, gap = self.points(x, s), self._of(s), np.full(len(x), np.inf)
        axes, turn, wheel = self._frames[1][of], self._at(s)[2], self.contact.surfaces()[1]
        normals = np.cos(turn)[:, None] * axes[:, 2] - np.sin(turn)[:, None] * axes[:, 1]
        for number, head in enumerate(self.contact.crossing.heads.values()):
            here = of == number
            gap[here] = between(RailSurface(head.surface), wheel, points[here], normals[here])
        return gap

    def slip(self, x: Array, s: Array) -> Array:
        """Modes of rigid slip (4, 2, nx, ns) on one head along the tangent ahead and along the
        section of the pressed surfaces, at x (nx,), s (ns,) in mm, as of `Developed.slip`.
        """
        scene, number = self.contact.scene, self._of(s)[0]
        share = closed_forms.contact_modulus(scene) / closed_forms.plane_strain_modulus(
            scene, WHEEL
        )
        (origin, axes), (t, h, turn) = (of[number] for of in self._frames), self._at(s)
        lift = (1 - share) * self.gap(np.full_like(s, origin[0]), s)
        t, h = t - np.sin(turn) * lift, h + np.cos(turn) * lift
        turn = np.arctan2(np.gradient(h), np.gradient(t))
        aside = np.outer(np.cos(turn), axes[1]) + np.outer(np.sin(turn), axes[2])
        places = np.stack(np.broadcast_arrays(x[:, None] - origin[0], t, h), axis=-1) @ axes
        velocity = replace(self._rigid, rail=None)(origin + places.reshape(-1, 3)).reshape(
            4, x.size, s.size, 3
        )
        return np.nan_to_num(np.stack([velocity @ axes[0], (velocity * aside).sum(-1)], axis=1))

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
            (origin, axes), (places, across, *_) = (
                (of[number] for of in self._frames),
                self._sections[number],
            )
            away = np.array([[each.x, each.y, each.z - each.gap] for each in near]) - origin
            x, s = origin[0] + away @ axes[0], np.interp(away @ axes[1], across, places)
            grid = np.meshgrid(
                np.linspace(x.min() - reach, x.max() + reach, ALONG),
                np.linspace(s.min() - reach, s.max() + reach, ACROSS) + self._middles[number],
                indexing="ij",
            )
            grids.append(grid)
        x, s = (np.concatenate([grid[k] for grid in grids], axis=1) for k in (0, 1))
        height = self.gap(x.ravel(), s.ravel()) / self.upright(s.ravel())
        return x, s, height.reshape(x.shape)


def develop(contact: Contact) -> Developed:
    """Developed surface of the rail of a contact. Raises ValueError for half-spaces, which have no
    profile.
    """
    rail = contact.profiles["rail"][0]
    y = np.unique([*np.linspace(*rail.domain, SAMPLES), *rail.joints, contact.touch.y])
    s = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(y), np.diff(rail.height(y))))])
    return Developed(contact, s - s[np.searchsorted(y, contact.touch.y)], y)
