"""The sweep of a script, read again from its folder; its rows of sweep.csv and its report.

The folder of a sweep: gone on with, broken, in use.
"""

import functools
import json
import math
import os
import re
import shutil
import subprocess
import sys
from html import unescape
from pathlib import Path

import command
import numpy as np
import pytest
from matplotlib.axes import Axes
from one_line import refusal
from sweep_command import ROLLER, SIX, rows

import railhead as rh
from railhead.meshing.mesh import MeshError
from railhead.postprocess.findings import Subject, Units
from railhead.postprocess.pictures import sweep_plots as plots
from railhead.results import pipeline, result_folder
from railhead.scene.scene import SceneError
from railhead.sweeps import store, sweep_table

FAST = rh.find("hertz_ellipse").replace(["effects.finite_bodies=off"])


def test_a_folder_keeps_the_sweep(tmp_path, in_this_process, capsys) -> None:
    """The same call solves nothing again; results have numbers."""
    out = tmp_path / "out"
    given = {"load": [1e4, 2e4], "wheel.rolling_radius": [420, 460]}
    table = rh.sweep(FAST, given, out=out, quiet=True)
    assert {"sweep.csv", "sweep.png", "records"} <= set(os.listdir(out))
    (out / "records" / "00001.json").unlink()
    again = rh.sweep(FAST, given, out=out, quiet=True)
    assert again[1].pressure == table[1].pressure
    assert "numbers only" in refusal(lambda: print(again[0].findings), ValueError)
    read = rh.load(out)
    assert isinstance(read, rh.Sweep) and read.keys == list(given)
    assert read.rows() == again.rows() and read[3].pressure == table[3].pressure
    for row, line in zip(read.rows(), rows(out), strict=True):
        assert {key: "" if value is None else str(value) for key, value in row.items()} == line
    assert command.told(capsys, "show", str(out))["rows"] == read.rows()
    assert command.status("show", str(out)) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80 and "4 combinations, all passed" in lines
    cells = {cell for line in lines for cell in line.split()}
    assert {f"{each.pressure.max:.5g}" for each in read} | {"checks", "rolling_radius"} <= cells
    assert "4 combinations, all passed" in read._repr_html_() and "body {" not in read._repr_html_()
    with pytest.raises(rh.SceneError, match="holds another sweep"):
        rh.sweep(FAST, {"load": [1e4]}, out=out, quiet=True)


