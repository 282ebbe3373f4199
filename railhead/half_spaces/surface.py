"""The surface on which the half-spaces of a contact meet, developed into a plane.

x runs along the rail from the first contact and s along the rail's profile from there. The gap is
along the rail's normals, the wheel comes down as a whole, and distances between patches are taken
along the surface, through the rail: that is exact within a plane and an approximation around a
bend, whose weight falls with the distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhead.contact import closed_forms, wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.geometry.placement import ContactPoint
from railhead.geometry.surfaces import along, between
from railhead.meshing.bodies import WHEEL
from railhead.theory.array_types import Array
from railhead.theory.friction.rolling import plane_modes

SAMPLES = 4001  # points on each profile


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

    @property
    def spans(self) -> list[Span]:
        """The whole profile."""
        return [Span(0.0, (float(self.s[0]), float(self.s[-1])), self.contact.touch)]

    def angle(self, s: Array) -> Array:
        """Angle (n,) of the rail's surface to the horizontal at s (n,) in mm, in rad; positive
        where z rises with y. Beyond the profile it is that of its end.
        """
        return np.asarray(np.arctan(self.contact.profiles["rail"][0].slope(self._across(s))))

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
        Of the gap between the bodies the wheel's displacement closes its share of the compliance.
        """
        scene = self.contact.scene
        modulus = closed_forms.contact_modulus(scene)
        share = modulus / closed_forms.plane_strain_modulus(scene, WHEEL)
        slip = wheelset_kinematics.rigid_slip(self.contact, share)
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
            height = self.gap(x.ravel(), s.ravel()) / np.cos(self.angle(s.ravel()))
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
    """The plane z = 0 between half-spaces, with places x, s as of `Developed`.
    contact: bodies and first contact.
    """

    contact: Contact

    def friction_coefficient(self, s: Array) -> Array:
        """Coefficient of friction (n,) at s (n,) in mm."""
        return self.contact.friction_coefficient(s)

    def points(self, x: Array, s: Array) -> Array:
        """Points (n, 3) in space, in mm, at x, s (n,) in mm."""
        return np.column_stack([x, s, np.zeros_like(x)])

    def slip(self, x: Array, s: Array) -> Array:
        """Modes of rigid slip (4, 2, nx, ns) at x (nx,), s (ns,) in mm."""
        return plane_modes(x, s)


def develop(contact: Contact) -> Developed:
    """Developed surface of the rail of a contact. Raises ValueError for half-spaces, which have no
    profile.
    """
    rail = contact.profiles["rail"][0]
    y = np.unique([*np.linspace(*rail.domain, SAMPLES), *rail.joints, contact.touch.y])
    s = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(y), np.diff(rail.height(y))))])
    return Developed(contact, s - s[np.searchsorted(y, contact.touch.y)], y)
