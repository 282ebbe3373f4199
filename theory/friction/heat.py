"""Flash temperature of a contact that slips, by Blok's formula for a band that moves fast.

Thermal constants of steel, and the case that this is tested on: Ertz and Knothe, Wear 253 (2002)
498, as in examples/ertz_temperature.inp of github.com/eve70a/CONTACT.
"""

from __future__ import annotations

import math

CONDUCTIVITY = 50.0  # W/(m K)
DENSITY = 7850.0  # kg/m3
SPECIFIC_HEAT = 450.0  # J/(kg K)
MIDDLE = 3 * math.pi / 8  # of an ellipse: mean flux on its longest line over that of the patch


def flash_temperature(
    dissipated: float, area: float, half_length: float, speed: float, *, line: bool
) -> float:
    """Largest rise of the surface temperature, K: 1.13 (q/2) sqrt(2 a/v)/sqrt(k rho c), q the mean
    heat flux on the longest line of the patch along the rail, k rho c the thermal constants of
    steel.

    dissipated: energy per rolled length, N.
    area: of the patch, mm2.
    half_length: a, half length of the patch along the rail, mm.
    speed: v, m/s.
    line: whether the contact is a line contact; else an ellipse.
    The heat is distributed as the pressure; half of it flows into each body.
    """
    flux = dissipated * speed / (1e-6 * area) * (1.0 if line else MIDDLE)
    effusivity = math.sqrt(CONDUCTIVITY * DENSITY * SPECIFIC_HEAT)
    return 1.13 * flux / 2 * math.sqrt(2e-3 * half_length / speed) / effusivity
