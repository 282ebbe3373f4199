"""The thesis's case: wheel R 420, cylindrical tread, on the UIC54 head, 25 kN."""

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

SCENE = Scene(
    name="uic54_thesis",
    load="25 kN",
    rail=Rail(profile="54E1", young_modulus="207 GPa", poisson_ratio=0.3),
    wheel=Wheel(profile="cylinder", rolling_radius=420, young_modulus="207 GPa", poisson_ratio=0.3),
)

if __name__ == "__main__":
    run_case(SCENE)
