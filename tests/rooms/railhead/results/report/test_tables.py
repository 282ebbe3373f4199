"""Result tables: on narrow terminals, as CSV; and the plan as JSON.

report.html: one file, complete, with the numbers of summary.json, that a browser can draw.
"""

import io
import json
import math
import re
from dataclasses import replace
from pathlib import Path

import command
import csv_rows
import numpy as np
import pytest
from one_line import refusal
from rich.console import Console
from solved import solved

import railhead as rh
from railhead import api
from railhead.cli.examined import geometry
from railhead.planning.effects import in_words
from railhead.postprocess.findings import Units, brief
from railhead.postprocess.pictures import gallery
from railhead.results import quantity_rows, result_folder
from railhead.results.report import html, output_units, terminal
from railhead.scene import quantities


@pytest.fixture(scope="module")
def full() -> dict:
    """A summary with all the columns that a table may have, and long numbers."""
    summary = solved("hertz_ellipse", "mesh.patch_size=1.2").summary
    result = {**summary["result"], "approach_mm": 0.0123456}
    beside = {"half_space": summary["hertz"], "elastic": result}
    return {**summary, **beside, "result": result, "accuracy": {"bound": {"max_MPa": 0.0123}}}


def printed(summary: dict, width: int, units: Units | None = None) -> list[str]:
    out = io.StringIO()
    terminal.show_result(summary, Console(file=out, width=width), units or Units())
    return out.getvalue().splitlines()


@pytest.mark.parametrize("width", [50, 80, 120])
def test_no_number_is_cut(full: dict, width: int) -> None:
    """Columns that do not fit stand in further tables."""
    lines = printed(full, width)
    text = "\n".join(lines)
    assert "…" not in text
    for row in quantity_rows.rows(full, "contact"):
        for name, value in row.items():
            assert name in text
            if isinstance(value, float) and name not in quantity_rows.RELATIVE:
                assert f"{value:.5g}" in text, (row["quantity"], name)
    table = [line for line in lines if line.startswith(("largest pressure", "quantity", "──"))]
    assert len(table) > 3 and max(map(len, table)) <= min(width, terminal.WIDEST)
    assert all(each.label in text for each in quantities.rows("contact"))


def test_tables_and_sentences_are_in_the_readers_units(full: dict) -> None:
    """What yields, and what was left out at an edge."""
    plastic = {
        "load_over_first_yield": 2.0, "strain_max": 1e-3, "body": "rail",
        "place_mm": (0.0, 25.4, -50.8), "volume_mm3": 25.4**3, "top_mm": 2.54, "depth_mm": 5.08,
        "residual_von_mises_max_MPa": 68.94757293, "residual_depth_rail_mm": 0.0254,
        "residual_depth_wheel_mm": 1e-15,
        "elastic_p0_over_k": 4.0,
    }  # fmt: skip
    edge = {
        "quantity": "tau_max", "value_MPa": 689.4757293, "body": "rail",
        "place_mm": (25.4, 0.0, 0.0),
    }  # fmt: skip
    stress = {**full["result"]["stress"], "at_edges": [edge]}
    result = {**full["result"], "plastic": plastic, "stress": stress}
    assert "separate patches" not in "\n".join(printed(full, 400))
    one = {
        "centre_mm": [1e-13, -25.4, 0.0], "contact_angle_rad": 0.1, "a_mm": 2.54, "b_mm": 1.27,
        "area_mm2": 10.0, "max_MPa": 68.94757293, "load_share": 0.75,
    }  # fmt: skip
    result["patches"] = [one, {**one, "max_MPa": 689.4757293, "load_share": 0.25}]
    lines = printed({**full, "result": result}, 400, output_units.parse("in,ksi"))
    text = " ".join(" ".join(lines).split())
    assert "1 75 0 -1 5.73 0.1 0.05 0.0155 10 2 25 0 -1 5.73 0.1 0.05 0.0155 100" in text
    assert "half length" not in text and "Hertz" not in text and "elastic FE" in text
    assert "volume that yields in3 1 no law" in text and "its largest depth in 0.2 no" in text
    assert "left in the rail in 0.001 no law" in text and "left in the wheel in 0 " in text
    assert "von Mises stress left ksi 10 no law" in text
    assert "tau_max 100 ksi in the rail at (1, 0, 0) in" in text


