"""A wheel on a rail that is given by sections: its heads, and its contacts with them.

The wheel stands at `rail.position`. It touches each head at a place of its own (`lowest_places`).
Axes: x along the rail from the axle, y of the sections, z up.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cache, cached_property
from itertools import permutations
from pathlib import Path
from typing import ClassVar

import numpy as np
from scipy.interpolate import CubicSpline

from railhead.contact import lowest_places, solid
from railhead.contact.solid import Contact
from railhead.contact.surface_shape import SurfaceShape
from railhead.geometry import sections
from railhead.geometry.lofting import FACE, Lofted, loft
from railhead.geometry.measured.orientation import Orientation
from railhead.geometry.placement import ContactPoint, Pose, ProfilePair, turned
from railhead.geometry.profiles import Polynomial, Profile, Spline
from railhead.geometry.sections import Head, Section
from railhead.geometry.surfaces import Height, RailSurface, Values, WheelSurface
from railhead.postprocess.findings import Frame
from railhead.scene.scene import Rail, Scene, SceneError
from railhead.scene.sections import refuse_first
from railhead.theory.array_types import Array

NAMES = ("rail", "wing")
REACH = 0.25  # of the rolling radius, ahead and behind, in which the wheel is over the rail
STRETCH = 18.0  # mm of the surface on either side of the contacts
NEAR = 0.3  # mm of height in which further contact points of a head are kept
SAMPLES = 401  # points of a section at a contact, and of a roller's ...
TOP, PLACES = 0.4, 101  # ... up to this part of its radius beside its top
ELASTIC = {"young_modulus", "poisson_ratio"}
PLACED = {
    "sections",
    "position",
    *(f"profile_{key}" for key in ("unit", "mirror", "flip", "shift")),
}
"""Keys of [rail] and [wing] that say where a head is; all others say what it is made of."""
SECTIONS = "a rail of sections"


@dataclass(frozen=True, kw_only=True, eq=False)
class TouchedHead:
    """A head under the wheel.

    name: "rail" or "wing".
    surface: of the head near the contacts.
    touches: where the wheel is lowest over it, lowest first; gaps are those of a wheel whose origin
        is a rolling radius above z = 0.
    """

    name: str
    surface: Lofted
    touches: list[ContactPoint]


@dataclass(frozen=True, kw_only=True, eq=False)
class Crossing:
    """A wheel that touches a rail of sections, without load.

    scene: the scene.
    heads: those under the wheel, by name.
    wheel: profile of the wheel.
    """

    scene: Scene
    heads: dict[str, TouchedHead]
    wheel: Profile

    @property
    def lowest(self) -> str:
        """Name of the head that the wheel touches first."""
        return min(self.heads, key=lambda name: self.heads[name].touches[0].gap)

    @cached_property
    def lift(self) -> float:
        """How far the wheel's origin is higher than a rolling radius where it touches first, mm."""
        return max(-head.touches[0].gap for head in self.heads.values())

    @cached_property
    def pose(self) -> Pose:
        """Pose of the wheel that touches."""
        return _hanging(self.scene).moved(z=self.lift)

    def height(self, lift: float) -> float:
        """Height of the tape circle's lowest point over z = 0 of the sections, mm, at a lift as of
        `lift`, mm.
        """
        _, _, (ahead, _, up) = self.pose.rotation
        return lift + self.scene.wheel.rolling_radius * (1 - math.hypot(ahead, up))

    def placed(self, name: str) -> list[ContactPoint]:
        """Where the wheel that touches is lowest over the head of this name, lowest first."""
        lift = self.lift
        return [
            replace(each, z=each.z + lift, gap=each.gap + lift) for each in self.heads[name].touches
        ]

    def nearest(self, place: Sequence[float]) -> str:
        """Name of the head that a place (x, y, z), mm, lies on."""
        return min(self.heads, key=lambda name: abs(self.heads[name].touches[0].y - place[1]))

    def alone(self, name: str) -> float:
        """`height` of a wheel that touches nothing but the head of this name, mm."""
        return self.height(-self.heads[name].touches[0].gap)

    def touching(self, clearance: float) -> list[str]:
        """Names of the heads over which the wheel is at most `clearance` mm high."""
        heads = self.heads.values()
        return [each.name for each in heads if self.lift + each.touches[0].gap <= clearance]


