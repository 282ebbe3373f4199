"""The patch before anything is meshed: what the mesh is refined around and Newton starts from.

Where the gap over Hertz's ellipse is Hertz's parabola and nothing else comes close, the forecast is
that ellipse. Elsewhere boundary elements solve for it on the exact gap, in the tangent plane of the
contact point. Contacts with other tangent planes (tread and flange) share the load as
springs side by side: the rigid approach at which their loads add up to the whole.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from scipy.optimize import brentq
from scipy.spatial import cKDTree

from meshing.placement import Touch
from postprocess.findings import Frame
from railhead.flat import FlatContact
from railhead.geometry import Contact
from theory import boundary_element
from theory.boundary_element import PatchSolution
from theory.hertz import Ellipse
from theory.line import LineContact

Array = NDArray[np.float64]
PARABOLIC = 0.02  # largest deviation from Hertz's gap over his approach
ONE_PLANE = 0.1  # rad between contact angles that share a tangent plane
CELLS = 64
TOLERANCE = 1e-5
MINOR = 0.02  # of the load: smaller patches are not refined for


@dataclass(frozen=True)
class Zone:
    """A patch: centre (3,), half lengths a along the rail and b across it (mm), contact angle."""

    centre: tuple[float, float, float]
    a: float
    b: float
    angle: float


@dataclass(frozen=True)
class Nearest:
    """Whether the nearest of known points (n, 3) touches and lies within reach (mm)."""

    tree: cKDTree
    touches: NDArray[np.bool_]
    reach: float

    def __call__(self, points: Array) -> NDArray[np.bool_]:
        distance, index = self.tree.query(points)
        return np.asarray(self.touches[index] & (distance < self.reach))


@dataclass(frozen=True)
class InEllipse:
    """Whether points lie in Hertz's ellipse, turned by an angle in the tangent plane (rad)."""

    frame: Frame
    a: float
    b: float
    turn: float

    def __call__(self, points: Array) -> NDArray[np.bool_]:
        x, s, height = self.frame.local(points).T
        c, t = math.cos(self.turn), math.sin(self.turn)
        inside = ((c * x + t * s) / self.a) ** 2 + ((c * s - t * x) / self.b) ** 2 < 1.0
        return np.asarray(inside & (np.abs(height) < max(self.a, self.b)))


@dataclass(frozen=True)
class Forecast:
    """zones: patches, most loaded first; moments: centre (x, s) and semi-axes of all of the
    pressure by its moments, in the frame of the first contact, mm; touching: points (n, 3) ->
    (n,) whether they touch; hertzian: whether exact Hertz is the forecast."""

    zones: tuple[Zone, ...]
    moments: tuple[float, float, float, float]
    touching: Callable[[Array], NDArray[np.bool_]]
    hertzian: bool

    @property
    def minor(self) -> float:
        """Smaller half length of the most loaded patch, mm."""
        return min(self.zones[0].a, self.zones[0].b)


def forecast(contact: Contact, ellipse: Ellipse | LineContact, load: float | None) -> Forecast:
    """load: vertical, N; None where ellipse.approach is given."""
    if isinstance(ellipse, LineContact) or isinstance(contact, FlatContact):
        return _hertz(contact, ellipse)
    if contact.half_space or _parabolic(contact, ellipse):
        return _hertz(contact, ellipse)
    try:
        solved = solve(contact, ellipse, load, CELLS)
    except ValueError:  # no closed patch within the profiles: the finite elements will tell
        return _hertz(contact, ellipse)
    points, forces, zones = [], [], []
    for touch, patch in solved:
        frame = Frame((touch.x, touch.y, touch.z), touch.angle)
        x, s = np.meshgrid(patch.x, patch.s, indexing="ij")
        flat = np.column_stack([x.ravel(), s.ravel(), np.zeros(x.size)])
        points.append(np.array(frame.origin) + flat @ frame.axes)
        cell = (patch.x[1] - patch.x[0]) * (patch.s[1] - patch.s[0])
        forces.append(cell * patch.pressure.ravel())
        zones += _zones(patch, frame, cell)
    total = sum(force for force, _ in zones)
    zones.sort(key=lambda each: -each[0])
    kept = tuple(zone for force, zone in zones if force > MINOR * total)
    everything, force = np.concatenate(points), np.concatenate(forces)
    return Forecast(
        kept,
        _moments(Frame(contact.origin, contact.touch.angle).local(everything), force),
        Nearest(cKDTree(everything), force > 0, max(zone.b for zone in kept)),
        False,
    )


