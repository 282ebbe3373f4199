"""Parallel cylinders R 10 on R 13, 3200 N a millimetre, held at their diametral planes (VM191)."""

import math

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

SCENE = Scene(
    name="two_cylinders",
    load="32 kN",
    rail=Rail(
        profile="arc",
        crown_radius=13,
        depth=13,
        length=10,
        young_modulus=29120,
        poisson_ratio=0.3,
    ),
    wheel=Wheel(
        profile="arc",
        rolling_radius=math.inf,
        transverse_radius=10,
        rim_depth=10,
        young_modulus=30000,
        poisson_ratio=0.25,
    ),
)

if __name__ == "__main__":
    run_case(SCENE)
