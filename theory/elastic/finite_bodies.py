"""What a half-space leaves out of a contact: how far finite bodies bend its surface otherwise.

Under a force F, a body that ends a distance away moves by that of a half-space and a smooth rest.
Over the patch the rest is a rigid motion, which changes the approach alone, and a curvature, which
adds to the relative curvature of the bodies. Lengths in mm.
"""

import math

import numpy as np
from scipy.integrate import quad
from scipy.special import elliprd, elliprf

REACH = 40.0  # of the integrals below; the integrands fall as exp(-2 u)


def held_below(depth: float, poisson: float) -> float:
    """Curvature (1/mm^3, over F (1 - nu^2)/(pi E)) of the surface that the rigid base under a layer
    adds, under a point force F on a layer of thickness `depth` (mm) bonded to that base.

    The layer moves by F (1 - nu^2)/(pi E H) int L(u) J0(u r/H) du, with H the thickness, L = (2 k
    sinh 2u - 4u) / (2 k cosh 2u + 1 + k^2 + 4 u^2) and k = 3 - 4 nu (P. Meijers, Applied Scientific
    Research 18, 1968; L = 1 is Boussinesq's half-space), so the curvature is int (1 - L) u^2 du /
    (2 H^3).
    """
    k = 3 - 4 * poisson

    def rest(u: float) -> float:
        """The integrand (1 - L(u)) u^2."""
        e = math.exp(-2 * u)  # scaled by it, nothing overflows
        above = k * (1 - e * e) - 4 * u * e
        below = k * (1 + e * e) + (1 + k * k + 4 * u * u) * e
        return (1 - above / below) * u * u

    return float(quad(rest, 0, REACH)[0]) / (2 * depth**3)


def free_edge(distance: float, poisson: float) -> float:
    """Curvature (1/mm^3, over F (1 - nu^2)/(pi E)) of the surface that a free edge at right angles
    adds, under a force F at a distance D (mm) from the edge: psi/(4 D^3).

    The edge acts as a force psi F at the mirrored place; psi is that of `image` (R. Guilbault,
    Journal of Tribology 133, 2011).
    """
    return image(poisson) / (4 * distance**3)


def image(poisson: float) -> float:
    """Force at the mirrored place that stands for a free edge, over the real force: Guilbault's psi
    = 1.29 - (0.08 - 0.5 nu)/(1 - nu).
    """
    return 1.29 - (0.08 - 0.5 * poisson) / (1 - poisson)


def own_curvatures(a: float, b: float) -> tuple[float, float]:
    """Curvatures of the surface along a and along b under Hertz's pressure on an ellipse, over
    F/(pi E*): R_D(0, b^2, a^2) and R_D(0, a^2, b^2), 1/mm^3 (from Johnson, Contact Mechanics,
    3.41). a, b: semi-axes, mm.
    """
    return float(elliprd(0, b * b, a * a)), float(elliprd(0, a * a, b * b))


def own_approach(a: float, b: float) -> float:
    """Approach of two half-spaces under Hertz's pressure on an ellipse, over F/(pi E*): 3/2 R_F(0,
    a^2, b^2), 1/mm; semi-axes a and b in mm.
    """
    return 1.5 * float(elliprf(0, a * a, b * b))


def change(curvature: float, a: float, b: float) -> float:
    """Relative rise of the largest pressure, and fall of the area, by an additional curvature.

    curvature: over F/(pi E*), 1/mm^3, a mean of the bodies weighted by their compliance. a, b:
        semi-axes of the patch, mm. Largest pressure and area change with the power 2/3 and -2/3 of
        both curvatures together; the larger ratio of additional to own curvature is taken for both
        directions.
    """
    ratio = curvature / min(own_curvatures(a, b))
    return float(np.expm1(2 / 3 * np.log1p(ratio)))
