"""The surface on which the half-spaces of a contact meet, developed into a plane.

x runs along the rail from the first contact and s along the rail's profile from there. The gap is
along the rail's normals, the wheel comes down as a whole, and distances between patches are taken
along the surface, through the rail: that is exact within a plane and an approximation around a
bend, whose weight falls with the distance.

Each head of a crossing is a half-space of its own, developed along its section at right angles to
the tangent ahead at its first contact, which may rise along the rail. Heads share the sink of the
wheel and displace each other as on one half-space: their contacts lie as far apart as in space.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import find_objects, label

from railhead.contact import closed_forms, wheelset_kinematics
from railhead.contact.crossing import CrossingContact
from railhead.contact.solid import Contact
from railhead.contact.wheelset_kinematics import RigidSlip
from railhead.geometry.placement import ContactPoint
from railhead.geometry.profiles import Profile, Spline
from railhead.geometry.surfaces import RailSurface, along, between
from railhead.meshing.bodies import WHEEL
from railhead.theory.array_types import Array, Index, Mask
from railhead.theory.bem.pressure_solver import BoundaryElementSolution, Window
from railhead.theory.friction.rolling import plane_modes

SAMPLES = 4001  # points on each profile
HEAD = 2001  # points on the section of a head
BESIDE, LEAST = 1.6, 4.0  # half sizes of the search over those of paraboloids; mm, at least
ALONG, ACROSS = 41, 61  # places of the search on each head
PENETRATION = 1e-3  # least overlap, over the approach, that shows a missed patch
Locus = tuple[Array, Array, Array]
"""Places x, s on a developed surface, and the vertical height of the undeformed wheel over the rail
there, (n,) or (n, m), mm."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """The rail, or a head of a crossing: its section in a plane, swept along the normal of that
    plane.

    touch: first contact.
    origin, axes: a point (3,) of the plane, mm, and unit vectors (3, 3), a row each: ahead, across
        and out of the rail.
    angle: of the vector across to the horizontal, about the one ahead, rad.
    profile: of the section: height over the origin at places t across from it, mm.
    t, s: (n,) places across, ascending, and their arc lengths from the first contact, mm.
    middle: s of the first contact on the developed surface, mm.
    rail: true surface; None where it is the section moved ahead.
    friction: coefficient of friction; NaN: that of the scene.
    """

    touch: ContactPoint
    origin: Array
    axes: Array
    angle: float
    profile: Profile
    t: Array
    s: Array
    middle: float = 0.0
    rail: RailSurface | None = None
    friction: float = math.nan

    @property
    def ends(self) -> tuple[float, float]:
        """Arc lengths of both ends of the section from the first contact on it, mm."""
        return float(self.s[0]), float(self.s[-1])

    def across(self, s: Array, beyond: float | None = None) -> Array:
        """Places t (n,) at s (n,) of the developed surface, mm; `beyond` outside the section, or
        its end where that is None.
        """
        return np.interp(s - self.middle, self.s, self.t, beyond, beyond)

    def turn(self, t: Array) -> Array:
        """Angle (n,) of the surface to the vector across at places t (n,), mm, rad."""
        return np.asarray(np.arctan(self.profile.slope(t)))


@dataclass(frozen=True)
class Developed:
    """The surface (x, s) of the rail, or of the heads of a crossing, developed into a plane: x
    along the rail, s along the section from the first contact. Those of further heads lie as far
    from the first as in space.
    contact: bodies and first contact.
    sections: one, or one for each head.
    """

    contact: Contact
    sections: tuple[Section, ...]

    @property
    def y(self) -> Array:
        """Places (n,) across of the first section, mm: y on a plain rail."""
        return self.sections[0].t

    @property
    def s(self) -> Array:
        """Arc lengths (n,) there, mm."""
        return self.sections[0].s

    @cached_property
    def _rigid(self) -> RigidSlip:
        """Rigid slip of the wheel."""
        return wheelset_kinematics.rigid_slip(self.contact)

    @cached_property
    def _share(self) -> float:
        """Share of the gap that the wheel's displacement closes: its share of the compliance."""
        scene = self.contact.scene
        modulus = closed_forms.contact_modulus(scene)
        return modulus / closed_forms.plane_strain_modulus(scene, WHEEL)

    def _of(self, s: Array) -> Index:
        """Number (n,) of the section that places s (n,), mm, lie on."""
        middles = [each.middle for each in self.sections]
        return np.asarray(np.abs(s[:, None] - middles).argmin(axis=1))

    def _on(self, s: Array) -> Iterator[tuple[Section, Mask]]:
        """Each section, and which of the places s (n,), mm, lie on it."""
        of = self._of(s)
        return ((each, of == number) for number, each in enumerate(self.sections))

    def at(self, s: float) -> Section:
        """The section that a place s, mm, lies on."""
        return self.sections[int(self._of(np.array([s]))[0])]

    def under(self, touch: ContactPoint) -> Section:
        """The section below a contact point."""
        return min(self.sections, key=lambda each: abs(touch.y - each.touch.y))

    def place(self, touch: ContactPoint) -> tuple[float, float]:
        """Place x, s of a contact point, mm."""
        section = self.under(touch)
        x, t, _ = section.axes @ ([touch.x, touch.y, touch.z - touch.gap] - section.origin)
        s = section.middle + np.interp(t, section.t, section.s)
        return float(section.origin[0] + x), float(s)

    def angle(self, s: Array) -> Array:
        """Angle (n,) of the surface to the horizontal across, about the tangent ahead, at s (n,) in
        mm, in rad; positive where z rises with y. Beyond a section it is that of its end.
        """
        out = np.empty(len(s))
        for section, on in self._on(s):
            out[on] = section.angle + section.turn(section.across(s[on]))
        return out

    def lean(self, s: Array) -> Array:
        """Angle (n,) at which the tangent ahead rises, at s (n,), mm, rad."""
        return np.array([each.touch.lean for each in self.sections])[self._of(s)]

    def upright(self, s: Array) -> Array:
        """Cosine (n,) of the angle of the surface's normal to the vertical at s (n,), mm."""
        return np.asarray(np.cos(self.angle(s)) * np.cos(self.lean(s)))

    def friction_coefficient(self, s: Array) -> Array:
        """Coefficient of friction (n,) at s (n,) in mm; beyond a section that of its end."""
        scene, own = self.contact.scene, np.array([each.friction for each in self.sections])
        found = scene.friction.at(self.angle(s), scene.heat.bulk)
        return np.where(np.isnan(own[self._of(s)]), found, own[self._of(s)])

    def points(self, x: Array, s: Array) -> Array:
        """Points (n, 3) in space, in mm, on the sections moved to x, at s, (n,) in mm; NaN beyond
        them.
        """
        out = np.empty((len(s), 3))
        for section, on in self._on(s):
            t = section.across(s[on], math.nan)
            away = np.column_stack([x[on] - section.origin[0], t, section.profile.height(t)])
            out[on] = section.origin + away @ section.axes
        return out

    def gap(self, x: Array, s: Array) -> Array:
        """Undeformed gap (n,) along the normals of the sections at x, s (n,), in mm; infinite where
        a normal misses the wheel or the rail and beyond a section.
        """
        out, points, wheel = np.empty(len(s)), self.points(x, s), self.contact.surfaces[1]
        for section, on in self._on(s):
            turn = section.turn(section.across(s[on]))
            normals = np.outer(np.cos(turn), section.axes[2])
            normals -= np.outer(np.sin(turn), section.axes[1])
            if section.rail is None:
                out[on] = along(wheel, points[on], normals)
            else:
                out[on] = between(section.rail, wheel, points[on], normals)
        return out

    def slip(self, x: Array, s: Array) -> Array:
        """Modes of rigid slip (4, 2, nx, ns) on one section, along the tangent ahead and across, at
        x (nx,), s (ns,) in mm (`RigidSlip`); 0 beyond it. Places and tangents are those of the
        pressed surface, which lies between both bodies where the wheel is lowest.
        """
        section = self.at(float(s[0]))
        t, origin, axes = section.across(s, math.nan), section.origin, section.axes
        lowest = np.full_like(s, section.touch.x)
        if section.rail is None:
            lowest = np.interp(s, self._line[1], self._line[0])
        lift = (1 - self._share) * self.gap(lowest, s)
        lift[np.isinf(lift)] = math.nan
        h, turn = section.profile.height(t), section.turn(t)
        t, h = t - np.sin(turn) * lift, h + np.cos(turn) * lift
        turn = np.arctan2(np.gradient(h), np.gradient(t))
        aside = np.outer(np.cos(turn), axes[1]) + np.outer(np.sin(turn), axes[2])
        places = np.stack(np.broadcast_arrays(x[:, None] - origin[0], t, h), axis=-1) @ axes
        velocity = self._rigid.velocity(origin + places.reshape(-1, 3))
        velocity = velocity.reshape(4, x.size, s.size, 3)
        return np.nan_to_num(np.stack([velocity @ axes[0], (velocity * aside).sum(-1)], axis=1))

    def locus(self, closure: float) -> Locus:
        """x, s and vertical height over the rail (n,), in mm, of the wheel's contact locus, where
        its points are over the rail. Of surfaces with a shape, and of heads, it is a grid (n, m)
        instead, which holds all places that can touch after a closure (mm).
        """
        pair, shape = self.contact.pair, self.contact.shape
        if isinstance(self.contact, CrossingContact):
            grids = [self._around(section, closure) for section in self.sections]
            x, s = (np.concatenate(each, axis=1) for each in zip(*grids, strict=True))
        elif pair is not None and shape is not None:
            along_rail, across = shape.grid(pair, closure)
            x, s = np.meshgrid(along_rail, np.interp(across, self.y, self.s), indexing="ij")
        else:
            return self._line
        height = self.gap(x.ravel(), s.ravel()) / self.upright(s.ravel())
        return x, s, height.reshape(x.shape)

    @cached_property
    def _line(self) -> Locus:
        """As of `locus`, for profiles without a shape."""
        pair, pose = self.contact.pair, self.contact.pose
        assert pair is not None and pose is not None
        points = pair.outline(pose, np.linspace(*pair.wheel.domain, SAMPLES)).points
        x, y, z = points[np.isfinite(points).all(axis=1)].T
        over = (y > self.y[0]) & (y < self.y[-1])
        x, y, z = x[over], y[over], z[over]
        return x, np.interp(y, self.y, self.s), z - pair.rail.height(y)

    def _around(self, section: Section, closure: float) -> list[Array]:
        """Grid of places x, s (n, m), mm, around the contacts of a head."""
        near = [each for each in self.contact.touches(math.inf) if self.under(each) is section]
        halves = [
            max(LEAST, BESIDE * math.sqrt(2 * closure / max(curvature, 1e-4)))
            for curvature in (section.touch.curvature_x, section.touch.curvature_y)
        ]
        reach = max(halves)  # principal axes may be turned
        x, s = np.array([self.place(each) for each in near]).T
        return np.meshgrid(
            np.linspace(x.min() - reach, x.max() + reach, ALONG),
            np.linspace(s.min() - reach, s.max() + reach, ACROSS),
            indexing="ij",
        )

    def near(self, locus: Locus, closure: float) -> list[Window]:
        """Rectangles around the places of a locus at which the undeformed wheel lies in the rail
        after a closure, mm, and around the contact points at which paraboloids would.
        """
        x, s, height = locus
        found, shape = list[Window](), self.contact.shape
        touches = self.contact.touches(closure)
        if shape is not None:  # the smooth bodies touch elsewhere
            touches = [replace(self.contact.touch, x=shape.first[0], y=shape.first[1])]
        for touch in touches:
            depth = 2 * (closure - touch.gap) * math.cos(touch.angle)
            a, b = (
                math.sqrt(depth / max(each, self._flattest))
                for each in (touch.curvature_x, touch.curvature_y)
            )
            found.append((self.place(touch), (a, b)))
        return found + self._boxes(x, s, np.maximum(closure - height, 0.0))

    def missed(self, locus: Locus, found: BoundaryElementSolution) -> list[Window]:
        """Rectangles around the places of a locus outside of the windows of a solution at which the
        wheel lies in the rail by more than 0.1 % (PENETRATION) of the approach.
        """
        x, s, height = locus
        beside = height < found.approach
        for window in found.windows:
            reach = [
                abs(axis - cells.mean()) > np.ptp(cells) / 2
                for axis, cells in ((x, window.x), (s, window.s))
            ]
            beside &= reach[0] | reach[1]
        depth, at = np.zeros_like(x), (x[beside], s[beside])
        closed = found.approach * self.upright(at[1]) - self.gap(*at)
        depth[beside] = closed - found.displacement(*at, self.angle(at[1]))
        return self._boxes(x, s, np.where(depth > PENETRATION * found.approach, depth, 0.0))

    @property
    def _flattest(self) -> float:
        """Least relative curvature that is searched around, 1/mm."""
        return 0.1 / self.contact.scene.wheel.rolling_radius

    def _boxes(self, x: Array, s: Array, depth: Array) -> list[Window]:
        """Rectangles around the runs of a locus x, s (n,) in mm that lies by depth (n,) mm in the
        rail. On a grid (n, m) they are its connected parts.
        """
        found: list[Window] = []
        if depth.ndim == 2:
            steps = [np.median(np.abs(np.diff(each, axis=k))) for k, each in enumerate((x, s))]
            for part in find_objects(label(depth > 0, np.ones((3, 3)))[0]):
                centre, (a, b) = window_of(x[part], s[part])
                found.append((centre, (a + float(steps[0]), b + float(steps[1]))))
            return found
        curvature = max(self.contact.touch.curvature_x, self._flattest)
        for (run,) in find_objects(label(depth > 0)[0]):
            step = float(np.max(np.abs(np.diff(s[max(run.start - 1, 0) : run.stop + 1]))))
            centre, (a, b) = window_of(x[run], s[run])
            half = math.sqrt(2 * depth[run].max() / curvature)
            found.append((centre, (a + half, b + step)))
        return found