def solve(
    contact: Contact, ellipse: Ellipse, load: float | None, cells: int
) -> list[tuple[Touch, PatchSolution]]:
    """Half-space patches, one for each tangent plane in which something touches.

    Raises ValueError where there is no closed patch within the profiles.
    """
    groups = _planes(contact, ellipse)
    first = groups[0]
    cosine = math.cos(first[0].angle)

    def patch(group: list[Touch], **given: float) -> PatchSolution:
        return _patch(contact, ellipse, group, cells, **given)

    if load is not None:
        single = patch(first, load=load / cosine)
        rigid = single.approach / cosine
    else:
        rigid = ellipse.approach / cosine
        single = patch(first, approach=ellipse.approach)
    groups = [group for group in groups if group[0].gap < rigid]
    if len(groups) == 1:
        return [(first[0], single)]

    def all_at(rigid: float) -> list[tuple[Touch, PatchSolution]]:
        down = [(group, rigid * math.cos(group[0].angle)) for group in groups]
        near = [(group, depth) for group, depth in down if rigid > group[0].gap * (1 + 1e-6)]
        return [(group[0], patch(group, approach=depth)) for group, depth in near]

    def excess(rigid: float) -> float:
        vertical = sum(p.load * math.cos(touch.angle) for touch, p in all_at(rigid))
        return vertical / float(load or 1.0) - 1

    return all_at(rigid if load is None else brentq(excess, 0.05 * rigid, rigid, rtol=1e-3))


def alone(contact: Contact, ellipse: Ellipse) -> PatchSolution:
    """The patch in the tangent plane of first contact, as if it carried the ellipse's load.

    Raises ValueError as `solve`.
    """
    return _patch(contact, ellipse, _planes(contact, ellipse)[0], CELLS, load=ellipse.load)


def _patch(
    contact: Contact, ellipse: Ellipse, group: list[Touch], cells: int, **given: float
) -> PatchSolution:
    s = [(touch.y - group[0].y) / math.cos(group[0].angle) for touch in group]
    return boundary_element.solve(
        contact.half_space_gap(group[0]), ellipse.contact_modulus,
        centre=(0.0, (min(s) + max(s)) / 2),
        half_size=(1.5 * ellipse.a, 1.5 * ellipse.b + np.ptp(s) / 2),
        cells=cells, tolerance=TOLERANCE, **given,
    )  # fmt: skip


def _parabolic(contact: Contact, ellipse: Ellipse) -> bool:
    """Whether the exact gap over the ellipse and a little beyond is Hertz's, and nothing else is
    within reach of the approach."""
    touch = contact.touch
    if len(contact.touches(ellipse.approach / math.cos(touch.angle))) > 1:
        return False
    turn, radius = np.meshgrid(np.linspace(0, 2 * np.pi, 25), [0.5, 1.0])
    u, v = (ellipse.a * radius * np.cos(turn)).ravel(), (ellipse.b * radius * np.sin(turn)).ravel()
    c, t = math.cos(touch.orientation), math.sin(touch.orientation)
    gap = contact.half_space_gap(touch)(c * u - t * v, t * u + c * v)
    expected = (ellipse.curvature_x * u**2 + ellipse.curvature_y * v**2) / 2
    return bool(np.abs(gap - expected).max() < PARABOLIC * ellipse.approach)


def _hertz(contact: Contact, ellipse: Ellipse | LineContact) -> Forecast:
    """Of a line contact the zone is as wide as long: its section does not know the length."""
    touch, frame = contact.touch, Frame(contact.origin, contact.touch.angle)
    touching = InEllipse(frame, ellipse.a, ellipse.b, touch.orientation)
    a, b = ellipse.a, ellipse.b
    if isinstance(ellipse, LineContact):
        a = b = ellipse.half_width
    zone = Zone(contact.origin, a, b, touch.angle)
    return Forecast((zone,), (0.0, 0.0, a, b), touching, True)


def _planes(contact: Contact, ellipse: Ellipse) -> list[list[Touch]]:
    """Contact points that the approach can reach, by tangent plane, the first one's first."""
    groups: list[list[Touch]] = []
    for touch in contact.touches(4 * ellipse.approach / math.cos(contact.touch.angle)):
        for group in groups:
            if abs(touch.angle - group[0].angle) < ONE_PLANE:
                group.append(touch)
                break
        else:
            groups.append([touch])
    return groups


def _zones(patch: PatchSolution, frame: Frame, cell: float) -> list[tuple[float, Zone]]:
    """Load (N) and extent of each separate patch in a tangent plane."""
    parts, count = label(patch.pressure > 0, structure=np.ones((3, 3)))
    found = []
    for number in range(1, count + 1):
        i, j = np.nonzero(parts == number)
        force = float(cell * patch.pressure[i, j].sum())
        ends = [(axis[index.min()], axis[index.max()], axis[1] - axis[0])
                for axis, index in ((patch.x, i), (patch.s, j))]  # fmt: skip
        (x, a), (s, b) = (((low + high) / 2, (high - low + step) / 2) for low, high, step in ends)
        middle = np.array(frame.origin) + np.array([x, s, 0.0]) @ frame.axes
        centre = (float(middle[0]), float(middle[1]), float(middle[2]))
        found.append((force, Zone(centre, float(a), float(b), frame.angle)))
    return found


def _moments(local: Array, force: Array) -> tuple[float, float, float, float]:
    x, s = (float(np.average(local[:, axis], weights=force)) for axis in (0, 1))
    a, b = (
        math.sqrt(5 * float(np.average((local[:, axis] - middle) ** 2, weights=force)))
        for axis, middle in ((0, x), (1, s))
    )
    return x, s, a, b
