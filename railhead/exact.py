"""Exact Hertz for the pair of a scene."""

from __future__ import annotations

import math

import numpy as np

from meshing.tags import RAIL
from railhead.flat import FlatContact
from railhead.geometry import Contact
from railhead.scene import Scene, SceneError
from theory import hertz
from theory.hertz import Ellipse
from theory.line import LineContact


def plane_strain_modulus(scene: Scene, body: int) -> float:
    """E / (1 - nu^2), MPa."""
    part = scene.rail if body == RAIL else scene.wheel
    return part.young_modulus / (1 - part.poisson_ratio**2)


def contact_modulus(scene: Scene) -> float:
    """E*, MPa."""
    rail, wheel = scene.rail, scene.wheel
    return hertz.contact_modulus(
        rail.young_modulus, rail.poisson_ratio, wheel.young_modulus, wheel.poisson_ratio
    )


def estimate(scene: Scene, contact: Contact, load: float | None = None) -> Ellipse | LineContact:
    """Exact Hertz for the pair under a load (N), by default that or the approach of the scene."""
    load = load if load is not None else scene.load
    if isinstance(contact, FlatContact) and contact.dimension.line:
        return contact.estimate(load)
    return ellipse(scene, contact, load)


def ellipse(scene: Scene, contact: Contact, load: float | None = None) -> Ellipse:
    """A point contact; the normal force of a vertical load is load / cos(angle)."""
    touch, modulus = contact.touch, contact_modulus(scene)
    load = load if load is not None else scene.load
    cosine = math.cos(touch.angle)
    if load is not None:
        return hertz.point_contact(touch.curvature_x, touch.curvature_y, modulus, load / cosine)
    return hertz.point_contact_from_approach(
        touch.curvature_x, touch.curvature_y, modulus, float(scene.approach or 0.0) * cosine
    )


def finite(scene: Scene, contact: Contact) -> Ellipse | LineContact:
    """The estimate; SceneError for a load or approach that no wheel of this size could bear."""
    with np.errstate(all="ignore"):
        found = estimate(scene, contact)
    major = found.half_width if isinstance(found, LineContact) else max(found.a, found.b)
    if found.p0 > 0 and major < scene.wheel.rolling_radius:
        return found
    key, value = ("load", scene.load) if scene.load is not None else ("approach", scene.approach)
    raise SceneError(
        key,
        f"{value:g} makes a patch of {found.a:.3g} x {found.b:.3g} mm; give a smaller one, "
        "whose patch is smaller than wheel.rolling_radius",
    )
