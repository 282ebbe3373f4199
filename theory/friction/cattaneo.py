"""A tangential force on a pressed contact that does not roll: Cattaneo and Mindlin.

Like materials, traction along the force alone (its small part across is neglected: below 1 % in the
displacement). The force Q grows from 0 at a constant load N; mu N is the limit. Forces are in N,
lengths in mm, energies in N mm. Sources: Cattaneo 1938, Mindlin 1949, Mindlin and Deresiewicz
1953; Johnson, Contact Mechanics, 7.2 and 7.4.
"""

import math
from dataclasses import dataclass

from scipy.special import elliprd, elliprf

from railhead.theory.elastic.hertz import Ellipse


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


@dataclass(frozen=True)
class CattaneoMindlin:
    """A Hertz ellipse under a tangential force without rolling: an inner ellipse sticks, the rest
    slips.

    limit: largest tangential force, friction coefficient times load, N.
    compliance: tangential approach over force where the whole patch sticks, mm/N.
    """

    limit: float
    compliance: float

    def stick_ratio(self, force: float) -> float:
        """Axes of the ellipse that sticks over those of the patch, (1 - Q/mu N)^(1/3), under a
        force Q (N). ValueError: a force outside 0..mu N.
        """
        return math.cbrt(self._rest(force))

    def approach(self, force: float) -> float:
        """Tangential approach, mm, under a force (N) that increased from 0 (Johnson, 7.42).
        ValueError: a force outside 0..mu N.
        """
        return self._scale * (1 - self._rest(force) ** (2 / 3))

    @property
    def _scale(self) -> float:
        """Tangential approach at full slip, mm."""
        return 1.5 * self.compliance * self.limit

    def _rest(self, force: float) -> float:
        """1 - Q/mu N for a force Q (N). ValueError: a force outside 0..mu N."""
        if not 0 <= force <= self.limit:
            raise ValueError(f"force must be within 0..mu N = {self.limit} N, got {force}")
        return 1 - force / self.limit


def ellipse(
    contact: Ellipse, friction: float, shear_modulus: float, poisson: float, *, across: bool
) -> CattaneoMindlin:
    """Cattaneo and Mindlin's contact of bodies of the same material under Hertz's pressure.

    friction: coefficient; shear_modulus, poisson: G (MPa) and nu of both bodies; across: whether
        the force acts along y instead of x.
    """
    compliance = initial_compliance(contact.a, contact.b, shear_modulus, poisson)
    return CattaneoMindlin(friction * contact.load, compliance[across])


def strip_stick_ratio(share: float, largest: float | None = None) -> float:
    """Half width that sticks over the half width of a strip: sqrt(1 - share), share = Q/mu P (Q
    tangential force, P load).

    largest: earlier larger share from which the force returned; the result is then sqrt(1 -
        (largest - share)/2), and the slip outside is reversed. ValueError: the share is outside
        0..1, or -largest..largest.
    """
    lower, upper = (0.0, 1.0) if largest is None else (-largest, min(largest, 1.0))
    if not lower <= share <= upper:
        raise ValueError(f"the share of mu P must be within {lower}..{upper}, got {share}")
    return math.sqrt(1 - (share if largest is None else (largest - share) / 2))
