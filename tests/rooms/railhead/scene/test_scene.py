"""A scene takes what is right, and says in one line what is wrong."""

import math
import pickle
import re
from dataclasses import replace

import command
import numpy as np
import pint
import pytest
from pydantic import ValidationError
from scene_keys import ARC_RAIL, ARC_WHEEL, HALF, scene

import railhead as rh
from railhead.scene import catalogue, units
from railhead.scene.scene import (
    Effects,
    Mesh,
    Rail,
    Scene,
    SceneError,
    Solver,
    Wheel,
    Wheelset,
    unit,
    unit_questions,
)

INF = math.inf


def value_of(whole: Scene, key: str) -> object:
    """Return the value of a dotted key."""
    section, dot, leaf = key.partition(".")
    return getattr(getattr(whole, section), leaf) if dot else getattr(whole, section)


@pytest.mark.parametrize(("word", "value"), [("on", True), ("off", False)])
def test_on_and_off_are_true_and_false_too(tmp_path, word: str, value: bool) -> None:
    (file := tmp_path / "it.toml").write_text(f"load = 1\neffects.heat = {value}".lower())
    for found in (
        catalogue.read_scene(file),
        scene().replace([f"effects.heat={value}"]),
        scene().replace(effects={"heat": value}),
    ):
        assert found.effects.heat == word


@pytest.mark.parametrize(
    ("key", "text", "number"),
    [
        ("load", "25 kN", 25000.0),
        ("load", "110.3kN", 110300.0),
        ("load", " 0.11 MN ", 110000.0),
        ("load", "25\u00a0kN", 25000.0),
        ("load", "1 kgf", 9.80665),
        ("load", "25000", 25000.0),
        ("load", np.int64(25000), 25000.0),
        ("accuracy", "1%", 0.01),
        ("accuracy", "5 %", 0.05),
        ("rail.length", "42 cm", 420.0),
        ("rail.length", "1 in", 25.4),
        ("rail.length", "300 µm", 0.3),
        ("rail.young_modulus", "207 GPa", 207000.0),
        ("rail.young_modulus", "210 kN/mm²", 210000.0),
        ("rail.young_modulus", "2.1e5 N/mm^2", 210000.0),
        ("rail.young_modulus", "inf", INF),
        ("rail.poisson_ratio", "30%", 0.3),
        ("rail.inclination", "1:20", 0.05),
        ("rail.inclination", "-1 / 40", -0.025),
        ("rail.inclination", "2.5%", 0.025),
        ("rail.inclination", "2.86 deg", math.tan(math.radians(2.86))),
        ("rail.inclination", "-50 mrad", math.tan(-0.05)),
        ("wheel.rolling_radius", "0.42 m", 420.0),
        ("wheelset.shift", "-0.5 cm", -5.0),
        ("solver.theta", -1.0, -1),
        ("solver.max_newton", "200", 200),
        ("mesh.order", 1, 1),
    ],
)
def test_units_are_converted_exactly(key: str, text: object, number: float) -> None:
    assert value_of(scene(**{key: text}), key) == number


@pytest.mark.parametrize("kind", [units.FORCE, units.LENGTH, units.STRESS, units.DURATION])
@pytest.mark.parametrize(
    "number", ["25", "0.42", "-1.1", "2.1e5", "0.1", "1e-3", "123456.789012345"]
)
def test_usual_units_are_those_of_pint(kind: units.QuantityKind, number: str) -> None:
    by_pint = replace(kind, factors={})
    for name in kind.factors:
        assert kind.convert(number, name) == by_pint.convert(number, name)


def test_aliases_name_the_standard_profile() -> None:
    assert scene(**{"rail.profile": "UIC54"}).rail.profile == "54E1"
    assert scene(**{"rail.profile": "UIC60"}).rail.profile == "60E1"
    assert scene(**{"rail.profile": "60e1"}).rail.profile == "60E1"
    assert scene(**{"wheel.profile": "s1002"}).wheel.profile == "S1002"


