"""The pair of a scene as theory takes it: materials, exact Hertz, and what lies between them."""

import math

import numpy as np

from railhead.contact.solid import Contact
from railhead.meshing.bodies import BODY_NAMES
from railhead.scene.scene import NOMINAL_RADIUS, Scene, SceneError
from railhead.theory.elastic import hertz
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import Hertz, LineContact
from railhead.theory.friction import tangential
from railhead.theory.friction.tangential import MaterialPair
from railhead.theory.friction_laws import ByTemperature, Falling, Heat, Interface, Law

CELLS = 64  # along the patch, for temperatures before anything is solved: 0.1 %
CONTINUUM = 1e-6  # mm, least half length of a patch: some atoms
LARGEST = 1e6  # mm, largest half length of a patch: no body is longer
ROUNDING = 1e3  # least gap of a patch over the rounding error of coordinates


def plane_strain_modulus(scene: Scene, body: int) -> float:
    """E / (1 - nu^2) of a body (tag RAIL or WHEEL), MPa; infinite for an infinite modulus."""
    part = scene.bodies[BODY_NAMES[body]]
    return part.young_modulus / (1 - part.poisson_ratio**2)


def contact_modulus(scene: Scene) -> float:
    """Contact modulus E* of the pair, MPa: 1/E* is the sum of (1 - nu^2)/E of both bodies."""
    rail, wheel = scene.rail, scene.wheel
    return hertz.contact_modulus(
        rail.young_modulus, rail.poisson_ratio, wheel.young_modulus, wheel.poisson_ratio
    )


def tangential_pair(scene: Scene) -> MaterialPair:
    """Shear modulus (MPa), Poisson's ratio and mismatch of both materials of the scene combined,
    for tangential contact. As simulated they are `Context.tangential_pair`.
    """
    rail, wheel = scene.rail, scene.wheel
    return tangential.pair(
        wheel.young_modulus, wheel.poisson_ratio, rail.young_modulus, rail.poisson_ratio
    )


def hertz_contact(scene: Scene, contact: Contact, load: float | None = None) -> Hertz:
    """Exact Hertz, line or ellipse, for the pair under a vertical load (N), or where that is None
    under the load or approach of the scene. Its own load is the normal force.
    """
    along_line = contact.line_contact(load if load is not None else scene.load)
    return along_line or ellipse(scene, contact, load)


def ellipse(scene: Scene, contact: Contact, load: float | None = None) -> Ellipse:
    """Hertz's point contact under a vertical load (N), or where that is None under the load or
    approach of the scene. The normal force is load / cos(contact angle), the normal approach is
    approach * cos.
    """
    touch, modulus = contact.touch, contact_modulus(scene)
    load = load if load is not None else scene.load
    cosine = touch.upright
    if load is not None:
        return hertz.point_contact(touch.curvature_x, touch.curvature_y, modulus, load / cosine)
    return hertz.point_contact_from_approach(
        touch.curvature_x, touch.curvature_y, modulus, float(scene.approach or 0.0) * cosine
    )


def hertz_if_valid(scene: Scene, contact: Contact) -> Hertz:
    """Exact Hertz for the scene's load or approach.
    Raises SceneError where there is no patch, where it is larger than the wheel, or too small for
    continuum mechanics or for the coordinates of the bodies.
    """
    key, value = ("load", scene.load) if scene.load is not None else ("approach", scene.approach)
    try:
        with np.errstate(all="ignore"):
            found = hertz_contact(scene, contact)
    except (ArithmeticError, ValueError):  # beyond the numbers there are
        text = f"{value:g} makes no patch with these radii and moduli; give values of real bodies"
        raise SceneError(key, text) from None
    major, minor = max(found.half_lengths), min(found.half_lengths)
    least, most = _smallest(scene, contact, found), min(scene.wheel.rolling_radius, LARGEST)
    if found.p0 > 0 and math.isfinite(found.load) and least <= minor and major < most:
        return found
    size = f"{value:g} makes a patch of {found.a:.3g} x {found.b:.3g} mm"
    raise SceneError(key, f"{size}; give one with half lengths from {least:.3g} to {most:.3g} mm")


