"""Half-spaces cut to blocks whose outer faces follow the exact displacement."""

from __future__ import annotations

from railhead.geometry.solid import Contact
from railhead.planning.effects.base import Effect, Hertz
from railhead.scene.scene import Scene


def decide(scene: Scene, contact: Contact, ellipse: Hertz) -> Effect:
    """Called for by rail.extent = half-space."""
    if contact.half_space:
        return Effect(True, True, "rail.extent = half-space: what lies beyond the blocks deforms")
    why = "the bodies end where they really end"
    return Effect(False, False, why, {"on": f"rail.extent is {scene.rail.extent}"})
