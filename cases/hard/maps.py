"""Cases that fill the failure maps: laws against factors, Poisson's ratio against stiffness."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cases.hard.case import Case
from cases.hard.scenes import ELLIPSE, against_hertz

LAWS = {
    "default": (),
    "Nitsche, theta 1": ("solver.theta=1",),
    "Nitsche, theta 0": ("solver.theta=0",),
    "Nitsche, theta -1": ("solver.theta=-1",),
    "penalty": ("solver.method=penalty",),
}
FACTORS = [10.0**power for power in range(-3, 7)]
RULED = (0.1, 100.0)  # factors of the default law with a rule
POISSON = (0.0, 0.3, 0.45, 0.49, 0.499, 0.4999)
STIFFNESS = [10.0**power for power in (-4, -2, 0, 2, 4)]
FACTOR_MAP, MATERIAL_MAP = "factor", "nu x E ratio"


def factor_cases() -> Iterator[Case]:
    """solver.gamma_factor for every law on the thesis ellipse."""
    for law, keys in LAWS.items():
        for factor in FACTORS:
            low, high = RULED
            ruled = law == "default" and low <= factor <= high
            yield Case(
                FACTOR_MAP, f"{law}, {factor:g}", "penalty tuned wrongly", "exact Hertz",
                0.01 if ruled else math.inf,
                against_hertz(ELLIPSE.replace([*keys, f"solver.gamma_factor={factor!r}"])),
                newton=10 if ruled else 30, seconds=40, quick=ruled,
            )  # fmt: skip


def material_cases() -> Iterator[Case]:
    """Poisson's ratio of a rail of any stiffness under a steel wheel."""
    for poisson in POISSON:
        for ratio in STIFFNESS:
            yield Case(
                MATERIAL_MAP, f"{poisson:g}, {ratio:g}", "soft or stiff and incompressible rail",
                "exact Hertz", math.inf,
                against_hertz(ELLIPSE.replace([f"rail.poisson_ratio={poisson}",
                                               f"rail.young_modulus={207e3 * ratio!r}"])),
                newton=30, seconds=40,
            )  # fmt: skip
