"""From a scene to its bodies: profiles, first contact, sections and exact surfaces."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshing import outlines, placement, profiles
from meshing.bodies import Body
from meshing.profiles import Profile
from meshing.surfaces import ExactGap, ParabolicGap, RailSurface, WheelSurface
from meshing.tags import RAIL, WHEEL
from railhead.scene import Scene, SceneError

Array = NDArray[np.float64]
RAIL_HALF_WIDTH = 35.0  # mm, of a head given by a single radius
TREAD_HALF_WIDTH = 67.5  # mm, of a cylinder, cone or arc
HEAD_DEPTH = 50.0  # mm, of a block below a single-radius or measured crown
RIM_DEPTH = 60.0  # mm


def rail_profile(scene: Scene) -> Profile:
    """Crown z(y) of the rail as it stands, inclination included."""
    rail = scene.rail
    if rail.profile in ("54E1", "60E1"):
        return profiles.rail_head(rail.profile, rail.inclination)
    if rail.profile == "arc":
        profile = profiles.single_radius(float(rail.crown_radius or 0), RAIL_HALF_WIDTH)
    else:
        profile = _measured("rail.profile", rail.profile)
    return profiles.rolled(profile, rail.inclination)


def wheel_profile(scene: Scene) -> Profile:
    """Tread z(y), outwards from the nominal rolling radius."""
    wheel = scene.wheel
    if wheel.profile in profiles.CONES:
        return profiles.cone(profiles.CONES[wheel.profile], TREAD_HALF_WIDTH, wheel.profile)
    if wheel.profile == "arc":
        return profiles.single_radius(float(wheel.transverse_radius or 0), TREAD_HALF_WIDTH)
    if wheel.profile == "S1002":
        return profiles.s1002()
    return _measured("wheel.profile", wheel.profile)


def _measured(key: str, path: str) -> Profile:
    try:
        return profiles.from_csv(Path(path))
    except (ValueError, OSError) as error:
        raise SceneError(key, f"{error}; give a .csv file of points y, z in mm") from None


@dataclass(frozen=True)
class Contact:
    """First contact of the undeformed bodies and the exact gap around it.

    touch: see `placement.Touch`; half-spaces touch at the origin.
    """

    scene: Scene
    touch: placement.Touch
    rail: Profile | None
    wheel: Profile | None

    @property
    def half_space(self) -> bool:
        """Flat blocks under Hertz's parabolic gap."""
        return self.rail is None

    @property
    def origin(self) -> tuple[float, float, float]:
        """Contact point, mm."""
        return 0.0, self.touch.y, self.touch.z

    @property
    def mirror_across(self) -> str | None:
        """Why y = 0 is not a plane of symmetry; None if it is one."""
        if self.half_space:
            return None
        scene = self.scene
        if scene.rail.profile not in ("54E1", "60E1", "arc") or scene.wheel.profile not in (
            "cylinder",
            "arc",
        ):
            return f"wheel {Path(scene.wheel.profile).stem} on rail {Path(scene.rail.profile).stem}"
        if scene.rail.inclination:
            return f"rail inclined {scene.rail.inclination:g}"
        if scene.wheelset.shift:
            return f"wheel shifted {scene.wheelset.shift:g} mm"
        return None

    def half_space_gap(self, x: Array, s: Array) -> Array:
        """Gap along the rail's normals at tangent-plane coordinates x, s (n,), mm."""
        c, t = math.cos(self.touch.angle), math.sin(self.touch.angle)
        points = np.column_stack([x, self.touch.y + c * s, self.touch.z + t * s])
        return self.gap(RAIL)(points)[0]

    def gap(self, slave: int) -> ExactGap | ParabolicGap:
        """Exact gap from the slave body (RAIL or WHEEL) to the other one."""
        if self.rail is None or self.wheel is None:
            outward = 1 if slave == RAIL else -1
            return ParabolicGap(self.touch.curvature_x, self.touch.curvature_y, outward)
        rail = RailSurface(self.rail)
        wheel = WheelSurface(
            self.wheel,
            self.scene.wheel.rolling_radius,
            self.scene.wheelset.shift,
            self.touch.axle_height,
        )
        return ExactGap(rail, wheel) if slave == RAIL else ExactGap(wheel, rail)


