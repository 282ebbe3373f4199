"""The bodies of a scene: sections, and how they are swept and placed."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from railhead.contact.solid import Contact
from railhead.geometry import outlines, profiles
from railhead.geometry.placement import ContactPoint, Pose, about_axle
from railhead.meshing.bodies import RAIL, WHEEL, Body
from railhead.scene.scene import Scene, SceneError
from railhead.theory.array_types import Array

HEAD_DEPTH = 50.0  # mm, of a block below a single-radius or measured crown
FOOT = 25.0  # mm, of it below the groove between two heads at least
RIM_DEPTH = 60.0  # mm
MOST_SLENDER = 9.0  # half length of the wheel's segment over its thickness; gmsh fails on thinner
THINNEST = 1e-3  # mm, width of a wheel in a section
# Corners of a whole section with a smaller radius (mm), far below the elements there, are left out:
# area +0.13 %, second moments +0.2 % (vertical bending) and +0.9 % (lateral).
SHARP_BELOW = 5.0
TWIST_REACH = 500.0  # mm, half length of a whole section that can twist: it decays over about 300


def bodies(
    contact: Contact, reach: float, deformable: Sequence[int], *, whole_section: bool, half: bool
) -> list[Body]:
    """Sections and sweeps of the deformable bodies of a solid, rail first; of half-spaces blocks.
    contact: first contact of the undeformed bodies.
    reach: half length along the rail of bodies without a length of their own, or half the edge of
        the blocks for half-spaces, mm.
    deformable: tags of the bodies wanted, RAIL or WHEEL.
    whole_section: whether a rail has web and foot, else its head alone; only for a standard rail.
    half: whether only y >= 0 is outlined.
    Raises SceneError where a depth or a width of the scene does not fit.
    """
    made = []
    if RAIL in deformable:
        made.append(_rail(contact, reach, whole_section=whole_section, half=half))
    if WHEEL in deformable:
        made.append(_wheel(contact, reach, half=half))
    return made


def depth(scene: Scene, body: int) -> float:
    """Nominal depth at which the body (RAIL or WHEEL) of a solid is held, mm. A depth of the scene
    counts from the top of the crown, or from the nominal rolling radius inwards. The default is
    50 mm (HEAD_DEPTH), or the smaller of 60 mm (RIM_DEPTH) and half the rolling radius. It counts
    from the lowest end of the crown, or from the point of the tread nearest to the axle, without
    the drop to there. So does a rim_depth that ends above that point. For a standard rail this is
    the depth of its head, also where web and foot are meshed.
    """
    if body == WHEEL:
        return scene.wheel.rim_depth or min(RIM_DEPTH, 0.5 * scene.wheel.rolling_radius)
    if name := standard_rail(scene):
        return outlines.head_depth(name)
    return scene.rail.depth or HEAD_DEPTH


def tread(contact: Contact, touch: ContactPoint) -> Array:
    """Ends (2,) of the wheel's tread across, from a contact point, mm: those of its profile, and at
    most half of its width away.
    """
    half = (contact.scene.wheel.width or math.inf) / 2
    return np.clip(np.array(contact.profiles["wheel"][0].domain) - touch.wheel_y, -half, half)


def standard_rail(scene: Scene) -> str:
    """Name of the standard profile of a scene's rail; empty for another one and for sections,
    beside which `rail.profile` says nothing.
    """
    name = scene.rail.profile
    return name if name in profiles.STANDARD_RAILS and not scene.rail.varies else ""


def rail_reach(contact: Contact, reach: float, *, whole_section: bool) -> float:
    """Half length of the rail, mm: half of `rail.length` where given, else reach.
    reach: half length where the scene gives none and the rail does not twist, mm. A whole section
        without symmetry at y = 0 can twist and gets at least 500 mm (TWIST_REACH).
    """
    if contact.scene.rail.length is not None:
        return contact.scene.rail.length / 2
    twisted = whole_section and contact.why_asymmetric_in_y() is not None
    return max(reach, TWIST_REACH) if twisted else reach


def _rail(contact: Contact, reach: float, *, whole_section: bool, half: bool) -> Body:
    """The rail as a section and half length: standard section, block below a crown, or half-space.
    Arguments: as of `bodies`. Raises SceneError where rail.depth does not exceed the drop of the
    crown.
    """
    scene = contact.scene
    if contact.pair is None:
        return _half_space(RAIL, reach, half=half)
    if name := standard_rail(scene):
        extent = "section" if whole_section else "head"
        section = outlines.rail_section(name, extent, half=half)
        if whole_section:
            section = outlines.sharpened(section, SHARP_BELOW)
        angle = math.atan(scene.rail.inclination)
        c, s = math.cos(angle), math.sin(angle)
        section = [curve.moved(np.array([[c, -s], [s, c]]), np.zeros(2)) for curve in section]
    else:
        start, end = contact.pair.rail.domain
        heights = contact.pair.rail.height(np.array([start, end, *contact.pair.rail.joints]))
        lowest = float(np.nanmin(heights[:2]))
        base = min(lowest - HEAD_DEPTH, float(np.nanmin(heights)) - FOOT)
        base = base if scene.rail.depth is None else -scene.rail.depth
        if base >= lowest:
            raise SceneError(
                "rail.depth",
                f"{scene.rail.depth:g} is not allowed; it must be larger than the height of the "
                f"crown ({-lowest:g})",
            )
        section = outlines.block_section(
            contact.pair.rail, 0.0 if half else start, end, base, outwards=1, half=half
        )
    return Body(RAIL, section, rail_reach(contact, reach, whole_section=whole_section))


def _wheel(contact: Contact, reach: float, *, half: bool) -> Body:
    """The wheel as a ring segment in its pose, its middle at the first contact, or a half-space. A
    segment reaches at most 1.2 times the rolling radius to each side. `wheel.width` cuts the tread
    at half of it to each side of the first contact. Arguments: as of `bodies`. Raises SceneError
    where the rim is not less deep than the wheel, or the segment is too thin for its length.
    """
    scene = contact.scene
    wheel = scene.wheel
    if contact.pair is None or contact.pose is None:
        return _half_space(WHEEL, reach, half=half)
    centre = contact.touch.wheel_y
    start, end = contact.pair.wheel.domain
    if wheel.width:
        start, end = max(start, centre - wheel.width / 2), min(end, centre + wheel.width / 2)
    deep = depth(scene, WHEEL)
    lowest = min(0.0, float(np.nanmin(contact.pair.wheel.height(np.linspace(start, end, 200)))))
    base = deep if wheel.rim_depth and deep > -lowest else deep - lowest
    if not wheel.rim_depth and base >= wheel.rolling_radius:  # a ball
        base = (wheel.rolling_radius - lowest) / 2
    if base >= wheel.rolling_radius:
        raise SceneError(
            "wheel.rim_depth",
            f"{deep:g} is not allowed; with the drop of the tread towards the axle "
            f"({base - deep:g}) it must be smaller than wheel.rolling_radius "
            f"({wheel.rolling_radius:g})",
        )
    reach = wheel.segment_length / 2 if wheel.segment_length else reach
    reach = min(reach, 1.2 * wheel.rolling_radius)
    thinnest = max(reach / MOST_SLENDER * (2 if half else 1), THINNEST)
    if end - start < thinnest:
        shorter = 2 * reach * (end - start) / thinnest
        text = f"give wheel.segment_length = {0.99 * shorter:.3g} or less"
        if np.ptp(contact.pair.wheel.domain) > thinnest:
            text = f"give at least {thinnest:g}, or a shorter wheel.segment_length"
        raise SceneError(
            "wheel.width",
            f"{end - start:g} is too thin a plate for a segment {2 * reach:g} mm long; {text}",
        )
    section = outlines.block_section(
        contact.pair.wheel, 0.0 if half else start, end, base, outwards=-1, half=half
    )
    below = np.array([0.0, -wheel.rolling_radius])
    section = [curve.moved(np.eye(2), below) for curve in section]
    pose = Pose(contact.pose.rotation @ about_axle(contact.touch.axle_angle), contact.pose.origin)
    return Body(WHEEL, section, reach, (0.0, wheel.rolling_radius), pose=pose)


def _half_space(tag: int, reach: float, *, half: bool) -> Body:
    """A block with one flat contact face, a body tagged RAIL (below) or WHEEL (above); all other
    outer faces are supported, planes of symmetry excepted: held, or moved by the far field. reach:
    half width, depth and half length, mm.
    """
    flat = profiles.single_radius(math.inf, reach, "flat")
    outwards = 1 if tag == RAIL else -1
    section = outlines.block_section(
        flat, 0.0 if half else -reach, reach, -outwards * reach, outwards=outwards, half=half
    )
    section = [
        replace(curve, role="support") if curve.role == "free" else curve for curve in section
    ]
    return Body(tag, section, reach, end_role="support")
