"""Scenes solved side by side: table, crashes, what is tried again."""

import os
from pathlib import Path

import pytest
from sweep_command import KEYS, refused, rows, sweep

import railhead as rh
from railhead.planning import simulation_plan as planning
from railhead.run.progress import Progress
from railhead.sweeps import parallel, runner, store, sweep_table
from railhead.sweeps.grid import ParameterGrid, parse_values


def test_a_row_for_each_combination(swept: Path) -> None:
    found = rows(swept)
    given = [(float(row[KEYS["load"]]), float(row[KEYS["wheel.rolling_radius"]])) for row in found]
    assert given == [(p, r) for p in (5e4, 8e4, 11e4) for r in (420, 460)]
    assert {row["checks"] for row in found} == {"passed"}
    assert sorted(os.listdir(swept)) == sorted(
        [".railhead", "records", "report.html", "sweep.csv", "sweep.json", "sweep.png"]
    )
    for row in found:
        assert float(row["found load [N]"]) == pytest.approx(float(row["load [N]"]))


def loads(case: str, values: list[float], folder: Path) -> parallel.ParallelSweep:
    """A sweep over loads that is not run yet."""
    grid = ParameterGrid.combine(rh.find(case), {"load": values})
    return parallel.ParallelSweep(grid=grid, folder=folder)


def test_a_record_that_goes_while_a_sweep_runs_is_said(
    tmp_path: Path, monkeypatch, in_this_process
) -> None:
    task = loads("long_roller", [50e3, 80e3], tmp_path / "sweep")
    monkeypatch.setattr(parallel, "_solve", _nothing)
    found = parallel.run(task, pictures=False, quiet=True)
    assert found is not None and checks(found) == [f"NOT SOLVED: {parallel.LOST_RECORD}"] * 2


def checks(found: rh.Sweep) -> list[str]:
    return [row["checks"] for row in found.rows()]


def _nothing(*_: object) -> None: ...


def test_one_that_does_not_converge_leaves_the_others(
    tmp_path: Path, capsys, in_this_process
) -> None:
    out = tmp_path / "out"
    over = ("--over", "solver.max_newton=1,30", "--no-pictures")
    assert sweep("two_cylinders", "--quiet", *over, "--out", str(out)) == 1
    one, other = rows(out)
    assert one["checks"].startswith("NOT CONVERGED: too many Newton steps")
    assert one["p_max [MPa]"] == "" and one["solver.max_newton"] == "1"
    assert other["checks"] == "passed" and float(other["p_max [MPa]"]) > 0
    assert "solver.max_newton = 1: NOT CONVERGED" in capsys.readouterr().err


def test_a_job_that_is_lost_is_said_in_the_row_of_its_scene(
    tmp_path: Path, monkeypatch, in_this_process
) -> None:
    """It leaves no record. The same command tries it again."""
    task = loads("sphere_on_plane", [100, 200, 300], tmp_path / "out")
    asked: list[int] = []

    def solve(folder: Path, number: int, over, _) -> None:
        asked.append(number)
        if number == 1:
            raise OSError("lost")
        store.write(folder, number, sweep_table.record(*over, RuntimeError("of a test")))

    monkeypatch.setattr(parallel, "_solve", solve)
    found = parallel.run(task, pictures=True, quiet=True)
    assert asked == [0, 1, 2]
    reasons = ("of a test", "OSError: lost", "of a test")
    assert found is not None and found.failures == []
    assert checks(found) == [f"NOT SOLVED: {why}" for why in reasons]
    assert [row["load [N]"] for row in rows(task.folder)] == ["100.0", "200.0", "300.0"]
    assert rh.load(task.folder).rows() == found.rows()
    asked.clear()
    parallel.run(task, pictures=False, quiet=True)
    assert asked == [0, 1, 2]


def test_what_has_no_memory_now_is_tried_again(tmp_path, monkeypatch, in_this_process) -> None:
    task = loads("sphere_on_plane", [100], tmp_path / "out")
    with monkeypatch.context() as patch:
        patch.setattr("railhead.run.refinement.cost.free_memory", lambda: 0)
        (short,) = checks(parallel.run(task, pictures=False, quiet=True))
    assert "NOT SOLVED" in short and "GB free" in short
    assert checks(parallel.run(task, pictures=False, quiet=True)) == ["passed"]


def test_a_sweep_has_one_datum_of_the_approach() -> None:
    """The whole rail is called for at 1 and 2 mm alone."""
    given = rh.find("s1002_60e1").replace(["load=40kN", "effects.plasticity=off"])
    grid = ParameterGrid.combine(given, parse_values(["wheelset.shift=1mm,2mm,3mm"]))
    alone = [planning.make(scene).effects["rail_section"].on for scene in grid.scenes]
    plans = runner.plan_all(grid, Progress(quiet=True))
    assert alone == [True, True, False]
    assert [plan.effects["rail_section"].on for plan in plans.values()] == [True] * 3
    assert [scene.effects.rail_section for scene in grid.scenes] == ["auto", "auto", "on"]


def test_what_makes_no_contact_is_refused_before_anything_runs(capsys, tmp_path) -> None:
    """The second of two: it is named with its values."""
    line = refused(
        capsys, tmp_path / "out", "s1002_60e1", "--over", "wheelset.shift=0,30mm",
        "--set", "wheelset.back_to_back=1250",
    )  # fmt: skip
    assert "wheelset.shift [mm] = 30.0" in line