@dataclass(frozen=True)
class Plane:
    """The plane z = 0 between half-spaces and of a line, with places x, s as of `Developed`.
    contact: bodies and first contact.
    """

    contact: Contact

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


def window_of(x: Array, s: Array) -> Window:
    """Smallest rectangle that holds places x (n,) and s (m,), in mm."""
    (x0, x1), (s0, s1) = ((float(each.min()), float(each.max())) for each in (x, s))
    return ((x0 + x1) / 2, (s0 + s1) / 2), ((x1 - x0) / 2, (s1 - s0) / 2)


def develop(contact: Contact) -> Developed:
    """Developed surface of the rail of a contact. Raises ValueError for half-spaces, which have no
    profile.
    """
    rail, _ = contact.surfaces
    if isinstance(contact, CrossingContact):
        return Developed(contact, _heads(contact))
    profile, touch = contact.profiles["rail"][0], contact.touch
    t = np.unique([*np.linspace(*profile.domain, SAMPLES), *profile.joints, touch.y])
    section = Section(
        touch=touch,
        origin=np.zeros(3),
        axes=np.eye(3),
        angle=0.0,
        profile=profile,
        t=t,
        s=_lengths(t, profile, touch.y),
        rail=None if rail.added is None else rail,
    )
    return Developed(contact, (section,))


