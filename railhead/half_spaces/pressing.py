"""The rail's surface developed around a contact, and one elastic problem on it.

x runs along the rail from the first contact and s along the rail's profile from there. The gap is
along the rail's normals, the wheel comes down as a whole, and distances between patches are taken
along the surface, through the rail: that is exact within a plane and an approximation around a
bend, whose weight falls with the distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import find_objects, label

from railhead.contact import closed_forms, wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.geometry.surfaces import along
from railhead.meshing.bodies import WHEEL
from railhead.theory.array_types import Array
from railhead.theory.bem import pressure_solver
from railhead.theory.bem.influence import Lines
from railhead.theory.bem.pressure_solver import BoundaryElementSolution, Window
from railhead.theory.elastic.line import Hertz

SAMPLES = 4001  # points on each profile
FIRST_REACH = 1.2  # closure up to which patches are searched at first, over Hertz's approach
PENETRATION = 1e-3  # least overlap, over the approach, that shows a missed patch
MAX_SOLUTIONS = 5
TOLERANCE = 1e-5
CELLS = 64  # cells along each axis of a patch


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
        upper = along(wheel, self.points(x, s), normals)
        if rail.height is None:
            return upper
        lower = along(rail, self.points(x, s), normals)
        return np.where(np.isfinite(lower), upper - np.where(np.isfinite(lower), lower, 0), np.inf)

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


def develop(contact: Contact) -> Developed:
    """Developed surface of the rail of a contact. Raises ValueError for half-spaces, which have no
    profile.
    """
    rail = contact.surfaces()[0].profile
    y = np.unique([*np.linspace(*rail.domain, SAMPLES), *rail.joints, contact.touch.y])
    s = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(y), np.diff(rail.height(y))))])
    return Developed(contact, s - s[np.searchsorted(y, contact.touch.y)], y)


def solve(
    contact: Contact,
    ellipse: Hertz,
    load: float | None,
    cells: int = CELLS,
    known: BoundaryElementSolution | None = None,
    *,
    lines: Lines | None = None,
    start: BoundaryElementSolution | None = None,
) -> BoundaryElementSolution:
    """Boundary-element solution, elastic and frictionless, with all patches of a contact under a
    vertical load (N), or at the ellipse's approach.
    ellipse: exact Hertz for the first contact, of which contact modulus and approach are used.
    load: vertical load, N; None for the approach along the vertical, the ellipse's over the cosine
        of the contact angle.
    cells: number of cells along each axis of a patch.
    known: the same on 64 cells (CELLS), from which finer grids start; None: it is solved first.
    lines: compliance of the lines along x beside that of the half-spaces; None: zero.
    start: a similar solution, in whose windows the patches are searched first; None: around the
        contact points.
    Where the solution leaves a point of the wheel's contact locus inside the rail, a patch was
    missed and is added. Raises ValueError for half-spaces, where there is no closed patch within
    the profiles, and where patches are still missed after five solutions (MAX_SOLUTIONS).
    """
    surface, cosine = develop(contact), math.cos(contact.touch.angle)
    rigid = ellipse.approach / cosine
    x, s, height = surface.locus(2 * FIRST_REACH * rigid)
    if start is None:
        windows = _around(contact, surface, FIRST_REACH * rigid)
        windows += _boxes(contact, x, s, np.maximum(FIRST_REACH * rigid - height, 0))
    else:
        windows = [_window(window.x, window.s) for window in start.windows]
    for _ in range(MAX_SOLUTIONS):
        found = pressure_solver.solve_developed(
            surface.gap,
            ellipse.contact_modulus,
            windows,
            surface.angle,
            cells=cells,
            load=load,
            approach=rigid if load is None else None,
            tolerance=TOLERANCE,
            lines=lines,
            known=known,
        )
        known = None
        missed = _boxes(contact, x, s, _inside(surface, found, x, s, height))
        if not missed:
            return found
        windows = [_window(window.x, window.s) for window in found.windows] + missed
    raise ValueError(
        f"after {MAX_SOLUTIONS} solutions the wheel still lies in the rail beside the patches"
    )


def _inside(
    surface: Developed, found: BoundaryElementSolution, x: Array, s: Array, height: Array
) -> Array:
    """Depth (n,) in mm of the wheel's contact locus in the rail outside of the windows of a
    solution; zero where this is at most 0.1 % (PENETRATION) of the approach.
    x, s, height: of the locus in the developed plane, or on a grid, mm; the depth has their shape.
    """
    beside = height < found.approach
    for window in found.windows:
        reach = [
            abs(axis - cells.mean()) > np.ptp(cells) / 2
            for axis, cells in ((x, window.x), (s, window.s))
        ]
        beside &= reach[0] | reach[1]
    depth = np.zeros_like(x)
    x, s = x[beside], s[beside]
    angle = surface.angle(s)
    closed = found.approach * np.cos(angle) - surface.gap(x, s)
    depth[beside] = closed - found.displacement(x, s, angle)
    return np.where(depth > PENETRATION * found.approach, depth, 0.0)


def _window(x: Array, s: Array) -> Window:
    """Smallest rectangle that holds places x (n,) and s (m,), in mm: centre (x, s) and half sizes
    (x, s).
    """
    (x0, x1), (s0, s1) = ((float(each.min()), float(each.max())) for each in (x, s))
    return ((x0 + x1) / 2, (s0 + s1) / 2), ((x1 - x0) / 2, (s1 - s0) / 2)


def _boxes(contact: Contact, x: Array, s: Array, depth: Array) -> list[Window]:
    """Rectangles around the runs of the contact locus x, s (n,) in mm that lie by depth (n,) mm in
    the rail: centre (x, s) and half sizes (x, s). On a grid (n, m) they are its connected parts.
    """
    found: list[Window] = []
    if depth.ndim == 2:
        steps = [np.abs(np.diff(each, axis=k)).max() for k, each in enumerate((x, s))]
        for part in find_objects(label(depth > 0, np.ones((3, 3)))[0]):
            centre, (a, b) = _window(x[part], s[part])
            found.append((centre, (a + float(steps[0]), b + float(steps[1]))))
        return found
    curvature = max(contact.touch.curvature_x, 0.1 / contact.scene.wheel.rolling_radius)
    for (run,) in find_objects(label(depth > 0)[0]):
        half = math.sqrt(2 * depth[run].max() / curvature)
        step = float(np.max(np.abs(np.diff(s[max(run.start - 1, 0) : run.stop + 1]))))
        low, high = s[run].min() - step, s[run].max() + step
        middle, spread = (x[run].min() + x[run].max()) / 2, np.ptp(x[run]) / 2
        found.append(((float(middle), (low + high) / 2), (half + float(spread), (high - low) / 2)))
    return found


def _around(contact: Contact, surface: Developed, rigid: float) -> list[Window]:
    """Rectangles around the contact points at which paraboloids would lie in the rail after a
    closure `rigid` (mm): centre (x, s) and half sizes (x, s), mm.
    """
    found: list[Window] = []
    touches = contact.touches(rigid)
    if contact.shape is not None:  # the smooth bodies touch elsewhere
        x, y = contact.shape.first
        touches = [replace(contact.touch, x=x, y=y)]
    for touch in touches:
        depth = 2 * (rigid - touch.gap) * math.cos(touch.angle)
        least = 0.1 / contact.scene.wheel.rolling_radius
        halves = [math.sqrt(depth / max(c, least)) for c in (touch.curvature_x, touch.curvature_y)]
        s = float(np.interp(touch.y, surface.y, surface.s))
        found.append(((touch.x, s), (halves[0], halves[1])))
    return found
