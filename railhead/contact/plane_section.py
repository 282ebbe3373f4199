"""A scene as a section: what `geometry` is for solids."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from railhead.contact import solid as geometry
from railhead.contact.bodies import HEAD_DEPTH, RIM_DEPTH
from railhead.contact.bodies import bodies as solid_bodies
from railhead.contact.dimension import Dimension
from railhead.contact.solid import Contact
from railhead.geometry import outlines, profiles
from railhead.geometry.placement import Pair, parabolic_contact
from railhead.geometry.pose import upright
from railhead.geometry.profiles import Profile
from railhead.geometry.surfaces import ExactGap, ParabolicGap, RailSurface
from railhead.meshing import plane
from railhead.meshing.bodies import Body
from railhead.meshing.tags import RAIL, WHEEL
from railhead.scene.scene import Scene, SceneError
from railhead.theory.elastic import line
from railhead.theory.elastic.line import LineContact

if TYPE_CHECKING:
    from railhead.solver.space.kinematics import Kinematics

ANY_RADIUS = 1e4  # mm: the section across a straight bar does not depend on it
WIDE = 1e4  # mm: what is flat across has no end in a section


@dataclass(frozen=True, kw_only=True)
class FlatContact(Contact):
    """First contact in a section; see `Contact` and `Dimension`."""

    dimension: Dimension

    @property
    def plane(self) -> str:
        """Of the section: 'xz' or 'yz'."""
        return "yz" if self.dimension.kind == "plane_across" else "xz"

    @property
    def lengthwise(self) -> bool:
        """Whether the section runs along the rail."""
        return self.plane == "xz"

    @property
    def revolved(self) -> bool:
        """Whether the section is a meridian."""
        return self.dimension.kind == "axisymmetric"

    @property
    def line(self) -> bool:
        """Whether the contact is one along a line."""
        return self.dimension.line

    @property
    def kinematics(self) -> Kinematics:
        """What the section's coordinates stand for."""
        from railhead.solver.space.kinematics import Kinematics

        first = [0.0, 1.0, 0.0] if self.plane == "yz" else [1.0, 0.0, 0.0]
        return Kinematics(
            np.array([first, [0.0, 0.0, 1.0]]),
            (0.0, self.dimension.centre, 0.0),
            self.dimension.length or 1.0,
            self.revolved,
        )

    @property
    def mirror_along(self) -> str | None:
        """Why x = 0 is not a plane of symmetry of the section."""
        if self.plane == "yz":
            return "the section runs across the rail"
        return "the axis of revolution bounds the section" if self.revolved else None

    @property
    def mirror_across(self) -> str | None:
        """Why y = 0 is not a plane of symmetry of the section across the rail."""
        return super().mirror_across if self.plane == "yz" else "the section runs along the rail"

    def gap(self, slave: int) -> ExactGap | ParabolicGap:
        """Exact gap from the slave body (RAIL or WHEEL) to the other one."""
        if self.pair is None or self.lengthwise:
            return super().gap(slave)
        rail = RailSurface(self.pair.rail)
        wheel = plane.StraightTread(self.pair.wheel, self.lift, self.scene.wheelset.shift)
        return ExactGap(rail, wheel) if slave == RAIL else ExactGap(wheel, rail)

    def estimate(self, load: float | None) -> LineContact:
        """Line contact under the load (N), or the approach of the scene."""
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

    def approach(self, contact: LineContact) -> float | None:
        """Exact approach of the supports, mm, along the load; None where no formula is known.

        Half-planes: of the datum points; half discs: of their axes, the whole discs being loaded
        from both sides.
        """
        if self.half_space:
            return contact.approach / math.cos(self.touch.angle)
        rail, wheel = self.scene.rail, self.scene.wheel
        if self.lengthwise or len(discs := self.discs) < 2:
            return None
        below = discs[RAIL], rail.young_modulus, rail.poisson_ratio
        above = discs[WHEEL], wheel.young_modulus, wheel.poisson_ratio
        return sum(line.cylinder_approach(contact.strip, *body) for body in (below, above))

    @property
    def lift(self) -> float:
        """Height of the wheel's nominal rolling radius in the section across the rail, mm."""
        shift = self.scene.wheelset.shift
        tread = 0.0 if self.pair is None else float(self.pair.wheel.height(self.touch.y - shift))
        return self.touch.z + tread

    @property
    def discs(self) -> dict[int, float]:
        """Radius (mm) of the bodies that are half a disc in the section across the rail."""
        rail, wheel = self.scene.rail, self.scene.wheel
        found = {}
        for tag, radius, depth, width in (
            (RAIL, rail.crown_radius, rail.depth, rail.width),
            (WHEEL, wheel.transverse_radius, wheel.rim_depth, wheel.width),
        ):
            if radius and depth == radius and (width is None or width >= 2 * radius):
                found[tag] = radius
        return found


