"""`railhead locate` and `railhead profile`, and measured profiles in a scene: numbers, refusals."""

import json
import math
import os
import re
from functools import partial
from pathlib import Path

import command
import matplotlib
import numpy as np
import pytest
from csv_rows import rows
from matplotlib.text import Text
from one_line import refusal

import railhead as rh
from railhead import api
from railhead.cases.s1002_60e1 import SCENE
from railhead.cli import geometry
from railhead.contact import solid
from railhead.geometry import profiles
from railhead.results.report import output_units, terminal
from railhead.scene.scene import Scene, SceneError

DATA = Path(__file__).parents[1] / "geometry" / "data"
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
    assert found["noise_mm"] == pytest.approx(0.01, rel=0.25)
    assert 8 < found["smoothing_mm"][1] < 80
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


@pytest.mark.parametrize(
    ("kind", "words"),
    [("svg", rb"<\?xml.*railhead "), pytest.param("pdf", rb"%PDF", marks=pytest.mark.slow)],
)  # the first is stamped
def test_a_picture_has_another_format_beside_png(kind: str, words: bytes, tmp_path) -> None:
    with matplotlib.rc_context():
        assert command.status("profile", BAN, "--format", kind, "--out", str(tmp_path / "o")) == 0
    assert re.match(words, (tmp_path / "o" / f"profile.{kind}").read_bytes(), re.DOTALL)
    assert (tmp_path / "o" / "profile.png").is_file()


def test_a_key_of_wheels_tells_a_wheel(tmp_path, capsys) -> None:
    """Of a table of points, which is a rail otherwise."""
    wheel = solid.from_file(Scene.from_mapping({"load": 1, "wheel": {"profile": PRW}}), "wheel")
    np.savetxt(tmp_path / "wheel.csv", wheel.points, delimiter=",")
    given = str(tmp_path / "wheel.csv"), "--json", "--set", "wheel.profile_flip=off"
    assert command.status("profile", *given, *quickly(tmp_path)) == 0
    summary = json.loads(capsys.readouterr().out)
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
    assert words in command.refused(capsys, "profile", name)
    assert os.listdir(here) == [name]


def test_a_profile_whose_sides_are_open_is_examined_and_not_solved(
    worn: Scene, here, capsys
) -> None:
    """Of a head of no standard, worn at one side, in a table that says nothing."""
    points = np.loadtxt(worn.rail.profile, delimiter=",")
    points[:, 1] -= 1.2 * np.exp(-(((points[:, 0] + 21) / 7) ** 2))
    np.savetxt(here / "wide.csv", points * [1.1, 1], delimiter=",")
    assert command.status("profile", "wide.csv", "--json", "--no-pictures") == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["profile"]["sides"] == "open" and summary["standard"] is None
    wide = worn.replace([f"rail.profile={here / 'wide.csv'}"])
    said = refusal(lambda: api.plan(wide))
    assert said.startswith("rail.profile_mirror: nothing in wide.csv tells its field side")
    api.plan(wide.replace(["rail.profile_mirror=off"]))


def located(*assignments: str) -> dict:
    return geometry.locate(SCENE.replace(assignments)).summary()


def test_command_prints_json_and_writes_pictures(tmp_path, capsys) -> None:
    folder = tmp_path / "located"
    given = f"s1002_60e1 --shift 3mm --yaw 2mrad --json --out {folder}"
    assert command.status("locate", *given.split()) == 0
    printed = json.loads(capsys.readouterr().out)
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
    assert f"at most {profile.worn.largest_loss / 25.4:.3g} in at" in worn
    for name, draw in (found.drawings(inches) | profile.drawings(inches)).items():
        texts = [text.get_text() for text in draw(None).figure.findobj(Text)]
        assert not [text for text in texts if re.search(r"\b[mu]m\b", text)], name


def swept(tmp_path, capsys, *arguments: str) -> dict:
    """Summary of `railhead locate`, whose files are in tmp_path/out."""
    given = ("locate", "s1002_60e1", "--json", *quickly(tmp_path), *arguments)
    assert command.status(*given, "--force") == 0
    return json.loads(capsys.readouterr().out)


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
        ("load=1kN", "load: is not allowed in --over of locate; give wheelset.shift alone"),
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
