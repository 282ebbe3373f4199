"""Scenes: values with units, defaults, what is replaced, and what is wrong, said in one line."""

import math
import pickle
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import get_args

import command
import numpy as np
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st
from one_line import refusal

import railhead as rh
from railhead.scene import catalogue, units
from railhead.scene.scene import (
    Scene,
    SceneError,
    Wheel,
    unit_questions,
)

HALF = {"rail.extent": "half-space"}
ARC_RAIL = {"rail.profile": "arc", "rail.extent": "half-space"}
ARC_WHEEL = {"wheel.profile": "arc"}


def scene(**keys) -> Scene:
    """Return a scene of 25 kN with some dotted keys set."""
    data = {"load": 25000}
    for key, value in keys.items():
        section, dot, leaf = key.partition(".")
        if dot:
            data.setdefault(section, {})[leaf] = value
        else:
            data[section] = value
    return Scene.from_mapping(data)


NAN, INF = math.nan, math.inf


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
    assert scene(**{key: text}).value(key) == number


@pytest.mark.parametrize("kind", [units.FORCE, units.LENGTH, units.STRESS, units.DURATION])
@pytest.mark.parametrize(
    "number", ["25", "0.42", "-1.1", "2.1e5", "0.1", "1e-3", "123456.789012345"]
)
def test_usual_units_are_those_of_pint(kind: units.QuantityKind, number: str) -> None:
    by_pint = replace(kind, factors={})
    for name in kind.factors:
        assert kind.convert(number, name) == by_pint.convert(number, name)


def test_a_scene_and_its_error_survive_a_pickle() -> None:
    whole = scene()
    assert len({whole, scene()}) == 1 and pickle.loads(pickle.dumps(whole)) == whole
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
    "a switch by true": ({}, ["effects.heat=true"], {"effects.heat": "on"}),
    "a switch by False": ({}, ["effects.heat=off"], {"effects.heat": False}),
    "several keys": (
        {},
        ["load=110kN", "rail.profile=arc", "rail.crown_radius = 80", "solver.theta=-1", "name='x'"],
        {"load": 110000, **CROWN, "solver.theta": -1, "name": "x"},
    ),
    "load by approach": ({}, ["approach=0.1 mm"], BY_APPROACH),
    "approach by load": (BY_APPROACH, ["load=25 kN"], {}),
    "no approach": ({}, ["approach=none"], {}),
    "no method": ({}, ["solver.theta=-1", "solver.method=none"], {"solver.theta": -1}),
    "theta beside nitsche": ({"solver.theta": 0}, ["solver.method=nitsche"], {"solver.theta": 0}),
    "no theta by penalty": (
        {"solver.theta": 0},
        ["solver.method=penalty"],
        {"solver.method": "penalty"},
    ),
    "an arc by a rail": (CROWN, ["rail.profile=60E1"], {"rail.profile": "60E1"}),
    "an arc by itself": (CROWN, ["rail.profile=arc"], CROWN),
    "a rail, no power of ten": ({}, ['rail.profile="60E1"'], {"rail.profile": "60E1"}),
    "rails by other names": (
        {"rail.profile": "UIC54"},
        ["rail.profile=UIC60"],
        {"rail.profile": "60e1"},
    ),
    "a wheel in small letters": ({}, ["wheel.profile=s1002"], {"wheel.profile": "S1002"}),
    "a name, no power of ten": ({}, ["name=1e3"], {"name": "1e3"}),
    "a name, no date": ({}, ["name=2012-06-01"], {"name": "2012-06-01"}),
}


@pytest.mark.parametrize(("before", "assigned", "after"), REPLACED.values(), ids=REPLACED)
def test_assignments_replace_keys_and_what_they_exclude(before, assigned, after) -> None:
    assert scene(**before).replace(assigned) == scene(**after)


def ranges(annotation: object) -> Iterator[units.Range]:
    """Ranges of numbers in the type of a key, also of tables in tables."""
    if isinstance(annotation, units.Range):
        yield annotation
    for field in getattr(annotation, "model_fields", {}).values():
        for each in (*field.metadata, field.annotation):
            yield from ranges(each)
    for each in get_args(annotation):
        yield from ranges(each)


