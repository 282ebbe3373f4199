"""Which combinations a sweep has, and what is refused."""

import json

import command
import numpy as np
import pytest
from sweep_command import refused, sweep

import railhead as rh
from railhead.sweeps.grid import ParameterGrid, parse_values, read_rows, shown


def values(*texts: str, case: str = "s1002_60e1") -> list[tuple[object, ...]]:
    grid = ParameterGrid.combine(rh.find(case), parse_values(texts))
    return [tuple(grid.values(number).values()) for number in range(len(grid.scenes))]


def test_lists_and_ranges_multiply_the_last_fastest() -> None:
    found = values("load=25kN,50000 N", "wheelset.shift=0,1:2:.5mm")
    assert found == [(p, s) for p in (25e3, 50e3) for s in (0, 1, 1.5, 2)]
    assert values("wheelset.shift=2:0:-1 mm") == [(2,), (1,), (0,)]
    assert values("wheelset.shift=0:1:0.3mm") == [(0,), (0.3,), (0.6,), (0.9,)]
    assert values("rail.inclination=1:20,1:40") == [(0.05,), (0.025,)]
    assert values("rail.profile=54E1,60E1") == [("54E1",), ("60E1",)]
    assert values("wheelset.yaw=0:2:1mrad") == [(0,), (0.001,), (0.002,)]


def test_keys_that_need_each_other_may_be_swept_together() -> None:
    """Without a creepage the case could have no speed."""
    over = "--over rolling.speed=10m/s,30m/s --over rolling.creepage_along=0.1%,1%"
    given = "--fast --set friction.coefficient=0.3"
    assert command.status("plan", "hertz_ellipse", *f"{over} {given}".split()) == 0


@pytest.mark.parametrize(
    "over, said",
    [
        ("load=25kN,3mm", r"load: '3mm' is not a force"),
        ("wheelset.shift=0:40:10mm", r"wheelset.shift: '40mm' is not allowed"),
        ("wheelset.shift=0mm:1mm:1mm", "wheelset.shift: '0mm:1mm:1mm' is no range"),
        ("wheelset.shift=0:1:0mm", "never gets to its end"),
        ("wheelset.shift=0:1:-1mm", "never gets to its end"),
        ("wheelset.shift=0:1:1e-9mm", "too many values; give at most 10000"),
        ("load=1:2:1e-9999kN", "too many values; give at most 10000"),
        ("load=1:2:1e-9999999kN", "too many values; give at most 10000"),
        ("load=25,50kN", "load: '25' has no unit and others have one"),
        ("load=25kN,,50kN", "load: a value between two commas is missing"),
        ("load=25kN,0.025MN", "gives load=25000.0 twice"),
        ("loadd=3", "loadd: unknown key; did you mean load"),
        ("load", "--over: 'load' is not key=values"),
        ("=3", "--over: '=3' is not key=values"),
        ("load=1kN --over load=2kN", "load: is given twice"),
        ("load=1kN --over approach=0.1mm", "load, approach: both are given"),
        ("load=1:200:1kN --over wheelset.shift=0:10:0.1mm", "20200 combinations"),
    ],
)
def test_wrong_values_and_combinations_are_one_line(over: str, said: str, capsys, tmp_path) -> None:
    words = over.split(" --over ")
    given = [part for each in words for part in ("--over", each)]
    line = refused(capsys, tmp_path / "out", "s1002_60e1", *given)
    assert line.startswith("railhead: ") and said in line


