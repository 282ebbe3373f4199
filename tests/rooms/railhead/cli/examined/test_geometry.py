"""`railhead locate` and `railhead profile`, and measured profiles in a scene: numbers, refusals."""

import json
import math
import os
import re
from functools import partial
from pathlib import Path

import command
import drawn_sections
import numpy as np
import pytest
from csv_rows import rows
from matplotlib.text import Text
from one_line import refusal

import railhead as rh
from railhead import api
from railhead.cases.s1002_60e1 import SCENE
from railhead.cli.examined import geometry
from railhead.contact import solid
from railhead.geometry import profiles
from railhead.results.report import output_units, terminal
from railhead.scene.scene import Scene, SceneError

DATA = Path(__file__).parents[2] / "geometry" / "data"
BAN, PRW = str(DATA / "MBench_UIC60_v3.ban"), str(DATA / "MBench_S1002_v3.prw")


def test_a_drawn_profile_is_said_to_be_taken_as_drawn(tmp_path) -> None:
    y = np.arange(-35.0, 35.1, 0.25)
    points = np.column_stack([y, profiles.rail_head("60E1").height(y)])
    np.savetxt(tmp_path / "rail.csv", points, "%.6f", ",")
    found = rh.profile(tmp_path / "rail.csv").measured
    text = " ".join(terminal.profile_lines({"rail": found.summary()}))
    assert "taken as drawn (points 0.25 mm apart, rounded to 1e-06 mm)" in text
    assert "smoothing" not in text


@pytest.fixture(autouse=True)
def _few_positions(monkeypatch) -> None:
    """Three of the many that a wheelset is placed at."""
    monkeypatch.setattr(geometry, "SHIFTS", np.linspace(-3.0, 3.0, 3))


@pytest.fixture(scope="module")
def worn(tmp_path_factory) -> Scene:
    """54E1 under a cylinder, 10 um of noise."""
    rail = profiles.rail_head("54E1")
    y = np.arange(rail.domain[0] + 0.3, rail.domain[1] - 0.3, 0.2)
    noise = np.random.default_rng(1).normal(0.0, 0.01, y.shape)
    z = rail.height(y) - np.exp(-((y / 25.0) ** 2) / 2) + noise
    file = tmp_path_factory.mktemp("worn") / "1.csv"
    np.savetxt(file, np.column_stack([y, z]), "%.5f", ",", header="y, z in mm")
    rail_keys = {"profile": str(file), "inclination": 0}
    return Scene.from_mapping(
        {"name": "worn", "load": 1e5, "rail": rail_keys, "wheel": {"rolling_radius": 460}}
    )


def test_the_plan_says_how_a_profile_was_smoothed_and_what_it_leaves_open(worn: Scene) -> None:
    planned = api.plan(worn)
    found = planned.as_dict()["profiles"]["rail"]
    assert found["noise_mm"] == pytest.approx(0.01, rel=0.25) and 8 < found["smoothing_mm"][1] < 80
    open_ = planned.as_dict()["profile_uncertainty"]["relative"]
    assert 0.005 < open_ < 0.3
    text = " ".join(str(planned).split())
    assert "noise" in text and "smoothing length" in text
    assert f"leaves {open_:.1%} of the largest pressure and of the area open" in text


def test_a_wavelength_that_is_given_is_taken(worn: Scene) -> None:
    found = solid.from_file(worn.replace(["rail.smoothing=12 mm"]), "rail")
    assert found.wavelengths == (12.0, 12.0)