@pytest.mark.slow
def test_a_script_needs_no_guard(tmp_path) -> None:
    """Processes of a sweep do not run the script that started them."""
    script = tmp_path / "script.py"
    script.write_text(
        "import railhead as rh\n"
        "print('begins')\n"
        "scene = rh.find('hertz_ellipse').replace(['effects.finite_bodies=off'])\n"
        "print([each.load for each in rh.sweep(scene, load=[1e4, 2e4], quiet=True)])\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    assert done.stdout == "begins\n[10000.0, 20000.0]\n", done.stderr


def test_the_angle_of_a_row_is_that_of_its_patch(swept) -> None:
    """Of several patches the most loaded one, which need not be where the plan saw the first."""
    kept = store.read(swept, 0)
    planned = sweep_table.row(kept)["contact angle [deg]"]
    assert planned == math.degrees(kept["summary"]["plan"]["contact_angle_rad"])
    kept["summary"]["result"]["patches"] = [{"contact_angle_rad": 0.1}, {"contact_angle_rad": 0.3}]
    line = sweep_table.row(kept)
    assert line["contact angle [deg]"] == math.degrees(0.1) and line["patches"] == 2


def test_a_row_holds_what_its_columns_say() -> None:
    """Each number of a summary is another one."""
    numbers = {
        "max_MPa": 1.0, "mean_MPa": 2.0, "area_mm2": 3.0, "a_mm": 4.0, "b_mm": 5.0,
        "tau_max_MPa": 6.0, "tau_max_depth_mm": 7.0, "von_mises_max_MPa": 8.0,
    }  # fmt: skip
    forces = (
        "force_along_N", "force_across_N", "moment_Nmm", "limit_N", "creepage_along",
        "creepage_across", "spin_per_mm", "shift_along_mm", "shift_across_mm", "stick_share",
        "t_gamma_N", "t_gamma_over_area_MPa", "surface_fatigue_index", "shakedown",
    )  # fmt: skip
    bounds = (
        "max_MPa", "area_mm2", "a_mm", "b_mm", "tau_max_MPa", "approach_mm", "force_across_N",
        "moment_Nmm", "t_gamma_N", "stick_share",
    )  # fmt: skip
    result = {
        "pressure": numbers, "patch": numbers, "stress": {**numbers, "tau_max_body": "rail"},
        "approach_mm": 9.0, "load_N": 10.0, "contact_point_mm": [11.0, 12.0, 13.0],
        "patches": [{"contact_angle_rad": 14.0}, {}],
        "friction": {key: 20.0 + i for i, key in enumerate(forces)}
        | {"below_resolution": ["t_gamma_N", "traction_max_MPa", "force_along_N"]},
    }  # fmt: skip
    summary = {
        "railhead": "0", "date": "now",
        "effects_after": {
            "plasticity": {"needed": False, "notable": True, "why": "yields"},
            "heat": {"needed": False, "notable": False, "why": "cold"},
        }, "result": result,
        "checks": {"converged": True, "passed": True},
        "plan": {"contact_angle_rad": 17.0}, "cost": {"dofs": 15},
        "accuracy": {"bound": {key: 40.0 + i for i, key in enumerate(bounds)}},
    }  # fmt: skip
    over = {"load": 16.0, "wheelset.yaw": 0.0015, "rail.profile": "input/0123abcd/worn.csv"}
    over |= {"wheel.profile": "input/4567abcd/worn.csv"}
    names = {"rail.profile": "worn.csv", "wheel.profile": "p2/worn.csv"}
    record = {"over": over, "fault": "", "summary": summary, "names": names}
    assert sweep_table.row(record) == {
        "load [N]": 16.0, "wheelset.yaw [mrad]": 1.5, "rail.profile": "worn.csv",
        "wheel.profile": "p2/worn.csv", "below resolution": "force along; T-gamma",
        "checks": "passed", "p_max [MPa]": 1.0, "p_mean [MPa]": 2.0,
        "area [mm2]": 3.0, "a [mm]": 4.0, "b [mm]": 5.0, "tau_max [MPa]": 6.0,
        "tau_max depth [mm]": 7.0, "tau_max body": "rail", "von_mises_max [MPa]": 8.0,
        "found approach [mm]": 9.0, "found load [N]": 10.0,
        "contact angle [deg]": math.degrees(14.0),
        "unknowns": 15, "patch x [mm]": 11.0, "patch y [mm]": 12.0, "patch z [mm]": 13.0,
        "patches": 2, "force along [N]": 20.0, "force across [N]": 21.0, "moment [N mm]": 22.0,
        "mu N [N]": 23.0, "creepage along": 24.0, "creepage across": 25.0, "spin [1/mm]": 26.0,
        "shift along [mm]": 27.0, "shift across [mm]": 28.0, "stick share": 29.0,
        "T-gamma [N]": 30.0, "T-gamma/area [N/mm2]": 31.0, "surface fatigue index": 32.0,
        "shakedown": 33.0, "axle": None, "wear number [N]": None, "wear regime": None, "p0/k": None,
        "least mu": None, "rise rail [K]": None, "rise wheel [K]": None,
        "warnings": "plasticity: yields",
        "p_max estimate": 40.0, "area estimate": 41.0, "a estimate": 42.0,
        "b estimate": 43.0, "tau_max estimate": 44.0, "approach estimate": 45.0,
        "force across estimate": 46.0, "moment estimate": 47.0, "T-gamma estimate": 48.0,
        "von_mises_max estimate": None, "program": "railhead 0",
        "date": "now",
    }  # fmt: skip


def test_a_sweep_says_what_a_run_says() -> None:
    """Fifty combinations that passed with estimates of 16 to 43 %, and bodies that would yield."""
    rows = [
        {"checks": "passed", "p_max [MPa]": 900.0, "p_max estimate": 0.003, "warnings": ""},
        {"checks": "passed", "p_max [MPa]": 6400.0, "p_max estimate": 0.43,
         "warnings": "plasticity: R260 would yield; off: it is asked so; heat: 200 K"},
        {"checks": "FAILED: a", "p_max [MPa]": 3e3, "p_max estimate": None,
         "warnings": "plasticity: R260 would yield"},
        {"checks": "NOT SOLVED: gmsh"},
    ]  # fmt: skip
    (said,) = [
        line for line in sweep_table.verdict(rows, Units({"MPa": "GPa"})) if "largest" in line
    ]
    assert said.startswith("largest pressure 0.9 to 6.4 GPa, estimated within 0.30%")
    assert sweep_table.verdict(rows) == [
        "4 combinations, 2 not passed, 2 with warnings",
        "largest pressure 900 to 6400 MPa, estimated within 0.30% to 43.00%; 1 without an estimate",
        "plasticity: a warning in 2 of 4 (column warnings)",
        "heat: a warning in 1 of 4 (column warnings)",
    ]


def test_what_is_below_resolution_is_marked_in_every_row() -> None:
    """As a run marks it; one key that fails in several rows is named once."""
    row = {"checks": "FAILED: a", "T-gamma [N]": 3.0, "force along [N]": -5.0, "mu N [N]": 100.0,
           "below resolution": "T-gamma", "force along estimate": 1.2e-5}  # fmt: skip
    assert sweep_table.cell(row, "T-gamma [N]", Units()) == "3 (below resolution)"
    error = "-5\u00a0\u00b1\u00a00.0012% of mu N"
    assert sweep_table.cell(row, "force along [N]", Units()) == error
    assert sweep_table.verdict([row, row]) == [
        "2 combinations, 2 not passed",
        "FAILED: a (in 2)",
        "T-gamma: below resolution in 2",
    ]
    assert {"T-gamma [N]", "force along [N]"} < set(sweep_table.short([row]))


def test_bars_are_estimates(tmp_path, monkeypatch) -> None:
    drawn = []
    monkeypatch.setattr(Axes, "errorbar", lambda self, x, y, error, **_: drawn.append((y, error)))
    rows = [
        {"load [N]": load, "checks": "passed", "p_max [MPa]": 100.0, "p_max estimate": bound}
        for load, bound in ((1.0, 0.1), (2.0, None))
    ]
    plots.curves(["load [N]"], rows, Subject(), tmp_path / "a.png")
    assert drawn[0][1][0] == pytest.approx(10.0) and np.isnan(drawn[0][1][1])
    assert np.isnan(drawn[1][1]).all()


def test_the_report_of_a_sweep_has_all_of_it(swept) -> None:
    """The picture, a row for each combination in both tables, what differs and what does not."""
    text = (swept / "report.html").read_text(encoding="utf-8")
    assert "<title>sweep of long_roller over load and wheel.rolling_radius</title>" in text
    assert "6 combinations, all passed" in text and text.count("data:image/png;base64,") == 1
    short, full = (_cells(text, name) for name in ("answers", "all"))
    table = rows(swept)
    assert len(short) == len(full) == 7 and full[0] == list(table[0])
    for line, row in zip(short[1:], table, strict=True):
        found = dict(zip(short[0], line, strict=True))
        bound = f"{100 * float(row['p_max estimate']):.2g}%"
        assert found["p_max [MPa]"] == f"{float(row['p_max [MPa]']):.5g}\u00a0\u00b1\u00a0{bound}"
        assert found["checks"] == "passed"
    assert _cells(text, "asked")[0] == ["load [N]", "50000, 80000, 110000"]
    same = {name for name, _ in _cells(text, "scene")}
    assert "mesh.patch_size" in same and not {"load", "wheel.rolling_radius"} & same


def test_what_failed_is_red(tmp_path) -> None:
    store.begin(tmp_path / "out", {"scene": {"name": "a"}, "over": {"load": [1.0]}})
    fault = sweep_table.record({"load": 1.0}, {}, MeshError("gmsh <no>"))
    store.write(tmp_path / "out", 0, fault)
    rh.load(tmp_path / "out").write_report(tmp_path, [rh.find("sphere_on_plane")], Units())
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert 'class="verdict bad"' in text and '<td class="bad">NOT SOLVED: gmsh &lt;no&gt;' in text


def _cells(text: str, name: str) -> list[list[str]]:
    """Texts of the cells of the table of this id, by line."""
    (table,) = re.findall(rf'<table id="{name}">(.*?)</table>', text, re.DOTALL)
    lines = re.findall("<tr>(.*?)</tr>", table, re.DOTALL)
    return [
        [unescape(each) for each in re.findall("<t[dh].*?>(.*?)</t[dh]>", line)] for line in lines
    ]


def test_a_surface_along_the_rail_has_its_columns_and_panels() -> None:
    """Where it touches, how the patches share the load, and the approach; not beside it."""
    hollow = {"kind": "flat", "length": 20.0, "depth": 0.2}
    scene = rh.Scene(
        load=10e3,
        rail={"profile": "arc", "crown_radius": 300},
        wheel={"surface": hollow},
        effects={"finite_bodies": "off"},
    )
    rows = []
    for position in (0.02, 40.0):
        over = {"wheel.surface.position": position}
        solved = rh.solve(scene.replace(**over), quiet=True)
        rows.append(sweep_table.row(sweep_table.record(over, {}, solved)))
    assert rows[0]["wheel.surface.position [mm]"] == 0.02 and rows[0]["patches"] == 2
    assert rows[0]["contact ahead [mm]"] == pytest.approx(8.0, abs=0.2)
    assert 0.5 < rows[0]["load share"] < 0.6 and 0 < rows[0]["height in patch [mm]"] < 0.2
    assert not {"contact ahead [mm]", "load share"} & rows[1].keys()
    assert set(plots.SHAPE) < plots.panels(rows).keys()
    assert not set(plots.SHAPE) & plots.panels(rows[1:]).keys()


def test_another_sweep_is_not_gone_on_with(swept: Path, capsys) -> None:
    before = (swept / "sweep.csv").read_bytes()
    out = ("--out", str(swept))
    other = ("--over", "load=50kN,80kN,111kN", "--over", "wheel.rolling_radius=420mm,460mm")
    line = command.refused(capsys, "sweep", *ROLLER, *other, *out)
    assert "--out: " in line and "over.load [50000.0, 80000.0, 110000.0]" in line
    assert (swept / "sweep.csv").read_bytes() == before
    swapped = (*SIX[2:], *SIX[:2])
    line = command.refused(capsys, "sweep", *ROLLER, *swapped, *out)
    assert "with keys in another order" in line


@pytest.mark.parametrize("content", [
    None, "{}", '{"fault": ""}', "[]", '{"fault": "", "summary": {}}',
    '{"fault": "", "summary": null}', '{"fault": "", "summary": {"checks": {"converged": true}}}',
    '{"fault": "gmsh: no"}',
])  # fmt: skip
@pytest.mark.parametrize("name", ["sweep.json", "records/00000.json"])
def test_a_broken_file_is_said(copied: Path, name: str, content: str | None, capsys) -> None:
    half = (copied / name).read_text(encoding="utf-8")[:100]
    (copied / name).write_text(half if content is None else content, encoding="utf-8")
    err = command.refused(capsys, "sweep", *ROLLER, *SIX, "--out", str(copied))
    if name.startswith("records") or content in (None, "[]"):
        assert f"{name}' is broken; delete it and start again" in err
        assert "is broken" in refusal(lambda: rh.load(copied))
    else:
        assert "holds another sweep" in err


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("summary", "result", "contact_point_mm"), [0.0]), (("over", "load"), 80000.0),
        (("summary", "accuracy", "bound", "max_MPa"), "0.1"),
        (("summary", "result", "pressure", "max_MPa"), "800"),
        (("summary", "result", "pressure", "max_MPa"), float("nan")),
    ],
)  # fmt: skip
def test_a_record_that_is_none_of_its_combination_is_said(
    copied: Path, place: tuple[str, ...], value: object, capsys
) -> None:
    """As it would be by a hand, or copied from another combination."""
    record = copied / "records" / "00000.json"
    kept = json.loads(record.read_text())
    functools.reduce(dict.get, place[:-1], kept)[place[-1]] = value
    record.write_text(json.dumps(kept))
    line = command.refused(capsys, "sweep", *ROLLER, *SIX, "--out", str(copied))
    assert "00000.json' is broken; delete it and start again" in line