def test_result_csv_is_the_printed_table(tmp_path) -> None:
    result = solved(rh.find("sphere_on_plane"))
    result.save(tmp_path / "out", pictures=False)
    raw = (tmp_path / "out" / "result.csv").read_bytes()
    assert raw.startswith(b"\xef\xbb\xbf") and raw.count(b"\r\n") == raw.count(b"\n")
    rows = {row["quantity"]: row for row in csv_rows.rows(tmp_path / "out" / "result.csv")}
    expected = {
        ("largest pressure", "unit"): "MPa",
        ("largest pressure", "value"): result.pressure.max,
        ("largest pressure", "estimate"): result.estimate.pressure_max,
        ("largest pressure", "Hertz"): result.hertz.pressure.max,
        ("largest pressure", "half-space"): "",
        ("largest shear stress: its depth", "value"): result.stress.tau_max_depth,
        ("largest von Mises stress: its body", "value"): "wheel",
        ("load", "value"): result.load,
        ("program", "value"): f"railhead {rh.__version__}",
        ("date", "value"): result.as_dict()["date"],
    }
    for (quantity, column), value in expected.items():
        assert rows[quantity][column] == str(value), quantity
    off = result.pressure.max / result.hertz.pressure.max - 1
    assert float(rows["largest pressure"]["FE - Hertz"]) == pytest.approx(off)


def test_friction_is_in_the_table_too() -> None:
    keys = ("friction.coefficient=0.3", "rolling.force_along=10kN", "mesh.patch_size=0.6")
    table = list(quantity_rows.everything(solved("long_roller", *keys).summary))
    rows = {row["quantity"]: row for row in table}
    assert len(rows) == len(table) and rows["where von Mises stress is largest"]["value"] == "below"
    assert rows["force along the rail"]["value"] == pytest.approx(1e4)
    assert rows["force along the rail"]["Carter"] == pytest.approx(1e4, rel=0.1)
    assert "frictionless FE" in rows["largest pressure"]


def test_rows_with_other_columns_make_one_table() -> None:
    text = result_folder.encoded([{"a": 1, "b": None}, {"b": 0.1, "c": "x, y"}]).decode("utf-8-sig")
    assert text == 'a,b,c\r\n1,,\r\n,0.1,"x, y"\r\n'


def test_the_plan_as_json_says_what_the_printed_one_says(capfd) -> None:
    case = ("s1002_60e1", "--set", "wheelset.shift=1mm", "--accuracy", "1%")
    assert command.status("plan", *case, "--json") == 0
    out, errors = capfd.readouterr()
    assert command.status("plan", *case) == 0 and errors == ""
    said, words = json.loads(out), " ".join(capfd.readouterr().out.replace("│", " ").split())
    assert said["scene"]["wheelset"]["shift"] == 1 and said["scene"]["accuracy"] == 0.01
    for name, effect in said["plan"]["effects"].items():
        line = f"{name} {'on' if effect['on'] else 'off'} {effect['why'].split()[0]}"
        assert line in words and effect["called_for"] in (True, False)
    assert f"{said['plan']['unknowns']} unknowns" in words
    assert f"angle {math.degrees(said['contact']['angle_rad']):.3f} deg" in words
    reachable = [row for row in said["prices"] if row["unknowns"] is not None]
    assert len(reachable) > 1 and all(f"{row['unknowns']}" in words for row in reachable)
    costs = [(row["unknowns"], row["seconds"], row["memory_MB"]) for row in reachable]
    assert costs == sorted(costs)  # a smaller error costs more


def test_zero_is_printed_as_0() -> None:
    """Also what is a rounding of friction times load, and a number that rounds to -0."""
    forces = {"limit_N": 7500.0, "force_across_N": -2.8e-8, "moment_Nmm": 3e-7, "spin_per_mm": -0.0}
    summary = {"result": {"friction": forces}, "accuracy": {"bound": {}}}
    rows = {row["quantity"]: row["FE"] for row in quantity_rows.rows(summary, "friction")}
    assert [f"{value:g}" for value in rows.values()] == ["0", "0", "0"]
    assert quantity_rows.text("FE - Hertz", -1e-7, "", Units()) == "+0.00%"
    assert quantity_rows.text("estimate", 25.528, "N", Units()) == "above 100%"
    assert f"{terminal.rounded(-1e-9):.3f}" == "0.000" and brief(-0.0) == "0"


def test_keys_that_are_no_defaults_are_in_the_report() -> None:
    rows = html.scene_rows(rh.find("uic54_22t5_axle").replace(["wheelset.yaw=2 mrad"]))
    assert ("wheelset.yaw", 0.002) in rows and not [key for key, _ in rows if "effects" in key]


