"""The real profiles, or one radius each where the patch stays within one arc of both."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from railhead.contact.solid import Contact
from railhead.geometry.profiles import Arc, Polynomial, osculating
from railhead.planning.context import Context, Effect, PostSolveVerdict
from railhead.postprocess.findings import Findings

MARGIN = 1.1  # factor on the patch that must lie within one arc


def decide(context: Context) -> Effect:
    """Real profiles are called for where the predicted patch, times 1.1 (MARGIN), comes near a
    joint of two arcs of a profile, or the profile is no arc there; otherwise one radius each is
    enough.
    """
    contact = context.contact
    if not contact.cross_profiles:
        why = "the section runs along the rail"
        if contact.half_space and contact.plane != "xz":
            why = "half-spaces have one radius each"
        return Effect(False, False, why, {"on": why})
    reach = MARGIN * context.hertz.b * math.cos(contact.touch.angle)
    called, why = _leaves(contact, contact.touch.y - reach, contact.touch.y + reach)
    return Effect(called, called, f"{MARGIN} times the predicted patch, {why}")


def check(context: Context, effect: Effect, found: Findings) -> PostSolveVerdict | None:
    """Verdict whether the patch of the solution leaves one arc of either body though its profile
    was one radius; None where the effect cannot be on.
    """
    if "on" in effect.refused:
        return None
    centre, reach = found.patch.centre[1], found.patch.b
    if found.patch.outlines:
        across = np.concatenate(found.patch.outlines)[:, 1]
        low, high = float(across.min()), float(across.max())
    else:
        low, high = centre - reach, centre + reach
    cosine, y = math.cos(found.frame.angle), found.frame.origin[1]
    leaves, why = _leaves(context.contact, y + low * cosine, y + high * cosine)
    return PostSolveVerdict(leaves and not effect.on, f"the patch, {why}")


def one_radius(contact: Contact) -> Contact:
    """The contact with each profile replaced by its circle of curvature at the contact; half-spaces
    and sections along the rail are unchanged.
    """
    if contact.pair is None or not contact.cross_profiles:
        return contact
    y = contact.touch.y
    rail, wheel = (osculating(profile, y - shift) for _, profile, shift in contact.cross_profiles)
    return replace(contact, pair=replace(contact.pair, rail=rail, wheel=wheel))


def _leaves(contact: Contact, low: float, high: float) -> tuple[bool, str]:
    """Whether the range low <= y <= high (mm) on the rail spans more than one arc of either body,
    or a piece that is no arc, and a sentence that says so.
    """
    nearest, owner = math.inf, ""
    for body, profile, shift in contact.cross_profiles:
        piece = next(p for p in profile.pieces if p.end >= contact.touch.y - shift)
        straight = isinstance(piece, Polynomial) and len(piece.coefficients) <= 2
        if not (isinstance(piece, Arc) or straight):
            return True, f"on the {body}'s {profile.name} where it is no arc"
        for joint in profile.joints:
            if abs(joint + shift - contact.touch.y) < abs(nearest - contact.touch.y):
                nearest, owner = joint + shift, body
    span = f"y = {low:.1f} to {high:.1f} mm"
    if not owner:
        return False, f"{span}, lies on one arc each"
    crosses = bool(low < nearest < high)
    verb = "crosses" if crosses else "ends before"
    return crosses, f"{span}, {verb} the {owner}'s joint at y = {nearest:.1f} mm"