def test_what_a_message_gives_as_an_example_is_read() -> None:
    """By the very key that names it."""
    read = 0
    for quantity in ranges(Scene):
        for words in (quantity.kind.hint, quantity.allowed):
            for example in filter(None, re.split(r", | or ", words.partition("e.g. ")[2])):
                assert math.isfinite(units.to_base(example.strip('"'), quantity.kind)), example
                read += 1
    assert read > 50


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


WRONG: list[tuple[str, object, str]] = [
    ("load", "25 kg", "'25 kg' is not a force; give newtons"),
    ("load", 0, "0 is not allowed; give a force from 1e-40"),
    ("load", "-3 kN", "'-3 kN' is not allowed"),
    ("load", INF, "inf is not allowed; give a force from 1e-40"),
    ("load", NAN, "nan is not a force"),
    ("load", "nan", "'nan' is not a force"),
    ("load", True, "True is not a force"),
    ("load", [25000], "[25000] is not a force"),
    ("load", {"value": 1}, "is not a force"),
    ("load", "", "'' is not a force"),
    ("load", "heavy", "'heavy' is not a force"),
    ("load", "25 kiloelephants", "is not a force"),
    ("load", "25,5 kN", "is not a force"),
    ("load", "25 kN kN", "is not a force"),
    ("load", "9**9**9 N", "is not a force"),
    ("load", "1 N**9**9**9", "is not a force"),
    ("load", "1 mm**0", "is not a force"),
    ("load", "5%", "is not a force"),
    ("load", "25\nkg", "is not a force"),
    ("load", 10**400, "is not a force"),
    ("load", 10**5000, "is not a force; give newtons"),
    ("load", "1e9999999999999999999 N", "is not a force"),
    ("load", "1e400 N", "is not allowed; give a force from"),
    ("load", 1 + 2j, "is not a force"),
    ("load", 25 * pint.UnitRegistry().kN, "is not a force"),
    ("load", np.array([[1.0], [2.0]]), "is not a force"),
    ("approach", 0.1, "load, approach: both are given (25000, 0.1); give exactly one"),
    ("approach", "1 N", "'1 N' is not a length"),
    ("approach", -0.1, "-0.1 is not allowed; give a length from"),
    ("accuracy", 0.0004, "0.0004 is not allowed; give a fraction from 0.0005 to 0.2"),
    ("accuracy", "21%", "'21%' is not allowed; give a fraction from 0.0005 to 0.2"),
    ("accuracy", "1 deg", "'1 deg' is not a fraction"),
    ("name", "a/b", "'a/b' is not allowed; give 1 to 100 letters"),
    ("name", "\u8f2a" * 34, "is not allowed; give 1 to 100 letters"),
    ("name", "..", "'..' is not allowed"),
    ("name", "", "'' is not allowed"),
    ("name", "a\n", "is not allowed"),
    ("name", 7, "7 is not allowed"),
    ("name", "x" * 101, "is not allowed"),
    ("rail", 5, "5 is not a table; give [rail] and its keys"),
    ("rail", None, "None is not a table"),
    (
        "rail.profile",
        "54E2",
        "'54E2' is not allowed; give 54E1, 60E1, arc or a .csv, .txt, .dat, .asc, .tsv, .mpt, "
        ".ban, .prr or .rail file",
    ),
    ("rail.profile", 54, "54 is not allowed"),
    ("rail.profile", 60e1, "600.0 is not allowed; give a text in quotes: 54E1, 60E1, arc or"),
    ("wheel.segment_length", 1009, "1009 is not allowed; give at most 2.4 rolling_radius (1008)"),
    ("rail.profile", "no_such_file.csv", "is not a readable file"),
    ("rail.profile", "\ud800.csv", "is not a readable file"),
    ("rail.profile", "\0.csv", "is not a readable file"),
    ("rail.profile", "arc", "rail.crown_radius: not given; profile arc needs it"),
    ("rail.crown_radius", 80, "80 is not allowed; only profile arc takes it"),
    ("rail.crown_radius", 0, "0 is not allowed; give a length from 1e-6 to 1e9 mm; inf is flat"),
    ("rail.crown_radius", "80 MPa", "'80 MPa' is not a length"),
    (
        "rail.crown_radus",
        80,
        "unknown key; did you mean crown_radius? allowed here: young",
    ),
    ("rail.zzz", 80, "unknown key; allowed here: young_modulus, poisson_ratio, steel,"),
    ("rail.inclination", "1:4", "'1:4' is not allowed; give a slope from -0.2 to 0.2"),
    ("rail.inclination", "1:0", "'1:0' is not a slope; give a slope or an angle"),
    ("rail.inclination", "12 deg", "'12 deg' is not allowed"),
    ("rail.inclination", "180 deg", "'180 deg' is not a slope"),
    ("rail.inclination", "inf deg", "'inf deg' is not a slope"),
    ("rail.inclination", "0.05 mm", "'0.05 mm' is not a slope"),
    ("rail.extent", "whole", "'whole' is not allowed; give head, section or half-space"),
    ("rail.extent", ["head"], "['head'] is not allowed"),
    ("rail.length", INF, "inf is not allowed; give a length from 0.001 to 1e6 mm"),
    ("rail.young_modulus", "207 kN", "'207 kN' is not a stress; give megapascals"),
    (
        "rail.young_modulus",
        0,
        "0 is not allowed; give a stress from 1e-12 to 1e15 MPa; inf is rigid",
    ),
    ("rail.young_modulus", None, "None is not a stress"),
    ("rail.poisson_ratio", 0.5, "0.5 is not allowed; give a number from 0 to 0.5, but not 0.5"),
    ("rail.poisson_ratio", -0.1, "-0.1 is not allowed"),
    ("rail.poisson_ratio", "0.3 mm", "'0.3 mm' is not a number"),
    ("rail.yield_stress", INF, "inf is not allowed; give a stress from 1e-6 to 1e9 MPa"),
    ("wheel.profile", "54E1", "give cylinder, cone20, cone40, S1002, arc or a .csv, .txt, .dat"),
    ("wheel.profile", "arc", "wheel.transverse_radius: not given"),
    ("wheel.transverse_radius", 300, "300 is not allowed; only profile arc takes it"),
    ("wheel.transverse_radius", 0, "0 is not allowed; give a length from 1e-6 to 1e9 mm"),
    ("wheel.rolling_radius", 0, "0 is not allowed; give a length from 1e-6 to 1e9 mm; inf is flat"),
    ("rail.depth", 40, "40 is not allowed; only profile arc takes it"),
    ("rail.width", 40, "40 is not allowed; only profile arc takes it"),
    ("effects.plane_strain", "yes", "'yes' is not allowed; give auto, on or off"),
    ("wheel.rim_depth", "thick", "'thick' is not a length"),
    ("wheel.width", -1, "-1 is not allowed"),
    ("wheel.segment_length", "1:20", "'1:20' is not a length"),
    ("wheelset.shift", "31 mm", "'31 mm' is not allowed; give a length from -30 to 30 mm"),
    ("solver.method", "lagrange", "'lagrange' is not allowed; give nitsche or penalty"),
    ("solver.method", "\ud800", "is not Unicode text"),
    ("solver.theta", 2, "2 is not allowed; give 1, 0 or -1"),
    ("solver.theta", 0.5, "0.5 is not allowed; give 1, 0 or -1"),
    ("solver.theta", True, "True is not a number"),
    ("solver.gamma_factor", 0, "0 is not allowed; give a positive, finite number"),
    ("solver.linear", None, "None is not allowed; give auto, direct or multigrid"),
    ("solver.max_newton", 0, "0 is not allowed; give a whole number from 1 to 200"),
    ("solver.max_newton", 201, "201 is not allowed"),
    ("solver.max_newton", 3.5, "3.5 is not allowed"),
    ("mesh.cell", "prism", "'prism' is not allowed; give tetrahedron or hexahedron"),
    ("mesh.order", 3, "3 is not allowed; give 1 or 2"),
    ("mesh.patch_size", 0, "0 is not allowed"),
    ("effects.symmetry", 2, "2 is not allowed; give auto, on or off"),
    ("lode", 25000, "unknown key; did you mean load? allowed here: name, load,"),
    ("a\nb", 1, "unknown key; allowed here: name,"),
    ("", 1, "'': unknown key"),
    ("self", 1, "unknown key"),
    ("unload", "maybe", "'maybe' is not allowed; give true or false"),
]


