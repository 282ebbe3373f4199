"""What is wrong with a scene is said in one line: which key, what it was, what is allowed."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from one_line import refusal
from scene_keys import ARC_RAIL, ARC_WHEEL, HALF, scene

import railhead as rh
from railhead.scene.scene import Scene, SceneError, Wheel

NAN, INF = math.nan, math.inf
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
        ".ban or .prr file",
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


def test_half_space_refuses_a_tabulated_profile(tmp_path) -> None:
    table = tmp_path / "rail.csv"
    table.write_text("0,0\n")
    assert scene(**{"rail.profile": table}).rail.profile == str(table)
    with pytest.raises(SceneError, match="rail.profile: .* has no single radius"):
        scene(**{"rail.profile": str(table), **HALF})


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
    with pytest.raises(SceneError, match="unknown key"):
        scene(**{"rail.gouge": "none"})


@pytest.mark.parametrize("texts", [3, "load=1", None])
def test_assignments_that_are_no_list_are_one_line(texts: object) -> None:
    for call in (rh.find("hertz_ellipse").replace, lambda keys: rh.profile([[0, 0]], None, keys)):
        with pytest.raises(rh.SceneError, match="assignments: .* is no list of texts; give one"):
            call(texts)