@dataclass(frozen=True, kw_only=True, eq=False)
class OverSection(Height):
    """Height of a head over its section at a contact, swept straight along the rail, mm.

    surface: of the head.
    section: of it at the contact; the contact's x, mm, is `position`.
    """

    surface: Lofted
    section: Profile

    def __call__(self, x: Array, y: Array) -> Values:
        """Height and slopes at places x from the contact and y (n,), mm; beyond what is lofted
        those at its end, and zero beside it.
        """
        at = np.clip(x + self.position, *self.surface.stretch)
        z, ahead, aside = self.surface(at, y)
        inside = at == x + self.position
        found = z - self.section.height(y), inside * ahead, aside - self.section.slope(y)
        first, second, third = (np.nan_to_num(each) for each in found)
        return first, second, third

    @property
    def range(self) -> float:
        """Largest less smallest height on a line along the rail, as long as is lofted, mm."""
        x = np.linspace(-self.length, self.length, SAMPLES)
        return float(np.ptp(self(x, np.full_like(x, sum(self.section.domain) / 2))[0]))


@dataclass(frozen=True, kw_only=True)
class HeadContact(Contact):
    """First contact of a wheel on one head of a rail of sections, with x = 0 there: the head is its
    section there swept straight along, and what the true head has over it is in the gap.

    crossing: wheel and heads without load.
    """

    never_symmetric: ClassVar[tuple[str | None, str | None]] = None, SECTIONS

    crossing: Crossing

    @property
    def ahead(self) -> float:
        """Distance of x = 0 from the axle, mm."""
        return self.crossing.heads[self.crossing.lowest].touches[0].x


@dataclass(frozen=True, kw_only=True)
class CrossingContact(HeadContact):
    """First contact of a wheel on all heads of a rail of sections; x = 0 below its axle.
    The profile of the rail in `pair` is its section at the first contact; where two heads are
    meshed both sections at their contacts, on one foot. It is swept straight along, and the gap is
    that of the true heads.
    """

    never_symmetric = SECTIONS, SECTIONS

    @property
    def ahead(self) -> float:
        """Distance of x = 0 from the axle, mm."""
        return 0.0

    @property
    def smooth(self) -> HeadContact:
        """The contact of the section that is swept straight along."""
        given = {each.name: getattr(self, each.name) for each in fields(self)}
        return HeadContact(**given)

    @property
    def origin(self) -> tuple[float, float, float]:
        """Contact point (x, y, z) in space, mm."""
        return self.touch.x, self.touch.y, self.touch.z

    @property
    def frame(self) -> Frame:
        """Axes of the first contact, as of `Contact`, of which the first rises as the rail does."""
        return replace(super().frame, lean=self.touch.lean)

    @cached_property
    def cross_profiles(self) -> list[tuple[str, Profile, float]]:
        """As of `Contact`, with the sections of all heads at their contacts."""
        heads = self.crossing.heads.values()
        rails = [("rail", _section(head.surface, head.touches[0]), 0.0) for head in heads]
        return [*rails, ("wheel", *self.profiles["wheel"])]

    def touches(self, clearance: float) -> list[ContactPoint]:
        """Contact points on all heads as of `Contact`."""
        heads = self.crossing.heads
        found = [each for name in heads for each in self.crossing.placed(name)]
        return sorted((each for each in found if each.gap <= clearance), key=lambda each: each.gap)

    @cached_property
    def surfaces(self) -> tuple[RailSurface, WheelSurface]:
        """The exact surfaces of the heads and of the wheel in space."""
        crossing, radius = self.crossing, self.scene.wheel.rolling_radius
        strips = [strip for head in crossing.heads.values() for strip in head.surface.strips]
        heads = Lofted((*strips,), self.scene.rail.position)
        return RailSurface(heads), WheelSurface(crossing.wheel, radius, crossing.pose)


