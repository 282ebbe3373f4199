"""Keys of the tables [rail.surface] and [wheel.surface]."""

import math
from pathlib import Path

import pytest
from one_line import refusal

from railhead.scene.catalogue import portable, read_scene
from railhead.scene.scene import Scene, unit

SCENE = Scene(load=1e4, wheel={"rolling_radius": 450.0})


@pytest.mark.parametrize(
    "keys, said",
    [
        ({"kind": "dent"}, "rail.surface.kind: 'dent' is not allowed; give flat, cosine or map"),
        ({"length": 3.0}, "rail.surface.kind"),
        ({"kind": "flat", "length": 3.0}, "rail.surface.depth: not given"),
        ({"kind": "flat", "depth": 3.0}, "rail.surface.length: not given; kind flat needs it"),
        ({"kind": "cosine", "length": 9.0}, "rail.surface.amplitude: not given"),
        ({"kind": "map"}, "rail.surface.file: not given"),
        ({"kind": "map", "file": "gone.csv"}, "rail.surface.file: 'gone.csv' is not a readable"),
        ({"kind": "flat", "length": 3, "depth": 1, "amplitude": 1}, "rail.surface.amplitude: is"),
        ({"kind": "flat", "length": 3, "depth": -1}, "rail.surface.depth: -1 is not allowed"),
        ({"kind": "flat", "length": 3, "depth": 1, "position": "5 deg"}, "rail.surface.position"),
        ({"kind": "flat", "length": 3, "depht": 1}, "rail.surface.depht: unknown key; did you me"),
    ],
)
def test_wrong_keys_are_one_line(keys: dict, said: str) -> None:
    assert refusal(lambda: SCENE.replace(rail={"surface": keys})).startswith(said)


def test_a_position_in_degrees_is_an_arc_of_the_wheel() -> None:
    flat = {"kind": "flat", "length": 60.0, "position": "5 deg"}
    given = SCENE.replace(wheel={"surface": flat})
    assert given.wheel.surface.position == pytest.approx(450 * math.radians(5), rel=1e-14)
    turned = given.replace(["wheel.surface.position=-0.1 rad"])
    assert turned.value("wheel.surface.position") == -45.0
    assert turned.wheel.surface.length == 60.0 and unit("wheel.surface.position") == "mm"
    assert given.replace(["wheel.surface=none"]) == SCENE


def test_nothing_rolls_steadily_over_a_shape() -> None:
    keys = {"surface": {"kind": "cosine", "length": 30.0, "amplitude": 0.01}}
    line = refusal(lambda: SCENE.replace(rail=keys, rolling={"creepage_along": 0.001}))
    assert line.startswith("rolling: is not allowed beside rail.surface")


def test_the_file_of_a_map_moves_with_its_scene(tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_text("0,0,0\n")
    (tmp_path / "a.toml").write_text('load = 1\nrail.surface = {kind = "map", file = "m.csv"}\n')
    scene = read_scene(tmp_path / "a.toml")
    assert scene.rail.surface.file == str(tmp_path / "m.csv")
    assert Path(scene.rail.surface.file) in scene.files
    assert portable(scene)["rail"]["surface"]["file"].startswith("input/")
