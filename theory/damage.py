"""Damage of steel by rolling: shakedown, first yield, surface fatigue, wear.

Limits of repeated rolling are in p0/k, by Melan's theorem. p0: largest pressure; k: yield stress in
shear. Residual stresses of plane strain, rho_xx and rho_yy, depend on the depth alone. At every
depth the limit is that of the pair that makes the largest von Mises stress of a passage the least.
Below the surface it is p0 over the largest shear stress xz, which no residual stress takes over
(Johnson, Contact Mechanics, 9.2): p0 = 4 k without friction.
At the surface the stress along changes from the leading to the trailing edge, and one rho_yy does
not balance yy everywhere: 2.32 k at a coefficient of 0.4, where the shear stress alone has 2.5 k.
Of a circle Ponter, Hearle and Johnson (J. Mech. Phys. Solids 33, 1985) have 4.68 k without
friction.

T-gamma is the energy dissipated per rolled length.
"""

import math

import numpy as np
from scipy.optimize import brentq, minimize

from railhead.theory.array_types import Array
from railhead.theory.elastic import line
from railhead.theory.friction import sliding

LINE = 4.0  # shakedown limit p0/k of a line contact without friction
CIRCLE = 4.68  # shakedown limit p0/k of a circular patch without friction
DEPTHS, PLACES = 81, 161  # where the shear stress of a strip is looked for
#: Limits between wear regimes, T-gamma over the area of the patch, N/mm2: wheel R8T on rail UIC60
#: 900A, twin discs. Lewis and Dwyer-Joyce, Proc. IMechE J 218 (2004), as in src/usfd of
#: github.com/thiernodms/KPFASTSIMUSFD.
TWIN_DISC = (10.4, 77.2)
DRY = 0.2  # coefficient of friction below which these limits, of dry discs, say nothing: a choice
REGIMES = ("mild", "severe", "catastrophic")


def _strip(scale: float) -> line.LineContact:
    """Line contact whose half width is `scale` times that of STRIP, with the same curvature."""
    load = 1e-3 * scale**2
    return line.contact(1e-3, (1.0, 1.0), (0.0, 0.0), length=1.0, across=False, load=load)


STRIP = _strip(1.0)  # the reference strip: the limits are the same for all


def shakedown_limit(
    friction: float, poisson: float, used: float | None = None, *, kinematic: bool = False
) -> float:
    """Largest p0/k (largest pressure over yield stress in shear) at which a line contact shakes
    down, to 1e-3.

    friction: coefficient; poisson: Poisson's ratio.
    used: traction coefficient, tangential over normal force, not negative, in steady rolling with
        Carter's tractions; None: the whole patch slips.
    kinematic: whether the steel hardens kinematically without end: its back stress shifts the
        shear stress xz, of which half the range of a passage is left.
    """
    share = 1.0 if used is None or not friction else min(used / friction, 1.0)
    stick = math.sqrt(1 - share)
    x, depth = np.meshgrid(np.linspace(-1.2, 1.2, PLACES), np.linspace(0.0, 1.0, DEPTHS))
    below = _stress(friction, stick, poisson, x.ravel(), depth.ravel())[:, 4].reshape(x.shape)
    largest = np.ptp(below, axis=1).max() / 2 if kinematic else np.abs(below).max()
    return min(float(STRIP.p0 / largest), surface_limit(friction, poisson, stick, kinematic))


def ellipse_limit(ratio: float) -> float:
    """Largest p0/k at which an ellipse without friction shakes down, an upper bound: p0 over the
    largest shear stress xz of the middle plane.

    ratio: half length along the rolling direction over that across. With (t^2 - 1)(2 t - 1) =
        ratio^2 the limit is 2 t (t + 1)/sqrt(2 t - 1): 4 of a line across, 4.67 of a circle.
    """
    root = brentq(lambda t: (t * t - 1) * (2 * t - 1) - ratio**2, 1.0, 2.0 + ratio)
    t = float(root)
    return 2 * t * (t + 1) / math.sqrt(2 * t - 1)


def surface_limit(
    friction: float, poisson: float, stick: float = 0.0, kinematic: bool = False
) -> float:
    """Largest p0/k for which the surface of a line contact alone shakes down (Melan, von Mises).
    friction: coefficient; poisson: Poisson's ratio; stick: half width that sticks over half width
    of the patch in steady rolling; 0 is full slip. kinematic: as of `shakedown_limit`.
    In full slip all stresses beside the patch lie between those of its two edges.
    """
    wave = -np.cos(np.linspace(0.0, math.pi, PLACES))
    x = np.concatenate([wave, 1 - stick + stick * wave])
    return STRIP.p0 / _least_shear_yield(
        _stress(friction, stick, poisson, x, np.zeros_like(x)), kinematic
    )