@pytest.mark.slow
def test_the_uncertainty_is_a_part_of_every_estimate_and_no_mesh_mends_it(worn: Scene) -> None:
    """An accuracy finer than it is refused."""
    line = refusal(lambda: rh.solve(worn, accuracy=0.02, quiet=True))
    assert "the measured profile leaves" in line and "on any mesh" in line
    summary = rh.solve(worn, quiet=True).as_dict()
    hidden = summary["plan"]["profile_uncertainty"]["relative"]
    assert hidden > 0.02 and summary["accuracy"]["parts"]
    for name, parts in summary["accuracy"]["parts"].items():
        assert parts["profile"] == hidden
        assert summary["accuracy"]["bound"][name] == pytest.approx(sum(parts.values()))


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("rail.smoothing", "0.5", "0.5 is not allowed; give auto or a wavelength from 1 to 100 mm"),
        ("rail.smoothing", "much", "'much' is not a length; give auto or a wavelength"),
        ("rail.profile_unit", "ft", "'ft' is not allowed; give auto, mm, m or inch"),
        ("rail.profile_mirror", "yes", "'yes' is not allowed; give auto, on or off"),
        ("wheel.profile_flip", "up", "'up' is not allowed; give auto, on or off"),
        ("rail.profile_origin", "mine", "'mine' is not allowed; give auto or file"),
        ("wheel.smoothing", "10", "only a profile from a file takes it"),
        ("rail.profile", PRW, "is not allowed; give 54E1, 60E1, arc or a .csv"),
    ],
)
def test_wrong_keys_are_one_line(worn: Scene, key: str, value: str, words: str) -> None:
    line = refusal(lambda: worn.replace([f"{key}={value}"]))
    assert line.startswith(f"{key}: ") and words in line


def quickly(folder: Path) -> tuple[str, ...]:
    """Options for a command whose files are not looked at."""
    return "--no-pictures", "--out", str(folder / "out")


def test_command_draws_a_profile_and_says_its_wear(here, capsys) -> None:
    assert command.status("profile", BAN) == 0
    text = capsys.readouterr().out
    assert "MiniProf" in text and "mirrored" in text and "against 60E1" in text
    folder = here / "results" / "MBench_UIC60_v3_profile"
    assert {path.name for path in folder.iterdir()} == {
        ".railhead", "input", "profile.csv", "profile.png", "scene.toml", "summary.json",
    }  # fmt: skip
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["standard"] == "60E1" and summary["wear"]["largest_mm"] < 0.1
    written = rows(folder / "profile.csv")
    assert {row["program"] for row in written} == {f"railhead {rh.__version__}"}
    middle = [float(row["curvature_per_mm"]) for row in written if -12 < float(row["y_mm"]) < 0]
    np.testing.assert_allclose(middle, 1 / 300, rtol=0.1)


def test_a_key_of_wheels_tells_a_wheel(tmp_path, capsys) -> None:
    """Of a table of points, which is a rail otherwise."""
    wheel = solid.from_file(Scene.from_mapping({"load": 1, "wheel": {"profile": PRW}}), "wheel")
    np.savetxt(tmp_path / "wheel.csv", wheel.points, delimiter=",")
    given = str(tmp_path / "wheel.csv"), "--set", "wheel.profile_flip=off"
    summary = command.told(capsys, "profile", *given, *quickly(tmp_path))
    assert (summary["body"], summary["standard"]) == ("wheel", "S1002")


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("rail.csv", "y,z\n0,0\n1,x\n", "rail.csv, line 3: '1,x' is no point; give two numbers"),
        ("rail.ban", "0 0\n", "rail.ban, line 1: ends after 1 points; give"),
        ("rail.prr", "point.begin\n", "rail.prr, line 1: ends without point.end; give"),
        ("rail.txt", "0 0\n1 1\n", "rail.txt, line 2: ends after 2 points; give at least 12"),
        ("rail.doc", "0 0\n", "is not allowed; give 54E1, 60E1, arc or a .csv"),
    ],
)
def test_wrong_files_are_one_line_status_2_and_nothing_written(
    name, text, words, here, capsys
) -> None:
    (here / name).write_text(text)
    assert words in command.refused(capsys, "profile", name) and os.listdir(here) == [name]


