"""Deformable bodies: a much stiffer one is rigid, and only its surface takes part."""

from __future__ import annotations

import math

from railhead.planning.context import Context, Effect

SHARE = 0.1  # share of the accuracy: compliance of a body that is taken as rigid


def decide(body: str, context: Context) -> Effect:
    """Whether a body ('rail' or 'wheel') deforms, by its share s of the compliance 1/E* = sum of
    (1 - nu^2)/E.
    Without that share, approach and pressure are off by 2/3 s and the semi-axes by s/3 (Johnson,
    Contact Mechanics, 4.22 to 4.24).
    """
    part = context.scene.bodies[body]
    if math.isinf(part.young_modulus):
        why = "E is infinite: only its surface takes part"
        return Effect(False, False, why, {"on": "E is infinite"})
    compliance = (1 - part.poisson_ratio**2) / part.young_modulus
    share = compliance * context.hertz.contact_modulus
    limit = SHARE * context.accuracy
    called = share >= limit
    text = f"it holds {share:.3g} of the compliance (1 - nu^2)/E"
    why = f"{text}, above {limit:.1g}" if called else f"{text}, below {limit:.1g}: rigid"
    return Effect(called, called, why, error=0.0 if called else share)
