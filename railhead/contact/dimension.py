"""Does the scene need three dimensions? A line contact is solved in a plane section, a contact of
two bodies of revolution about the same axis in a meridian section."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhead.contact.solid import RAIL_HALF_WIDTH, TREAD_HALF_WIDTH
from railhead.scene.scene import (
    NOMINAL_RADIUS,
    Scene,
    SceneError,
    refuse_unused,
    set_but_unused,
)
from railhead.theory.elastic import hertz, line

SLENDER = 5.0  # predicted semi-axis across over half the contact length that makes a line contact:
# the pressure at both ends is then within 2 % of that in the middle, sqrt(1 - 1/25)
LEVEL = 0.1  # largest slope of either surface within the contact length of a line contact
EQUAL = 1e-9  # relative difference of the curvatures of a circular contact


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
    width = 2 * _half_width(scene, along, length)
    if width > length and forced != "on":
        return _solid(forced, f"a plate: the strip is {width:.3g} mm wide and {length:.4g} mm long")
    return Dimension("plane_along", text, length, centre)


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


def _half_width(scene: Scene, along: float, length: float) -> float:
    """Half width, in the direction of the rail, of the strip of a line contact in a section along
    the rail, mm.
    along: relative curvature along the rail, 1/mm; length: of the contact line across the rail, mm.
    """
    rail, wheel = scene.rail, scene.wheel
    return line.contact(
        along,
        (rail.young_modulus, wheel.young_modulus),
        (rail.poisson_ratio, wheel.poisson_ratio),
        length=length,
        across=False,
        load=scene.load,
        approach=scene.approach,
    ).half_width


def _semi_axis_across(scene: Scene, along: float, across: float) -> float:
    """Semi-axis across the rail of Hertz's ellipse, mm, for relative curvatures along and across
    (1/mm) and the load or approach of the scene.
    """
    rail, wheel = scene.rail, scene.wheel
    modulus = hertz.contact_modulus(
        rail.young_modulus, rail.poisson_ratio, wheel.young_modulus, wheel.poisson_ratio
    )
    with np.errstate(all="ignore"):  # absurd loads are refused later, in one line
        if scene.load is not None:
            return hertz.point_contact(along, across, modulus, scene.load).b
        approach = float(scene.approach or 0.0)
        return hertz.point_contact_from_approach(along, across, modulus, approach).b
