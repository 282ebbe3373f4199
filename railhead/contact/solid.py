"""From a scene to its bodies: profiles, first contact, sections and exact surfaces."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from railhead.contact import surface_shape
from railhead.contact.surface_shape import SurfaceShape
from railhead.geometry import placement, profiles, wheelset
from railhead.geometry.measured import measured_profile as measured
from railhead.geometry.measured.measured_profile import Measured
from railhead.geometry.measured.orientation import SYMMETRIC, Orientation
from railhead.geometry.placement import (
    ContactPoint,
    PlacementError,
    Pose,
    ProfilePair,
    upright,
)
from railhead.geometry.profiles import Profile
from railhead.geometry.surfaces import ExactGap, ParabolicGap, RailSurface, WheelSurface, between
from railhead.geometry.wheelset import Placed, Track, WheelsetOnTrack
from railhead.meshing.bodies import RAIL
from railhead.postprocess.findings import Frame
from railhead.scene.bodies import is_profile_file
from railhead.scene.scene import Rail, Scene, SceneError, Wheel
from railhead.theory.array_types import Array
from railhead.theory.elastic.line import Hertz, LineContact

if TYPE_CHECKING:
    from railhead.solver.space.kinematics import Kinematics

RAIL_HALF_WIDTH = 35.0  # mm, of a head given by a single radius
TREAD_HALF_WIDTH = 67.5  # mm, of a cylinder, cone or arc
NEAR_GAP = 10.0  # mm from a gap between points of a profile, at which nothing may touch


def rail_profile(scene: Scene, stretch: float = 1.0) -> Profile:
    """Crown z(y) of the rail as it stands, mm, inclination included. Standard rails and arcs are
    turned about the crown centre, files about their origin. Raises SceneError for a file that
    cannot be used.

    stretch: factor on the smoothing wavelengths of a measured profile.
    """
    rail = scene.rail
    if rail.varies:
        key = "sections" if rail.sections else "roller_radius"
        raise SceneError(f"rail.{key}", "is not known here: run, sweep and locate take it")
    if rail.profile in profiles.STANDARD_RAILS:
        return profiles.rail_head(rail.profile, rail.inclination)
    if rail.profile != "arc":
        found = sided(from_file(scene, "rail", stretch))
        if found.oriented.open_by and rail.gauge is None:
            text = f"nothing in {found.path.name} says that its origin is the crown centre, whose "
            text += f"top is {found.oriented.open_by:.1f} mm beside it; give file if it is, or "
            raise SceneError("rail.profile_origin", text + "rail.profile_shift, or rail.gauge")
        return found.profile
    half_width = rail.width / 2 if rail.width else RAIL_HALF_WIDTH
    crown = profiles.single_radius(float(rail.crown_radius or 0), half_width)
    return profiles.rolled(crown, rail.inclination)


def wheel_profile(scene: Scene, stretch: float = 1.0) -> Profile:
    """Tread profile z(y), mm, outwards from the nominal rolling radius, y = 0 at the tape circle.
    Raises SceneError for a file that cannot be used.

    stretch: factor on the smoothing wavelengths of a measured profile.
    """
    wheel = scene.wheel
    if wheel.profile in profiles.CONES:
        return profiles.cone(profiles.CONES[wheel.profile], TREAD_HALF_WIDTH, wheel.profile)
    if wheel.profile == "arc":
        return profiles.single_radius(float(wheel.transverse_radius or 0), TREAD_HALF_WIDTH)
    if wheel.profile == "S1002":
        return profiles.s1002()
    return sided(from_file(scene, "wheel", stretch)).profile


def sided(found: Measured) -> Measured:
    """The measured profile itself. Raises SceneError where nothing tells its field side and both
    sides differ by more than 0.05 mm (SYMMETRIC).
    """
    if found.oriented.unlike > SYMMETRIC:
        key = f"{found.body}.profile_mirror"
        text = f"nothing in {found.path.name} tells its field side, and its sides differ by "
        text += f"{found.oriented.unlike:.2g} mm; give off if larger y is the field side, else on"
        raise SceneError(key, text)
    return found


def asked(scene: Scene, body: str) -> list[str]:
    """What a run asks, as "key: text", where its rail or wheel, `body`, has the profile from a file
    of this scene. Raises SceneError where the file cannot be used.
    """
    found, profile = list[str](), from_file(scene, body).profile
    try:
        rail_profile(scene) if body == "rail" else wheel_profile(scene)
    except SceneError as error:
        found.append(str(error))
    try:
        if body == "rail":
            wheelset.gauge_face(profile, scene.rail.gauge_height)
    except wheelset.GaugeError as error:
        found.append(f"rail.gauge_height, beside rail.gauge: {error}")
    return found


def tape_circle(scene: Scene) -> float:
    """Distance in mm from the flange back to the tape circle of a scene's wheel: of its file, else
    given, else 70 mm.
    """
    wheel = scene.wheel
    if is_profile_file(wheel.profile):
        return from_file(scene, "wheel").oriented.tape_circle
    given = None if wheel.profile == "S1002" else wheel.tape_circle  # of the other wheel
    return given or placement.TAPE_CIRCLE


def measured_bodies(scene: Scene) -> tuple[str, ...]:
    """The names 'rail' and 'wheel' of the bodies of a scene whose profiles come from files."""
    return tuple(
        body for body in ("rail", "wheel") if is_profile_file(getattr(scene, body).profile)
    )


def from_file(scene: Scene, body: str, stretch: float = 1.0) -> Measured:
    """The measured profile of body, 'rail' or 'wheel', from the scene's file; a rail's is turned by
    its inclination.
    stretch: factor on the smoothing wavelengths.
    Raises SceneError where the file cannot be read or is no profile.
    """
    part: Rail | Wheel = getattr(scene, body)
    given = Orientation(
        unit=part.profile_unit,
        mirror=part.profile_mirror,
        flip=part.profile_flip,
        origin=part.profile_origin,
        tape_circle=scene.wheel.tape_circle if body == "wheel" else None,
        shift=part.profile_shift,
    )
    wavelength = None if part.smoothing == "auto" else part.smoothing
    slope = scene.rail.inclination if body == "rail" else 0.0
    try:
        return measured.read(Path(part.profile), body, given, wavelength, slope, stretch)
    except (ValueError, OSError) as error:
        raise SceneError(f"{body}.profile", str(error)) from None


@dataclass(frozen=True, kw_only=True)
class FreeAxle:
    """How an axle turns on which no torque acts.

    turning: radius R by which it turns, mm: the axle moves by R in one radian.
    torque: moment of the creep forces of both wheels about the axle that is left, over mu N R;
        infinite where no motion was found.
    solves: number of pressures at which the tractions were solved.
    reason: why no motion was found; empty where one was.
    """

    turning: float
    torque: float
    solves: int = 0
    reason: str = ""

    @property
    def why(self) -> str:
        """Words that say what the radius is."""
        if self.reason:
            return f"the mean of both wheels' as none without torque was found: {self.reason}"
        left = f"{self.torque:.1g} mu N R is left of both wheels' moments about it"
        return f"found in {self.solves} pressings; {left}"

    def summary(self) -> dict[str, Any]:
        """Entries of summary.json: torque over mu N R, and number of pressures that were solved."""
        return {"axle_torque": self.torque, "axle_solves": self.solves}


@dataclass(frozen=True, kw_only=True)
class Contact:
    """First contact of the undeformed bodies of a scene, as a solid, and the exact gap around it.

    Axes of space are those of the rail of the wheel that is solved (`wheelset.side`): x along the
    rail, y across to the field side, z up; x = 0 at the first contact, y = z = 0 at the rail's
    crown centre (of half-spaces at the first contact).

    scene: the scene.
    touch: the contact point, in these axes: place, slope, gap and curvatures; of half-spaces and
        sections along the rail only place and relative curvatures are set.
    pair: both profiles; None for half-spaces, which touch at the origin.
    pose: of the wheel in these axes; None for half-spaces.
    placed: the whole wheelset, each side in axes of its own (`Placed.right` and `Placed.left`);
        None for half-spaces and sections.
    axle: how the axle turns without torque; None where that is not asked or not found out yet.
    shape: what is added to the smooth surfaces; None where that is nothing. Place, curvatures and
        sections are those of the smooth bodies, surfaces and gap those of the true ones.

    Class constants, other values in the sections of two dimensions in `plane_section`:
    plane: '' for a solid, 'xz' for a section along the rail, 'yz' for one across it.
    revolved: the section is a meridian.
    slips: directions in which the bodies may slip in the model: 0 along the rail, 1 across it.
    load_power: power of Hertz's half length, and of his stresses, that the load is proportional to:
        3, of a line 2.
    prescribed_length: key in summary.json of the half length that is prescribed, not solved for;
        None where there is none.
    never_symmetric: reasons why x = 0 and y = 0 are no planes of symmetry, whatever the bodies;
        None where it depends on them.
    error_family_shape: shape of the error envelopes, `Plan.setting`, of bodies that end; solid
        half-spaces have one of their own.
    """

    plane: ClassVar[Literal["", "xz", "yz"]] = ""
    revolved: ClassVar[bool] = False
    slips: ClassVar[tuple[int, ...]] = (0, 1)
    load_power: ClassVar[int] = 3
    prescribed_length: ClassVar[str | None] = None
    error_family_shape: ClassVar[str] = "bodies"
    never_symmetric: ClassVar[tuple[str | None, str | None]] = (None, None)

    scene: Scene
    touch: ContactPoint
    pair: ProfilePair | None = None
    pose: Pose | None = None
    placed: Placed | None = None
    axle: FreeAxle | None = None
    shape: SurfaceShape | None = None

    @property
    def smooth(self) -> Contact:
        """The contact of the bodies as they are meshed: nothing is added to their surfaces."""
        return replace(self, scene=self.scene.smooth, shape=None)

    @property
    def profiles(self) -> dict[str, tuple[Profile, float]]:
        """By body ('rail', 'wheel'): its profile, and the shift in mm that is added to the
        profile's own y for y in space. A wheel's shift holds at the first contact. Empty for
        half-spaces.
        """
        if self.pair is None:
            return {}
        shift = self.touch.y - self.touch.wheel_y
        return {"rail": (self.pair.rail, 0.0), "wheel": (self.pair.wheel, shift)}

    @property
    def cross_profiles(self) -> list[tuple[str, Profile, float]]:
        """Body ('rail', then 'wheel'), profile, and shift as in `profiles` (mm), of the profiles
        across the track that the gap depends on; empty for half-spaces and for sections along the
        rail.
        """
        return [(body, *profile) for body, profile in self.profiles.items()]

    @property
    def edges(self) -> list[float]:
        """Places y in space (mm) at which a body ends: the ends of both profiles, and of the
        tread's width around the first contact, at plus and minus infinity where the wheel has no
        width.
        """
        half = (self.scene.wheel.width or math.inf) / 2
        ends = [end + shift for _, each, shift in self.cross_profiles for end in each.domain]
        return [*ends, self.touch.y - half, self.touch.y + half]

    @property
    def kinematics(self) -> Kinematics:
        """How coordinates of the mesh become those of space: for a solid they are the same."""
        from railhead.solver.space.kinematics import SOLID

        return SOLID

    def line_contact(self, load: float | None) -> LineContact | None:
        """Closed form of a line contact under a vertical load (N), or at the approach of the scene
        where load is None; None for a point contact, as of every solid.
        """
        return None

    def exact_approach(self, hertz: Hertz) -> float | None:
        """Approach along the vertical, mm, that belongs to a closed form between half-spaces: of
        distant points, in plane strain of the datum points. None where no formula is known.
        """
        return hertz.approach / self.touch.upright

    def friction_coefficient(self, y: Array) -> Array:
        """Coefficient of friction (n,) on the rail's surface at y (n,), mm, by its angle across the
        track there: beyond the profile that of its end, of a plane the contact angle.
        """
        angle: Array = np.full(np.shape(y), self.touch.angle)
        for _, rail, _ in self.cross_profiles[:1]:
            angle = np.arctan(rail.slope(np.clip(y, *rail.domain)))
        return self.scene.friction.at(angle, self.scene.heat.bulk)

    @property
    def line(self) -> bool:
        """Whether the contact is one along a line."""
        return self.load_power == 2

    @property
    def solid_half_space(self) -> bool:
        """Whether both bodies are half-spaces in three dimensions."""
        return self.half_space and not self.plane

    @property
    def curved_solid(self) -> bool:
        """Whether both bodies are solids with profiles of their own: neither half-spaces nor a
        section.
        """
        return not (self.half_space or self.plane)

    @property
    def half_space(self) -> bool:
        """Whether both bodies are half-spaces under Hertz's parabolic gap: flat blocks where they
        are meshed.
        """
        return self.pair is None

    @property
    def origin(self) -> tuple[float, float, float]:
        """Contact point (x, y, z) in space, mm; x is 0."""
        return 0.0, self.touch.y, self.touch.z

    @property
    def frame(self) -> Frame:
        """Axes of the contact frame, with the contact point as origin: along the rail, along the
        common tangent across it to the field side, and out of the rail.
        """
        return Frame(self.origin, self.touch.angle)

    def why_asymmetric_in_y(self) -> str | None:
        """Reason why y = 0 is not a plane of symmetry of the bodies, as text; None if it is one, as
        of half-spaces. Friction is not looked at.
        """
        scene, (_, of_its_kind) = self.scene, self.never_symmetric
        if self.half_space or of_its_kind:
            return of_its_kind
        given, roll = scene.rail, self.placed.roll if self.placed else 0.0
        known = given.profile in (*profiles.STANDARD_RAILS, "arc")
        known = known and scene.wheel.profile in ("cylinder", "arc")
        named = f"wheel {Path(scene.wheel.profile).stem} on rail {Path(given.profile).stem}"
        reasons = (
            (given.gauge is not None, f"a track of gauge {given.gauge or 0.0:g} mm"),
            (not known, named),
            (given.inclination, f"rail inclined {given.inclination:g}"),
            (scene.wheelset.shift, f"wheel shifted {scene.wheelset.shift:g} mm"),
            (roll, f"axle rolled by {1e3 * roll:g} mrad"),
        )
        found = next((why for odd, why in reasons if odd), None)
        return found or self._yawed or self._uneven(1)

    def why_asymmetric_in_x(self) -> str | None:
        """Reason why x = 0 is not a plane of symmetry of the bodies, as text; None if it is one.
        Friction is not looked at.
        """
        return self.never_symmetric[0] or self._yawed or self._uneven(0)

    def _uneven(self, axis: int) -> str | None:
        """Text that the heights on the surfaces are no mirror images along (0) or across (1)."""
        odd = self.shape is not None and self.shape.odd[axis]
        return f"the surface differs at {'xy'[axis]} and -{'xy'[axis]}" if odd else None

    @property
    def _yawed(self) -> str | None:
        """Text that the axle is turned; None where it stands straight, and for half-spaces."""
        yaw = self.scene.wheelset.yaw
        return f"axle turned by {1e3 * yaw:g} mrad" if yaw and not self.half_space else None

    def touches(self, clearance: float) -> list[ContactPoint]:
        """Contact points whose gap (a height) is at most `clearance` mm above the first one's,
        lowest first; the first contact alone for half-spaces. Raises SceneError for one beside a
        gap between points of a profile.
        """
        if self.pair is None or self.pose is None:
            return [self.touch]
        found = self.pair.touches(self.pose, clearance)
        for touch in found:
            _refuse_gap(self.scene, touch)
        return found

    def half_space_gap(self, x: Array, s: Array) -> Array:
        """Gap (n,) in mm between both surfaces along the normal of the contact point's tangent
        plane, at x (along the rail) and s (across it), both (n,) in mm, from that point; infinite
        where the normal misses the rail or the wheel. Raises ValueError for half-spaces.
        """
        touch, axes = self.touch, self.touch.axes
        points = [touch.x, touch.y, touch.z] + np.column_stack([x, s]) @ axes[:2]
        return between(*self.surfaces, points, np.tile(axes[2], (len(x), 1)))

    @cached_property
    def surfaces(self) -> tuple[RailSurface, WheelSurface]:
        """The exact surfaces of rail and wheel in space. Raises ValueError for half-spaces."""
        if self.pair is None or self.pose is None:
            raise ValueError("half-spaces have no profiles")
        if self.shape is not None:
            return self.shape.surfaces(self.pair)
        wheel = WheelSurface(self.pair.wheel, self.pair.rolling_radius, self.pose)
        return RailSurface(self.pair.rail), wheel

    def gap(self, slave: int) -> ExactGap | ParabolicGap:
        """Exact undeformed gap from the slave body (RAIL or WHEEL) to the other one, of points in
        space; a parabola between half-spaces.
        """
        if self.half_space:
            outward = 1 if slave == RAIL else -1
            return ParabolicGap(self.touch.curvature_x, self.touch.curvature_y, outward)
        rail, wheel = self.surfaces
        return ExactGap(rail, wheel) if slave == RAIL else ExactGap(wheel, rail)


Pairs = tuple[ProfilePair, ProfilePair]
"""Profiles of the side that is solved, and of the other side."""


def pair(scene: Scene, stretch: float = 1.0) -> ProfilePair:
    """Profiles of the rail and the wheel that are solved, and its rolling radius; stretch: factor
    on the smoothing wavelengths of measured profiles. Raises SceneError for a file that cannot be
    used.
    """
    rail, wheel = rail_profile(scene, stretch), wheel_profile(scene, stretch)
    return ProfilePair(rail, wheel, scene.wheel.rolling_radius, tape_circle(scene))


def pairs(scene: Scene, stretch: float = 1.0) -> Pairs:
    """Profiles as of `pair` of both sides of a scene; where they are alike the same object twice.
    Raises SceneError for a file that cannot be used, with the key of its side.
    """
    here, given = pair(scene, stretch), scene.wheelset
    if not given.unlike:
        return here, here
    try:
        return here, pair(scene.opposite, stretch)
    except SceneError as error:
        body, _, key = error.key.partition(".")
        given_file = key == "profile" and getattr(given, f"other_{body}")
        key = f"wheelset.other_{body}" if given_file else error.key
        raise SceneError(key, error.text) from None


def on_track(scene: Scene, both: Pairs | None = None) -> WheelsetOnTrack:
    """The wheelset of a scene over its track; its shift is not in it.
    both: profiles in place of the scene's; None: the scene's own.
    Raises SceneError for a file that cannot be used.
    """
    given, rail = scene.wheelset, scene.rail
    here, there = both or pairs(scene)
    right, left = (here, there) if given.side == "right" else (there, here)
    track = Track(given.back_to_back, rail.gauge, rail.gauge_height)
    return WheelsetOnTrack(right=right, left=left, track=track, yaw=given.yaw, roll=given.roll)


def place(scene: Scene, clearance: float = 0.0, both: Pairs | None = None) -> Placed:
    """Lower the wheelset of a scene onto its track; its sides have axes of their own
    (`wheelset.Side`).
    clearance: height over the rail, mm, beyond that of the lowest contact point of the same side,
        up to which further contact points are kept; it does not lift the wheelset.
    both: profiles in place of the scene's; None: the scene's own.
    Raises SceneError where a wheel misses its rail or would not stay on it, where both cannot
    touch, where a rail ends above the gauge, and for a file that cannot be used.
    """
    shift = scene.wheelset.shift
    try:
        return on_track(scene, both).place(shift, clearance)
    except wheelset.GaugeError as error:
        raise SceneError("rail.gauge_height", str(error)) from None
    except PlacementError as error:
        text = f"{shift:g} mm: {error}; bring both wheels over their rails"
        raise SceneError("wheelset.shift", text) from None


def locate(scene: Scene, both: Pairs | None = None) -> Contact:
    """First contact, on its rail, of the wheel of the wheelset that is solved, with x = 0 there; of
    half-spaces the origin.
    both: profiles in place of the scene's; None: the scene's own.
    Raises SceneError as `place`, and where the pair has no point contact with a common tangent.
    """
    if scene.rail.extent == "half-space":
        return Contact(scene=scene, touch=placement.parabolic_contact(*scene.relative_curvatures()))
    return on_side(scene, place(scene, both=both))


def opposite(contact: Contact) -> Contact:
    """First contact of the other wheel of a contact's wheelset, as of `locate`, in the axes of its
    own side. Raises SceneError where it has no common tangent.
    """
    assert contact.placed is not None
    return on_side(contact.scene.opposite, contact.placed)


def on_side(scene: Scene, placed: Placed, *, line: bool = False) -> Contact:
    """First contact of the wheel of a placed wheelset that a scene solves, with x = 0 there. line:
    whether it may be a line contact, or conform. Raises SceneError where it is one and may not, and
    at the edge of a profile.
    """
    side = placed.right if scene.wheelset.side == "right" else placed.left
    touch = _tangent(scene, side.touches[0], line=line)
    centred, touch = side.pose.moved(x=-touch.x), replace(touch, x=0.0)
    added = surface_shape.shape(scene, side.pair, centred, touch)
    return Contact(
        scene=scene, touch=touch, pair=side.pair, pose=centred, placed=placed, shape=added
    )


def lower(scene: Scene) -> Contact:
    """First contact of a single wheel without roll and yaw, lowered onto its rail; x = 0 there.
    `placed` is None.
    Raises SceneError where the wheel misses the rail, or the pair has no point contact with a
    common tangent.
    """
    if scene.rail.extent == "half-space":
        return locate(scene)
    both, shift = pair(scene), scene.wheelset.shift
    try:
        pose = upright(-both.touches(upright(0.0, shift))[0].gap, shift)
    except PlacementError as error:
        text = f"{shift:g} mm: {error}; bring the wheel over the rail"
        raise SceneError("wheelset.shift", text) from None
    return Contact(scene=scene, touch=_tangent(scene, both.touches(pose)[0]), pair=both, pose=pose)


def _tangent(scene: Scene, touch: ContactPoint, *, line: bool = False) -> ContactPoint:
    """The contact point as it is. Raises SceneError where the contact point is at the edge of a
    profile, within 10 mm (NEAR_GAP) of a gap or groove, or its relative curvature across the rail
    is not positive, as in a line contact, which is let pass with `line`.
    """
    if touch.at_edge:
        raise SceneError(
            "wheelset.shift",
            f"{scene.wheelset.shift:g} lets the wheel touch at an edge of a profile (y = "
            f"{touch.y:.2f} mm); move the wheel so that both surfaces share a tangent",
        )
    _refuse_gap(scene, touch)
    if not (line or touch.curvature_y > 0):
        raise SceneError(
            "rail.crown_radius, wheel.transverse_radius",
            f"relative curvature {touch.curvature_y:.3g} 1/mm across the rail is a line contact "
            "or a fully conformal pair; it must be positive",
        )
    return touch


def _refuse_gap(scene: Scene, touch: ContactPoint) -> None:
    """Raise SceneError for a contact point within 10 mm (NEAR_GAP) of a gap or groove."""
    for body, y in (("rail", touch.y), ("wheel", touch.wheel_y)):
        gaps = from_file(scene, body).gaps if body in measured_bodies(scene) else ()
        for start, end in gaps:
            if start - NEAR_GAP < y < end + NEAR_GAP:
                text = f"has a gap or groove from y = {start:.4g} to {end:.4g} mm, and the wheel "
                text += f"touches at {y:.2f} mm; give points there, or keep {NEAR_GAP:g} mm away"
                raise SceneError(
                    f"{body}.profile", f"{Path(getattr(scene, body).profile).name} {text}"
                )