NAME = "a_long_name_of_a_file_of_points_on_a_rail_head.csv"
COMMANDS = {
    "list": ["list"],
    "plan": ["plan", "uic54_22t5_axle"],
    "locate": ["locate", "s1002_60e1", "--shift", "3mm", "--no-pictures"],
    "run": ["run", "long_roller", "--set", "mesh.patch_size=1", "--no-pictures"],
    "profile": ["profile", NAME, "--no-pictures"],
}


@pytest.mark.parametrize("arguments", COMMANDS.values(), ids=COMMANDS)
def test_lines_fit_eighty_columns(arguments: list[str], capsys, here, monkeypatch) -> None:
    points = [f"{0.5 * y},{-((0.5 * y) ** 2) / 600}" for y in range(-60, 61)]
    (here / NAME).write_text("y (mm),z (mm)\n" + "\n".join(points))
    monkeypatch.setattr(geometry, "SHIFTS", np.linspace(-3.0, 3.0, 3))
    assert command.status(*arguments) in (0, 1)
    printed = capsys.readouterr().out
    lines = printed.splitlines()
    assert len(lines) > 5 and max(map(len, lines)) <= 80 and "…" not in printed
    if NAME in arguments:
        assert any(line.startswith(11 * " ") for line in lines)  # words go on below their column


def test_what_a_person_switched_off_is_no_failing(capsys) -> None:
    """Yield is called for, and half-spaces cannot have it; whoever switched it off knows."""
    plan = "plan", "uic54_22t5_axle", "--without", "finite_bodies"
    command.status(*plan)
    assert "though" in capsys.readouterr().out
    command.status(*plan, "--without", "plasticity")
    out = capsys.readouterr().out
    assert "│ plasticity " in out and "though" not in out


UNITS = output_units.parse("um,kN,GPa")


CELLS = "<tr><td>(.*?)</td><td>(.*?)</td>" + 2 * '<td class="n">(.*?)</td>'


def tables_of(text: str) -> list[str]:
    """Ids of tables."""
    return re.findall(r'<table id="(\w+)"', text)


def addresses_of(text: str) -> list[str]:
    """What it loads or leads to."""
    return re.findall(r'\s(?:src|href|data)="([^"]*)"', text)


@pytest.fixture(scope="module")
def result():
    scene = api.find("long_roller").replace(
        ["friction.coefficient=0.3", "rolling.creepage_along=0.1%", "mesh.patch_size=0.6"]
    )
    return api.solve(scene, quiet=True)