@pytest.mark.parametrize(
    ("key", "value", "words"), WRONG, ids=[f"{n}-{row[0]}" for n, row in enumerate(WRONG)]
)
def test_wrong_value_is_named_in_one_line(key: str, value: object, words: str) -> None:
    line = refusal(lambda: scene(**{key: value}))
    assert words in line
    assert (words if ": " in words and "." in words else key.replace("\n", "\\n")) in line


ARC = {"rail.profile": "arc", "rail.crown_radius": 80}
CONTRADICTIONS = [
    ({"load": None}, "load, approach: neither is given; give exactly one of them"),
    ({"rail.young_modulus": INF, "wheel.young_modulus": INF}, "both are inf (rigid)"),
    (
        {**ARC_RAIL, "rail.crown_radius": INF, "wheel.rolling_radius": INF},
        "curvature of 0 1/mm is neither a point nor a line contact",
    ),
    ({**HALF, **ARC_WHEEL, "wheel.transverse_radius": -200}, "curvature of -0.00166667 1/mm"),
    (
        {"solver.method": "penalty", "solver.theta": 0},
        "solver.theta: 0 is not allowed; only method nitsche",
    ),
    ({"rolling.pressure": "hertz"}, "rolling.pressure: hertz is not allowed without"),
    ({**HALF, "wheel.profile": "S1002"}, "wheel.profile: 'S1002' has no single radius"),
    *(
        ({**ARC, key: 1e-4}, f"{key}: 0.0001 is not allowed; give a length from 0.001 to 1e6 mm")
        for key in ("rail.length", "rail.depth", "rail.width", "wheel.width", "wheel.rim_depth",
                    "wheel.segment_length")
    ),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "words"), CONTRADICTIONS)
