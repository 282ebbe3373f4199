"""Effects between the surfaces: friction, its heat, friction that falls, an elastic layer.

Friction acts in a shift from rest or in steady rolling.
"""

import math
from collections.abc import Iterator

from railhead.contact import closed_forms, wheelset_kinematics
from railhead.planning import cost
from railhead.planning.context import Context, Effect, PostSolveVerdict
from railhead.postprocess.findings import Findings
from railhead.scene import bodies
from railhead.scene.sections import refuse_first

OMITTED = "not simulated: roughness, dynamics (docs/limits.md)"
HOT = 100.0  # K, least rise of the surfaces that matters where it is not simulated (a choice)
UNKNOWN = "flash temperature not known for this material; give the constants of [heat]"


def decide_friction(context: Context) -> Effect:
    """Friction is called for by a tangential force, by creepage or spin, or between bodies whose
    surfaces slip when pressed together: Dundurs' beta != 0 (Johnson, Contact Mechanics, 5.1 and
    5.4).
    With a coefficient of 0 it is not called for, and 'on' is refused, as where half-spaces answer
    and cannot have it. Raises SceneError for a force that would slide, a motion that a section does
    not have or without friction, and linear cells.
    """
    scene = context.scene
    coefficient, largest = friction_coefficient(context), scene.friction.largest
    if scene.effects.falling_friction == "off":
        pairs = () if scene.friction.table else scene.friction.pairs
        largest = max(mu for _, mu in ((0.0, coefficient), *pairs))
    table, along, across = scene.tangential_forces
    # On an inclined contact a force across carries a part of the load, or adds to it.
    normal = max(context.hertz.load + across * math.tan(context.contact.touch.angle), 0.0)
    force, most = math.hypot(along, across), largest * normal
    refuse_first(
        (
            force and force >= most and (scene.load is not None or not most),
            f"{table}.force_{'along' if along else 'across'}",
            f"{force:g} N would slide; give less than friction.coefficient times the normal force, "
            f"{most:g} N",
        ),
        *_beyond_the_section(context),
        (
            scene.rolling.prescribed and not largest and scene.rolling.passes is None,
            "rolling",
            "has no use with a friction.coefficient of 0; give one above 0, or leave it out",
        ),
    )
    called, why = _slips(context, force, coefficient * normal)
    locks = scene.mesh.linear and context.decided["finite_bodies"].on
    refuse_first(
        (
            called and locks and scene.effects.friction != "off",
            "mesh.order",
            "1 is not allowed with friction: on linear tetrahedra and triangles forces are 0.03 to "
            "0.14 mu N off; give 2",
        )
    )
    if not coefficient:
        return Effect(called, called, why, {"on": "friction.coefficient is 0"})
    if called and (missing := _beyond_half_spaces(context)):
        return Effect(True, False, f"{why}; {missing}", {"on": missing})
    return Effect(called, called, why)


def _slips(context: Context, force: float, limit: float) -> tuple[bool, str]:
    """Whether friction has an effect, and why. force: tangential force that is given, N; limit:
    coefficient of friction at the first contact times the normal force, N.
    """
    scene = context.scene
    if scene.rolling.prescribed:
        if not friction_coefficient(context):
            return False, "friction.coefficient = 0: it rolls freely"
        if not scene.rolling.from_wheelset:
            return True, f"the wheel rolls; {OMITTED}"
        return True, f"the wheel rolls as the wheelset stands, {context.wheelset.why}; {OMITTED}"
    if force:
        return True, f"a tangential force of {force:g} N, {force / limit:.3g} of mu N"
    untouched = "no tangential force and no creepage"
    if not unlike(context):
        return False, f"{untouched}, and Dundurs' beta = 0 leaves the surfaces unsheared"
    if not friction_coefficient(context):
        return False, f"{untouched}, and friction.coefficient = 0"
    beta = context.tangential_pair.dundurs_beta
    return True, f"it resists the slip of unlike materials, Dundurs' beta = {beta:.3g}"


def _beyond_the_section(context: Context) -> Iterator[tuple[object, str, str]]:
    """Rules, as of `refuse_first`, against a tangential motion or force that a plane section does
    not have: rolling or a motion along in a section across, or a motion across in a section along.
    Without the motion of a wheelset, which `wheelset_creepage` refuses.
    """
    scene, plane = context.scene, context.contact.plane
    along, across = scene.asymmetric_friction
    rolls = scene.rolling.prescribed
    table = "rolling" if rolls else "friction"
    text = "is not allowed: the scene is a section"
    yield plane == "yz" and rolls, "rolling", f"{text} across the rail"
    yield plane == "yz" and along, table, f"along the rail {text} across it"
    across = across and not scene.rolling.from_wheelset
    yield plane == "xz" and across, table, f"across the rail {text} along it"


