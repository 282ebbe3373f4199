"""What dissipated energy does to steel: wear regime by T-gamma, flash temperature by Blok.

T-gamma is the energy dissipated per rolled length. Blok's formula is that of a band of heat that
moves fast. Thermal constants of steel, and the case that they are tested on: Ertz and Knothe, Wear
253 (2002) 498, as in examples/ertz_temperature.inp of github.com/eve70a/CONTACT.
"""

from __future__ import annotations

import math

#: T-gamma over the area of the patch, N/mm2: wheel R8T on rail UIC60 900A, twin discs. Lewis and
#: Dwyer-Joyce, Proc. IMechE J 218 (2004), as in src/usfd of github.com/thiernodms/KPFASTSIMUSFD.
TWIN_DISC = (10.4, 77.2)
REGIMES = ("mild", "severe", "catastrophic")
CONDUCTIVITY = 50.0  # W/(m K)
DENSITY = 7850.0  # kg/m3
SPECIFIC_HEAT = 450.0  # J/(kg K)


def regime(value: float, limits: tuple[float, float]) -> str:
    """Wear regime ("mild", "severe" or "catastrophic") of a value of T-gamma, or of T-gamma over
    area. limits: the two values between the regimes, ascending, in the unit of `value`; each
    belongs to the regime above it.
    """
    return REGIMES[sum(value >= limit for limit in limits)]


def flash_temperature(
    dissipated: float, area: float, half_length: float, speed: float, middle_over_mean: float
) -> float:
    """Largest rise of the surface temperature, K: 1.13 (q/2) sqrt(2 a/v)/sqrt(k rho c), q the mean
    heat flux on the longest line of the patch along the rail, k rho c the thermal constants of
    steel. It holds for one patch.

    dissipated: energy per rolled length, N.
    area: of the patch, mm2.
    half_length: a, half length of the patch along the rail, mm.
    speed: v, m/s.
    middle_over_mean: mean pressure on that line over that of the patch, as of `Ellipse`.
    The heat is distributed as the pressure; half of it flows into each body.
    """
    flux = dissipated * speed / (1e-6 * area) * middle_over_mean
    effusivity = math.sqrt(CONDUCTIVITY * DENSITY * SPECIFIC_HEAT)
    return 1.13 * flux / 2 * math.sqrt(2e-3 * half_length / speed) / effusivity
