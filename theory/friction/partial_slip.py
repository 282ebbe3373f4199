"""Exact solutions of partial slip between like materials, as closed forms.

Carter 1926: a line contact that rolls along +x and drives. x = 0 is the middle of the strip, x = +w
its leading edge (Johnson, Contact Mechanics, 8.3). Creepage and force have one sign (see
`theory.friction.rolling`). The strip has the half width w, load P and relative curvature 1/R.

Cattaneo 1938, Mindlin 1949: a tangential force Q on a pressed contact that does not roll, with the
traction along the force alone (its small part across is neglected: below 1 % in the displacement).
Q grows from 0 at a constant load N; mu N is the limit (Mindlin and Deresiewicz 1953; Johnson, 7.2
and 7.4). Forces are in N, lengths in mm.
"""

import math

from scipy.special import elliprd, elliprf

from railhead.theory.elastic.hertz import Strip


def carter_share(strip: Strip, friction: float, creepage: float) -> float:
    """Force of the wheel on the rail along x over mu times normal force, -1 to 1, of Carter's strip
    that rolls at a creepage xi: 1 - (1 - |xi| R/(mu w))^2 with the sign of xi. Beyond the smallest
    creepage of full slip, mu w/R, it is 1 or -1. friction: coefficient mu.
    """
    part = min(abs(creepage) / (friction * strip.half_width * strip.curvature), 1.0)
    return math.copysign(part * (2 - part), creepage)


def initial_compliance(
    a: float, b: float, shear_modulus: float, poisson: float
) -> tuple[float, float]:
    """Tangential approach over force, mm/N, for a force along a and for one along b, of bodies that
    stick on the whole ellipse.

    a, b: semi-axes, mm; shear_modulus, poisson: G (MPa) and nu of both bodies. The traction Q/(2 pi
        a b)/sqrt(1 - x^2/a^2 - y^2/b^2) shifts the ellipse as a whole by Q/(pi G a b) ((1 - nu) I +
        nu I_x), where I and I_x integrate 1 and cos^2 over sqrt(cos^2/a^2 + sin^2/b^2) from 0 to
        pi/2, here in Carlson's forms (Mindlin 1949); (2 - nu)/(4 G a) on a circle.
    """
    p, q = 1 / a**2, 1 / b**2
    whole = elliprf(0, p, q)
    parts = q / 3 * elliprd(0, p, q), p / 3 * elliprd(0, q, p)
    scale = 1 / (math.pi * shear_modulus * a * b)
    along, across = (scale * ((1 - poisson) * whole + poisson * part) for part in parts)
    return float(along), float(across)


def ellipse_stick_ratio(share: float) -> float:
    """Axes of the inner ellipse that sticks over those of the patch, (1 - share)^(1/3), of a shift
    (Mindlin). share: Q/mu N, tangential force over its limit. ValueError: outside 0..1.
    """
    return math.cbrt(_rest(share))


def ellipse_shift(compliance: float, limit: float, share: float) -> float:
    """Tangential approach, mm, under a force that increased from 0 (Johnson, 7.42).

    compliance: tangential approach over force where the whole patch sticks, mm/N. limit: mu N, N.
    share: force over the limit. ValueError: outside 0..1.
    """
    return 1.5 * compliance * limit * (1 - _rest(share) ** (2 / 3))


def strip_stick_ratio(share: float) -> float:
    """Half width that sticks over the half width of a strip: sqrt(1 - share), share = Q/mu P (Q
    tangential force, P normal force), of a shift (Cattaneo) and of rolling (Carter). ValueError:
    the share is outside 0..1.
    """
    return math.sqrt(_rest(share))


def _rest(share: float) -> float:
    """1 - share. ValueError: the share is outside 0..1."""
    if not 0 <= share <= 1:
        raise ValueError(f"the share of mu N must be within 0..1, got {share}")
    return 1 - share