def _beyond_half_spaces(context: Context) -> str:
    """Reason why half-spaces cannot answer the friction of a scene where finite bodies are off;
    empty where they can: bodies that roll, and solid half-spaces of like materials under a force.
    """
    scene = context.scene
    if context.decided["finite_bodies"].on or scene.rolling.prescribed:
        return ""
    if grows(context):
        return "half-spaces do not follow unlike bodies that slip while the patch grows"
    if context.contact.solid_half_space:
        return ""
    return "the shift of bodies that end, or of a line, depends on where they are held"


def grows(context: Context) -> bool:
    """Whether friction acts while the patch grows: unlike materials without rolling."""
    return unlike(context) and not context.scene.rolling.prescribed


def friction_coefficient(context: Context) -> float:
    """Static coefficient of friction at the first contact."""
    scene = context.scene
    return float(scene.friction.at(context.contact.touch.angle, scene.heat.bulk))


def unlike(context: Context) -> bool:
    """Whether the materials as simulated differ so that frictionless bodies slip when pressed
    together. A body that does not deform has an infinite modulus.
    """
    return not context.tangential_pair.like


def beyond_grids(context: Context, *, layer: bool = False) -> str:
    """Name of the kind of bodies of a scene that can have no heat, no law of friction but Coulomb's
    and no layer, because their tractions are found neither along lines in rolling direction nor on
    grids of half-spaces; empty for all others. layer: whether a layer is asked for, which sections
    do not have.
    """
    decided = context.decided
    if decided["passes"].on:
        return "rolling.passes"
    if not decided["finite_bodies"].on:
        return ""
    if context.contact.plane:
        return "a section in two dimensions" if layer else ""
    if unlike(context):
        return "meshed bodies of unlike materials"
    return "bodies that yield" if decided["plasticity"].on else ""


def decide_heat(context: Context) -> Effect:
    """Surface temperatures are called for where bodies roll at a given speed with friction. Where
    they cannot be simulated, they are called for from a rise of 100 K (HOT) on.
    """
    scene, hertz = context.scene, context.hertz
    speed, rolling = scene.rolling.speed, scene.rolling
    if speed is None or not context.decided["friction"].on:
        return Effect.absent("nothing slips" if speed else "no rolling.speed is given")
    if not _known(context):
        return Effect.absent(UNKNOWN)
    missing = beyond_grids(context)
    if not missing:
        return Effect(True, True, "it rolls with friction at a given speed; no price")
    refused = {"on": f"no temperature is simulated with {missing}"}
    if rolling.force_along or rolling.force_across:
        return Effect(False, False, "the creepage of a given force is known afterwards", refused)
    moves = wheelset_kinematics.creepage(context.contact)
    slip = math.hypot(moves.along, moves.across) + abs(moves.spin) * max(hertz.half_lengths)
    most = closed_forms.flash_rise(scene, hertz, friction_coefficient(context) * hertz.load * slip)
    why = f"flash temperature up to {most:.3g} K where all slips, {HOT:g} K matter"
    return Effect(most >= HOT, False, f"{why}; {refused['on']}", refused)


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
        return Effect.absent("nothing slips" if law else "friction.law is coulomb")
    unknown = friction.law == "temperature" and not _known(context)
    refuse_first((unknown, "friction.law", f"temperature is not allowed: {UNKNOWN}"))
    _refuse_beyond_grids(context, "falling_friction", "friction.law", friction.law)
    why = f"friction.law is {friction.law}: the coefficient goes to {law.kinetic:g}"
    static = friction_coefficient(context)
    return Effect(True, True, f"{why}; costs {cost.LAW:g} s; left out, it is {static:g}")


def decide_layer(context: Context) -> Effect:
    """An elastic layer is called for by its thickness and modulus, where there is friction. Raises
    SceneError where it cannot be simulated and is not switched off.
    """
    friction = context.scene.friction
    thick, modulus = friction.layer_thickness, friction.layer_modulus
    if thick is None or modulus is None or not context.decided["friction"].on:
        return Effect.absent("nothing slips" if thick else "no friction.layer_thickness is given")
    _refuse_beyond_grids(context, "layer", "friction.layer_thickness", f"{thick:g} mm")
    why = f"it shears by {thick / modulus:.3g} mm/MPa; left out, creep curves begin steeper"
    return Effect(True, True, f"{why}; no price")


def _refuse_beyond_grids(context: Context, effect: str, key: str, value: str) -> None:
    """Raises SceneError for a key where tractions are not found on grids of half-spaces, unless the
    effect is switched off.
    """
    missing = beyond_grids(context, layer=effect == "layer")
    flat = "" if context.contact.plane else "effects.finite_bodies=off or "
    text = f"{value} is not allowed with {missing}; give {flat}effects.{effect}=off"
    refuse_first((missing and context.scene.effects.state(effect) != "off", key, text))
