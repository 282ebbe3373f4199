"""The whole rail on its foot, or its head cut where the web begins."""

from __future__ import annotations

import math

from railhead.geometry.solid import Contact
from railhead.meshing.outlines import head_depth
from railhead.meshing.profiles import STANDARD_RAILS
from railhead.planning import exact, twist
from railhead.planning.effects import true_profile
from railhead.planning.effects.base import After, Effect, Hertz, accuracy
from railhead.postprocess.findings import Findings
from railhead.scene.scene import Scene, SceneError
from railhead.theory.line import LineContact

CHANGE = (
    0.25  # of the stress at the cut over p0: what the largest shear stress changes by (measured)
)


def decide(scene: Scene, contact: Contact, ellipse: Hertz) -> Effect:
    """Called for where it is asked, where the cut is near enough to be felt, or where the twist of
    the rail brings another part of the profiles into contact."""
    extent, name = scene.rail.extent, scene.rail.profile
    if contact.half_space:
        why = "a half-space has neither web nor foot"
        return Effect(False, False, why, {"on": why})
    if name not in STANDARD_RAILS:
        if extent == "section":
            raise SceneError("rail.extent", "section needs rail.profile 54E1 or 60E1; give head")
        why = f"rail.profile {name} has neither web nor foot"
        return Effect(False, False, why, {"on": why})
    if extent == "section":
        return Effect(True, True, "rail.extent = section")
    felt, why = _felt(scene, contact, ellipse.a, ellipse.b)
    twists, because = _twists(scene, contact, ellipse)
    called = felt or twists
    return Effect(called, called, f"{why}; {because}")


def check(scene: Scene, contact: Contact, effect: Effect, found: Findings) -> After | None:
    """The same with the patch that was found."""
    if "on" in effect.refused:
        return None
    felt, why = _felt(scene, contact, found.patch.a, found.patch.b)
    if effect.on or felt or not effect.called_for:
        return After(felt and not effect.on, why)
    twists, because = _twists(scene, contact, exact.estimate(scene, contact))
    return After(twists, because if twists else why)


def _felt(scene: Scene, contact: Contact, a: float, b: float) -> tuple[bool, str]:
    """Boussinesq's 3F/(2 pi H^2) below a point load over p0 = 3F/(2 pi a b), Flamant's 2F'/(pi H)
    below a line load over p0 = 2F'/(pi b) (Johnson, Contact Mechanics, 3.19, 4.26, 2.19 and 4.43),
    H the depth of the cut."""
    depth, limit = head_depth(scene.rail.profile), accuracy(scene) / CHANGE
    ratio, name = (b / depth, "b/H") if contact.line else (a * b / depth**2, "ab/H^2")
    side = "above" if ratio > limit else "below"
    text = f"stress at the cut {depth:.1f} mm deep over p0: {name} = {ratio:.2g}"
    return bool(ratio > limit), f"{text}, {side} {limit:.2g}"


def _twists(scene: Scene, contact: Contact, ellipse: Hertz) -> tuple[bool, str]:
    """Whether pressure or area change by more than the accuracy as the load twists the rail, or
    may do so."""
    if contact.plane or isinstance(ellipse, LineContact):
        return False, "nothing twists in a section"
    if not math.isfinite(scene.rail.young_modulus):
        return False, "a rigid rail does not twist"
    if not true_profile.decide(scene, contact, ellipse).called_for:
        return False, "a twist changes nothing where both bodies have one radius"
    angle, limit = twist.twist(contact, ellipse), accuracy(scene)
    text = f"the load twists it by {1e3 * angle:.2g} mrad"
    try:
        change = twist.change(contact, ellipse, angle, twist.CENTRE * angle)
    except ValueError as error:
        return True, f"{text}: what that changes cannot be judged ({error})"
    side = "above" if change > limit else "below"
    return change > limit, f"{text}: pressure or area change by {change:.2g}, {side} {limit:g}"
