"""Two dimensions instead of three: a plane-strain or a meridian section."""

from __future__ import annotations

from railhead.geometry import dimension
from railhead.geometry.solid import Contact
from railhead.planning.effects.base import Effect, Hertz
from railhead.scene.scene import Scene


def plane_strain(scene: Scene, contact: Contact, hertz: Hertz) -> Effect:
    """Called for where the contact is a line (`dimension.choose`)."""
    kind = dimension.choose(scene)
    refused = {} if kind.line else {"on": kind.plane_strain}
    return Effect(kind.line, kind.line, kind.plane_strain, refused)


def axisymmetry(scene: Scene, contact: Contact, hertz: Hertz) -> Effect:
    """Called for where both bodies are of revolution about the contact's normal."""
    called, why = dimension.circular(scene)
    return Effect(called, dimension.choose(scene).kind == "axisymmetric", why)