def test_a_profile_whose_sides_are_open_is_examined_and_not_solved(
    worn: Scene, here, capsys
) -> None:
    """Of a head of no standard, worn at one side, in a table that says nothing."""
    points = np.loadtxt(worn.rail.profile, delimiter=",")
    points[:, 1] -= 1.2 * np.exp(-(((points[:, 0] + 21) / 7) ** 2))
    np.savetxt(here / "wide.csv", points * [1.1, 1], delimiter=",")
    summary = command.told(capsys, "profile", "wide.csv", "--no-pictures")
    assert summary["profile"]["sides"] == "open" and summary["standard"] is None
    wide = worn.replace([f"rail.profile={here / 'wide.csv'}"])
    said = refusal(lambda: api.plan(wide))
    assert said.startswith("rail.profile_mirror: nothing in wide.csv tells its field side")
    api.plan(wide.replace(["rail.profile_mirror=off"]))


def located(*assignments: str) -> dict:
    return geometry.locate(SCENE.replace(assignments)).summary()


def test_command_prints_json_and_writes_pictures(tmp_path, capsys) -> None:
    folder = tmp_path / "located"
    given = f"s1002_60e1 --shift 3mm --yaw 2mrad --out {folder}"
    printed = command.told(capsys, "locate", *given.split())
    assert printed.items() <= json.loads((folder / "summary.json").read_text()).items()
    assert printed["scene"]["wheelset"]["yaw"] == pytest.approx(2e-3)
    assert printed["rolling_radius_difference_mm"] == pytest.approx(0.958, abs=0.01)
    pictures = {path.name for path in folder.glob("*.png")}
    assert pictures == {"profiles.png", "rolling_radius.png", "conicity.png"}


def test_tables_and_pictures_are_in_the_readers_units(tmp_path, capsys) -> None:
    """Of the numbers of a wheelset and of a profile; files keep mm."""
    found = rh.locate(rh.find("s1002_60e1").replace(["wheelset.shift=2.54 mm"]))
    profile, inches = rh.profile(BAN), output_units.parse("in")
    tables = [terminal.recorded(partial(each.show, units=inches)) for each in (found, profile)]
    placed, worn = (" ".join(each.export_text().split()) for each in tables)
    radius = found.placed.right.touches[0].radius
    assert f"{radius / 25.4:.6g}"[:6] in placed and "shift 0.1 in" in placed and "1/in" in placed
    assert " mm" not in placed and worn.count(" mm") == 1  # the unit of the file
    assert f"at most {profile.worn.largest_loss / 25.4:.3g} in along the normal" in worn
    for name, draw in (found.drawings(inches) | profile.drawings(inches)).items():
        texts = [text.get_text() for text in draw(None).figure.findobj(Text)]
        assert not [text for text in texts if re.search(r"\b[mu]m\b", text)], name


def swept(tmp_path, capsys, *arguments: str) -> dict:
    """Summary of `railhead locate`, whose files are in tmp_path/out."""
    given = "locate", "s1002_60e1", "--force", *quickly(tmp_path), *arguments
    return command.told(capsys, *given)


def test_rows_over_shifts_are_those_of_single_places(tmp_path, capsys) -> None:
    """In any order that is typed, printed and in a table; the wheelset is alike on both sides."""
    found = swept(tmp_path, capsys, "--over", "wheelset.shift=3,-3,0.5,7")
    assert [row["shift_mm"] for row in found["rows"]] == [-3.0, 0.5, 3.0, 7.0]
    mirrored, _, row, _ = found["rows"]
    cells, single = rows(tmp_path / "out" / "positions.csv")[2], located("wheelset.shift=3 mm")
    touch = single["right"][0]
    assert row["radius_right_mm"] == pytest.approx(touch["radius_mm"], abs=1e-9)
    assert row["angle_right_deg"] == pytest.approx(math.degrees(touch["angle_rad"]), abs=1e-8)
    assert float(cells["right rail y [mm]"]) == pytest.approx(touch["rail_y_mm"])
    assert float(cells["right rolling radius [mm]"]) == row["radius_right_mm"]
    assert row["roll_mrad"] == pytest.approx(1e3 * single["roll_rad"], abs=1e-9)
    assert mirrored["radius_left_mm"] == row["radius_right_mm"]
    assert mirrored["roll_mrad"] == -row["roll_mrad"]