def test_files_of_one_name_are_told_apart_by_their_folders(tmp_path, in_this_process) -> None:
    """As far as it takes, in the table and its pictures; names that differ are enough."""
    y = np.linspace(-30.0, 30.0, 121)
    files = [tmp_path / name for name in ("p1/rail.csv", "p2/rail.csv", "p2/worn.csv")]
    for file, radius in zip(files, (300, 200, 250), strict=True):
        file.parent.mkdir(exist_ok=True)
        np.savetxt(file, np.column_stack([y, -(y**2) / (2 * radius)]), delimiter=",")
    scene = rh.Scene(load=25e3, quantities="patch", effects={"finite_bodies": "off"})
    out, paths = tmp_path / "out", list(map(str, files))
    table = rh.sweep(scene, {"rail.profile": paths[:2]}, out=out, quiet=True)
    assert [row["rail.profile"] for row in table.rows()] == ["p1/rail.csv", "p2/rail.csv"]
    assert [row["rail.profile"] for row in rh.load(out).rows()] == ["p1/rail.csv", "p2/rail.csv"]
    assert [row["checks"] for row in table.rows()] == ["passed"] * 2
    grid = ParameterGrid.combine(scene, {"rail.profile": [*paths[::2], "60E1"]})
    assert [names["rail.profile"] for names in grid.names] == ["rail.csv", "worn.csv", "60E1"]


def test_a_folder_with_other_files_takes_no_sweep(capsys, tmp_path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes").write_text("kept")
    assert sweep("s1002_60e1", "--over", "load=1kN", "--out", str(tmp_path / "mine")) == 2
    assert "holds 'notes'" in capsys.readouterr().err


def test_rows_of_a_file_are_combinations(tmp_path, capsys) -> None:
    """As measured along a track; units in the first line or beside the numbers."""
    file = tmp_path / "positions.csv"
    file.write_text("wheelset.shift [mm];wheelset.yaw\n1.5;2 mrad\n\n-3;0\n", encoding="utf-8-sig")
    grid = ParameterGrid.combine(rh.find("s1002_60e1"), {"load": ["1kN", "2kN"]}, read_rows(file))
    found = [tuple(grid.values(number).values()) for number in range(4)]
    assert found == [(1.5, 0.002, 1e3), (1.5, 0.002, 2e3), (-3, 0, 1e3), (-3, 0, 2e3)]
    assert grid.listed and grid.keys == ["wheelset.shift", "wheelset.yaw", "load"]


@pytest.mark.parametrize(
    "text, said",
    [
        ("load,load\n1,2\n", "is no table"),
        ("load\n", "is no table"),
        ("", "is no table"),
        ("load\n1,2\n", "line 2 of "),
        ("load\n1\n\n1,2\n", "line 4 of "),
        ("load\n3mm\n", "load: '3mm' is not a force"),
        ("load [mm]\n3\n", "load: '3mm' is not a force"),
        ("speed\n3\n", "speed: unknown key"),
        ("load\n1kN\n1000\n", "gives load=1000.0 twice"),
        ('load\n"10\n20\n', "is no table: unexpected end of data; give a .csv file in UTF-8"),
        ('load\n"10\n20"\n', r"load: '10\n20' is not a force"),
        (None, "No such file"),
    ],
)
def test_wrong_rows_are_one_line(text: str | None, said: str, capsys, tmp_path) -> None:
    file = tmp_path / "rows.csv"
    if text is not None:
        file.write_text(text)
    line = refused(capsys, tmp_path / "out", "s1002_60e1", "--over-file", str(file))
    assert line.startswith("railhead: ") and said in line


def test_a_sweep_is_planned_without_solving(capsys) -> None:
    for more in ((), ("--json",)):
        assert command.status("plan", "long_roller", "--over", "load=50kN,80kN", *more) == 0
    text, found = capsys.readouterr().out.split("{", 1)
    assert text.startswith("2 combinations\n") and "plane_strain: on in all" in text
    plans = [rh.plan(rh.find("long_roller").replace(load=load)).plan for load in (50e3, 80e3)]
    numbers = json.loads("{" + found)
    assert numbers["unknowns"] == [each.unknowns for each in plans]
    assert max(each.price.solving_seconds for each in plans) <= numbers["seconds"] < 10


def test_lists_stand_as_text_in_columns_and_pictures() -> None:
    assert shown("quantities", ("patch", "forces")) == "patch, forces"
