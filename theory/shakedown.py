"""What surfaces that roll again and again can bear, where all of the patch slips.

p0: largest pressure; k: yield stress in shear; friction: tangential over normal force, all of 1 or
MPa. Under a line nothing but the shear stress xz cannot be taken over by residual stresses, so that
a passage stays elastic in the end as long as it is below k everywhere (Melan's theorem; Johnson,
Contact Mechanics, 9.2): p0 = 4 k without friction, p0 = k/friction from friction 0.367 on, where
the surface is hit hardest. Of a circle Ponter, Hearle and Johnson (J. Mech. Phys. Solids 33, 1985)
have 4.68 k without friction, and k/friction where the surface is hit hardest.
"""

from __future__ import annotations

import math

import numpy as np

from railhead.theory import line, sliding

CIRCLE = 4.68  # p0/k without friction
DEPTHS, PLACES = 81, 161  # where the shear stress of a strip is looked for
STRIP = line.contact(1e-3, (1.0, 1.0), (0.0, 0.0), length=1.0, across=False, load=1e-3)  # any


def shakedown_limit(friction: float) -> float:
    """Largest p0/k of a line that shakes down, to 1e-3."""
    x, depth = np.meshgrid(np.linspace(-1.2, 1.2, PLACES), np.linspace(0.0, 1.0, DEPTHS))
    places = np.column_stack((x.ravel(), np.zeros(x.size), -depth.ravel()))
    stress = sliding.stress(STRIP, friction, 0.3, STRIP.half_width * places)
    return float(STRIP.p0 / np.abs(stress[:, 4]).max())  # xz is the same at any Poisson's ratio


def elastic_limit(friction: float, poisson: float) -> float:
    """Largest p0/k of a line that does not yield at all, by von Mises."""
    hardest = max(
        find(STRIP, friction, poisson).von_mises
        for find in (sliding.hardest_below, sliding.hardest_at_surface)
    )
    return math.sqrt(3) * STRIP.p0 / hardest


def surface_fatigue_index(friction: float, pressure: float, shear_yield: float) -> float:
    """FI_surf = friction - k/p0, above 0 where the surface ratchets: how far the friction is beyond
    the surface's limit in the map. Of an ellipse k/p0 = 2 pi a b k/(3 N) (Ekberg, Kabo and
    Andersson, Fatigue Fract. Eng. Mater. Struct. 25, 2002)."""
    return friction - shear_yield / pressure