def _stress(friction: float, stick: float, poisson: float, x: Array, depth: Array) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, under STRIP with Carter's
    tractions. x, depth: (n,), over the half width; stick: half width that sticks, from the
    leading edge on, over the half width.
    """

    def at(x: Array) -> Array:
        """Points (n, 3), mm, at x over the half width and the depths of the outer function."""
        return STRIP.half_width * np.column_stack((x, np.zeros_like(x), -depth))

    total = sliding.stress(STRIP, friction, poisson, at(x))
    if stick:
        inner, places = _strip(stick), at(x - 1 + stick)
        total -= sliding.stress(inner, friction, poisson, places)
        total += sliding.stress(inner, 0.0, poisson, places)
    return total


def _least_shear_yield(stress: Array, kinematic: bool) -> float:
    """Smallest yield stress in shear k (MPa) for which one residual stress rho_xx and one rho_yy
    keep the stresses at n places of one depth within von Mises' limit.

    stress: (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, of plane strain, where xy and yz are zero.
    kinematic: whether a back stress may shift xz, by the same at all places.

    k^2 = d^2/4 + (e - d/2)^2/3 + xz^2, d = xx - zz, e = yy - zz, residual stresses and shift
    included.
    """
    xx, yy, zz, _, xz, _ = stress.T / STRIP.p0

    def room(v: Array) -> Array:
        """k^2 - J_2 (n,), over p0^2, with the residual stresses v[0] and v[1] and the shift v[2],
        over p0, and k^2 = v[3].
        """
        half = (xx - zz + v[0]) / 2
        other = yy - zz + v[1] - half
        shear = xz + kinematic * v[2]
        return np.asarray(v[3] - half**2 - other**2 / 3 - shear**2)

    found = minimize(
        lambda v: v[3],
        [0.0, 0.0, 0.0, 10.0],
        method="SLSQP",
        constraints={"type": "ineq", "fun": room},
        options={"ftol": 1e-10},
    )
    return float(STRIP.p0 * math.sqrt(-room(np.append(found.x[:3], 0.0)).min()))


def elastic_limit(friction: float, poisson: float) -> float:
    """Largest p0/k of a line contact in full slip that does not yield anywhere, by von Mises.
    friction: coefficient; poisson: Poisson's ratio.
    """
    hardest = max(each.von_mises for each in sliding.peaks(STRIP, friction, poisson).values())
    return math.sqrt(3) * STRIP.p0 / hardest


def surface_fatigue_index(traction: float, pressure: float, shear_yield: float) -> float:
    """Surface fatigue index FI_surf = (traction - k)/p0, above 0 where the surface ratchets.

    traction: largest traction, pressure: largest pressure p0, shear_yield: yield stress in shear k,
        all MPa. Where all of an ellipse slips, the index is friction - 2 pi a b k/(3 N) (Ekberg,
        Kabo and Andersson, Fatigue Fract. Eng. Mater. Struct. 25, 2002).
    """
    return (traction - shear_yield) / pressure


def subsurface_fatigue_index(pressure: float, used: float) -> float:
    """Subsurface fatigue index FI_sub = p0 (1 + f^2)/6 = N (1 + f^2)/(4 pi a b) of an ellipse, MPa,
    without residual stress (Ekberg, Kabo and Andersson, Fatigue Fract. Eng. Mater. Struct. 25,
    2002).

    pressure: largest pressure p0, MPa. used: traction coefficient f, tangential over normal force.
    """
    return pressure * (1 + used**2) / 6


def wear_regime(value: float, limits: tuple[float, float]) -> str:
    """Wear regime ("mild", "severe" or "catastrophic") of a value of T-gamma, or of T-gamma over
    area. limits: the two values between the regimes, ascending, in the unit of `value`; each
    belongs to the regime above it.
    """
    return REGIMES[sum(value >= limit for limit in limits)]


def state(ratio: float, first: float, limit: float, beyond: str = "ratchets") -> str:
    """What repeated rolling does at a largest pressure over k: "elastic" up to that of first yield,
    "shakes down" up to a limit, and a word for what is beyond.
    """
    return "elastic" if ratio <= first else "shakes down" if ratio <= limit else beyond
