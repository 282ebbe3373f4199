"""Elastic sphere R 8 on a rigid plane (Cornell/ANSYS example: a = 1.010 mm)."""

import math

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

SCENE = Scene(
    name="sphere_on_plane",
    load=60 * math.pi,
    rail=Rail(profile="arc", crown_radius=math.inf, extent="half-space", young_modulus=math.inf),
    wheel=Wheel(
        profile="arc",
        rolling_radius=8,
        transverse_radius=8,
        young_modulus=1000,
        poisson_ratio=0.3,
    ),
)

if __name__ == "__main__":
    run_case(SCENE)