def test_defaults_are_the_thesis_pair() -> None:
    assert scene() == Scene(
        name="scene",
        load=25000,
        rail=Rail(profile="54E1", extent="head", young_modulus=207000, poisson_ratio=0.3),
        wheel=Wheel(profile="cylinder", rolling_radius=420, young_modulus=207000),
        wheelset=Wheelset(shift=0),
        solver=Solver(method="nitsche", theta=None, gamma_factor=1, linear="auto", max_newton=30),
        mesh=Mesh(cell="tetrahedron", order=None),
        effects=Effects(symmetry="auto"),
    )


def test_python_side_reads_units_and_raises_scene_error() -> None:
    keys = {"profile": "arc", "crown_radius": "8 cm"}
    assert Rail(**keys).crown_radius == 80
    with pytest.raises(SceneError, match="^crown_radius: -1 is not allowed"):
        Rail(profile="arc", crown_radius=-1)
    with pytest.raises(SceneError, match="^load, approach: neither is given"):
        Scene()


def test_scene_is_frozen_hashable_and_picklable() -> None:
    whole, key = scene(), "load"
    with pytest.raises(ValidationError):
        setattr(whole, key, 3.0)
    assert len({whole, scene()}) == 1
    assert pickle.loads(pickle.dumps(whole)) == whole
    error = pickle.loads(pickle.dumps(SceneError("load", "is wrong")))
    assert (str(error), error.key) == ("load: is wrong", "load")


@pytest.mark.parametrize(
    ("keys", "across"),
    [
        ({}, 1 / 300),
        ({"wheel.profile": "cone20", "rail.profile": "60E1"}, 1 / 300),
        ({**ARC_WHEEL, "wheel.transverse_radius": -330}, 1 / 300 - 1 / 330),
        ({**ARC_WHEEL, "wheel.transverse_radius": INF}, 1 / 300),
        ({**ARC_RAIL, "rail.crown_radius": 80}, 1 / 80),
    ],
)
def test_relative_curvatures_of_half_spaces(keys, across: float) -> None:
    assert scene(
        **HALF, **{k: v for k, v in keys.items() if k not in HALF}
    ).relative_curvatures() == pytest.approx((1 / 420, across), rel=1e-15)


BY_APPROACH = {"load": None, "approach": 0.1}
CROWN = {"rail.profile": "arc", "rail.crown_radius": 80}
#: Keys of a scene, what is assigned, and the keys that it has then.
REPLACED = {
    "nothing": ({}, [], {}),
    "several keys": (
        {},
        ["load=110kN", "rail.profile=arc", "rail.crown_radius = 80", "solver.theta=-1", "name='x'"],
        {"load": 110000, **CROWN, "solver.theta": -1, "name": "x"},
    ),
    "load by approach": ({}, ["approach=0.1 mm"], BY_APPROACH),
    "approach by load": (BY_APPROACH, ["load=25 kN"], {}),
    "no approach": ({}, ["approach=none"], {}),
    "no method": ({}, ["solver.theta=-1", "solver.method=none"], {"solver.theta": -1}),
    "an arc by a rail": (CROWN, ["rail.profile=60E1"], {"rail.profile": "60E1"}),
    "an arc by itself": (CROWN, ["rail.profile=arc"], CROWN),
    "a rail, no power of ten": ({}, ['rail.profile="60E1"'], {"rail.profile": "60E1"}),
    "a rail by its other name": ({}, ["rail.profile=UIC60"], {"rail.profile": "60E1"}),
    "a name, no power of ten": ({}, ["name=1e3"], {"name": "1e3"}),
    "a name, no date": ({}, ["name=2012-06-01"], {"name": "2012-06-01"}),
}


@pytest.mark.parametrize(("before", "assigned", "after"), REPLACED.values(), ids=REPLACED)
def test_assignments_replace_keys_and_what_they_exclude(before, assigned, after) -> None:
    assert scene(**before).replace(assigned) == scene(**after)


def test_what_a_message_gives_as_an_example_is_read() -> None:
    """By the very key that names it."""
    read = 0
    for name, kind in vars(units).items():
        for quantity in getattr(kind, "__metadata__", ()):
            for words in (quantity.kind.hint, quantity.allowed):
                examples = re.split(r", | or ", words.partition("e.g. ")[2])
                for example in filter(None, examples):
                    number = units.to_base(example.strip('"'), quantity.kind)
                    assert math.isfinite(number), (name, example)
                    read += 1
    assert read > 50