def test_a_killed_sweep_loses_only_what_was_running(copied: Path, in_this_process) -> None:
    """A record that was being written goes; the same command leaves whole ones as they are."""
    records, kept = copied / "records", copied / "records" / "00000.json"
    for path in records.glob("0000[2-5].*"):
        path.unlink()
    (records / ".00002.json.7").write_text("{")
    stamp = json.loads(kept.read_text())
    stamp["summary"]["result"]["pressure"]["max_MPa"] = 1234.5  # to be found in the table
    kept.write_text(json.dumps(stamp))
    assert command.status("sweep", *ROLLER, *SIX, "--no-pictures", "--out", str(copied)) == 0
    found = rows(copied)
    assert len(found) == 6 and {row["checks"] for row in found} == {"passed"}
    assert [row["p_max [MPa]"] for row in found].count("1234.5") == 1
    assert not list(records.glob(".*"))


def test_what_else_lies_among_the_records_is_left_alone(copied: Path) -> None:
    shutil.copy(copied / "records" / "00001.json", copied / "records" / "00001 (copy).json")
    assert len(store.done(copied)) == len(rh.load(copied).rows()) == 6


def test_broken_arrays_of_a_record_are_said(tmp_path: Path) -> None:
    store.write(tmp_path, 0, {}, {"pressure": np.ones(100)})
    path = store.record_path(tmp_path, 0).with_suffix(".npz")
    path.write_bytes(path.read_bytes()[:-30])
    assert "is broken" in refusal(lambda: store.read_arrays(tmp_path, 0))


