"""S1002 on 60E1 inclined 1:40, gauge 1435: the Manchester benchmark, 10 kN, wheelset central."""

from railhead import Rail, Scene, Wheel
from railhead.cli import run_case

YOUNG = 2 * 82000 * (1 + 0.28)

SCENE = Scene(
    name="s1002_60e1",
    load="10 kN",
    rail=Rail(
        profile="60E1",
        inclination="1:40",
        gauge=1435,
        young_modulus=YOUNG,
        poisson_ratio=0.28,
        steel="R260",
    ),
    wheel=Wheel(
        profile="S1002",
        rolling_radius=460,
        young_modulus=YOUNG,
        poisson_ratio=0.28,
        steel="ER7",
    ),
)

if __name__ == "__main__":
    run_case(SCENE)
