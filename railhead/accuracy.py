"""How fine a mesh an accuracy needs, and how good a result is: a priori and a posteriori.

The error of a quantity at n elements per semi-axis behaves like noise around a power law, as the
unstructured meshes of two sizes share no nodes. The bound of a result is therefore the larger of

    MARGIN * rms(n)                           what runs of known answer showed at this resolution
    SAFETY * |v - v_coarse| / (r^ORDER - 1)   Richardson's estimate, from a mesh coarser by r

rms(n) was measured on random Hertz half-spaces (`railhead study error-bounds` repeats it).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from scipy.optimize import brentq

MARGIN = 2.5
SAFETY = 1.25
ORDER = 2.5  # observed for quadratic cells; the linear laws are wide enough for theirs
STEP = 1.6  # refinement from the coarse mesh to the fine one
RANGE = (3.0, 60.0)  # elements per semi-axis that are considered
QUANTITIES = {
    "a_mm": ("patch", "a_mm"),
    "b_mm": ("patch", "b_mm"),
    "area_mm2": ("patch", "area_mm2"),
    "max_MPa": ("pressure", "max_MPa"),
    "approach_mm": ("approach_mm",),
    "tau_max_MPa": ("stress", "tau_max_MPa"),
    "tau_max_depth_mm": ("stress", "tau_max_depth_mm"),
    "von_mises_max_MPa": ("stress", "von_mises_max_MPa"),
}
"""Reported quantities that carry a bound, and their place under "result" in summary.json."""


@dataclass(frozen=True)
class PowerLaw:
    """rms relative error value * (6/n)^order."""

    value: float
    order: float

    def __call__(self, n: float) -> float:
        return float(self.value * (6.0 / n) ** self.order)


QUADRATIC = {
    "a_mm": PowerLaw(7.5e-4, 2.5),
    "b_mm": PowerLaw(7.5e-4, 2.5),
    "area_mm2": PowerLaw(7.5e-4, 2.5),
    "max_MPa": PowerLaw(5.5e-4, 2.7),
    "approach_mm": PowerLaw(1.7e-3, 2.5),
    "tau_max_MPa": PowerLaw(4.0e-4, 2.3),
    "tau_max_depth_mm": PowerLaw(2.2e-3, 2.0),
    "von_mises_max_MPa": PowerLaw(4.0e-4, 2.5),
}
LINEAR = dict.fromkeys(QUANTITIES, PowerLaw(2.5e-2, 1.4))


def laws(order: int) -> Mapping[str, PowerLaw]:
    """The measured laws for cells of that order."""
    return QUADRATIC if order > 1 else LINEAR


def expected(n: float, order: int) -> float:
    """Largest a priori bound of all quantities at n elements per semi-axis."""
    return MARGIN * max(law(n) for law in laws(order).values())


def resolution(accuracy: float, order: int) -> float:
    """Elements per semi-axis whose a priori bounds all meet the accuracy."""
    low, high = RANGE
    if expected(low, order) <= accuracy:
        return low
    if expected(high, order) >= accuracy:
        return high
    return float(brentq(lambda n: expected(n, order) - accuracy, low, high))


def flat(result: Mapping[str, Any]) -> dict[str, float]:
    """The bounded quantities of a "result"."""
    values = {}
    for name, path in QUANTITIES.items():
        inner: Any = result
        for key in path:
            inner = inner[key]
        values[name] = float(inner)
    return values


def bounds(
    coarse: Mapping[str, float], fine: Mapping[str, float], ratio: float, n: float, order: int
) -> dict[str, float]:
    """Relative bound of each quantity of the fine result (resolution n = ratio * n_coarse)."""
    found = {}
    for name, law in laws(order).items():
        richardson = SAFETY * abs(fine[name] / coarse[name] - 1) / (ratio**ORDER - 1)
        found[name] = max(MARGIN * law(n), richardson)
    return found


def next_resolution(n: float, worst: float, accuracy: float) -> float:
    """A finer mesh after the bound `worst` missed the accuracy: second order, within a factor 2."""
    return n * min(max(1.1 * (worst / accuracy) ** 0.5, 1.25), 2.0)
