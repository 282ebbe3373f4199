"""Temperature of two surfaces that roll and slip: heat of friction, and bodies of unlike warmth.

Heat flows into each body alone along its normal, as the surfaces pass the patch much faster than
heat spreads (Peclet number V a rho c/lambda of 10 and more; Carslaw and Jaeger; Ertz and Knothe,
Wear 253, 2002). A flux q that a body takes raises its surface, s behind the leading edge, by

    T(s) = 1/sqrt(pi lambda rho c V) int_0^s q(t)/sqrt(s - t) dt

Where two like bodies touch, they share the mean of their bulk temperatures at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhead.theory.array_types import Array

CONDUCTIVITY = 50.0  # W/(m K), steel; this and the next two: Ertz and Knothe, Wear 253 (2002) 498
SPECIFIC_HEAT = 450.0  # J/(kg K)
DENSITY = 7850.0  # kg/m3


@dataclass(frozen=True, kw_only=True)
class Heat:
    """Two bodies of one material that roll, their warmth, and how they divide the heat of friction.

    speed: V of rolling, m/s.
    bulk_rail, bulk_wheel: temperatures far from the patch, deg C.
    conductivity: lambda, W/(m K).
    density: rho, kg/m3.
    specific_heat: c, J/(kg K).
    share: of the heat of friction that the rail takes, 0 to 1; with 1/2 both surfaces are equally
        hot.
    """

    speed: float
    bulk_rail: float = 0.0
    bulk_wheel: float = 0.0
    conductivity: float = CONDUCTIVITY
    density: float = DENSITY
    specific_heat: float = SPECIFIC_HEAT
    share: float = 0.5

    @property
    def bulk(self) -> Array:
        """Bulk temperatures of rail and wheel, (2,), deg C."""
        return np.array([self.bulk_rail, self.bulk_wheel])

    def temperatures(self, x: Array, flux: Array) -> Array:
        """Temperatures of the surfaces of rail and wheel (2, nx, ny), deg C, in a patch that moves
        to +x, under a heat flux of friction (nx, ny), W/mm2. x (nx,): cell centres, mm.
        """
        taken = np.array([self.share, 1 - self.share])[:, None, None] * flux
        return np.asarray(self.bulk.mean() + self._weights(x) @ taken)

    def _weights(self, x: Array) -> Array:
        """Rise at each cell by a flux of 1 W/mm2 in each cell of its line, (nx, nx), K mm2/W. A
        flux that is constant in a cell of half width h adds 2 (sqrt(d + h) - sqrt(d - h)) at a
        distance d behind its centre, and 2 sqrt(h) there.
        """
        half = (x[1] - x[0]) / 2
        behind = np.maximum(x[None, :] - x[:, None] + half * np.array([1, -1])[:, None, None], 0.0)
        near, far = np.sqrt(1e-3 * behind)  # to the front and the rear end of a cell, sqrt(m)
        product = self.conductivity * self.density * self.specific_heat * self.speed
        return np.asarray(2e6 / math.sqrt(math.pi * product) * (near - far))
