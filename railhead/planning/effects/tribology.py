"""Effects between the surfaces: heat of friction, friction that falls, an elastic layer."""

from __future__ import annotations

import math

from railhead.planning import cost
from railhead.planning.context import Context, Effect, PostSolveVerdict
from railhead.planning.effects import interface
from railhead.planning.references import closed_forms
from railhead.postprocess.findings import Findings
from railhead.scene import bodies
from railhead.scene.scene import SceneError

HOT = 100.0  # K, least rise of the surfaces that matters where it is not simulated (a choice)
UNKNOWN = "flash temperature not known for this material; give the constants of [heat]"


def beyond_grids(context: Context, *, layer: bool = False) -> str:
    """Bodies whose tractions are found neither along lines in rolling direction nor on grids of
    half-spaces, in words: these can have no heat, no law of friction but Coulomb's and no layer.
    Empty of all others. layer: whether a layer is asked for, which sections do not have.
    """
    decided = context.decided
    if decided["passes"].on:
        return "rolling.passes"
    if not decided["finite_bodies"].on:
        return ""
    if context.contact.plane:
        return "a section in two dimensions" if layer else ""
    if interface.unlike(context):
        return "meshed bodies of unlike materials"
    return "bodies that yield" if decided["plasticity"].on else ""


def decide_heat(context: Context) -> Effect:
    """Surface temperatures are called for where bodies roll at a given speed with friction. Where
    they cannot be simulated, they are called for from a rise of 100 K (HOT) on.
    """
    scene, hertz = context.scene, context.hertz
    speed, rolling = scene.rolling.speed, scene.rolling
    if speed is None or not context.decided["friction"].on:
        why = "nothing slips" if speed else "no rolling.speed is given"
        return Effect(False, False, why, {"on": why})
    if not _known(context):
        return Effect(False, False, UNKNOWN, {"on": UNKNOWN})
    given = rolling.force_along or rolling.force_across
    most = (
        math.nan if given else closed_forms.flash_rise(scene, hertz, _slides(context) * hertz.load)
    )
    why = "the creepage of a given force is known afterwards"
    why = why if given else f"flash temperature up to {most:.3g} K where all slips"
    missing = beyond_grids(context)
    if not missing:
        return Effect(True, True, f"{why}; a strip integral, no price")
    text = f"no temperature is simulated with {missing}"
    return Effect(most >= HOT, False, f"{why}, {HOT:g} K matter; {text}", {"on": text})


def _slides(context: Context) -> float:
    """Static coefficient of friction times the largest rigid slip over the rolling speed."""
    moves = interface.creepage(context)
    slip = abs(moves.spin) * max(context.hertz.half_lengths) + math.hypot(moves.along, moves.across)
    return interface.friction_coefficient(context) * slip


def check_heat(context: Context, effect: Effect, found: Findings) -> PostSolveVerdict | None:
    """Verdict whether the flash temperature (a rise, K) of the dissipated energy reaches 100 K
    (HOT) where it is not simulated.

    It is 'unknown' (not needed) where a body is neither steel nor of infinite modulus, and None
    without a rolling speed, where nothing rolls with friction, and where it is simulated.
    """
    if context.scene.rolling.speed is None or math.isnan(found.dissipated) or effect.on:
        return None
    if not _known(context):
        return PostSolveVerdict(False, UNKNOWN)
    rise = closed_forms.flash_rise(context.scene, context.hertz, found.dissipated)
    hot = rise >= HOT
    text = f"flash temperature {rise:.3g} K, {'above' if hot else 'below'} {HOT:g} K"
    return PostSolveVerdict(hot, f"{text}: friction and yield stress fall with it" if hot else text)


def _known(context: Context) -> bool:
    """Whether thermal constants are given, or each body has the modulus of a steel or an infinite
    one.
    """
    moduli = (part.young_modulus for part in context.scene.bodies.values())
    steel = all(math.isinf(each) or bodies.is_steel(each) for each in moduli)
    return steel or context.scene.heat.known


def decide_falling_friction(context: Context) -> Effect:
    """A coefficient that depends on slip or temperature is called for by friction.law, where bodies
    roll with friction. Raises SceneError where it cannot be simulated and is not switched off.
    """
    scene = context.scene
    friction, law = scene.friction, closed_forms.law(scene)
    if law is None or not context.decided["friction"].on:
        why = "nothing slips" if law else "friction.law is coulomb"
        return Effect(False, False, why, {"on": why})
    if friction.law == "temperature" and not _known(context):
        raise SceneError("friction.law", f"temperature is not allowed: {UNKNOWN}")
    _refuse_beyond_grids(context, "falling_friction", "friction.law", friction.law)
    static = interface.friction_coefficient(context)
    half = f"with slip ({friction.law}), half at {friction.slip_half or 0:g} mm/s"
    what = "with the temperature" if friction.table else half
    if friction.memory is None and not friction.table:
        what += "; no friction.memory is given: it follows along the length of a cell"
    why = f"the coefficient goes from {static:g} to {law.kinetic:g} {what}"
    return Effect(True, True, f"{why}; costs {cost.LAW:g} s; left out, it is {static:g}")


def decide_layer(context: Context) -> Effect:
    """An elastic layer is called for by its thickness and modulus, where there is friction. Raises
    SceneError where it cannot be simulated and is not switched off.
    """
    friction = context.scene.friction
    thick, modulus = friction.layer_thickness, friction.layer_modulus
    if thick is None or modulus is None or not context.decided["friction"].on:
        why = "nothing slips" if thick else "no friction.layer_thickness is given"
        return Effect(False, False, why, {"on": why})
    _refuse_beyond_grids(context, "layer", "friction.layer_thickness", f"{thick:g} mm")
    why = f"it shears by {thick / modulus:.3g} mm/MPa; left out, creep curves begin steeper"
    return Effect(True, True, f"{why}; no price")


def _refuse_beyond_grids(context: Context, effect: str, key: str, value: str) -> None:
    """Raises SceneError for a key where tractions are not found on grids of half-spaces, unless the
    effect is switched off.
    """
    missing = beyond_grids(context, layer=effect == "layer")
    if missing and context.scene.effects.state(effect) != "off":
        flat = "" if context.contact.plane else "effects.finite_bodies=off or "
        text = f"{value} is not allowed with {missing}"
        raise SceneError(key, f"{text}; give {flat}effects.{effect}=off")
