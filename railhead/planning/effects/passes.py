"""Effects of repeated rolling over a rail that yields: the passes, and what they leave out."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from railhead.contact import wheelset_kinematics
from railhead.contact.crossing import HeadContact
from railhead.planning.context import Context, Effect
from railhead.planning.effects import interface
from railhead.scene.bodies import Rail, Wheel
from railhead.scene.sections import refuse_first
from railhead.theory import damage
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction import sliding
from railhead.theory.friction.partial_slip import carter_share

STEADY = {"hertz": 5.5, "contact": 6.0}  # largest p0/k that perfect plasticity has an answer for
# Traction over k of a line that perfect plasticity has an answer for. No surface carries more than
# k; between its points a mesh bears a little more: at 1.1 k, six elements on the half width and a
# coefficient of 0.4 a pass strains by 0.2, and 1.25 k does not converge.
BORNE = 1.1
# Plastic strain at which hardening must carry a load beyond that: strains are taken as small. Of a
# line under a kept p0/k of 5.8 a modulus of 800 MPa fails and 1500 MPa converges (this asks for 880
# MPa); in contact at 6.9 it is 2000 and 6000 MPa (2500 MPa).
LARGEST_STRAIN = 0.03
ASIDE = 2.2  # half lengths across from the middle of a patch: up to there yield is followed
OFF = "rolling.passes is not given"
KEY = "rolling.passes"


def decide_passes(context: Context) -> Effect:
    """Passes are called for where something rolls and yield is called for, and simulated where
    rolling.passes is given.

    SceneError: passes that `_refuse_what_has_no_passes` or `_refuse_unsteady` refuses.
    """
    scene = context.scene
    yields, count = context.decided["plasticity"].called_for, scene.rolling.passes
    if count is None and not scene.rolling.prescribed:
        return Effect(False, False, "nothing rolls", {"on": OFF})
    why, ratio = "the rail has no yield stress", 0.0
    if scene.rail.yields:
        ratio, why = _indicator(context)
    if count is None:
        called = yields and scene.rail.yields and scene.effects.plasticity != "off"
        if called:
            why += "; give rolling.passes"
        return Effect(called, False, why, {"on": OFF})
    if scene.effects.passes == "off":
        return Effect(yields, True, why)
    given = f"{count} is not allowed: "
    _refuse_what_has_no_passes(context, given)
    _refuse_unsteady(context, scene.rail, ratio)
    return Effect(yields, True, f"{count} passes; {why}")


def _refuse_unsteady(context: Context, body: Rail | Wheel, ratio: float) -> None:
    """Raise SceneError where the flow curve of a body has no steady answer to a pressure p0; ratio:
    p0 over its yield stress in shear.
    """
    rolling, name = context.scene.rolling, "rail" if isinstance(body, Rail) else "wheel"
    hardened = _flow_stress(body, LARGEST_STRAIN) / body.first_yield
    share = traction(context) if isinstance(context.hertz, LineContact) else 0.0
    steady = min(STEADY[rolling.pressure], BORNE / share if share else math.inf) * hardened
    beside = f" at Q/P = {share:.2g}" if share else ""
    text = f"{rolling.passes} is not allowed: p0/k is {ratio:.3g}, and the {name}'s flow curve has "
    instead = f"give a larger {name}.hardening_modulus, or a smaller load"
    answer = f"no steady answer above {steady:.3g}{beside}"
    refuse_first((ratio > steady, KEY, f"{text}{answer}; {instead}"))


def _refuse_what_has_no_passes(context: Context, given: str) -> None:
    """Raise SceneError for what passes cannot simulate: a rigid rail, one without yield stress, a
    wheel of finite modulus that its effect makes rigid, a force of [friction], patches whose
    regions of yield overlap, a rail whose section changes along it, and a section in which nothing
    rolls; given: the beginning of the message.
    """
    friction, wheel, elastic = (
        context.scene.friction,
        context.scene.wheel,
        context.half_spaces.elastic,
    )
    rules = (
        ("rail" not in context.deformable, "the rail is rigid; give effects.deformable_rail=auto"),
        (
            not context.scene.rail.yields,
            "the rail has no yield stress; give rail.steel or rail.yield_stress",
        ),
        (
            "wheel" not in context.deformable and math.isfinite(wheel.young_modulus),
            "the wheel is rigid by effects.deformable_wheel; give wheel.young_modulus=inf",
        ),
        (
            friction.force_along or friction.force_across,
            "a force of [friction] shifts a wheel that rests; give it in [rolling]",
        ),
        (
            isinstance(context.contact, HeadContact),
            "the rail has sections, so nothing is steady; give rail.profile of the place",
        ),
        (
            not isinstance(elastic, str) and _overlap(elastic.patches),
            "two patches roll over the same steel; give another wheelset.shift or profile",
        ),
        (
            0 not in context.contact.slips,
            "the scene is a section across the way; give a wheel that rolls, and of a circular "
            "patch effects.axisymmetry=off",
        ),
    )
    refuse_first(*((broken, KEY, f"{given}{text}") for broken, text in rules))


def _overlap(patches: Sequence[PatchSolution]) -> bool:
    """Whether the strips of two patches overlap in which plastic strain is followed (ASIDE)."""
    strips = sorted(
        (s - ASIDE * half, s + ASIDE * half)
        for s, half in ((each.centroid[1], each.half_extents[1]) for each in patches)
    )
    return any(one[1] > other[0] for one, other in pairwise(strips))


def decide_plasticity_wheel(context: Context) -> Effect:
    """Yield of the wheel in passes: called for, and simulated, where the largest elastic von Mises
    stress passes the wheel's yield stress; with tractions that of a patch that slips everywhere.

    SceneError: the flow curve of the wheel has no steady answer.
    """
    wheel, off = context.scene.wheel, context.scene.effects.plasticity_wheel == "off"
    if not context.decided["passes"].on or "wheel" not in context.stressed or not wheel.yields:
        return Effect.absent("no passes, or a wheel without a yield stress")
    stress, limit = context.von_mises["wheel"], wheel.first_yield
    if traction(context):
        slipping = interface.friction_coefficient(context), wheel.poisson_ratio
        peaks = sliding.peaks(context.hertz, *slipping).values()
        stress = max(stress, *(each.von_mises for each in peaks))
    verb = "passes" if stress > limit else "stays below"
    if stress > limit and not off:
        _refuse_unsteady(context, wheel, math.sqrt(3) * _largest(context) / limit)
    why = f"von Mises {stress:.4g} MPa {verb} the yield {limit:.4g} MPa of the wheel"
    return Effect(stress > limit, stress > limit, why)


def traction(context: Context) -> float:
    """Tangential over normal force in rolling: of given forces, at most the coefficient of
    friction; without them in a line contact that of Carter for the creepage (Johnson, Contact
    Mechanics, 8.6), else the coefficient. 0 without friction.
    """
    scene, hertz = context.scene, context.hertz
    coefficient = interface.friction_coefficient(context)
    if not (coefficient and scene.rolling.prescribed and context.decided["friction"].on):
        return 0.0
    _, along, across = scene.tangential_forces
    if along or across:
        return min(math.hypot(along, across) / hertz.load, coefficient)
    if not isinstance(hertz, LineContact):
        return coefficient
    creepage = abs(wheelset_kinematics.creepage(context.contact).along)
    return coefficient * carter_share(hertz, coefficient, creepage)


def _indicator(context: Context) -> tuple[float, str]:
    """Largest elastic pressure p0 over the rail's yield stress in shear k before any hardening, and
    a sentence that holds it against first yield and the shakedown limit.
    """
    scene, hertz = context.scene, context.hertz
    shear, p0 = scene.rail.first_yield / math.sqrt(3), _largest(context)
    ratio, share = p0 / shear, traction(context)
    first = math.sqrt(3) * p0 / context.von_mises["rail"]
    if isinstance(hertz, LineContact):
        limit, beside = line_limit(context, scene.rail), f" at Q/P = {share:.2g}"
    else:
        limit = min(damage.ellipse_limit(hertz.a / hertz.b), 2 * first)
        beside = f" without tractions, and less with Q/P up to {share:.2g}"
    text = f"p0/k = {ratio:.3g} of the elastic pressure, first yield {first:.3g}, shakedown limit "
    return ratio, f"{text}{limit:.3g}{beside if share else ''}"


def _largest(context: Context) -> float:
    """Largest elastic pressure p0, MPa."""
    elastic = context.half_spaces.elastic
    return context.hertz.p0 if isinstance(elastic, str) else elastic.max_pressure


def line_limit(context: Context, body: Rail | Wheel) -> float:
    """Largest pressure p0 over a body's yield stress in shear k, before any hardening, up to which
    a line contact of a scene shakes down, by Melan's theorem. A body that hardens kinematically
    alone counts with its back stress, others without hardening.
    """
    share, kinematic = traction(context), moves(body)
    friction = interface.friction_coefficient(context) if share else 0.0
    return damage.shakedown_limit(friction, body.poisson_ratio, share, kinematic=kinematic)


def moves(body: Rail | Wheel) -> bool:
    """Whether all hardening of a body that yields moves its yield surface."""
    back, _, (most, _) = body.law
    fraction = 1.0 if back else body.kinematic_fraction
    return body.hardens and fraction == 1 and not most


def _flow_stress(body: Rail | Wheel, strain: float) -> float:
    """Stress of the flow curve of a body that yields at a plastic strain, MPa; of recalled back
    stresses as by Armstrong and Frederick, whose rule is the softest.
    """
    strains, stresses = zip(*body.curve, strict=True)
    back, _, (most, speed) = body.law
    grown = sum(-c * math.expm1(-g * strain) / g if g else c * strain for c, g in back)
    grown += (body.hardening_modulus or 0.0) * strain - most * math.expm1(-speed * strain)
    return float(np.interp(strain, strains, stresses)) + grown