def test_records_beyond_five_digits_count(tmp_path: Path) -> None:
    """Job 100000 was done, and nobody saw it."""
    store.write(tmp_path, 100000, {})
    assert store.done(tmp_path) == {100000}


def test_wear_and_creep_tables_are_no_broken_sweeps(tmp_path: Path) -> None:
    """Their records, which are whole, were said to be broken, and to be deleted."""
    store.begin(tmp_path / "table", {"table": {"cells": 12}})
    store.write(tmp_path / "table", 0, {"forces": []})
    assert "holds no run and no sweep" in refusal(lambda: rh.load(tmp_path / "table"))


def test_a_folder_in_use_is_left_alone(copied: Path, capsys) -> None:
    """The second sweep threw the first one's records away."""
    before = {path: path.stat().st_mtime_ns for path in copied.rglob("*")}
    with result_folder.claimed(copied):
        line = command.refused(capsys, "sweep", *ROLLER, *SIX, "--out", str(copied))
    assert "--out: " in line and "in use by another command; wait for it" in line
    assert before == {path: path.stat().st_mtime_ns for path in copied.rglob("*")}


def test_a_sweep_goes_on_with_its_own_folder_and_leaves_others(tmp_path: Path, capsys) -> None:
    folder, mine, other = tmp_path / "sweep", {"case": "a"}, {"case": "b"}
    store.begin(folder, mine)
    store.write(folder, 3, {"fault": "gmsh: no"})
    store.begin(folder, mine, "move")
    assert store.done(folder) == {3} and not capsys.readouterr().err
    with pytest.raises(SceneError, match="case a and not b; give another folder, or force=True"):
        store.begin(folder, other)
    store.begin(folder, other, "move")
    assert store.done(folder) == set() and store.done(tmp_path / "sweep.1") == {3}
    assert capsys.readouterr().err.endswith("sweep.1/\n")
    store.write(folder, 3, {"fault": "gmsh: no"})
    store.begin(folder, other, "replace")
    assert store.done(folder) == set() and not result_folder.foreign(folder)
    (folder / "sweep.json").unlink()
    assert "holds another kind of result" in refusal(lambda: store.begin(folder, mine))