def test_a_cone_has_its_own_conicity_as_in_the_standard() -> None:
    """Whose tables leave the roll out; the rows have it, and a roll that is given counts."""
    scene = rh.find("cone20_uninclined_uic54").replace(["rail.inclination=1:20"])
    found = rh.locate(scene)
    assert list(found.summary()["conicity"][n]["value"] for n in (0, 10, 20)) == pytest.approx(
        [0.05] * 3, rel=1e-6
    )
    assert any(row["roll_mrad"] for row in found.summary()["rows"])
    rolled = rh.locate(scene.replace(["wheelset.roll=0.001"])).summary()["conicity"][20]["value"]
    assert rolled != pytest.approx(0.05, rel=1e-4)


def test_the_conicity_knows_no_steps(tmp_path, capsys) -> None:
    """Jumps are found between the shifts that are asked for; files hold what is printed."""
    coarse, fine = (
        swept(tmp_path, capsys, "--over", f"wheelset.shift={steps}")
        for steps in ("-8:8:4mm", "-4:4:0.5mm")
    )
    by, all_by = (
        {each["amplitude_mm"]: each["value"] for each in found["conicity"]}
        for found in (fine, coarse)
    )
    assert max(by) == 4.0 and max(all_by) == 8.0
    assert by == pytest.approx({key: all_by[key] for key in by}, rel=1e-8)
    assert fine["jumps_mm"] == pytest.approx([each for each in coarse["jumps_mm"] if abs(each) < 4])
    assert fine["nonlinearity_per_mm"] == pytest.approx((by[4.0] - by[2.0]) / 2)
    written = rows(tmp_path / "out" / "conicity.csv")
    file = {float(row["amplitude [mm]"]): float(row["equivalent conicity"]) for row in written}
    assert file == by
    for jump in fine["jumps_mm"]:
        before, after = (
            located(f"wheelset.shift={jump + step}")["rolling_radius_difference_mm"]
            for step in (-1e-5, 1e-5)
        )
        assert abs(after - before) > 0.1


def test_a_table_of_shifts_is_printed_with_those_left_out(tmp_path, capsys) -> None:
    given = ("--over", "wheelset.shift=-30mm,0,3mm")
    assert command.status("locate", "s1002_60e1", *quickly(tmp_path), *given) == 0
    printed = capsys.readouterr().out
    text = " ".join(printed.split())
    assert "left out -30 mm: the left wheel stands on its flange" in text
    assert re.search(r"^ +3 .* 460\.745 .* 0\.17968$", printed, re.MULTILINE)
    end = r"EN 15302; nonlinearity parameter -0\.031"
    assert re.search(rf"conicity .* 0\.174\d? at 3,.* {end}", text)
    lines = printed.partition("written to ")[0].splitlines()  # the folder's name may be long
    assert max(map(len, lines)) <= 80 and "…" not in printed


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ("load=1kN", "load: is not allowed in over of locate; give wheelset.shift alone"),
        ("wheelset.shift=40", "wheelset.shift: 40 is not allowed; give a length from -30 to 30 mm"),
        ("wheelset.shift", "--over: 'wheelset.shift' is not key=values"),
    ],
)
def test_wrong_shifts_are_one_line(values, words, here, capsys) -> None:
    assert words in command.refused(capsys, "locate", "s1002_60e1", "--over", values)
    assert os.listdir(here) == []


@pytest.mark.parametrize(
    "assignment, key",
    [
        ("rail.extent=half-space", "rail.extent|rail.profile|wheel.profile"),
        ("wheelset.yaw=1", "wheelset.yaw"),
        ("rail.gauge=1 mm", "rail.gauge"),
        ("wheelset.back_to_back=600", "wheelset.shift"),
    ],
)
def test_what_cannot_be_located_is_refused_by_its_key(assignment: str, key: str) -> None:
    with pytest.raises(SceneError, match=key):
        located(assignment)


def drawn(path: Path, points) -> str:
    np.savetxt(path, points, "%.5f", ",", header="y [mm],z [mm]", comments="")
    return str(path)


