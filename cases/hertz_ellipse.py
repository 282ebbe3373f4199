"""The thesis's radii as two half-spaces: what Hertz's formula describes exactly."""

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

SCENE = Scene(
    name="hertz_ellipse",
    load="25 kN",
    rail=Rail(profile="arc", crown_radius=300, extent="half-space"),
    wheel=Wheel(profile="cylinder", rolling_radius=420),
)

if __name__ == "__main__":
    run_case(SCENE)