def test_keys_have_the_units_of_their_quantities() -> None:
    known = {"load": "N", "rail.smoothing": "mm", "wheelset.yaw": "rad", "rail.profile": "",
             "rail.yield_stress": "MPa", "rail.inclination": "", "rolling.spin": "1/mm",
             "friction.tangential_load": "N", "no.key": ""}  # fmt: skip
    assert {key: unit(key) for key in known} == known


def test_files_that_a_scene_needs_are_named() -> None:
    scene = rh.find("hertz_ellipse")
    assert scene.files == []
    needs = scene.model_copy(
        update={"rail": scene.rail.model_copy(update={"profile": "/a/worn.ban"}),
                "wheel": scene.wheel.model_copy(update={"stress_strain": "/b/er7.csv"})}
    )  # fmt: skip
    assert [path.name for path in needs.files] == ["worn.ban", "er7.csv"]


# Questions about units that were probably mixed up.


@pytest.mark.parametrize(
    "key, value, meant",
    [
        ("rail.young_modulus", "207", "207000 MPa"),
        ("rail.young_modulus", "207e9", "207000 MPa"),
        ("wheel.young_modulus", "207e6", "207000 MPa"),
        ("wheel.rolling_radius", "0.42", "420 mm"),
        ("load", "25", "25000 N"),
        ("rail.yield_stress", "0.472", "472 MPa"),
        ("rail.crown_radius", "0.3", "300 mm"),
        ("wheel.transverse_radius", "-0.33", "-330 mm"),
    ],
)
def test_a_thousand_times_off_is_asked_about(key: str, value: str, meant: str) -> None:
    arcs = (
        [f"{key.split('.')[0]}.profile=arc"] if key.endswith("radius") and "roll" not in key else []
    )
    (line,) = unit_questions(rh.find("uic54_thesis").replace([*arcs, f"{key}={value}"]))
    assert line.startswith(f"{key} = ") and line.endswith(f"{meant} meant?")


def test_usual_and_small_models_are_not_asked_about() -> None:
    for case in catalogue.shipped():
        assert not list(unit_questions(rh.find(case))), case
    soft = ["rail.young_modulus=20", "load=30"]
    assert not list(unit_questions(rh.find("sphere_on_plane").replace(soft)))


def test_quantities_of_pint_are_read() -> None:
    """Of a registry of the script's own."""
    of = pint.UnitRegistry()
    asked = rh.find("uic54_thesis").replace(
        load=25.5 * of.kN, wheel={"young_modulus": 207 * of.GPa, "rolling_radius": 0.42 * of.m}
    )
    assert (asked.load, asked.wheel.young_modulus) == (25500.0, 207000.0)
    assert asked.wheel.rolling_radius == 420.0
    with pytest.raises(SceneError, match="load: .*is not a force"):
        asked.replace(load=3 * of.s)


def test_of_several_scenes_the_first_wrong_value_of_a_key_is_asked_about() -> None:
    """A sweep over loads without a unit asks once."""
    scene = rh.find("uic54_thesis")
    (line,) = unit_questions(*(scene.replace(load=load) for load in (25e3, 30.0, 40.0)))
    assert line.startswith("load = 30 N")


def test_a_script_is_warned_where_it_calls() -> None:
    """Solving asks as planning does."""
    asked = rh.find("hertz_ellipse").replace(
        ["effects.finite_bodies=off", "rail.young_modulus=207"]
    )
    for call in (rh.plan, rh.solve):
        with pytest.warns(UserWarning, match="207000 MPa meant") as caught:
            call(asked, quiet=True)
        assert caught[0].filename == __file__


def test_the_command_asks_in_one_line_and_goes_on(capsys) -> None:
    assert command.status("plan", "sphere_on_plane", "--set", "wheel.young_modulus=207") == 0
    out, err = capsys.readouterr()
    assert "predicted" in out
    assert err.splitlines() == [
        "railhead: wheel.young_modulus = 207 MPa, 0.001 times what is usual: 207000 MPa meant?"
    ]