def locate(scene: Scene, dimension: Dimension) -> FlatContact:
    """First contact in a section. Raises SceneError as `contact.solid.locate`."""
    if dimension.kind == "plane_across":
        solid = geometry.lower(_of_any_radius(scene))
        touch = replace(solid.touch, curvature_x=0.0)
        return FlatContact(scene, touch, solid.pair, solid.pose, dimension=dimension)
    radius, centre = scene.wheel.rolling_radius, dimension.centre
    across = 1 / radius if dimension.kind == "axisymmetric" else 0.0
    touch = replace(parabolic_contact(1 / radius, across), y=centre)
    if scene.rail.extent == "half-space":
        return FlatContact(scene, touch, dimension=dimension)
    if dimension.kind == "axisymmetric":
        pair = geometry.pair(scene)
    else:
        flat = profiles.single_radius(math.inf, WIDE)
        pair = Pair(flat, flat, radius)
    return FlatContact(scene, touch, pair, upright(radius), dimension=dimension)


def _of_any_radius(scene: Scene) -> Scene:
    wheel = scene.wheel.model_copy(update={"rolling_radius": ANY_RADIUS})
    return scene.model_copy(update={"wheel": wheel})


def _half_disc(contact: FlatContact, tag: int, *, half: bool) -> Body:
    radius = contact.discs[tag]
    section = plane.disc(radius, radius, 0.0, 0.0, half=half)
    if tag == RAIL:
        return Body(tag, plane.flipped(section), 0.0)
    place = np.array([contact.scene.wheelset.shift, contact.lift])
    return Body(tag, [curve.moved(np.eye(2), place) for curve in section], 0.0)


def bodies(
    contact: Contact, reach: float, deformable: Sequence[int], *, whole_section: bool, half: bool
) -> list[Body]:
    """Sections of the deformable bodies; reach: half length of what has no end of its own, mm."""
    assert isinstance(contact, FlatContact)
    if contact.half_space:
        return solid_bodies(contact, reach, deformable, whole_section=False, half=half)
    if contact.plane == "yz":
        scene = _of_any_radius(contact.scene)
        solid = Contact(scene, contact.touch, contact.pair, contact.pose)
        return [
            _half_disc(contact, body.tag, half=half) if body.tag in contact.discs else body
            for body in solid_bodies(
                solid, reach, deformable, whole_section=whole_section, half=half
            )
        ]
    rail, wheel = contact.scene.rail, contact.scene.wheel
    made = []
    if RAIL in deformable:
        end = (rail.width if contact.revolved else rail.length) or 2 * reach
        flat: Profile = profiles.single_radius(math.inf, end / 2)
        section = outlines.block_section(
            flat, 0.0 if half else -end / 2, end / 2, -(rail.depth or HEAD_DEPTH),
            outwards=1, half=half,
        )  # fmt: skip
        made.append(Body(RAIL, section, 0.0))
    if WHEEL in deformable:
        radius = wheel.rolling_radius
        depth = wheel.rim_depth or (radius if contact.revolved else min(RIM_DEPTH, 0.5 * radius))
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
        made.append(Body(WHEEL, plane.disc(radius, depth, arc, 0.0, half=half), 0.0))
    return made