def head_60e1(step: float = 0.25):
    head = profiles.rail_head("60E1")
    y = np.arange(-34.5, 34.6, step)
    return np.column_stack([y, head.height(y)])


@pytest.mark.parametrize("deep", [math.inf, 4.0], ids=["a gap", "an upright groove"])
def test_what_is_missing_far_from_the_contact_is_a_remark_and_beside_it_refused(
    tmp_path, deep: float
) -> None:
    for middle, refused in ((-25.0, False), (-2.0, True)):
        points = head_60e1()
        points[np.abs(points[:, 0] - middle) < 2.8, 1] -= deep
        points = points[np.isfinite(points[:, 1])]
        given = {"profile": drawn(tmp_path / "gap.csv", points), "profile_origin": "file"}
        scene = Scene.from_mapping({"load": 1e5, "rail": given | {"profile_mirror": "off"}})
        assert f"a gap or groove from y = {middle - 3:.4g}" in " ".join(
            solid.from_file(scene, "rail").remarks
        )
        if refused:
            text = refusal(lambda scene=scene: solid.locate(scene))
            assert text.startswith("rail.profile: gap.csv has a gap or groove from y = -5 to 1 mm")
        else:
            assert abs(solid.locate(scene).touch.y) < 1e-3


def test_a_second_contact_beside_a_gap_is_refused(tmp_path) -> None:
    """Two crests, R 91, 30 mm apart; the one without points is 0.003 mm lower."""
    y = np.arange(-34.5, 34.6, 0.25)
    points = np.column_stack([y, -0.25 * (1 + np.cos(2 * np.pi * y / 30)) - 1e-4 * y])
    given = {"profile": drawn(tmp_path / "all.csv", points), "profile_origin": "file"}
    both = solid.locate(Scene.from_mapping({"load": 1e5, "rail": given}))
    assert [round(each.y) for each in both.touches(0.05)] == [-15, 15]
    drawn(tmp_path / "all.csv", points[np.abs(y - 15) > 2.8])
    scene = Scene.from_mapping({"load": 1e5, "rail": given})
    assert refusal(lambda: solid.locate(scene).touches(0.05)).startswith(
        "rail.profile: all.csv has a gap or groove from y = 12 to 18 mm, and the wheel touches at 1"
    )


@pytest.mark.parametrize("lean", [0.0, 2.0])
def test_the_gauge_point_of_an_upright_face_is_its_widest_place(tmp_path, lean: float) -> None:
    """Crown R 300, corners R 10, faces from 10.5 to 30 mm below the top, that lean inwards."""
    y = np.arange(0, 26, 0.5)
    start, end = np.arctan(25.5 / 300), np.pi / 2 + np.radians(lean)
    corner = np.array([25.5, -(25.5**2) / 600]) - 10 * np.array([np.sin(start), np.cos(start)])
    turn = np.linspace(start, end, 40)[1:]
    arc = corner + 10 * np.column_stack([np.sin(turn), np.cos(turn)])
    down = np.arange(0.5, 20.1, 0.5)
    face = np.column_stack([arc[-1, 0] - np.tan(np.radians(lean)) * down, arc[-1, 1] - down])
    right = np.vstack([np.column_stack([y, -(y**2) / 600]), arc, face])
    both = np.vstack([(right[1:] * (-1, 1))[::-1], right])
    found = rh.profile(drawn(tmp_path / "face.csv", both))
    crown, gauge = found.measured.places.values()
    assert gauge[0] == pytest.approx(-right[:, 0].max(), abs=2e-3) and abs(gauge[1] + 14) < 1e-4
    assert found.summary()["asked"] == []


def test_a_wheel_that_begins_in_its_flange_may_be_given_its_tape_circle(tmp_path) -> None:
    y = np.arange(-64.0, 58.0, 0.5)
    points = np.column_stack([y, profiles.s1002().height(y)])
    file, keys = drawn(tmp_path / "wheel.csv", points), [[], ["wheel.tape_circle=70"]]
    one, other = (rh.profile(file, "wheel", more).measured for more in keys)
    np.testing.assert_array_equal(one.points, other.points)
    other = rh.profile(file, "wheel", ["wheel.tape_circle=69"]).measured
    assert other.oriented.tape_circle == 69 and np.array_equal(one.points, other.points)


