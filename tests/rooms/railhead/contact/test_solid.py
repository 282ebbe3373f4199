"""Both sides of a wheelset in a scene: which wheel is solved, and what is on the other side."""

import numpy as np
import pytest
from one_line import refusal

from railhead.cases.s1002_60e1 import SCENE
from railhead.contact import solid, wheelset_kinematics
from railhead.geometry import profiles
from railhead.planning import simulation_plan as planning
from railhead.scene.scene import Scene

ROLLS = {"friction.coefficient": 0.3, "rolling.from_wheelset": True}
UNLIKE = {
    "wheelset.shift": 3.0,
    "wheelset.yaw": 4e-3,
    "wheelset.other_rail": "54E1",
    "wheelset.other_wheel": "cone40",
    "wheelset.other_radius": 458.0,
}


def scene(**keys: object) -> Scene:
    """S1002 on 60E1 with a gauge."""
    return SCENE.replace(**(ROLLS | keys))


def mirrored(given: Scene) -> Scene:
    """The scene seen in a mirror: the wheel that is solved is on the other side."""
    here = given.wheelset
    return given.replace(
        **{
            "wheelset.side": "right" if here.side == "left" else "left",
            "wheelset.shift": -here.shift,
            "wheelset.yaw": -here.yaw,
            "wheelset.roll": "none" if here.roll is None else -here.roll,
        }
    )


@pytest.mark.parametrize("keys", [{}, UNLIKE, {**UNLIKE, "wheelset.roll": 1e-3}])
def test_the_mirror_of_a_scene_has_the_same_contact_and_creepage(keys: dict) -> None:
    one, two = scene(**keys), mirrored(scene(**keys))
    assert two.wheelset.side == "left"
    here, there = solid.locate(one), solid.locate(two)
    assert here.touch == there.touch and np.array_equal(here.pose.rotation, there.pose.rotation)
    creepages = [wheelset_kinematics.wheelset_creepage(each).creepage for each in (here, there)]
    assert creepages[0] == creepages[1]


def test_the_opposite_scene_solves_the_other_wheel_of_the_same_wheelset() -> None:
    one = scene(**UNLIKE)
    other = one.opposite
    assert other.wheelset.side == "left" and other.opposite == one
    assert (other.rail.profile, other.wheel.profile) == ("54E1", "cone40")
    here, there = solid.locate(one), solid.locate(other)
    assert here.placed.left.touches == there.placed.left.touches
    assert here.placed.right.touches == there.placed.right.touches
    assert there.touch.radius == here.placed.left.touches[0].radius
    radii = [wheelset_kinematics.wheelset_creepage(each).turning for each in (here, there)]
    assert radii[0] == radii[1] == (here.touch.radius + there.touch.radius) / 2


def test_unlike_sides_break_the_symmetry_across() -> None:
    """The axle rolls; nothing else in the scene is asymmetric."""
    given = Scene.from_mapping({"load": 1e5, "wheelset": {"other_radius": 415}})
    assert "axle rolled by" in solid.locate(given).why_asymmetric_in_y()
    assert planning.make(given).effects["symmetry_y"].on is False


def test_another_file_on_the_other_side_is_read_and_refused_by_its_key(tmp_path) -> None:
    rail = profiles.rail_head("60E1", 1 / 40)
    y = np.linspace(*rail.domain, 400)
    file = tmp_path / "left.csv"
    np.savetxt(file, np.column_stack([y, rail.height(y)]), delimiter=",", header="y,z in mm")
    given = scene(**{"wheelset.other_rail": str(file), "rail.inclination": 0})
    assert given.files == [file]
    contact = solid.locate(given)
    assert contact.placed.left.pair.rail.name == "left"
    assert contact.placed.right.pair.rail.name == "60E1"
    file.write_text("y,z\n0,0\n1,x\n")
    assert refusal(lambda: solid.locate(given)).startswith("wheelset.other_rail: left.csv, line 3")


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"rail.gauge_height": 15.875}, "rail.gauge_height: 15.875 is not allowed without gauge"),
        ({"wheelset.side": "middle"}, "wheelset.side: 'middle' is not allowed; give right or left"),
        ({"wheelset.other_rail": "arc"}, "wheelset.other_rail: 'arc' is not allowed; give 54E1,"),
        ({"wheelset.other_wheel": "S1003"}, "wheelset.other_wheel: 'S1003' is not allowed; give"),
    ],
)
def test_wrong_keys_are_one_line(keys: dict, words: str) -> None:
    data = {"load": 1e5}
    assert refusal(lambda: Scene.from_mapping(data).replace(**keys)).startswith(words)


def test_a_rail_that_ends_above_the_gauge_is_answered_by_a_key() -> None:
    """54E1 ends where its corner of R13 does; the height that the line names is enough."""
    given = scene(**{"rail.gauge_height": 20})
    line = refusal(lambda: solid.locate(given))
    assert line.startswith("rail.gauge_height: 20 mm is not reached by profile 60E1, which ends ")
    ends = float(line.split("ends ")[1].split(" mm")[0])
    assert ends < 20
    near = given.replace(**{"rail.gauge_height": ends - 0.1})
    assert solid.locate(near).touch.y != solid.locate(scene()).touch.y


def test_profiles_that_are_not_symmetric_are_named() -> None:
    contact = solid.locate(SCENE.replace(["rail.gauge=none"]))
    assert contact.why_asymmetric_in_y() == "wheel S1002 on rail 60E1"
    assert contact.why_asymmetric_in_x() is None
