"""Friction: a shift from rest, or steady rolling."""

from __future__ import annotations

import math

from railhead.contact import wheelset_kinematics
from railhead.contact.wheelset_kinematics import WheelsetCreepage
from railhead.planning.context import Context, Effect, PostSolveVerdict
from railhead.planning.references import closed_forms
from railhead.postprocess.findings import Findings
from railhead.scene.scene import SceneError
from railhead.scene.sections import refuse_first
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.friction import kalker
from railhead.theory.friction.rolling import Creepage

OMITTED = "not simulated: roughness, dynamics (docs/limits.md)"


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
    normal = context.hertz.load + across * math.tan(context.contact.touch.angle)
    limit, most = coefficient * max(normal, 0.0), largest * max(normal, 0.0)
    force = math.hypot(along, across)
    if force and force >= most and (scene.load is not None or not most):
        raise SceneError(
            f"{table}.force_{'along' if along else 'across'}",
            f"{force:g} N would slide; give less than friction.coefficient times the normal force, "
            f"{most:g} N",
        )
    wheelset = wheelset_creepage(context)
    _fits_the_section(context)
    untouched = "no tangential force and no creepage"
    if scene.rolling.prescribed and not largest and scene.rolling.passes is None:
        text = "has no use with a friction.coefficient of 0; give one above 0, or leave it out"
        raise SceneError("rolling", text)
    if not coefficient and scene.rolling.prescribed:
        called, why = False, "friction.coefficient = 0: it rolls freely"
    elif scene.rolling.prescribed:
        stands = f" as the wheelset stands, {wheelset.why}" if wheelset else ""
        called, why = True, f"the wheel rolls{stands}{_expected(context, limit)}; {OMITTED}"
    elif force:
        stick = max(0.0, 1 - force / limit) ** (1 / context.contact.load_power)
        why = (
            f"a tangential force of {force:g} N, {force / limit:.3g} of mu N: Cattaneo and Mindlin"
        )
        called, why = (
            True,
            f"{why}'s stick patch is {stick:.3g} times as long and wide as the patch",
        )
    elif not unlike(context):
        called, why = False, f"{untouched}, and Dundurs' beta = 0 leaves the surfaces unsheared"
    elif not coefficient:
        called, why = False, f"{untouched}, and friction.coefficient = 0"
    else:
        beta = context.tangential_pair.dundurs_beta
        called, why = True, f"it resists the slip of unlike materials, Dundurs' beta = {beta:.3g}"
    meshed = context.decided["finite_bodies"].on
    if called and meshed and scene.mesh.linear and scene.effects.friction != "off":
        raise SceneError(
            "mesh.order",
            "1 is not allowed with friction: on linear tetrahedra and triangles forces are 0.03 to "
            "0.14 mu N off; give 2",
        )
    if not coefficient:
        return Effect(called, called, why, {"on": "friction.coefficient is 0"})
    if called and (missing := _beyond_half_spaces(context)):
        return Effect(True, False, f"{why}; {missing}", {"on": missing})
    return Effect(called, called, why)


def _beyond_half_spaces(context: Context) -> str:
    """Reason why half-spaces cannot answer the friction of a scene where finite bodies are off;
    empty where they can: bodies that roll, and solid half-spaces of one material under a force.
    """
    scene, contact = context.scene, context.contact
    if context.decided["finite_bodies"].on or scene.rolling.prescribed:
        return ""
    if grows(context):
        return "half-spaces do not follow unlike bodies that slip while the patch grows"
    if scene.friction.cycle:
        return "half-spaces do not follow a cycle of forces"
    if contact.solid_half_space:
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


def check_friction(context: Context, effect: Effect, found: Findings) -> PostSolveVerdict | None:
    """Verdict whether friction was called for and left out; None where it was not called for."""
    if not effect.called_for:
        return None
    return PostSolveVerdict(
        not effect.on, "simulated" if effect.on else f"{effect.why}: the answer is frictionless"
    )


def wheelset_creepage(context: Context) -> WheelsetCreepage | None:
    """Creepage that follows from the wheelset where rolling.from_wheelset is true, else None.
    Raises SceneError for half-spaces and sections.
    """
    if not context.scene.rolling.from_wheelset:
        return None
    return wheelset_kinematics.wheelset_creepage(context.contact)


def creepage(context: Context) -> Creepage:
    """Creepage of the scene as of `wheelset_kinematics.creepage`; zero for a shift."""
    return wheelset_kinematics.creepage(context.contact)


def _expected(context: Context, limit: float) -> str:
    """Text with the tangential force of Kalker's linear theory for an ellipse over `limit` (N, mu
    times the normal force); empty for a line contact, given forces, and axis ratios outside 0.05
    to 20.
    """
    scene, ellipse = context.scene, context.hertz
    if not isinstance(ellipse, Ellipse) or scene.rolling.force_along or scene.rolling.force_across:
        return ""
    if not 0.05 <= ellipse.a / ellipse.b <= 20:
        return ""
    pair = closed_forms.tangential_pair(scene)
    linear = kalker.coefficients(ellipse.a / ellipse.b, pair.poisson)
    forces = linear.forces(ellipse.a, ellipse.b, pair.shear_modulus, creepage(context))
    share = math.hypot(*forces[:2]) / limit
    return f": Kalker's linear force is {share:.3g} mu N" + (
        ", most of the patch slips" if share > 1 else ""
    )


def _fits_the_section(context: Context) -> None:
    """Raises SceneError for a tangential motion or force that a plane section does not have:
    rolling or a motion along in a section across, or a motion across in a section along.
    """
    scene, plane = context.scene, context.contact.plane
    along, across = scene.asymmetric_friction
    rolls = scene.rolling.prescribed
    table = "rolling" if rolls else "friction"
    refuse_first(
        (
            plane == "yz" and rolls,
            "rolling",
            "is not allowed: the scene is a section across the rail",
        ),
        (
            plane == "yz" and along,
            table,
            "along the rail is not allowed: the scene is a section across it",
        ),
        (
            plane == "xz" and across,
            table,
            "across the rail is not allowed: the scene is a section along it",
        ),
    )
