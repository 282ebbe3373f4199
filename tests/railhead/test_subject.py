"""What pictures call a scene."""

from pathlib import Path

from railhead.catalogue import find
from railhead.planning import plan
from railhead.subject import subject


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
    assert found["sphere_on_plane"].title.endswith("on a plane (rigid), as half-spaces")
    assert not any(each.gauge or each.thesis for each in found.values())


def test_only_the_thesis_pair_is_held_against_the_thesis() -> None:
    scene = find("uic54_thesis")
    for changes, same in (((), True), (("load=50kN",), True), (("rail.inclination=1:40",), False)):
        found = subject(plan.make(scene.replace(changes)), 1.0)
        assert found.thesis is same
        assert found.gauge


def test_a_straight_bar_keeps_its_profile() -> None:
    scene = find("uic54_thesis").replace(("wheel.rolling_radius=inf", "rail.length=100mm"))
    found = subject(plan.make(scene), 1.0)
    assert "straight bar, profile cylinder, on rail 54E1" in found.title
    assert found.names["wheel"] == "bar" and found.gauge


def test_a_file_is_called_by_its_name() -> None:
    file = Path(__file__).parents[1] / "meshing" / "data" / "MBench_UIC60_v3.ban"
    keys = {"profile": str(file), "inclination": 0}
    found = subject(plan.make(find("s1002_60e1").replace(rail=keys)), 1.0)
    assert found.title.endswith("on rail MBench_UIC60_v3.ban")
