"""Heat of friction: an indicator alone, as no temperature is simulated."""

from __future__ import annotations

import math

from railhead.planning.context import Context, Effect, PostSolveVerdict
from railhead.planning.effects.interface import friction
from railhead.postprocess.findings import Findings
from railhead.scene import steels
from railhead.theory.elastic import contacts
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction.wear import flash_temperature

HOT = 100.0  # K, least flash temperature that matters (a choice)
UNKNOWN = "flash temperature not known for this material: the constants are those of steel"


def decide(context: Context) -> Effect:
    """Decision on heat, which is never simulated: called for where the flash temperature, if the
    whole patch slips, is 100 K (HOT) or more.
    """
    scene, hertz = context.scene, context.hertz
    speed, rolling = scene.rolling.speed, scene.rolling
    refused = {"on": "no temperature is simulated"}
    if speed is None or not context.decided["friction"].on:
        why = "nothing slips" if speed else "no rolling.speed is given"
        return Effect(False, False, why, refused)
    if not _steel(context):
        return Effect(False, False, UNKNOWN, refused)
    if rolling.force_along or rolling.force_across:
        return Effect(False, False, "the creepage of a given force is known afterwards", refused)
    moves = friction.creepage(context)
    a, b = contacts.half_lengths(hertz)
    slip = math.hypot(moves.along, moves.across) + abs(moves.spin) * max(a, b)
    most = flash_temperature(
        scene.friction.coefficient * hertz.load * slip,
        hertz.area,
        a,
        speed,
        line=isinstance(hertz, LineContact),
    )
    called = most >= HOT
    side = "above" if called else "below"
    why = f"flash temperature up to {most:.3g} K where all slips, {side} {HOT:g} K"
    return Effect(called, False, why, refused)


def check(context: Context, effect: Effect, found: Findings) -> PostSolveVerdict | None:
    """Verdict whether the flash temperature (a rise, K) of the dissipated energy reaches 100 K
    (HOT).

    It is 'unknown' (not needed) for deformable bodies that are not steel, and None without a
    rolling speed or without dissipation.
    """
    speed = context.scene.rolling.speed
    if speed is None or math.isnan(found.dissipated):
        return None
    if not _steel(context):
        return PostSolveVerdict(False, UNKNOWN)
    patch, line = found.patch, isinstance(context.hertz, LineContact)
    rise = flash_temperature(found.dissipated, patch.area, patch.a, speed, line=line)
    hot = rise >= HOT
    text = f"flash temperature {rise:.3g} K, {'above' if hot else 'below'} {HOT:g} K"
    return PostSolveVerdict(hot, f"{text}: friction and yield stress fall with it" if hot else text)


def _steel(context: Context) -> bool:
    """Whether each body that deforms has the modulus of a steel; a rigid one is taken for steel."""
    moduli = (part.young_modulus for part in context.scene.bodies.values())
    return all(math.isinf(each) or steels.is_steel(each) for each in moduli)