@pytest.fixture(scope="module")
def folder(result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "out"
    result.save(out, units=UNITS)
    return out


def test_one_file_without_a_network(folder: Path) -> None:
    text = (folder / html.NAME).read_text(encoding="utf-8")
    assert len(text) < 6e6
    addresses = addresses_of(text)
    assert len(addresses) == len(list(folder.glob("*.png")))
    assert all(address.startswith("data:image/png;base64,") for address in addresses)
    assert not re.search(r"@import|url\(\s*['\"]?https?:|<link|<script[^>]+src", text)
    assert {"answer", "friction", "checks", "scene", "plan", "left_out"} <= set(tables_of(text))
    assert "of the checks is in mm, N and MPa, whatever" in text
    assert not result_folder.foreign(folder)


def test_the_report_has_the_parts_of_the_estimates() -> None:
    """They add up; what is 0 for all quantities has no column."""
    summary = solved("hertz_ellipse").summary
    head, *rows = quantity_rows.error_parts(summary)
    assert head[:4] == ["quantity", "estimate", "mesh", "reading"] and "load steps" not in head
    bound = summary["accuracy"]["bound"]
    assert len(rows) == len(bound) and {row[0] for row in rows} > {"patch area", "approach"}
    for row in rows:
        total, *parts = (float(cell.rstrip("%")) for cell in row[1:])
        assert sum(parts) == pytest.approx(total, abs=0.002)


def test_numbers_are_those_of_the_summary(result, folder: Path) -> None:
    """In the units of the reader; with friction on so coarse a mesh no law holds."""
    text = (folder / html.NAME).read_text(encoding="utf-8")
    table = re.search(r'<table id="answer">.*?</table>', text, re.S)[0]
    rows = {label: cells for label, *cells in re.findall(CELLS, table)}
    assert len(rows) > 6
    assert rows["largest pressure"] == ["GPa", f"{1e-3 * result.pressure.max:.5g}", "no law"]


def brief_of(result, folder: Path) -> str:
    return html.render(result.solved, result.summary, UNITS, folder, "a title", brief=True)


def test_a_brief_report_is_the_answer_and_what_was_asked(result, folder: Path) -> None:
    text = brief_of(result, folder)
    assert tables_of(text) == ["answer", "friction"]
    assert len(addresses_of(text)) == 2 and "checks hold" in text and result.summary["date"] in text
    failed = {
        "failed": ["force_balance"],
        "passed": False,
        "advice": {"force_balance": "do better"},
    }
    worse = replace(result, summary=result.summary | {"checks": result.summary["checks"] | failed})
    text = brief_of(worse, folder)
    assert "FAILS" in text and "To do: do better" in text and "holds</td>" not in text


def with_passes(result):
    columns = ("strain_increment_max", "forward_mm", "groove_mm", "lean_mm")
    columns += ("pressure_max_MPa", "residual_along_MPa", "residual_across_MPa")
    rows = [dict.fromkeys(columns, 1e-3 * number) for number in range(30)]
    more = result.summary["result"] | {"passes": rows, "passes_words": "it shakes down"}
    more["passes_after"] = {"estimate": {}}
    return replace(result, summary=result.summary | {"result": more})


def test_passes_are_a_table(result, folder: Path) -> None:
    text = brief_of(with_passes(result), folder)
    table = re.search(r'<table id="passes">.*?</table>', text, re.S)
    numbers = [int(each) for each in re.findall(r'<tr><td class="n">([0-9]+)</td>', table[0])]
    assert numbers == [1, 2, 3, 30]
    ((_, rows, _),) = quantity_rows.passes(with_passes(result).summary["result"], UNITS)
    assert [row[0] for row in rows[1:]] == [str(each) for each in (*range(1, 11), 30)]
    assert "groove, um" in table[0] and ">29<" in table[0] and "-0<" not in table[0]


def test_report_and_pictures_are_left_out_when_asked(result, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(gallery, "drawings", lambda *_: {"pressure.png": Path.touch})
    asked = ("without", {"report": False}, {"pressure.png"}), ("bare", {"pictures": False}, set())
    for name, keys, drawn in asked:
        result.save(tmp_path / name, **keys)
        files = {path.name for path in (tmp_path / name).iterdir()}
        assert files & {"pressure.png", html.NAME} == drawn


def test_the_verdict_is_of_what_holds(result, folder: Path) -> None:
    """One patch or two; that a patch is no ellipse only where the mesh can tell."""
    summary = result.summary
    no_ellipse = {**summary["checks"], "hertzian": False, "passed": True}
    one = {
        "centre_mm": [0.0, 1.0, 2.0], "contact_angle_rad": 0.1, "a_mm": 1.0, "b_mm": 2.0,
        "area_mm2": 3.0, "max_MPa": 4.0, "load_share": 0.5,
    }  # fmt: skip
    two = {**summary["result"], "patches": [one, one]}

    def said(**changed) -> str:
        return html.render(result.solved, {**summary, **changed}, Units(), folder, "a title")

    after = {"plasticity": {"needed": True, "notable": False, "why": "it yields <b>here</b>"}}
    told = f'warn">\n<b>Left out: {in_words("plasticity")}; it yields &lt;b&gt;here&lt;/b&gt;.</b>'
    assert told in said(effects_after=after) and "<b>Left out:" not in said()

    assert "The patch is no ellipse" in said(checks=no_ellipse)
    assert "The patch is no ellipse" not in said(checks={**no_ellipse, "passed": False})
    assert re.search(r"The contact patch\s+is", said())
    several = said(result=two)
    assert "touch in 2 patches, each with a row below" in several and 'id="patches"' in several
    assert "The contact patch" not in several and "<th>Hertz" not in several


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [(645.16, "mm2", "1 in2"), (25.4, "N mm", "1 N in"), (6.894757293, "MPa", "1 ksi"),
     (1.0, "1/mm", "25.4 1/in"), (1.0, "N/mm2", "645.2 N/in2")],
)  # fmt: skip
def test_units_are_the_readers(value: float, unit: str, shown: str) -> None:
    assert output_units.parse("in, ksi").text(value, unit) == shown
    assert Units().value(value, unit) == value


@pytest.mark.parametrize("wrong", ["mm,furlong", "", "kN,N", "kg"])
def test_unknown_units_are_refused(wrong: str) -> None:
    assert "--units" in refusal(lambda: output_units.parse(wrong))