def _lengths(t: Array, profile: Profile, at: float) -> Array:
    """Arc lengths (n,) of places t (n,) of a profile from the place `at`, mm."""
    s = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(t), np.diff(profile.height(t))))])
    return np.asarray(s - np.interp(at, t, s))


def _heads(contact: CrossingContact) -> tuple[Section, ...]:
    """Sections of the heads of a crossing at right angles to the tangent ahead at their first
    contacts, up to where they are turned by 60 deg against these.
    """
    wing, found = contact.scene.wing, list[Section]()
    own = wing.friction_coefficient if wing else None
    for name, head in contact.crossing.heads.items():
        touch, rail = contact.crossing.placed(name)[0], RailSurface(head.surface)
        origin, axes = np.array([touch.x, touch.y, touch.z - touch.gap]), touch.axes
        low, high = head.surface.face(touch.x, touch.y, touch.slope)
        t = np.linspace(low - touch.y, high - touch.y, HEAD) / axes[1, 1]
        h = along(rail, origin + t[:, None] * axes[1], np.tile(axes[2], (len(t), 1)))
        t, h = t[np.isfinite(h)], h[np.isfinite(h)]
        profile = Profile(name, (Spline(float(t[0]), float(t[-1]), CubicSpline(t, h)),))
        _, y, z = origin - (found[0].origin if found else origin)
        section = Section(
            touch=touch,
            origin=origin,
            axes=axes,
            angle=touch.angle,
            profile=profile,
            t=t,
            s=_lengths(t, profile, 0.0),
            middle=math.copysign(math.hypot(y, z), y),
            rail=rail,
            friction=math.nan if own is None or name != "wing" else own,
        )
        found.append(section)
    return tuple(found)
