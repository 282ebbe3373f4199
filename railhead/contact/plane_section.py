"""Two dimensions: whether a scene needs a third one, and first contact in its section.

A line contact is solved in a plane section along or across the rail, a contact of two bodies of
revolution about the same axis in a meridian section.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from railhead.contact import closed_forms, crossing, solid
from railhead.contact.placed_bodies import HEAD_DEPTH, RIM_DEPTH
from railhead.contact.placed_bodies import bodies as solid_bodies
from railhead.contact.solid import RAIL_HALF_WIDTH, TREAD_HALF_WIDTH, Contact
from railhead.geometry import outlines, profiles
from railhead.geometry.placement import ProfilePair, parabolic_contact, upright
from railhead.geometry.profiles import Profile
from railhead.meshing.bodies import RAIL, WHEEL, Body
from railhead.scene.keys import refuse_unused, set_but_unused
from railhead.scene.scene import NOMINAL_RADIUS, Scene, SceneError
from railhead.theory.elastic import line
from railhead.theory.elastic.line import Hertz, LineContact

if TYPE_CHECKING:
    from railhead.solver.space.kinematics import Kinematics

SLENDER = 5.0  # predicted semi-axis across over half the contact length that makes a line contact:
# the pressure at both ends is then within 2 % of that in the middle, sqrt(1 - 1/25)
LEVEL = 0.1  # largest slope of either surface within the contact length of a line contact
EQUAL = 1e-9  # relative difference of the curvatures of a circular contact
ANY_RADIUS = 1e4  # mm: the section across a straight bar does not depend on it
ALONG = "the section runs along the rail"
WIDE = 1e4  # mm: what is flat across has no end in a section


@dataclass(frozen=True)
class Dimension:
    """How many dimensions the model of a scene needs, and why.
    kind: 'solid', 'plane_along' (section x, z), 'plane_across' (section y, z) or 'axisymmetric'.
    plane_strain: text that says why plane strain is on or off.
    length: length of the contact line, mm; 0 where the contact is no line.
    centre: y in space of the middle of the contact line of a section along the rail, mm; else 0.
    """

    kind: str
    plane_strain: str
    length: float = 0.0
    centre: float = 0.0

    @property
    def line(self) -> bool:
        """Whether the contact is a line, solved in plane strain; False for a meridian section."""
        return self.kind.startswith("plane")


def choose(scene: Scene) -> Dimension:
    """Choose solid, plane or meridian section for a scene, from its curvatures, its widths and the
    effects that the scene forces.
    Raises SceneError where effects.plane_strain or effects.axisymmetry cannot be as given, a line
    contact has no length or is not level, or its section cannot use a given key.
    """
    if scene.rail.varies:
        return Dimension("solid", "the section of the rail changes along it")
    ring = circular(scene)
    forced = scene.effects.axisymmetry
    if forced == "on" and not ring[0]:
        raise SceneError("effects.axisymmetry", f"'on' is not allowed: {ring[1]}; give auto or off")
    if ring[0] and forced != "off":
        return Dimension("axisymmetric", "the contact is a circle, not a line")
    if math.isinf(scene.wheel.rolling_radius):
        return _across(scene)
    return _along(scene)


def _curvatures(scene: Scene) -> tuple[float, float] | None:
    """Relative curvatures of a scene, along and across the rail, 1/mm; None for a profile without a
    single radius. Standard profiles have their nominal one.
    """
    try:
        return scene.relative_curvatures()
    except SceneError:
        return None


def circular(scene: Scene) -> tuple[bool, str]:
    """Whether both bodies, and their loads, are symmetric about the normal of the contact, with a
    text that says why or why not. Of the keys of effects only `friction` is looked at.
    """
    curvatures = _curvatures(scene)
    if curvatures is None:
        return False, "a profile without a single radius is no body of revolution"
    along, across = curvatures
    if not math.isclose(along, across, rel_tol=EQUAL):
        return False, f"relative curvatures {along:.4g} along and {across:.4g} 1/mm across differ"
    if any(scene.asymmetric_friction):
        return False, "a tangential force or creepage turns with no axis"
    text = f"relative curvature {along:.4g} 1/mm along and across"
    if scene.rail.extent == "half-space":
        return True, f"{text}: a circle between half-spaces"
    if scene.friction.uneven:
        return False, "friction differs with the angle of the surface across the rail"
    rail, wheel = scene.rail, scene.wheel
    sphere = wheel.profile == "arc" and wheel.transverse_radius == wheel.rolling_radius
    plane = rail.profile == "arc" and math.isinf(rail.crown_radius or 0)
    if not (sphere and plane):
        return False, "the bodies are not a sphere over the middle of a level plane"
    for key, value in set_but_unused(scene, "axisymmetric"):
        return False, f"{key} = {value}: no body of revolution about the contact's normal"
    return True, f"{text}: a sphere on the middle of a plane"


def _across(scene: Scene) -> Dimension:
    """Plane section across the rail, for a wheel that is a straight bar (rolling radius inf).
    Raises SceneError where plane strain is off, the length is missing, or the section cannot use a
    given key.
    """
    if scene.effects.plane_strain == "off":
        raise SceneError(
            "effects.plane_strain",
            "'off' is not allowed: wheel.rolling_radius is inf, the contact a line along the rail; "
            "give auto or on",
        )
    if scene.rail.length is None:
        raise SceneError(
            "rail.length", "not given; wheel.rolling_radius inf is a line contact of that length"
        )
    if scene.rail.extent != "half-space":
        refuse_unused(scene, "plane_across")
    why = f"no curvature along the rail: a line contact {scene.rail.length:g} mm long"
    return Dimension("plane_across", why, scene.rail.length)


def _along(scene: Scene) -> Dimension:
    """Plane section along the rail for a cylinder on a flat crown or one nearly so, else a solid.
    Curved across, it needs a predicted semi-axis across of at least 5 times (SLENDER) half the
    common width, and a strip that is not wider than long. Where plane strain is forced, half the
    common width is enough, and the strip may be wider.
    Raises SceneError where the forced plane strain or the geometry does not allow the choice.
    """
    forced = scene.effects.plane_strain
    curvatures = _curvatures(scene)
    if curvatures is None or curvatures[1] < 0:
        return _solid(forced, "curved across the rail")
    along, across = curvatures
    length, centre = _common_width(scene)
    slope = max(abs(1 / radius) for radius in _radii(scene)) * length / 2
    straight = scene.rail.inclination == 0 and scene.wheel.profile in ("cylinder", "arc")
    level = scene.rail.extent == "half-space" or (straight and slope < LEVEL)
    if across == 0:
        if scene.rail.extent != "half-space":
            refuse_unused(scene, "plane_along")
        if not level or length <= 0:
            raise SceneError(
                "rail.crown_radius, wheel.transverse_radius",
                "relative curvature 0 across the rail is a line contact or a fully conformal pair; "
                "a line contact needs a level flat crown under a cylinder",
            )
        if forced == "off":
            raise SceneError(
                "effects.plane_strain",
                "'off' is not allowed: without curvature across the rail the contact is a line; "
                "give auto or on",
            )
        why = f"no curvature across the rail: a line contact {length:.4g} mm long"
        return Dimension("plane_along", why, length, centre)
    if scene.rail.extent == "half-space":
        return _solid(forced, "half-spaces with an elliptic patch")
    share = _semi_axis_across(scene, along, across) / (length / 2) if length > 0 else 0.0
    text = f"predicted semi-axis across is {share:.3g} of half the common width {length:.4g} mm"
    for key, value in set_but_unused(scene, "plane_along"):
        return _solid(forced, f"{key} = {value}: no section along the rail")
    if not level or share < (1.0 if forced == "on" else SLENDER) or forced == "off":
        return _solid(forced, f"{text}, a line contact needs {SLENDER:g}")
    found = Dimension("plane_along", text, length, centre)
    width = 2 * _half_width(scene, along, found)
    if width > length and forced != "on":
        return _solid(forced, f"a plate: the strip is {width:.3g} mm wide and {length:.4g} mm long")
    return found


def _solid(forced: str, why: str) -> Dimension:
    """A solid with the text why. Raises SceneError where plane strain is forced 'on'."""
    if forced == "on":
        raise SceneError("effects.plane_strain", f"'on' is not allowed: {why}; give auto or off")
    return Dimension("solid", why)


def _radii(scene: Scene) -> tuple[float, float]:
    """Transverse radii of rail and wheel, mm; nominal ones for standard profiles."""
    rail, wheel = scene.rail, scene.wheel
    return (
        float(rail.crown_radius or NOMINAL_RADIUS[rail.profile]),
        float(wheel.transverse_radius or NOMINAL_RADIUS[wheel.profile]),
    )


def _common_width(scene: Scene) -> tuple[float, float]:
    """Width over which crown and tread face each other, and the y of its middle, mm; the width is
    not positive where they do not. A width that the scene does not give is the usual one of an arc,
    70 mm of the rail and 135 mm of the wheel.
    """
    rail = (scene.rail.width or 2 * RAIL_HALF_WIDTH) / 2
    wheel = (scene.wheel.width or 2 * TREAD_HALF_WIDTH) / 2
    shift = scene.wheelset.shift
    low, high = max(-rail, shift - wheel), min(rail, shift + wheel)
    return high - low, (low + high) / 2


def _half_width(scene: Scene, along: float, dimension: Dimension) -> float:
    """Half width of the strip of a line contact, mm, with the relative curvature `along` the rail
    (1/mm), under the load or approach of the scene.
    """
    touch = parabolic_contact(along, 0.0)
    strip = LongitudinalSection(scene=scene, touch=touch, dimension=dimension)
    return closed_forms.hertz_contact(scene, strip).half_lengths[0]


def _semi_axis_across(scene: Scene, along: float, across: float) -> float:
    """Semi-axis across the rail of Hertz's ellipse, mm, for relative curvatures along and across
    (1/mm) and the load or approach of the scene.
    """
    contact = Contact(scene=scene, touch=parabolic_contact(along, across))
    with np.errstate(all="ignore"):  # absurd loads are refused later, in one line
        return closed_forms.ellipse(scene, contact).b


@dataclass(frozen=True, kw_only=True)
class SectionContact(Contact, ABC):
    """First contact of the bodies in a section of two dimensions.
    dimension: kind of section, the reason for it, and the length of a line contact.

    Points and places are in the axes of space, as of a solid.
    """

    dimension: Dimension

    @property
    def kinematics(self) -> Kinematics:
        """How the two coordinates of the section become those of space: their directions, a point
        of the section, the thickness (mm; 1 where there is no length), and whether it is a
        meridian.
        """
        from railhead.solver.space.kinematics import Kinematics

        first = [0.0, 1.0, 0.0] if self.plane == "yz" else [1.0, 0.0, 0.0]
        return Kinematics(
            np.array([first, [0.0, 0.0, 1.0]]),
            (0.0, self.dimension.centre, 0.0),
            self.dimension.length or 1.0,
            self.revolved,
        )

    def line_contact(self, load: float | None) -> LineContact | None:
        """Closed form of the line contact over the length of the section's contact line, with the
        curvatures at first contact.
        load: vertical load, N; None takes the approach of the scene instead. The normal force is
            load / cos(contact angle), the normal approach is approach * cos.
        None only in a meridian section. Raises ValueError as `line.contact`.
        """
        rail, wheel, touch = self.scene.rail, self.scene.wheel, self.touch
        across, cosine = self.plane == "yz", math.cos(touch.angle)
        approach = None if load is not None else float(self.scene.approach or 0.0) * cosine
        return line.contact(
            touch.curvature_y if across else touch.curvature_x,
            (rail.young_modulus, wheel.young_modulus),
            (rail.poisson_ratio, wheel.poisson_ratio),
            length=self.dimension.length,
            across=across,
            load=None if load is None else load / cosine,
            approach=approach,
        )

    @abstractmethod
    def bodies(
        self, reach: float, deformable: Sequence[int], *, whole_section: bool, half: bool
    ) -> list[Body]:
        """Bodies of the section, each with its closed outline, for the deformable ones (RAIL,
        WHEEL).
        reach: half length of what has no end of its own, mm.
        whole_section: whether a rail has web and foot, else its head alone; only for a standard
            rail.
        half: whether only one side of the middle is outlined.
        Raises SceneError where a depth or a length of the scene does not fit the section.
        """


@dataclass(frozen=True, kw_only=True)
class LongitudinalSection(SectionContact):
    """Plane strain in the plane x, z along the rail: a cylinder on a flat crown, or half-planes."""

    plane = "xz"
    slips: ClassVar[tuple[int, ...]] = (0,)
    load_power = 2
    prescribed_length: ClassVar[str | None] = "b_mm"
    error_family_shape = "plane strain"
    never_symmetric: ClassVar[tuple[str | None, str | None]] = None, ALONG

    @property
    def cross_profiles(self) -> list[tuple[str, Profile, float]]:
        """Empty: the gap in a section along the rail depends on no profile across the track."""
        return []

    def exact_approach(self, hertz: Hertz) -> float | None:
        """Approach along the vertical, mm, as of half-spaces, for a closed form; None in plane
        strain for bodies that end.
        """
        return super().exact_approach(hertz) if self.half_space or self.revolved else None

    def bodies(
        self, reach: float, deformable: Sequence[int], *, whole_section: bool, half: bool
    ) -> list[Body]:
        """Bodies of the section, each with its closed outline, for the deformable ones (RAIL,
        WHEEL).
        reach: half length along x of a rail without `length`, as in a meridian section, mm. Also
            the length of arc to each side of a wheel without `segment_length`; of half-spaces half
            the edge of the blocks.
        whole_section: has no effect here.
        half: whether only x >= 0 is outlined. For a meridian section the caller must pass True
            (`Plan.parts`).
        A wheel ends at 1.2 rolling radii of arc to each side at most.
        Raises SceneError for a `rim_depth` above the rolling radius, and for a `segment_length`
        with a depth equal to the radius, which makes half a disc.
        """
        if self.half_space:
            return solid_bodies(self, reach, deformable, whole_section=False, half=half)
        rail, wheel = self.scene.rail, self.scene.wheel
        made = []
        if RAIL in deformable:
            end = rail.length or 2 * reach
            flat: Profile = profiles.single_radius(math.inf, end / 2)
            section = outlines.block_section(
                flat,
                0.0 if half else -end / 2,
                end / 2,
                -(rail.depth or HEAD_DEPTH),
                outwards=1,
                half=half,
            )
            made.append(Body(RAIL, section, 0.0))
        if WHEEL in deformable:
            radius = wheel.rolling_radius
            usual = radius if self.revolved else min(RIM_DEPTH, 0.5 * radius)  # half a sphere
            depth = wheel.rim_depth or usual
            if depth > radius:
                raise SceneError(
                    "wheel.rim_depth",
                    f"{depth:g} is not allowed; it must not be larger than wheel.rolling_radius "
                    f"({radius:g})",
                )
            if wheel.segment_length and depth == radius:
                raise SceneError(
                    "wheel.segment_length",
                    f"{wheel.segment_length:g} is not allowed; half a disc has no segment; give a "
                    f"wheel.rim_depth below wheel.rolling_radius ({radius:g}), or leave it out",
                )
            arc = min(wheel.segment_length / 2 if wheel.segment_length else reach, 1.2 * radius)
            made.append(Body(WHEEL, outlines.disc(radius, depth, arc, half=half), 0.0))
        return made


@dataclass(frozen=True, kw_only=True)
class MeridianSection(LongitudinalSection):
    """Half a meridian section, x >= 0, z, of two bodies of revolution about the contact normal: a
    sphere on a plane, or half-spaces with a circular patch. x is the radius.
    """

    revolved = True
    slips = ()
    load_power = 3
    prescribed_length = None
    error_family_shape = "meridian"
    never_symmetric = "the axis of revolution bounds the section", ALONG

    def line_contact(self, load: float | None) -> LineContact | None:
        """None: the contact of a meridian section is a point, for any load."""
        return None


@dataclass(frozen=True, kw_only=True)
class TransverseSection(SectionContact):
    """Plane strain in the plane y, z across the rail: a rail, or a half-plane, under a wheel that
    is a straight bar along x.
    """

    plane = "yz"
    slips = (1,)
    load_power = 2
    prescribed_length = "a_mm"
    error_family_shape = "plane strain"
    never_symmetric = "the section runs across the rail", None

    def exact_approach(self, hertz: Hertz) -> float | None:
        """Approach of the supports along the vertical, mm, for a closed form; None unless both
        bodies are half-planes or both are half discs.
        Half-planes: approach of their datum points along the vertical. Half discs: approach of
        their centres, where whole discs are loaded from both sides.
        """
        if self.half_space:
            return super().exact_approach(hertz)
        rail, wheel = self.scene.rail, self.scene.wheel
        if not isinstance(hertz, LineContact) or len(discs := self.discs) < 2:
            return None
        below = discs[RAIL], rail.young_modulus, rail.poisson_ratio
        above = discs[WHEEL], wheel.young_modulus, wheel.poisson_ratio
        return sum(line.cylinder_approach(hertz, *body) for body in (below, above))

    @property
    def lift(self) -> float:
        """z in space of the wheel's nominal rolling radius in the section across the rail, mm."""
        shift = self.scene.wheelset.shift
        tread = 0.0 if self.pair is None else float(self.pair.wheel.height(self.touch.y - shift))
        return self.touch.z + tread

    @property
    def discs(self) -> dict[int, float]:
        """Radius in mm by tag (RAIL, WHEEL) of the bodies that are half a disc: those whose depth
        is their radius and whose width is not given or at least two radii.
        """
        rail, wheel = self.scene.rail, self.scene.wheel
        found = {}
        for tag, radius, depth, width in (
            (RAIL, rail.crown_radius, rail.depth, rail.width),
            (WHEEL, wheel.transverse_radius, wheel.rim_depth, wheel.width),
        ):
            if radius and depth == radius and (width is None or width >= 2 * radius):
                found[tag] = radius
        return found

    def bodies(
        self, reach: float, deformable: Sequence[int], *, whole_section: bool, half: bool
    ) -> list[Body]:
        """Bodies of the section, each with its closed outline, for the deformable ones (RAIL,
        WHEEL).
        reach: half the edge of the blocks of half-planes, mm; no effect on other bodies.
        whole_section: whether a rail has web and foot, else its head alone; only for a standard
            rail.
        half: whether only y >= 0 is outlined.
        Raises SceneError where a depth or a width of the scene does not fit.
        """
        if self.half_space:
            return solid_bodies(self, reach, deformable, whole_section=False, half=half)
        contact = Contact(
            scene=_of_any_radius(self.scene), touch=self.touch, pair=self.pair, pose=self.pose
        )
        made = solid_bodies(contact, 0.0, deformable, whole_section=whole_section, half=half)
        return [
            self._half_disc(body.tag, half=half) if body.tag in self.discs else body
            for body in made
        ]

    def _half_disc(self, tag: int, *, half: bool) -> Body:
        """Body with the outline of a half disc, tagged RAIL (flat side below) or WHEEL (flat side
        above); half: whether only y >= 0 is outlined.
        """
        radius = self.discs[tag]
        upwards, place = np.eye(2), np.array([self.scene.wheelset.shift, self.lift])
        if tag == RAIL:
            upwards, place = np.diag([1.0, -1.0]), np.zeros(2)
        section = outlines.disc(radius, radius, 0.0, half=half)
        return Body(tag, [curve.moved(upwards, place) for curve in section], 0.0)


