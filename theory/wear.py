"""Wear regimes of wheel steel by the energy dissipated per rolled length, T-gamma.

Both sets of limits are from memory, not checked against a copy.
"""

from __future__ import annotations

#: T-gamma over the area of the patch, N/mm2: wheel R8T on rail UIC60 900A, twin discs. Lewis and
#: Dwyer-Joyce, Proc. IMechE J 218 (2004); Braghin et al., Wear 261 (2006).
TWIN_DISC = (10.4, 77.2)
#: T-gamma, N: British Rail's wear number. Pearce and Sherratt, Wear 144 (1991).
BRITISH_RAIL = (100.0, 200.0)
REGIMES = ("mild", "severe", "catastrophic")


def regime(value: float, limits: tuple[float, float]) -> str:
    """Which of REGIMES."""
    return REGIMES[sum(value >= limit for limit in limits)]
