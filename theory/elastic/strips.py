"""Stresses of the half-plane below strips that each carry a constant pressure and traction.

Plane strain; lengths in mm, stresses in MPa. With zeta = x + i depth and F = int p/(zeta - t) dt of
the pressure and G of the traction, as in `theory.elastic.line` (Johnson, Contact Mechanics, 2.5):

    xx = (Im F + d Re F' - 2 Re G + d Im G')/pi      zz = (Im F - d Re F' - d Im G')/pi
    xz = (d Im F' - Im G - d Re G')/pi               yy = nu (xx + zz)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Strips:
    """Stresses at n points below m strips side by side.

    poisson: Poisson's ratio.
    """

    def __init__(self, edges: Array, x: Array, depth: Array, poisson: float) -> None:
        """edges: ends of the strips (m + 1,), ascending, mm; x, depth: of the points (n,), mm, at a
        depth above 0.
        """
        self.poisson, self._depth = poisson, depth
        zeta = (x + 1j * depth)[:, None] - edges
        self._log, self._slope = np.log(zeta), 1 / zeta

    def stress(self, pressure: Array, traction: Array | None = None) -> Array:
        """Stress (n, 4), columns xx, yy, zz, xz (z upwards), MPa, tension positive. pressure:
        (m,), MPa. traction: (m,) on the half-plane along +x, MPa; None: zero.
        """
        F, slope = self._potential(pressure)
        d = self._depth
        xx, zz, xz = F.imag + d * slope.real, F.imag - d * slope.real, d * slope.imag
        if traction is not None:
            G, bent = self._potential(traction)
            xx += -2 * G.real + d * bent.imag
            zz += -d * bent.imag
            xz += -G.imag - d * bent.real
        return np.column_stack([xx, self.poisson * (xx + zz), zz, xz]) / np.pi

    def _potential(self, values: Array) -> tuple[NDArray, NDArray]:
        """F and its derivative (n,) for values (m,) on the strips."""
        jumps = np.diff(values, prepend=0.0, append=0.0)
        return self._log @ jumps, self._slope @ jumps
