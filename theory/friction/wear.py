"""Wear regimes of wheel steel by the energy dissipated per rolled length, T-gamma."""

from __future__ import annotations

#: T-gamma over the area of the patch, N/mm2: wheel R8T on rail UIC60 900A, twin discs. Lewis and
#: Dwyer-Joyce, Proc. IMechE J 218 (2004), as in src/usfd of github.com/thiernodms/KPFASTSIMUSFD.
TWIN_DISC = (10.4, 77.2)
REGIMES = ("mild", "severe", "catastrophic")


def regime(value: float, limits: tuple[float, float]) -> str:
    """Wear regime ("mild", "severe" or "catastrophic") of a value of T-gamma, or of T-gamma over
    area. limits: the two values between the regimes, ascending, in the unit of `value`.
    """
    return REGIMES[sum(value >= limit for limit in limits)]
