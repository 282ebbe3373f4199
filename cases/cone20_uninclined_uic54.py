"""Coned tread 1:20 on an upright UIC54: the contact lies off the crown, at the R300-R80 joint."""

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

SCENE = Scene(
    name="cone20_uninclined_uic54",
    load="25 kN",
    rail=Rail(profile="54E1"),
    wheel=Wheel(profile="cone20", rolling_radius=420),
)

if __name__ == "__main__":
    run_case(SCENE)
