"""Effects of repeated rolling over a rail that yields: the passes, and what they leave out."""

from __future__ import annotations

import math

import numpy as np

from railhead.contact import wheelset_kinematics
from railhead.planning.context import Context, Effect
from railhead.planning.effects import interface
from railhead.scene.scene import Rail
from railhead.scene.sections import refuse_first
from railhead.theory import damage
from railhead.theory.elastic.line import LineContact
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
OFF = "rolling.passes is not given"
KEY = "rolling.passes"


def decide_passes(context: Context) -> Effect:
    """Passes are called for where something rolls and yield is called for, and simulated where
    rolling.passes is given.

    SceneError: passes over a rail that does not deform or has no yield stress, in a section across
    the rail, and where the flow curve of the rail has no steady answer.
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
    hardened = _flow_stress(scene.rail, LARGEST_STRAIN) / scene.rail.first_yield
    share = traction(context) if isinstance(context.hertz, LineContact) else 0.0
    bearable = BORNE / share if share else math.inf
    steady = min(STEADY[scene.rolling.pressure], bearable) * hardened
    beside = f" at Q/P = {share:.2g}" if share else ""
    text = f"{given}p0/k is {ratio:.3g}, and the rail's flow curve has no steady answer above"
    instead = "give a larger rail.hardening_modulus, or a smaller load"
    refuse_first((ratio > steady, KEY, f"{text} {steady:.3g}{beside}; {instead}"))
    return Effect(yields, True, f"{count} passes; {why}")


def _refuse_what_has_no_passes(context: Context, given: str) -> None:
    """Raise SceneError for what passes cannot simulate: a rigid rail, one without yield stress, a
    wheel that only its effect makes rigid, a force of [friction], several patches, and a section
    across the way; given: the beginning of the message.
    """
    friction, wheel, elastic = context.scene.friction, context.scene.wheel, context.elastic
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
            not isinstance(elastic, str) and len(elastic.patches) > 1,
            "there are several patches; passes know one; give another wheelset.shift or profile",
        ),
        (
            0 not in context.contact.slips,
            "the scene is a section across the way; give a wheel that rolls, and of a circular "
            "patch effects.axisymmetry=off",
        ),
    )
    refuse_first(*((broken, KEY, f"{given}{text}") for broken, text in rules))


def decide_plasticity_wheel(context: Context) -> Effect:
    """Yield of the wheel in passes, which know the rail's alone: called for where the largest
    elastic von Mises stress passes the wheel's yield stress.
    """
    refused = {"on": "passes know the yield of the rail alone"}
    wheel = context.scene.wheel
    if not context.decided["passes"].on or "wheel" not in context.stressed or not wheel.yields:
        return Effect(False, False, "no passes, or a wheel without a yield stress", refused)
    stress, limit = context.von_mises(wheel.poisson_ratio), wheel.first_yield
    verb = "passes" if stress > limit else "stays below"
    why = f"von Mises {stress:.4g} MPa {verb} the yield {limit:.4g} MPa of the wheel"
    return Effect(stress > limit, False, f"{why}, which passes take as elastic", refused)


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
    scene, hertz, elastic = context.scene, context.hertz, context.elastic
    poisson = scene.rail.poisson_ratio
    shear = scene.rail.first_yield / math.sqrt(3)
    p0 = hertz.p0 if isinstance(elastic, str) else elastic.max_pressure
    ratio, share = p0 / shear, traction(context)
    first = math.sqrt(3) * p0 / context.von_mises(poisson)
    if isinstance(hertz, LineContact):
        limit, beside = line_limit(context), f" at Q/P = {share:.2g}"
    else:
        limit = min(damage.ellipse_limit(hertz.a / hertz.b), 2 * first)
        beside = f" without tractions, and less with Q/P up to {share:.2g}"
    text = f"p0/k = {ratio:.3g} of the elastic pressure, first yield {first:.3g}, shakedown limit "
    return ratio, f"{text}{limit:.3g}{beside if share else ''}"


def line_limit(context: Context) -> float:
    """Largest pressure p0 over the rail's yield stress in shear k, before any hardening, up to
    which a line contact of a scene shakes down, by Melan's theorem. A rail that hardens
    kinematically alone counts with its back stress, others without hardening.
    """
    scene, share = context.scene, traction(context)
    kinematic = moves(scene.rail)
    friction = interface.friction_coefficient(context) if share else 0.0
    poisson = scene.rail.poisson_ratio
    return damage.shakedown_limit(friction, poisson, share, kinematic=kinematic)


def moves(rail: Rail) -> bool:
    """Whether all hardening of a rail that yields moves its yield surface."""
    back, _, (most, _) = rail.law
    fraction = 1.0 if back else rail.kinematic_fraction
    return rail.hardens and fraction == 1 and not most


def _flow_stress(rail: Rail, strain: float) -> float:
    """Stress of the flow curve of a rail that yields at a plastic strain, MPa; of recalled back
    stresses as by Armstrong and Frederick, whose rule is the softest.
    """
    strains, stresses = zip(*rail.curve, strict=True)
    back, _, (most, speed) = rail.law
    grown = sum(-c * math.expm1(-g * strain) / g if g else c * strain for c, g in back)
    grown += (rail.hardening_modulus or 0.0) * strain - most * math.expm1(-speed * strain)
    return float(np.interp(strain, strains, stresses)) + grown
