"""Half a 22.5 t axle: 110.3 kN, coned tread 1:20 on UIC54 inclined 1:20; R260 and ER7 yield."""

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

SCENE = Scene(
    name="uic54_22t5_axle",
    load="110.3 kN",
    rail=Rail(profile="54E1", inclination="1:20", steel="R260"),
    wheel=Wheel(profile="cone20", rolling_radius=420, steel="ER7"),
)

if __name__ == "__main__":
    run_case(SCENE)
