"""Steel roller R 50 on an aluminium block 200 x 200 mm, 35 kN a millimetre (NAFEMS benchmark)."""

import math

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

SCENE = Scene(
    name="roller_on_block",
    load="350 kN",
    rail=Rail(
        profile="arc",
        crown_radius=math.inf,
        width=10,
        depth=200,
        length=200,
        young_modulus="70 GPa",
        poisson_ratio=0.3,
    ),
    wheel=Wheel(
        profile="cylinder",
        rolling_radius=50,
        rim_depth=50,
        young_modulus="210 GPa",
        poisson_ratio=0.3,
    ),
)

if __name__ == "__main__":
    run_case(SCENE)
