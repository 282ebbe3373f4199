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
HEADROOM = 1.15
AIM = 0.98  # of the accuracy: the bound of the resolution that just meets it must not miss it
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
    """rms relative error value * (6/n)^order + floor, the floor being that of the reading;
    richardson: the order with which two meshes are compared."""

    value: float
    order: float
    floor: float = 0.0
    richardson: float = ORDER

    def __call__(self, n: float) -> float:
        return float(self.value * (6.0 / n) ** self.order + self.floor)


Laws = Mapping[str, PowerLaw]
QUADRATIC = {
    "a_mm": PowerLaw(4.5e-4, 2.5),
    "b_mm": PowerLaw(4.5e-4, 2.5),
    "area_mm2": PowerLaw(4.5e-4, 2.5),
    "max_MPa": PowerLaw(3.3e-4, 2.7),
    "approach_mm": PowerLaw(1.02e-3, 2.5),
    "tau_max_MPa": PowerLaw(2.4e-4, 2.3),
    "tau_max_depth_mm": PowerLaw(1.3e-3, 2.0),
    "von_mises_max_MPa": PowerLaw(2.4e-4, 2.5),
}
LOBED = QUADRATIC | {
    "a_mm": PowerLaw(6e-3, 1.0, richardson=1.0),
    "b_mm": PowerLaw(6e-3, 1.0, richardson=1.0),
    "area_mm2": PowerLaw(5e-3, 1.0, richardson=1.0),
    "max_MPa": PowerLaw(7e-3, 1.0, richardson=1.0),
}
"""Quadratic cells where the patch is no ellipse: no moments give its outline, no parabola its
peak, and p has ridges where arcs join. From five such pairs against boundary elements."""
LINEAR = dict.fromkeys(QUANTITIES, PowerLaw(2.5e-2, 1.4))


SECTION = {
    "a_mm": PowerLaw(5.2e-4, 1.9),
    "b_mm": PowerLaw(5.2e-4, 1.9),
    "area_mm2": PowerLaw(1.0e-3, 1.9),
    "max_MPa": PowerLaw(6.0e-4, 1.0),
    "approach_mm": PowerLaw(3.0e-4, 2.0),
    "tau_max_MPa": PowerLaw(3.0e-4, 2.0),
    "tau_max_depth_mm": PowerLaw(2.4e-3, 2.5, 1.5e-4),
    "von_mises_max_MPa": PowerLaw(3.0e-4, 2.0),
}
"""Quadratic cells of a section, from random line and circular contacts on unlike meshes."""
SECTION_LINEAR = LINEAR | {"tau_max_depth_mm": PowerLaw(3.5e-2, 0.8)}


def laws(order: int, *, section: bool = False, hertzian: bool = True) -> Laws:
    """The measured laws for cells of that order, in a section or in space, there for patches that
    are ellipses or not."""
    if order == 1:
        return SECTION_LINEAR if section else LINEAR
    if section:
        return SECTION
    return QUADRATIC if hertzian else LOBED


def expected(n: float, laws: Laws) -> float:
    """Largest a priori bound of all quantities at n elements per semi-axis."""
    return MARGIN * max(law(n) for law in laws.values())


def resolution(accuracy: float, laws: Laws) -> float:
    """Elements per semi-axis whose a priori bounds all meet the accuracy.

    Coarse meshes are made finer by HEADROOM: Richardson's estimate from two of them is noisy, and
    a third mesh costs more.
    """
    low, high = RANGE
    accuracy *= AIM
    if expected(low, laws) <= accuracy:
        return HEADROOM * low
    if expected(high, laws) >= accuracy:
        return high
    n = float(brentq(lambda n: expected(n, laws) - accuracy, low, high))
    return max(n, min(HEADROOM * n, HEADROOM * STEP * low))


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
    coarse: Mapping[str, float],
    fine: Mapping[str, float],
    ratio: float,
    n: float,
    laws: Laws,
) -> dict[str, float]:
    """Relative bound of each quantity of the fine result (resolution n = ratio * n_coarse)."""
    found = {}
    for name, law in laws.items():
        gain = ratio**law.richardson - 1
        richardson = SAFETY * abs(fine[name] / coarse[name] - 1) / gain
        found[name] = max(MARGIN * law(n), richardson)
    return found


def next_resolution(n: float, worst: float, accuracy: float) -> float:
    """A finer mesh after the bound `worst` missed the accuracy: second order, within a factor 2."""
    return n * min(max(1.1 * (worst / accuracy) ** 0.5, 1.25), 2.0)