def gap_deviation(contact: Contact, ellipse: Hertz) -> float:
    """Largest deviation of the exact gap over the ellipse from Hertz's parabola, over the approach;
    infinite where another contact point is within reach of the approach, and where the surfaces
    have a shape. Raises ValueError for half-spaces.
    """
    touch = contact.touch
    if contact.shape is not None:
        return math.inf
    if len(contact.touches(ellipse.approach / touch.upright)) > 1:
        return math.inf
    turn, radius = np.meshgrid(np.linspace(0, 2 * np.pi, 25), [0.5, 1.0])
    u, v = (ellipse.a * radius * np.cos(turn)).ravel(), (ellipse.b * radius * np.sin(turn)).ravel()
    c, t = math.cos(touch.orientation), math.sin(touch.orientation)
    gap = contact.half_space_gap(c * u - t * v, t * u + c * v)
    expected = (touch.curvature_x * u**2 + touch.curvature_y * v**2) / 2
    return float(np.abs(gap - expected).max() / ellipse.approach)


def _smallest(scene: Scene, contact: Contact, found: Hertz) -> float:
    """Smallest half length of a patch that is meaningful, mm: 1e-6 mm (CONTINUUM), and for real
    bodies also the one whose gap is 1000 times (ROUNDING) the rounding of the largest radius.
    The gap is the smaller half length squared times the curvature.
    """
    if contact.half_space:
        return CONTINUUM
    rail, wheel = scene.rail, scene.wheel
    radii = [
        abs(radius)
        for radius in (
            wheel.rolling_radius,
            rail.crown_radius or NOMINAL_RADIUS.get(rail.profile, 0.0),
            wheel.transverse_radius or 0.0,
        )
        if math.isfinite(radius)
    ]
    rounding = ROUNDING * np.finfo(float).eps * max(radii, default=0.0)
    if isinstance(found, LineContact):
        curvature = found.curvature
    else:
        curvature = max(found.curvature_x, found.curvature_y)
    return max(CONTINUUM, math.sqrt(rounding / curvature))


def interface(scene: Scene) -> Interface:
    """Heat, law of friction and layer of a scene, without what its effects switch off."""
    friction, effects = scene.friction, scene.effects
    layer = 0.0
    if friction.layer_thickness and friction.layer_modulus and effects.layer != "off":
        layer = friction.layer_thickness / friction.layer_modulus
    if scene.rolling.speed is None:
        return Interface(layer=layer)
    heat = Heat(speed=scene.rolling.speed, **scene.heat.model_dump())
    found = None if effects.falling_friction == "off" else law(scene)
    return Interface(heat=heat, law=found, memory=friction.memory, layer=layer)


def coulomb(scene: Scene) -> bool:
    """Whether tractions have Coulomb's law alone: no law of the coefficient and no layer."""
    found = interface(scene)
    return found.law is None and not found.layer


def law(scene: Scene) -> Law | None:
    """Law of the coefficient of a scene; None of Coulomb's."""
    friction = scene.friction
    if friction.table:
        return ByTemperature(friction.table)
    if friction.kinetic is None or friction.slip_half is None:
        return None
    return Falling(friction.kinetic, friction.slip_half, friction.law == "linear")


def flash_rise(scene: Scene, hertz: Hertz, dissipated: float) -> float:
    """Largest rise of the hotter surface, K, by an energy that friction dissipates per rolled
    length, N, distributed as Hertz's pressure. It holds for one patch. The scene has a speed.
    """
    heat = interface(scene).heat
    assert heat is not None
    u = (2 * np.arange(CELLS) + 1) / CELLS - 1
    along = isinstance(hertz, LineContact) and hertz.across
    pressure = np.full_like(u, hertz.p0) if along else hertz.p0 * np.sqrt(1 - u**2)
    flux = heat.speed * dissipated / hertz.load * pressure[:, None]
    hot = heat.temperatures(hertz.half_lengths[0] * u, flux)
    return float((hot - heat.bulk.mean()).max())
