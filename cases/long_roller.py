"""Steel roller R 420 on a flat rail head 70 mm wide, 110 kN: a line contact."""

import math

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

SCENE = Scene(
    name="long_roller",
    load="110 kN",
    rail=Rail(profile="arc", crown_radius=math.inf),
    wheel=Wheel(profile="cylinder", rolling_radius=420),
)

if __name__ == "__main__":
    run_case(SCENE)
