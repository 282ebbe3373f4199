"""What pictures call a scene."""

from pathlib import Path

import pytest

from railhead.planning import plan
from railhead.results.subject import shared_y, subject
from railhead.scene.catalogue import find


def test_bodies_have_names_of_their_own() -> None:
    found = {
        name: subject(plan.make(find(name)), 1000.0)
        for name in ("two_cylinders", "sphere_on_plane", "long_roller")
    }
    assert found["two_cylinders"].names == {"rail": "lower cylinder", "wheel": "upper cylinder"}
    assert found["sphere_on_plane"].names == {"rail": "plane", "wheel": "sphere"}
    assert found["sphere_on_plane"].revolved
    assert "1 kN" in found["long_roller"].title
    assert found["long_roller"].names == {"rail": "block", "wheel": "roller"}
    assert found["sphere_on_plane"].title.endswith("sphere R 8 mm on a rigid plane, as half-spaces")
    assert not any(each.gauge for each in found.values())


def test_a_real_rail_has_a_gauge_side() -> None:
    assert subject(plan.make(find("uic54_thesis")), 1.0).gauge


def test_a_straight_bar_keeps_its_profile() -> None:
    scene = find("uic54_thesis").replace(("wheel.rolling_radius=inf", "rail.length=100mm"))
    found = subject(plan.make(scene), 1.0)
    assert "straight bar, profile cylinder, on rail 54E1" in found.title
    assert found.names["wheel"] == "bar" and found.gauge


def test_a_rigid_wheel_is_called_so_and_friction_is_said() -> None:
    keys = "wheel.young_modulus=inf", "friction.coefficient=0.3", "rolling.creepage_along=0.1%"
    found = subject(plan.make(find("uic54_thesis").replace(keys)), 25e3)
    end = "rigid wheel R 420 mm, tread cylinder, on rail 54E1, friction\N{NO-BREAK SPACE}0.3"
    assert found.title.endswith(end)
    assert found.rolls and found.rubs


def test_y_is_called_what_all_scenes_of_a_sweep_call_it() -> None:
    plans = [plan.make(find(name)) for name in ("uic54_thesis", "long_roller", "sphere_on_plane")]
    alone = [shared_y([each]) for each in plans]
    assert alone == ["y, across the rail, mm", "y, along the axis, mm", "y, mm"]
    assert shared_y(plans[:1] * 2) == alone[0] and shared_y(plans) == "y, mm"


def test_a_file_is_called_by_its_name() -> None:
    file = Path(__file__).parents[1] / "geometry" / "data" / "MBench_UIC60_v3.ban"
    keys = {"profile": str(file), "inclination": 0}
    found = subject(plan.make(find("s1002_60e1").replace(rail=keys)), 1.0)
    assert found.title.endswith("on rail MBench_UIC60_v3.ban")


def test_the_position_of_a_wheelset_is_said() -> None:
    keys = "wheelset.shift=-3mm", "wheelset.yaw=2mrad"
    found = subject(plan.make(find("s1002_60e1").replace(keys)), 1.0)
    end = "on rail 60E1, inclined 1:40, shifted -3 mm, yaw 2 mrad"
    assert found.title.replace("\N{NO-BREAK SPACE}", " ").endswith(end)


@pytest.mark.parametrize(
    ("finite_bodies", "method"), [("auto", "finite elements"), ("off", "half-spaces")]
)
def test_the_method_is_that_of_the_answer(finite_bodies: str, method: str) -> None:
    scene = find("s1002_60e1").replace((f"effects.finite_bodies={finite_bodies}",))
    assert subject(plan.make(scene), 1.0).method == method
