"""Deformable bodies: a much stiffer one is rigid, and only its surface takes part."""

from __future__ import annotations

import math

from railhead.effects.base import Effect, Hertz, accuracy
from railhead.geometry import Contact
from railhead.scene import Scene

SHARE = 0.1  # of the asked accuracy: compliance that may be left out


def rail(scene: Scene, contact: Contact, ellipse: Hertz) -> Effect:
    """Whether the rail deforms."""
    return _decide(scene, ellipse, scene.rail.young_modulus, scene.rail.poisson_ratio)


def wheel(scene: Scene, contact: Contact, ellipse: Hertz) -> Effect:
    """Whether the wheel deforms."""
    return _decide(scene, ellipse, scene.wheel.young_modulus, scene.wheel.poisson_ratio)


def ratios(scene: Scene, contact: Contact, ellipse: Hertz) -> dict[str, float]:
    """Poisson's ratio by body, of those that deform."""
    found = {}
    for name, part, decision in (("rail", scene.rail, rail), ("wheel", scene.wheel, wheel)):
        effect = f"deformable_{name}"
        if decision(scene, contact, ellipse).forced(effect, scene.effects.state(effect)).on:
            found[name] = part.poisson_ratio
    return found


def _decide(scene: Scene, ellipse: Hertz, young: float, poisson: float) -> Effect:
    """By its share of 1/E* = sum (1 - nu^2)/E: without a share s the approach and the pressure are
    off by 2/3 s and the semi-axes by s/3 (Johnson, Contact Mechanics, 4.22 to 4.24)."""
    if math.isinf(young):
        why = "E is infinite: only its surface takes part"
        return Effect(False, False, why, {"on": "E is infinite"})
    share = (1 - poisson**2) / young * ellipse.contact_modulus
    limit = SHARE * accuracy(scene)
    called = share >= limit
    text = f"it holds {share:.3g} of the compliance (1 - nu^2)/E"
    why = f"{text}, above {limit:.1g}" if called else f"{text}, below {limit:.1g}: rigid"
    return Effect(called, called, why, error=0.0 if called else share)
