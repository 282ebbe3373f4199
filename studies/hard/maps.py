"""Cases that fill the failure maps: laws against factors, Poisson's ratio against stiffness.

Each cell is right or refused by a check; around the defaults it must be right.
"""

from __future__ import annotations

from collections.abc import Iterator

from studies.hard.case import Case
from studies.hard.scenes import ELLIPSE, against_hertz

LAWS = {
    "default": (),
    "Nitsche, theta 1": ("solver.theta=1",),
    "Nitsche, theta 0": ("solver.theta=0",),
    "Nitsche, theta -1": ("solver.theta=-1",),
    "penalty": ("solver.method=penalty",),
}
FACTORS = [10.0**power for power in range(-3, 7)]
SURE = (0.1, 100.0)  # factors that the default law must bear
POISSON = (0.0, 0.3, 0.45, 0.49, 0.499, 0.4999)
STIFFNESS = [10.0**power for power in (-4, -2, 0, 2, 4)]
FACTOR_MAP, MATERIAL_MAP = "factor", "nu x E ratio"
EITHER = 0.05  # of a quantity without an estimate: what a check lets pass without an accuracy


def factor_cases() -> Iterator[Case]:
    """solver.gamma_factor for every law on the thesis ellipse."""
    for law, keys in LAWS.items():
        for factor in FACTORS:
            sure = law == "default" and SURE[0] <= factor <= SURE[1]
            scene = ELLIPSE.replace([*keys, f"solver.gamma_factor={factor!r}"])
            solve = against_hertz(scene) if sure else against_hertz(scene, limit=EITHER)
            yield Case(
                FACTOR_MAP, f"{law}, {factor:g}", "penalty tuned wrongly", "exact Hertz", solve,
                newton=10 if sure else 30, quick=sure, refusable=not sure,
            )  # fmt: skip


def material_cases() -> Iterator[Case]:
    """Poisson's ratio of a rail of any stiffness under a steel wheel."""
    for poisson in POISSON:
        for ratio in STIFFNESS:
            scene = ELLIPSE.replace(
                [f"rail.poisson_ratio={poisson}", f"rail.young_modulus={207e3 * ratio!r}"]
            )
            yield Case(
                MATERIAL_MAP, f"{poisson:g}, {ratio:g}", "soft or stiff and incompressible rail",
                "exact Hertz", against_hertz(scene), newton=30,
            )  # fmt: skip
