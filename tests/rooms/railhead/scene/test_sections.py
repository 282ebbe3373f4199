"""Tables of a scene: steels and flow curves, pairs of friction, surfaces that are added."""

import math
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from one_line import refusal

from railhead import find
from railhead.planning import simulation_plan as planning
from railhead.run.model_setup import hardening
from railhead.scene import catalogue
from railhead.scene.bodies import steels
from railhead.scene.scene import Rail, Scene, unit
from railhead.scene.sections import SceneError
from railhead.solver.material import Backstress

JIANG = ((1633, 85.4), (493.4, 76.6), (149.1, 88.3), (45.0, 96.7), (13.6, 141.1))  # c, r of 1070
ROLLING = ("friction.coefficient=0.3", "rolling.creepage_along=0.1%")


def test_every_steel_has_a_source_and_no_hardening_that_nobody_measured() -> None:
    """Radii of yield surfaces after torsion had been taken for a flow curve: 560 MPa at 10 %, where
    EN 13674-1 wants a tensile strength of 880."""
    for name, steel in steels().items():
        measured = "with back stresses" if steel.backstress else "without hardening"
        assert steel.kind.endswith(measured) and steel.source, name
        curve = hardening(Rail(steel=name))
        assert 200 < curve.initial_yield_stress == steel.yield_stress < 1000
        stress, slope = curve.stress_and_slope(np.array([0.0, 0.1, 5.0]))
        assert np.all(stress == steel.yield_stress) and not slope.any()


@pytest.mark.parametrize(
    "keys, key, said",
    [
        (
            {"steel": "R350HT"},
            "steel",
            "'R350HT' is not allowed; give R260, ER7, ER8, 1070, or a yie",
        ),
        ({"steel": 260}, "steel", "260 is not allowed; give R260"),
        ({"steel": "R260", "yield_stress": 500}, "yield_stress", "is not allowed beside steel"),
        ({"steel": "R260", "hardening_modulus": 1e3}, "hardening_modulus", "without yield_stress"),
        ({"kinematic_fraction": 0.5}, "kinematic_fraction", "without steel, yield_stress or"),
        ({"yield_stress": 500, "kinematic_fraction": 1.5}, "kinematic_fraction", "1.5"),
        ({"yield_stress": 500, "hardening_modulus": -1}, "hardening_modulus", "-1"),
        ({"stress_strain": "none.csv"}, "stress_strain", "not a readable .csv file"),
        ({"backstress": [[4e4, 100]]}, "backstress", "without yield_stress"),
        ({"yield_stress": 400, "backstress": [4e4, 100]}, "backstress", "give pairs of C (MPa)"),
        ({"yield_stress": 400, "backstress": [[0, 100]]}, "backstress", "0 is not allowed"),
        ({"yield_stress": 400, "recall_exponent": 5}, "recall_exponent", "without backstress"),
        (
            {"yield_stress": 400, "backstress": [[4e4, 1]], "recall_exponent": 0.5},
            "recall_exponent",
            "give 0, or 1 to 30",
        ),
        ({"yield_stress": 400, "isotropic": [60]}, "isotropic", "give two of them"),
        ({"steel": "1070", "kinematic_fraction": 1}, "kinematic_fraction", "beside back stresses"),
    ],
)
def test_wrong_ways_to_yield_are_one_line(keys: dict, key: str, said: str) -> None:
    with pytest.raises(SceneError) as error:
        Rail(**keys)
    assert error.value.key == key and said in error.value.text


def test_back_stresses_of_keys_and_of_a_steel_reach_the_solver(tmp_path) -> None:
    keys = ["rail.yield_stress=400", "rail.backstress=[[40000, 100], [5000, 0]]"]
    scene = Scene(load=1000).replace([*keys, "rail.isotropic=[60, 8]", "wheel.steel=1070"])
    law, steel = hardening(scene.rail), hardening(scene.wheel)
    assert law.backstresses == (Backstress(40000, 100), Backstress(5000, 0))
    assert law.isotropic == (60, 8) and law.recall_exponent == 0
    assert steel.recall_exponent == 5 and len(steel.backstresses) == 5
    for part, (c, r) in zip(steel.backstresses, JIANG, strict=True):
        assert part.modulus == pytest.approx(1.5 * c * r, rel=2e-3)
        assert part.recall == pytest.approx(1.5**0.5 * c, abs=0.06)


def test_a_modulus_goes_on_and_a_file_ends(tmp_path) -> None:
    straight = hardening(Rail(yield_stress=500, hardening_modulus=1e3, kinematic_fraction=0.7))
    assert straight.kinematic == 0.7
    assert straight.stress_and_slope(np.array([0.0, 5.0]))[0] == pytest.approx([500, 5500])
    file = tmp_path / "curve.csv"
    file.write_text("\ufeffstrain,stress\n0,480\n0.001,580\n\n", encoding="utf-8")
    curve = hardening(Rail(stress_strain=str(file)))
    assert curve.stress_and_slope(np.array([0.0005, 0.01]))[0] == pytest.approx([530, 580])