def test_elastic_answers_of_steel_that_would_yield_are_marked_in_all_that_a_sweep_shows(
    tmp_path, in_this_process
) -> None:
    """Of 20 and 110 kN on a rail of R260 the second is beyond first yield (22 kN)."""
    scene = rh.find("uic54_22t5_axle").replace(
        ["effects.finite_bodies=off", "effects.plasticity=off"]
    )
    table = rh.sweep(scene, {"load": [2e4, 1.1e5]}, out=tmp_path / "out", quiet=True)
    assert [row.get("steel") for row in table.rows()] == [None, "would yield"]
    assert "the steel would yield in 1, whose answers" in " ".join(table._repr_html_().split())
    sheet = table.plot("sweep")
    texts = [each.get_text() for part in sheet.subfigs for each in part.texts]
    assert any("20000 N to 110000 N, half-spaces" in text for text in texts)
    notes = [part.get_suptitle() for part in sheet.subfigs]
    assert any("hollow: elastic answer, the steel would yield" in note for note in notes)
    report = (tmp_path / "out" / "report.html").read_text()
    assert "whose answers are elastic" in report and "<th>steel</th>" in report


def test_what_cannot_be_solved_is_a_row(monkeypatch, in_this_process) -> None:
    def failing(plan, *_):
        raise MeshError("gmsh: no")

    monkeypatch.setattr(pipeline, "solve", failing)
    table = rh.sweep(rh.find("sphere_on_plane"), {"wheelset.yaw": [0]}, quiet=True)
    assert list(table) == []
    assert table.rows() == [{"wheelset.yaw [mrad]": 0.0, "checks": "NOT SOLVED: gmsh: no"}]
