"""Tangential traction: recognised, not simulated."""

from __future__ import annotations

from railhead.planning.effects.base import NOT_SIMULATED, After, Context, Effect
from railhead.postprocess.findings import Findings
from railhead.theory import hertz

NO_MISMATCH = 1e-9  # |beta| that is rounding


def decide(context: Context) -> Effect:
    """Called for by a tangential load, or by friction between bodies whose surfaces slip when
    they are pressed together: Dundurs' beta != 0 (Johnson, Contact Mechanics, 5.1 and 5.4)."""
    scene = context.scene
    rail, wheel, asked = scene.rail, scene.wheel, scene.friction
    beta = hertz.dundurs_beta(
        rail.young_modulus, rail.poisson_ratio, wheel.young_modulus, wheel.poisson_ratio
    )
    untouched = "no tangential load"
    if asked.tangential_load:
        called, why = True, f"a tangential load of {asked.tangential_load:g} N"
    elif abs(beta) < NO_MISMATCH:
        called, why = False, f"{untouched}, and Dundurs' beta = 0 leaves the surfaces unsheared"
    elif not asked.coefficient:
        called, why = False, f"{untouched}, and friction.coefficient = 0"
    else:
        called, why = True, f"it resists the slip of unlike materials, Dundurs' beta = {beta:.3g}"
    return Effect(called, False, why, {"on": NOT_SIMULATED})


def check(context: Context, effect: Effect, found: Findings) -> After | None:
    """It does not depend on the solution."""
    return After(True, f"{effect.why}: the answer is frictionless") if effect.called_for else None
