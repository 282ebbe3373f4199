"""Which combinations a sweep has, and what is refused."""

import pytest
from sweep_command import refused, sweep

import railhead as rh
from railhead.sweeps.grid import ParameterGrid, parse_values

SHIFTS = "wheelset.shift=0:10:0.5mm"


def values(*texts: str, case: str = "s1002_60e1") -> list[tuple[object, ...]]:
    grid = ParameterGrid.combine(rh.find(case), parse_values(texts))
    grid.refuse_duplicates()
    return [tuple(grid.values(number).values()) for number in range(len(grid.scenes))]


def test_lists_and_ranges_multiply_the_last_fastest() -> None:
    found = values("load=25kN,50000 N", "wheelset.shift=0,1:2:.5mm")
    assert found == [(p, s) for p in (25e3, 50e3) for s in (0, 1, 1.5, 2)]
    assert values("wheelset.shift=2:0:-1 mm") == [(2,), (1,), (0,)]
    assert values("wheelset.shift=0:1:0.3mm") == [(0,), (0.3,), (0.6,), (0.9,)]
    assert values("rail.inclination=1:20,1:40") == [(0.05,), (0.025,)]
    assert values("rail.profile=54E1,60E1") == [("54E1",), ("60E1",)]
    assert values("wheelset.yaw=0:2:1mrad") == [(0,), (0.001,), (0.002,)]


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
    ],
)
def test_wrong_values_are_one_line(over: str, said: str, capsys, tmp_path) -> None:
    line = refused(capsys, tmp_path / "out", "s1002_60e1", "--over", over)
    assert line.startswith("railhead: ") and said in line


def test_wrong_combinations_are_one_line(capsys, tmp_path) -> None:
    out, case = tmp_path / "out", "s1002_60e1"
    twice = refused(capsys, out, case, "--over", "load=1kN", "--over", "load=2kN")
    assert "load: is given twice" in twice
    both = refused(capsys, out, case, "--over", "load=1kN", "--over", "approach=0.1mm")
    assert "load, approach: both are given" in both
    many = refused(capsys, out, case, "--over", "load=1:200:1kN", "--over", SHIFTS[:-5] + "0.1mm")
    assert "20200 combinations" in many
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes").write_text("kept")
    assert sweep(case, "--over", "load=1kN", "--out", str(tmp_path / "mine")) == 2
    assert "holds 'notes'" in capsys.readouterr().err