def locate(scene: Scene, dimension: Dimension) -> Contact:
    """First contact of a scene as a solid or in the section that dimension names.
    Raises SceneError for a profile's file that cannot be used. As a solid with profiles, and in a
    section across the rail, it is also raised where a wheel misses its rail or the pair has no
    contact with a common tangent.
    """
    if scene.rail.varies:
        return crossing.contact(scene)
    if dimension.kind == "solid":
        return solid.locate(scene)
    if dimension.kind == "plane_across":
        contact = solid.lower(_of_any_radius(scene))
        touch = replace(contact.touch, curvature_x=0.0)
        return TransverseSection(
            scene=scene, touch=touch, pair=contact.pair, pose=contact.pose, dimension=dimension
        )
    revolved = dimension.kind == "axisymmetric"
    kind = MeridianSection if revolved else LongitudinalSection
    radius = scene.wheel.rolling_radius
    across = 1 / radius if revolved else 0.0
    touch = replace(parabolic_contact(1 / radius, across), y=dimension.centre)
    if scene.rail.extent == "half-space":
        return kind(scene=scene, touch=touch, dimension=dimension)
    flat = profiles.single_radius(math.inf, WIDE)
    pair = solid.pair(scene) if revolved else ProfilePair(flat, flat, radius)
    return kind(scene=scene, touch=touch, pair=pair, pose=upright(radius), dimension=dimension)


def _of_any_radius(scene: Scene) -> Scene:
    """The scene with a wheel of the rolling radius 10 m (ANY_RADIUS), for a section across the rail
    that does not depend on the radius.
    """
    wheel = scene.wheel.model_copy(update={"rolling_radius": ANY_RADIUS})
    return scene.model_copy(update={"wheel": wheel})
