"""The whole rail on its foot, or its head cut where the web begins."""

from __future__ import annotations

import math

from railhead.geometry.outlines import head_depth
from railhead.geometry.profiles import STANDARD_RAILS
from railhead.planning.context import Context, Effect, PostSolveVerdict
from railhead.planning.references import rail_twist
from railhead.postprocess.findings import Findings
from railhead.scene.scene import SceneError

# Relative change of the largest shear stress over the stress at the cut over p0 (measured).
STRESS_CHANGE = 0.25


def decide(context: Context) -> Effect:
    """Whole rail on its foot, for rail.extent = section, where the cut of the head changes the
    stress, or where the twist of the rail brings another part of the profiles into contact.
    Raises SceneError for extent section without a standard rail.
    """
    rail, hertz = context.scene.rail, context.hertz
    extent, name = rail.extent, rail.profile
    if context.contact.half_space:
        why = "a half-space has neither web nor foot"
        return Effect(False, False, why, {"on": why})
    if name not in STANDARD_RAILS:
        if extent == "section":
            raise SceneError("rail.extent", "section needs rail.profile 54E1 or 60E1; give head")
        why = f"rail.profile {name} has neither web nor foot"
        return Effect(False, False, why, {"on": why})
    if extent == "section":
        return Effect(True, True, "rail.extent = section")
    cut, why = _cut_matters(context, hertz.a, hertz.b)
    twists, twist_text = _twists(context)
    called = cut or twists
    return Effect(called, called, f"{why}; {twist_text}")


def check(context: Context, effect: Effect, found: Findings) -> PostSolveVerdict | None:
    """Verdict whether the cut or the twist matters, with the patch of the solution; None where no
    whole section can be had.
    """
    if "on" in effect.refused:
        return None
    cut, why = _cut_matters(context, found.patch.a, found.patch.b)
    if effect.on or cut or not effect.called_for:
        return PostSolveVerdict(cut and not effect.on, why)
    twists, twist_text = _twists(context)
    return PostSolveVerdict(twists, twist_text if twists else why)


def _cut_matters(context: Context, a: float, b: float) -> tuple[bool, str]:
    """Whether the stress at the cut of a rail head, over p0, exceeds what the accuracy allows, and
    a sentence that says so.
    a, b: semi-axes of the patch, mm.
    The stress is Boussinesq's 3F/(2 pi H^2) below a point load over p0 = 3F/(2 pi a b), or
    Flamant's 2F'/(pi H) below a line load over p0 = 2F'/(pi b), with H the depth of the cut
    (Johnson, Contact Mechanics, 3.19, 4.26, 2.19 and 4.43).
    """
    depth, limit = head_depth(context.scene.rail.profile), context.accuracy / STRESS_CHANGE
    ratio, name = (b / depth, "b/H") if context.contact.line else (a * b / depth**2, "ab/H^2")
    side = "above" if ratio > limit else "below"
    text = f"stress at the cut {depth:.1f} mm deep over p0: {name} = {ratio:.2g}"
    return bool(ratio > limit), f"{text}, {side} {limit:.2g}"


def _twists(context: Context) -> tuple[bool, str]:
    """Whether pressure or area change by more than the accuracy as the load twists the rail, or may
    do so, and a sentence that says so.
    """
    contact = context.contact
    if contact.plane:
        return False, "nothing twists in a section"
    if not math.isfinite(context.scene.rail.young_modulus):
        return False, "a rigid rail does not twist"
    if not context.decided["true_profile"].called_for:
        return False, "a twist changes nothing where both bodies have one radius"
    angle, limit = rail_twist.twist(contact, context.hertz), context.accuracy
    text = f"the load twists it by {1e3 * angle:.2g} mrad"
    try:
        change = context.twist_change
    except ValueError as error:
        return True, f"{text}: what that changes cannot be judged ({error})"
    side = "above" if change > limit else "below"
    return change > limit, f"{text}: pressure or area change by {change:.2g}, {side} {limit:g}"