def contact(scene: Scene) -> HeadContact:
    """First contact of a scene with a rail of sections: with all heads where half-spaces answer,
    or two are near; else with the head that it touches first. Raises SceneError as `touch`, and for
    what is not simulated on such a rail.
    """
    fast = scene.effects.finite_bodies == "off"
    text = "is not simulated yet on a rail of sections; "
    refuse_first(
        (scene.rolling.prescribed and not fast, "rolling", f"{text}leave it out, or --fast"),
        (
            scene.rolling.from_wheelset and scene.rolling.axle != "nominal",
            "rolling.axle",
            f"{scene.rolling.axle} {text}give nominal",
        ),
        (scene.load is None, "approach", f"{text}give a load"),
        _unlike(scene, ELASTIC, f"{text}give that of the rail"),
        *(
            (part.surface, f"{body}.surface", f"{text}leave it out")
            for body, part in scene.bodies.items()
        ),
    )
    found = touch(scene, NEAR)
    near, at = [] if fast else found.touching(NEAR), found.placed(found.lowest)[0]
    surface, several = found.heads[found.lowest].surface, len(near) > 1
    if "wing" in near:
        text = "is not that of the rail, and finite elements know one; give that, or --fast"
        refuse_first(_unlike(scene, {*type(scene.rail).model_fields} - PLACED, text))
    text = "is not simulated on two heads by finite elements; leave it out, or --fast"
    refuse_first((several and scene.rubs, "friction", text))
    for name in near:
        _refuse_end(scene, found.heads[name])
    rail = _one_foot(found) if several else _section(surface, at)
    pair = ProfilePair(rail, found.wheel, scene.wheel.rolling_radius)
    if fast or several:
        return CrossingContact(scene=scene, touch=at, pair=pair, pose=found.pose, crossing=found)
    pose = found.pose.moved(x=-at.x)
    over = OverSection(length=STRETCH, position=at.x, surface=surface, section=pair.rail)
    shape = SurfaceShape(rail=over, wheel=None, pose=pose, first=(0.0, at.y), odd=(True, True))
    at = replace(at, x=0.0)
    return HeadContact(scene=scene, touch=at, pair=pair, pose=pose, crossing=found, shape=shape)


def _refuse_end(scene: Scene, head: TouchedHead) -> None:
    """Raise SceneError where a head ends close to its contact, or has an edge there."""
    at = head.touches[0]
    room = 0.0 if at.at_edge else float(np.abs(np.subtract(head.surface.stretch, at.x)).min())
    text = (
        f"{scene.rail.position:g} is {room:.3g} mm from the end of the head or of the sections, or "
        f"from an edge, at the contact on the {head.name}; finite elements need {STRETCH:g} mm: "
        "give another, or --fast"
    )
    refuse_first((room < STRETCH, "rail.position", text))


def _unlike(scene: Scene, keys: set[str], text: str) -> tuple[str, str, str]:
    """Condition for `refuse_first` with a text: the first of some keys in which [wing], if there is
    one, differs from [rail].
    """
    rail, wing = scene.rail, scene.wing or scene.rail
    unlike = (key for key in sorted(keys) if getattr(wing, key) != getattr(rail, key))
    first = next(unlike, "")
    return first, f"wing.{first}", text


def _section(surface: Lofted, at: ContactPoint) -> Profile:
    """Section of a head at a contact point, up to where it is turned by 60 deg against the
    horizontal and against the contact.
    """
    faces = [surface.face(at.x, at.y, slope) for slope in (0.0, at.slope)]
    y = np.linspace(min(faces)[0], max(each[1] for each in faces), SAMPLES)
    z = surface(np.full_like(y, at.x), y)[0]
    return Profile("sections", (Spline(float(y[0]), float(y[-1]), CubicSpline(y, z)),))


def _one_foot(found: Crossing) -> Profile:
    """Sections of two heads at their contacts as one profile. Between their faces the sides go down
    straight to the ends of the sections, and the foot from one to the other; where sections meet
    before, it is a line between the faces.
    """
    one, other = sorted(
        ((_section(head.surface, head.touches[0]), head) for head in found.heads.values()),
        key=lambda each: each[0].domain,
    )
    (first, left), (second, right) = one, other
    inner = (first, left, 1), (second, right, 0)
    faces = [(end := each.domain[side], float(each.height(end))) for each, _, side in inner]
    feet = [head.surface.ends(head.touches[0].x)[side] for _, head, side in inner]
    places = np.array([faces[0], *feet, faces[1]])
    if not (np.diff(places[:, 0]) > FACE).all():
        places = places[[0, -1]]
    lines = [
        Polynomial(y, end, (z - (slope := (low - z) / (end - y)) * y, slope))
        for (y, z), (end, low) in zip(places, places[1:], strict=False)
    ]
    return Profile("sections", (*first.pieces, *lines, *second.pieces))