def locate(scene: Scene) -> Contact:
    """Lower the wheel onto the rail.

    Raises SceneError where the pair has no point contact with a common tangent.
    """
    if scene.rail.extent == "half-space":
        along, across = scene.relative_curvatures()
        touch = placement.Touch(0.0, 0.0, 0.0, scene.wheel.rolling_radius, along, across, False)
        return Contact(scene, touch, None, None)
    rail, wheel = rail_profile(scene), wheel_profile(scene)
    try:
        touch = placement.lower(rail, wheel, scene.wheel.rolling_radius, scene.wheelset.shift)
    except placement.PlacementError as error:
        raise SceneError("wheelset.shift", f"{error}; bring the wheel over the rail") from None
    if touch.at_edge:
        raise SceneError(
            "wheelset.shift",
            f"{scene.wheelset.shift:g} lets the wheel touch at an edge of a profile (y = "
            f"{touch.y:.2f} mm); move the wheel so that both surfaces share a tangent",
        )
    if not touch.curvature_y > 0:
        raise SceneError(
            "rail.crown_radius, wheel.transverse_radius",
            f"relative curvature {touch.curvature_y:.3g} 1/mm across the rail is a line contact "
            "or a fully conformal pair; it must be positive",
        )
    return Contact(scene, touch, rail, wheel)


def bodies(contact: Contact, reach: float, *, half: bool) -> list[Body]:
    """Sections and sweeps of the deformable bodies.

    reach: half length along the rail (edge of the cube for half-spaces), mm; half: only y >= 0.
    """
    scene = contact.scene
    made = []
    if not math.isinf(scene.rail.young_modulus):
        made.append(_rail(contact, reach, half=half))
    if not math.isinf(scene.wheel.young_modulus):
        made.append(_wheel(contact, reach, half=half))
    return made


def _rail(contact: Contact, reach: float, *, half: bool) -> Body:
    scene = contact.scene
    if contact.rail is None:
        return _half_space(RAIL, reach, half=half)
    length = scene.rail.length
    if scene.rail.profile in ("54E1", "60E1"):
        section = outlines.rail_section(scene.rail.profile, scene.rail.extent, half=half)
        angle = math.atan(scene.rail.inclination)
        c, s = math.cos(angle), math.sin(angle)
        section = [curve.moved(np.array([[c, -s], [s, c]]), np.zeros(2)) for curve in section]
    else:
        if scene.rail.extent == "section":
            raise SceneError("rail.extent", "section needs rail.profile 54E1 or 60E1; give head")
        start, end = contact.rail.domain
        base = float(np.nanmin(contact.rail.height(np.array([start, end])))) - HEAD_DEPTH
        section = outlines.block_section(
            contact.rail, 0.0 if half else start, end, base, outwards=1, half=half
        )
    return Body(RAIL, section, length / 2 if length else reach)


def _wheel(contact: Contact, reach: float, *, half: bool) -> Body:
    wheel = contact.scene.wheel
    if contact.wheel is None:
        return _half_space(WHEEL, reach, half=half)
    shift = contact.scene.wheelset.shift
    centre = contact.touch.y - shift
    start, end = contact.wheel.domain
    if wheel.width:
        start, end = max(start, centre - wheel.width / 2), min(end, centre + wheel.width / 2)
    depth = wheel.rim_depth or min(RIM_DEPTH, 0.5 * wheel.rolling_radius)
    base = depth - min(0.0, float(np.nanmin(contact.wheel.height(np.linspace(start, end, 200)))))
    if base >= wheel.rolling_radius:
        raise SceneError(
            "wheel.rim_depth",
            f"{depth:g} is not allowed; it must be smaller than wheel.rolling_radius "
            f"({wheel.rolling_radius:g})",
        )
    section = outlines.block_section(
        contact.wheel, 0.0 if half else start, end, base, outwards=-1, half=half
    )
    lift = np.array([shift, contact.touch.axle_height - wheel.rolling_radius])
    section = [curve.moved(np.eye(2), lift) for curve in section]
    reach = wheel.segment_length / 2 if wheel.segment_length else reach
    reach = min(reach, 1.2 * wheel.rolling_radius)
    return Body(WHEEL, section, reach, (contact.touch.axle_height, wheel.rolling_radius))


def _half_space(tag: int, reach: float, *, half: bool) -> Body:
    """A block with one flat contact face; all other outer faces are supported (far field)."""
    flat = profiles.single_radius(math.inf, reach, "flat")
    outwards = 1 if tag == RAIL else -1
    section = outlines.block_section(
        flat, 0.0 if half else -reach, reach, -outwards * reach, outwards=outwards, half=half
    )
    section = [
        replace(curve, role="support") if curve.role == "free" else curve for curve in section
    ]
    return Body(tag, section, reach, end_role="support")