@pytest.mark.parametrize(
    "rows, said",
    [
        (
            "0,500\n0.1,450",
            "line 2: stress 450 is not allowed; give 500 to 1e.09 MPa, as it may not fall",
        ),
        ("0.01,500\n0.1,600", "line 1: the first plastic strain is 0.01; give 0"),
        ("strain,stress\n0,500\n0,600", "line 3: plastic strain 0 does not rise"),
        ("0,500", "has 1 points; give at least two"),
        ("0,1e-300\n0.1,1e11", "line 1: stress 1e-300 is not allowed"),
        ("0,500\nx,600", "line 2: 'x,600' is no point"),
        ("\udcff\udcfe\x00\x01,5", "curve.csv, line 1: no points follow"),
    ],
)
def test_a_wrong_curve_names_its_line(tmp_path, rows: str, said: str) -> None:
    file = tmp_path / "curve.csv"
    file.write_bytes(rows.encode(errors="surrogateescape"))
    with pytest.raises(SceneError, match=said):
        Rail(stress_strain=str(file))


@pytest.mark.parametrize(
    "keys",
    [
        ["rail.yield_stress=300", "effects.plasticity=off"],
        [*ROLLING, "effects.finite_bodies=off"],
    ],
)
def test_linear_tetrahedra_matter_only_where_cells_yield_or_roll(keys: list[str]) -> None:
    planning.make(find("hertz_ellipse").replace([*keys, "mesh.order=1"]))


PAIRS = ((-10.0, 0.5), (20.0, 0.4), (60.0, 0.1))


def scene(coefficient: object) -> Scene:
    return Scene(load="80 kN", friction={"coefficient": coefficient})


def test_pairs_are_the_same_in_toml_in_set_and_in_python(tmp_path) -> None:
    given = scene([["-10 deg", 0.5], (20, "40%"), [60, 0.1]])
    assert given.friction.coefficient == PAIRS
    text = "friction.coefficient=[[-10, 0.5], [20, 0.4], [60, 0.1]]"
    assert scene(0.3).replace([text]) == given
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(catalogue.portable(given)))
    assert catalogue.read_scene(tmp_path / "scene.toml") == given


def test_between_angles_it_is_linear_and_beyond_them_constant() -> None:
    angles = np.radians([-90.0, -10.0, 5.0, 20.0, 50.0, 60.0, 80.0])
    found = scene(PAIRS).friction.at(angles, 0.0)
    assert found == pytest.approx([0.5, 0.5, 0.45, 0.4, 0.175, 0.1, 0.1])
    assert scene(0.3).friction.at(angles, 0.0).tolist() == 7 * [0.3]
    assert scene("30%").friction.at(math.pi / 4, 0.0) == 0.3


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([], "rising angles"),
        ([[0, 0.3], [0, 0.4]], "rising angles"),
        ([[20, 0.3], [10, 0.4]], "rising angles"),
        ([0.3, 0.4], "give pairs"),
        ([[0, 0.3, 0.1]], "give pairs"),
        ([[0, 0.0], [60, 0.1]], "0.0 is not allowed; give a number from 0 to 2, but not 0"),
        ([[0, 3.0], [60, 0.1]], "3.0 is not allowed"),
        ([["x", 0.3], [60, 0.1]], "'x' is not an angle; give degrees"),
        ([[0, 0.3], [91, 0.1]], "91 is not allowed; give an angle from -90 to 90 deg"),
        (3.0, "give a number from 0 to 2 or pairs of an angle and a coefficient"),
        ("high", "'high' is not a number"),
        ("[[0, 0.3], [60, 0.1", "is not a number"),
    ],
)
def test_what_is_neither_a_number_nor_pairs_is_refused_in_one_line(given, words: str) -> None:
    said = refusal(lambda: scene(given))
    assert said.startswith("friction.coefficient: ") and words in said


SCENE = Scene(load=1e4, wheel={"rolling_radius": 450.0})


@pytest.mark.parametrize(
    "keys, said",
    [
        ({"kind": "dent"}, "rail.surface.kind: 'dent' is not allowed; give flat, cosine or map"),
        ({"length": 3.0}, "rail.surface.kind: is missing; give flat, cosine, map"),
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
    scene = catalogue.read_scene(tmp_path / "a.toml")
    assert scene.rail.surface.file == str(tmp_path / "m.csv")
    assert Path(scene.rail.surface.file) in scene.files
    assert catalogue.portable(scene)["rail"]["surface"]["file"].startswith("input/")