def test_contradiction_is_named_in_one_line(keys, words: str) -> None:
    assert words in refusal(lambda: scene(**keys))


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("load", "assignment: 'load' is not key=value"),
        ("=3", "assignment: '=3' is not key=value"),
        ("", "assignment: '' is not key=value"),
        ("rail=5", "rail: 5 is not allowed; set one of its keys: young_modulus"),
        ("rail={profile='arc'}", "rail: "),
        ("load=", "load: '' is not a force"),
        ("load=[1]", "load: [1] is not a force"),
        ("load.x=1", "load: {'x': 1} is not a force"),
        ("rail.a.b=1", "rail.a: unknown key"),
        ("foo.bar=1", "foo: unknown key"),
        ("rail.poisson_ratio=0.5", "rail.poisson_ratio: 0.5 is not allowed"),
        ("load=" + "[" * 5000, "load: "),
        (".=1", "'': unknown key"),
        ("load=1\nname = 2", r"load: '1\nname = 2' is not a force"),
    ],
)
def test_malformed_assignment_is_named_in_one_line(assignment: str, words: str) -> None:
    assert words in refusal(lambda: scene().replace([assignment]))


@pytest.mark.parametrize("data", [5, None, "load = 1", [("load", 1)], {5: 1}, {"rail": {5: 1}}])
def test_from_mapping_refuses_what_is_no_table_of_keys(data) -> None:
    with pytest.raises(SceneError):
        Scene.from_mapping(data)


@given(st.sampled_from(["load", "rail.inclination", "accuracy", "rail.profile", "name"]), st.text())
def test_any_text_is_read_or_refused_in_one_line(key: str, text: str) -> None:
    try:
        assert scene(**{key: text}).wheel == Wheel()
    except SceneError as error:
        assert len(str(error).splitlines()) == 1


def test_none_gives_any_key_its_default() -> None:
    given = scene(**{"rail.gauge": 1435, "rail.steel": "R260", "accuracy": 0.01})
    assert given.replace(["rail.gauge=none", "rail.steel=none", "accuracy=none"]) == scene()
    assert scene(**{"rail.profile": "none", "wheel.rolling_radius": "none"}) == scene()
    assert "unknown key" in refusal(lambda: scene(**{"rail.gouge": "none"}))


@pytest.mark.parametrize("texts", [3, "load=1", None])
def test_assignments_that_are_no_list_are_one_line(texts: object) -> None:
    for call in (rh.find("hertz_ellipse").replace, lambda keys: rh.profile([[0, 0]], None, keys)):
        with pytest.raises(rh.SceneError, match="assignments: .* is no list of texts; give one"):
            call(texts)
