"""First contact in two dimensions: sections along and across the rail, and meridian sections."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from railhead.contact import solid
from railhead.contact.dimension import Dimension
from railhead.contact.placed_bodies import HEAD_DEPTH, RIM_DEPTH
from railhead.contact.placed_bodies import bodies as solid_bodies
from railhead.contact.solid import Contact
from railhead.geometry import outlines, profiles
from railhead.geometry.placement import ProfilePair, parabolic_contact, upright
from railhead.geometry.profiles import Profile
from railhead.geometry.surfaces import ExactGap, ParabolicGap, RailSurface, StraightTread
from railhead.meshing.bodies import RAIL, WHEEL, Body
from railhead.scene.scene import Scene, SceneError
from railhead.theory.elastic import line
from railhead.theory.elastic.line import Hertz, LineContact

if TYPE_CHECKING:
    from railhead.solver.space.kinematics import Kinematics

ANY_RADIUS = 1e4  # mm: the section across a straight bar does not depend on it
WIDE = 1e4  # mm: what is flat across has no end in a section


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

    @property
    def cross_profiles(self) -> list[tuple[str, Profile, float]]:
        """Empty: the gap in a section along the rail depends on no profile across the track."""
        return []

    def exact_approach(self, hertz: Hertz) -> float | None:
        """Approach along the vertical, mm, as of half-spaces, for a closed form; None in plane
        strain for bodies that end.
        """
        return super().exact_approach(hertz) if self.half_space or self.revolved else None

    def why_asymmetric_in_x(self) -> str | None:
        """None: a cylinder on a flat crown is symmetric about x = 0."""
        return None

    def why_asymmetric_in_y(self) -> str | None:
        """Why y = 0 is no plane of symmetry of the section: the section has no direction y."""
        return "the section runs along the rail"

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

    def line_contact(self, load: float | None) -> LineContact | None:
        """None: the contact of a meridian section is a point, for any load."""
        return None

    def why_asymmetric_in_x(self) -> str | None:
        """Why x = 0 is no plane of symmetry of the section: it is the axis of revolution, which
        bounds the section.
        """
        return "the axis of revolution bounds the section"


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

    def why_asymmetric_in_x(self) -> str | None:
        """Why x = 0 is no plane of symmetry of the section: the section has no direction x."""
        return "the section runs across the rail"

    def gap(self, slave: int) -> ExactGap | ParabolicGap:
        """Exact gap from the slave body (RAIL or WHEEL) to the other one; a parabola between
        half-planes. The wheel is a straight bar.
        """
        if self.pair is None:
            return super().gap(slave)
        rail = RailSurface(self.pair.rail)
        wheel = StraightTread(self.pair.wheel, self.lift, self.scene.wheelset.shift)
        return ExactGap(rail, wheel) if slave == RAIL else ExactGap(wheel, rail)

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
        return sum(line.cylinder_approach(hertz.strip, *body) for body in (below, above))

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