def test_profile_says_at_once_what_a_run_asks(tmp_path) -> None:
    points = head_60e1()
    points = points[points[:, 1] > -13.4] + [[0.0, 0.0]]
    points[points[:, 0] > 20, 1] -= 0.2
    side, gauge = rh.profile(drawn(tmp_path / "open.csv", points)).summary()["asked"]
    assert side.startswith("rail.profile_mirror: ") and "give off if" in side
    assert gauge.startswith("rail.gauge_height, beside rail.gauge: 14 mm is not reached")
    scene = Scene.from_mapping({"load": 1e5, "rail": {"profile": str(tmp_path / "open.csv")}})
    assert refusal(lambda: solid.locate(scene)) == side


@pytest.mark.parametrize("name", ["one.rail", "one.wheel", "one.RAIL"])
def test_extensions_that_name_the_body_are_read(tmp_path, name: str) -> None:
    y = np.arange(-62.0, 58.0, 0.5)
    points = np.column_stack([y, profiles.s1002().height(y)]) if "wheel" in name else head_60e1()
    assert rh.profile(drawn(tmp_path / name, points)).measured.body == name[4:].lower()


def test_advice_on_a_narrow_wheel_can_be_followed() -> None:
    """A ball in a hollow: a larger wheel.width does not make its profile wider."""
    from railhead.planning import simulation_plan as planning

    shapes = {"rail.profile": "arc", "rail.crown_radius": 10, "wheel.profile": "arc"}
    scene = Scene(load=1e4).replace(**shapes, **{"wheel.transverse_radius": -10.02})
    text = refusal(lambda: planning.make(scene))
    length = float(re.search(r"give wheel.segment_length = (\S+) or less", text)[1])
    assert planning.make(scene.replace(**{"wheel.segment_length": length})).reach


def test_the_path_over_a_crossing_is_a_row_for_each_position(tmp_path, capsys) -> None:
    """Case 6 of the crossings' reference: the wheel goes over at 194.50 mm."""
    tables = [
        drawn_sections.write(
            tmp_path / "nose", range(150, 300, 10), lambda x: drawn_sections.nose(x) - [20.0, 0.0]
        ),
        drawn_sections.write(tmp_path / "wing", range(130, 300, 10), drawn_sections.wing),
    ]
    text = f"""load = 80000
[rail]
sections = {tables[0]!r}
position = 192
[wing]
sections = {tables[1]!r}
[wheel]
profile = "cone40"
rolling_radius = 460
"""
    (tmp_path / "case.toml").write_text(text)
    given = ("locate", str(tmp_path / "case.toml"), "--out", str(tmp_path / "out"))
    over = ("--over", "rail.position=192:198:2mm")
    found = command.told(capsys, *given, *over)
    assert [row["position_mm"] for row in found["rows"]] == [192, 194, 196, 198]
    assert [row["touching"] for row in found["rows"]] == ["wing", "both", "rail", "rail"]
    first = found["rows"][0]
    assert first["wheel_height_mm"] == pytest.approx(-3.29540, abs=1e-5)
    assert (first["heads"]["rail"]["angle_deg"], first["heads"]["wing"]["x_mm"]) == pytest.approx(
        (2.701, 186.2616), abs=0.001
    )
    assert found["over_mm"] == pytest.approx([194.5012], abs=2e-3)
    written = rows(tmp_path / "out" / "positions.csv")
    assert float(written[0]["rail height alone [mm]"]) == pytest.approx(-3.42671, abs=1e-5)
    assert (tmp_path / "out" / "passage.png").stat().st_size > 10_000
    assert command.status(*given, "--force", *over) == 0
    assert "goes over from one head to the other at 194.5 mm" in " ".join(
        capsys.readouterr().out.split()
    )
    said = command.refused(capsys, *given, "--over", "wheelset.shift=1")
    assert "wheelset.shift: is not allowed in over of locate beside rail.sections" in said
