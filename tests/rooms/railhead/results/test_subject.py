"""What pictures call a scene."""

from pathlib import Path

import pytest

from railhead.planning import simulation_plan
from railhead.results.subject import shared_y, subject
from railhead.scene.catalogue import find


def test_bodies_have_names_of_their_own() -> None:
    found = {
        name: subject(simulation_plan.make(find(name)), 1000.0)
        for name in ("two_cylinders", "sphere_on_plane", "long_roller")
    }
    assert found["two_cylinders"].names == {"rail": "lower cylinder", "wheel": "upper cylinder"}
    assert found["sphere_on_plane"].names == {"rail": "plane", "wheel": "sphere"}
    assert found["sphere_on_plane"].revolved
    assert "1 kN" in found["long_roller"].title
    assert found["long_roller"].names == {"rail": "block", "wheel": "roller"}
    assert found["sphere_on_plane"].title.endswith("sphere R 8 mm on a rigid plane, as half-spaces")
    assert not any(each.gauge for each in found.values())


BAN = str(Path(__file__).parents[1] / "geometry" / "data" / "MBench_UIC60_v3.ban")
TITLES = {
    "a straight bar": (
        "uic54_thesis", ("wheel.rolling_radius=inf", "rail.length=100mm"),
        "straight bar, profile cylinder, on rail 54E1",
    ),
    "a rigid wheel and friction": (
        "uic54_thesis",
        ("wheel.young_modulus=inf", "friction.coefficient=0.3", "rolling.creepage_along=0.1%"),
        "rigid wheel R 420 mm, tread cylinder, on rail 54E1, friction 0.3",
    ),
    "a file": ("s1002_60e1", (f"rail.profile={BAN}", "rail.inclination=0"),
               "on rail MBench_UIC60_v3.ban"),
    "a wheelset": ("s1002_60e1", ("wheelset.shift=-3mm", "wheelset.yaw=2mrad"),
                   "on rail 60E1, inclined 1:40, shifted -3 mm, yaw 2 mrad"),
}  # fmt: skip


@pytest.mark.parametrize(("case", "keys", "end"), TITLES.values(), ids=TITLES)
def test_a_title_says_bodies_and_where_they_stand(
    case: str, keys: tuple[str, ...], end: str
) -> None:
    found = subject(simulation_plan.make(find(case).replace(keys)), 25e3)
    assert found.title.replace("\N{NO-BREAK SPACE}", " ").endswith(end)
    assert found.gauge
    assert (found.rolls and found.has_friction) == ("friction" in end)
    assert found.names["wheel"] == ("bar" if "bar" in end else "wheel")


def test_y_is_called_what_all_scenes_of_a_sweep_call_it() -> None:
    plans = [
        simulation_plan.make(find(name))
        for name in ("uic54_thesis", "long_roller", "sphere_on_plane")
    ]
    alone = [shared_y([each]) for each in plans]
    assert alone == ["y, across the rail, mm", "y, along the axis, mm", "y, mm"]
    assert shared_y(plans[:1] * 2) == alone[0] and shared_y(plans) == "y, mm"