def touch(
    scene: Scene, clearance: float = 0.0, *, stretch: float = 1.0, every: int = 1
) -> Crossing:
    """Where the wheel of a scene touches the heads of its rail.
    clearance: height over the lowest place of a head, mm, up to which others are kept.
    stretch: factor on the smoothing wavelengths of a measured wheel.
    every: 2 leaves out every second section.
    Raises SceneError for sections that cannot be read, for a position beyond them, and where the
    wheel touches their ends or misses them.
    """
    wheel, found, ends = solid.wheel_profile(scene, stretch), {}, []
    for name, head in heads(scene).items():
        ends += [head.x[0], head.x[-1]]
        touched = _touched(scene, name, head, wheel, clearance, every)
        if touched:
            found[name] = touched
    at = scene.rail.position
    text = f"{at:g} is beyond the sections; give {min(ends):g} to {max(ends):g} mm"
    refuse_first(
        (not min(ends) <= at <= max(ends), "rail.position", text),
        (not found, "wheelset.shift", f"no part of the wheel is over the rail at {at:g} mm"),
    )
    crossing = Crossing(scene=scene, heads=found, wheel=wheel)
    for name, other in permutations(found, 2):
        low = found[name].touches[0]
        over = found[other].surface(np.array([low.x]), np.array([low.y]))[0][0]
        text = f"lies where the {other} is, at x = {at + low.x:.4g}, y = {low.y:.4g} mm; give heads"
        refuse_first((over > low.z - low.gap - NEAR, f"{name}.sections", f"{text} side by side"))
    first = found[crossing.lowest].touches[0]
    text = (
        f"{at:g} lets the wheel touch at an end of the sections, or an edge of them, at "
        f"x = {at + first.x:.4g}, y = {first.y:.4g} mm; give another, or more sections"
    )
    refuse_first((first.at_edge, "rail.position", text))
    return crossing


def heads(scene: Scene) -> dict[str, Head]:
    """The heads of a scene's rail by name: of both tables, or one or two of that of the rail, the
    one with the smaller y first; or a roller. Raises SceneError for sections that cannot be read.
    """
    if scene.rail.roller_radius:
        return {"rail": _roller(scene, scene.rail.roller_radius)}
    if scene.wing is None:
        found = _read("rail", scene.rail, split=True)
        return dict(zip(NAMES, found, strict=False))
    both = zip(NAMES, (scene.rail, scene.wing), strict=True)
    return {name: _read(name, part, split=False)[0] for name, part in both}


def _roller(scene: Scene, radius: float) -> Head:
    """The top of a roller as a head, by sections of a body of revolution with the rail's profile
    over the radius (mm).
    """
    profile = solid.rail_profile(scene.replace(rail={"roller_radius": None}))
    x = radius * TOP * np.linspace(-1, 1, PLACES)
    y = np.union1d(np.linspace(*profile.domain, SAMPLES), profile.joints)

    def load(index: int) -> Section:
        """The section of an index."""
        height = np.sqrt((radius + profile.height(y)) ** 2 - x[index] ** 2) - radius
        return Section(points=np.column_stack([y, height]), resolution=0.0)

    return Head(x=x, ends=frozenset(), load=cache(load))


def _read(name: str, part: Rail, *, split: bool) -> tuple[Head, ...]:
    """Heads of a table of sections. Raises SceneError where it cannot be read."""
    given = Orientation(
        unit=part.profile_unit,
        mirror=part.profile_mirror,
        flip=part.profile_flip,
        shift=part.profile_shift,
    )
    try:
        return sections.heads(Path(str(part.sections)), given, split=split)
    except (ValueError, OSError) as error:
        raise SceneError(f"{name}.sections", str(error)) from None


def _hanging(scene: Scene) -> Pose:
    """Pose of the wheel of a scene with its origin a rolling radius above z = 0, mm."""
    given = scene.wheelset
    sign = 1 if given.side == "right" else -1
    rotation = turned(sign * given.yaw, sign * (given.roll or 0.0))
    return Pose(rotation, np.array([0.0, sign * given.shift, scene.wheel.rolling_radius]))


def _touched(
    scene: Scene, name: str, head: Head, wheel: Profile, clearance: float, every: int
) -> TouchedHead | None:
    """A head with the lowest places of the wheel over it; None where there is none. Raises
    SceneError for sections that cannot be read.
    """
    at, reach = scene.rail.position, REACH * scene.wheel.rolling_radius
    body = WheelSurface(wheel, scene.wheel.rolling_radius, _hanging(scene))
    try:
        rough = loft(head, at - reach, at + reach, smooth=False, every=every)
        places = lowest_places.grid(replace(rough, origin=at), body, reach, clearance)
        if not len(places):
            return None
        low, high = at + places[:, 0].min() - STRETCH, at + places[:, 0].max() + STRETCH
        surface = replace(loft(head, low, high, every=every), origin=at)
    except (ValueError, OSError) as error:
        raise SceneError(f"{name}.sections", str(error)) from None
    touches = lowest_places.refined(surface, body, places, clearance)
    return TouchedHead(name=name, surface=surface, touches=touches)
