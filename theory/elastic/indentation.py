"""A sphere and a flat pressed together, one of which yields: formulas fitted to finite elements of
others. Below first yield they are Hertz's.

Loads, approaches and radii are over those of first yield, pressures over the yield stress.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from scipy.optimize import brentq

HERTZ_LIMIT = 1.9  # approach up to which Jackson and Green keep Hertz


@dataclass(frozen=True)
class Indentation:
    """State of a sphere and a flat under a load, below first yield or beyond it.

    approach: approach of the bodies, over that at first yield.
    radius: radius of the patch, over that at first yield.
    pressure: mean pressure over the yield stress.
    """

    approach: float
    radius: float
    pressure: float


def yield_pressure(nu: float) -> float:
    """Largest pressure of a sphere at first yield over the yield stress: 1.295 e^(0.736 nu), a fit
    (Jackson and Green 2005, eq. 3). nu: Poisson's ratio.
    """
    return 1.295 * math.exp(0.736 * nu)


def jackson_green(load: float, nu: float, strain: float) -> Indentation:
    """Approach, radius and mean pressure of an elastic-plastic sphere without hardening; Hertz's up
    to an approach of 1.9 times (HERTZ_LIMIT) that of first yield.

    load: over the load of first yield.
    nu: Poisson's ratio.
    strain: yield stress over E/(1 - nu^2).
    Jackson and Green, J. Tribology 127 (2005) 343, eqs. 9, 10, 13 to 16.
    """
    c, b = yield_pressure(nu), 0.14 * math.exp(23 * strain)

    def area(w: float) -> float:
        """Area of the patch over that at first yield, at an approach over that of first yield."""
        return w if w <= HERTZ_LIMIT else w * (w / HERTZ_LIMIT) ** b

    def force(w: float) -> float:
        """Load over that of first yield, at an approach over that of first yield."""
        if w <= HERTZ_LIMIT:
            return w**1.5
        a_over_r = math.pi * c * strain / 2 * math.sqrt(area(w))
        hardness = 2.84 * (1 - math.exp(-0.82 * a_over_r**-0.7))
        elastic = math.exp(-(w ** (5 / 12)) / 4) * w**1.5
        return elastic + 4 * hardness / c * (1 - math.exp(-(w ** (5 / 9)) / 25)) * w

    w = approach_under(force, load)
    return Indentation(w, math.sqrt(area(w)), 2 / 3 * c * load / area(w))


def approach_under(force: Callable[[float], float], load: float) -> float:
    """Approach at which a force law reaches a load; approach, force and load over their values at
    first yield.
    """
    return float(brentq(lambda w: force(w) - load, 0.0, 10.0 + 2.0 * load))
