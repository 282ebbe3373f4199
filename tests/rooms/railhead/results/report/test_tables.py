"""Result tables: on narrow terminals, as CSV; and the plan as JSON."""

import io
import json
import math

import command
import csv_rows
import numpy as np
import pytest
from rich.console import Console
from solved import solved

import railhead as rh
from railhead.cli import geometry
from railhead.postprocess.findings import Units, brief
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


def test_sentences_are_in_the_readers_units(full: dict) -> None:
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
    result["patches"] = [{"load_share": 0.75}, {"load_share": 0.25}]
    text = "\n".join(printed({**full, "result": result}, 400, output_units.parse("in,ksi")))
    assert "2 separate patches: a and b are those of the most loaded one (75 % of the load)" in text
    assert "rail at (0, 1, -2) in, in 1 in3 between 0.1 in and 0.2 in deep" in text
    assert "Unloaded: the rail 0.001 in deep, von Mises stress up to 10 ksi" in text
    assert "up to 10 ksi (without an estimate)." in text
    assert "Yields from 0.5 of the load on" in text
    assert "tau_max 100 ksi in the rail at (1, 0, 0) in" in text
    result["plastic"] = {**plastic, "load_over_first_yield": 20.0}
    text = "\n".join(printed({**full, "result": result}, 400))
    assert "(without an estimate; more load steps take 9 to 13 % from it at 20 times" in text


def test_columns_without_a_value_are_left_out(full: dict) -> None:
    assert "half-space" in "\n".join(printed(full, 120))
    assert "half-space" not in "\n".join(printed({**full, "half_space": None}, 120))


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


def test_rounding_is_no_depth() -> None:
    """What lies at the surface has depth 0 in the table, by every method."""
    result = solved(rh.find("long_roller").replace(["mesh.patch_size=0.4"]))
    summary = json.loads(json.dumps(result.as_dict()))
    for method in ("result", "hertz"):
        summary[method]["stress"]["tau_max_depth_mm"] = 9e-18
    row = quantity_rows.rows(summary, "contact")[7]
    assert row["quantity"].strip() == "its depth" and row["FE"] == row["Hertz"] == 0.0
    summary["result"]["stress"]["tau_max_depth_mm"] = 1e-3
    assert quantity_rows.rows(summary, "contact")[7]["FE"] == 1e-3


def test_friction_is_in_the_table_too() -> None:
    keys = ("friction.coefficient=0.3", "rolling.force_along=10kN", "mesh.patch_size=0.6")
    summary = solved("long_roller", *keys).summary
    table = list(quantity_rows.everything(summary))
    rows = {row["quantity"]: row for row in table}
    assert len(rows) == len(table)
    assert rows["where von Mises stress is largest"]["value"] == "below"
    assert rows["force along the rail"]["value"] == pytest.approx(1e4)
    assert rows["force along the rail"]["Carter"] == pytest.approx(1e4, rel=0.1)
    assert "frictionless FE" in rows["largest pressure"]
    bound = {"accuracy": {**summary["accuracy"], "bound": {"creepage_along": 0.01}}}
    table = quantity_rows.rows({**summary, **bound}, "friction")
    assert [row["quantity"] for row in table if row["estimate"] == 0.01] == ["creepage along"]


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
    idle = words.partition("no part ")[2].partition(" (why: --json)")[0].split(", ")
    for name, effect in said["plan"]["effects"].items():
        line = f"{name} {'on' if effect['on'] else 'off'} {effect['why'].split()[0]}"
        assert (line in words) != (name in idle) and effect["called_for"] in (True, False)
        assert name not in idle or not (effect["on"] or effect["called_for"])
    assert f"{said['plan']['unknowns']} unknowns" in words
    assert f"a = {said['hertz']['a_mm']:.4g} mm" in words
    assert f"angle {math.degrees(said['contact']['angle_rad']):.3f} deg" in words
    assert f"{said['mesh']['patch_size_mm']:.3g} mm in the patch" in words
    reachable = [row for row in said["prices"] if row["unknowns"] is not None]
    assert len(reachable) > 1 and all(f"{row['unknowns']}" in words for row in reachable)
    costs = [(row["unknowns"], row["seconds"], row["memory_MB"]) for row in reachable]
    assert costs == sorted(costs)  # a smaller error costs more
    assert said["patches"] and not said["plan"]["forecast"]["hertzian"]


def test_zero_is_printed_as_0() -> None:
    """Also what is a rounding of friction times load, and a number that rounds to -0."""
    forces = {"limit_N": 7500.0, "force_across_N": -2.8e-8, "moment_Nmm": 3e-7, "spin_per_mm": -0.0}
    summary = {"result": {"friction": forces}, "accuracy": {"bound": {}}}
    rows = {row["quantity"]: row["FE"] for row in quantity_rows.rows(summary, "friction")}
    assert [f"{value:g}" for value in rows.values()] == ["0", "0", "0"]
    assert quantity_rows.text("FE - Hertz", -1e-7, "", Units()) == "+0.00%"
    assert f"{terminal.rounded(-1e-9):.3f}" == "0.000" and brief(-0.0) == "0"


def test_a_yaw_is_in_mrad_in_the_report() -> None:
    scene = rh.find("s1002_60e1").replace(["wheelset.yaw=2 mrad"])
    assert ("wheelset: yaw", "2 mrad") in html.scene_rows(scene, Units())


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


def test_effects_that_have_no_part_in_a_scene_are_one_line(capsys) -> None:
    """Their reasons stay in the JSON; one that a person chose is told."""
    command.status("plan", "hertz_ellipse")
    out = capsys.readouterr().out
    assert "no part    plane_strain, axisymmetry, surface_shape, true_profile," in out
    assert "Poisson's ratio" not in out and "│ symmetry_x " in out
    command.status("plan", "hertz_ellipse", "--without", "mean_dilatation")
    assert "│ mean_dilatation " in capsys.readouterr().out
    command.status("plan", "hertz_ellipse", "--json")
    assert "Poisson's ratio 0.3" in capsys.readouterr().out


def test_what_a_person_switched_off_is_no_failing(capsys) -> None:
    """Yield is called for, and half-spaces cannot have it; whoever switched it off knows."""
    plan = "plan", "uic54_22t5_axle", "--without", "finite_bodies"
    command.status(*plan)
    assert "though" in capsys.readouterr().out
    command.status(*plan, "--without", "plasticity")
    out = capsys.readouterr().out
    assert "│ plasticity " in out and "though" not in out


def test_the_coefficient_of_friction_is_an_attribute() -> None:
    """The page of friction laws names it; it was a key of summary.json alone."""
    found = quantities.read(quantities.FrictionQuantities, {"coefficient": 0.3})
    assert found.coefficient == 0.3
