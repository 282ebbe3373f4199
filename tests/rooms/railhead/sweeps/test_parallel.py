"""Scenes solved side by side: table, files for ParaView, crashes, kills.

Scenes that share a mesh, and those that do not.
"""

import os
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path

import pytest
from solved import planned, solved
from sweep_command import KEYS, ROLLER, refused, rows, sweep

import railhead as rh
from railhead.planning import simulation_plan as planning
from railhead.results import pipeline
from railhead.run import mesh_solution, refinement
from railhead.run.progress import Progress
from railhead.sweeps import parallel, runner, store, sweep_table, worker_pool
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


def test_one_group_of_loads_is_shared_among_idle_processes() -> None:
    """Every load once; where there is a group for each process, none is split."""
    assert parallel.split_among_workers([0, 1, 2, 3, 4], groups=1, workers=2) == [[0, 2, 4], [1, 3]]
    assert parallel.split_among_workers([3, 4], groups=1, workers=8) == [[3], [4]]
    assert parallel.split_among_workers([0, 1, 2], groups=2, workers=3) == [[0, 1, 2]]
    assert parallel.split_among_workers([0, 1, 2], groups=3, workers=1) == [[0, 1, 2]]


def test_shared_loads_give_the_same_numbers(
    swept: Path, tmp_path: Path, monkeypatch, in_this_process
) -> None:
    """The mesh is made again in each job: two of them here, one a group in `swept`."""
    monkeypatch.setattr(worker_pool, "workers", lambda ranks: 2)
    over = ("--over", "load=50kN,80kN,110kN", "--set", "wheel.rolling_radius=420mm")
    out = ("--no-pictures", "--out", str(tmp_path / "out"))
    assert sweep(*ROLLER, *over, *out) == 0
    alone = [row for row in rows(swept) if row[KEYS["wheel.rolling_radius"]] == "420.0"]
    for one, other in zip(alone, rows(tmp_path / "out"), strict=True):
        assert one["unknowns"] == other["unknowns"]
        for name in ("p_max [MPa]", "area [mm2]", "a [mm]", "tau_max [MPa]", "found approach [mm]"):
            assert float(one[name]) == pytest.approx(float(other[name]), rel=1e-10), name


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
    assert found is not None
    assert checks(found) == [f"NOT SOLVED: {parallel.LOST_RECORD}"] * 2


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


def test_what_a_crash_takes_with_it_is_solved_by_itself(tmp_path: Path, monkeypatch) -> None:
    """The process dies at the second of three loads on one mesh, and again alone. The row says so;
    the same command tries it again."""
    task = loads("sphere_on_plane", [100, 200, 300], tmp_path / "out")
    asked: list[list[int]] = []

    @contextmanager
    def one_process(ranks: int, jobs: int):
        def submit(work, *job) -> Future:
            future: Future = Future()
            if work is runner.plan_each:
                future.set_result(worker_pool.attempt(work, *job))
                return future
            folder, over, group, *_ = job
            asked.append(list(over))
            first = next(iter(group))
            if first in over and first != 1:
                fault = RuntimeError("none of a test")
                store.write(folder, first, sweep_table.record(*over[first], fault))
            lost = "the process crashed" if 1 in group else ""
            future.set_result(worker_pool.Attempt(None, lost))
            return future

        yield submit

    monkeypatch.setattr(worker_pool, "submitting", one_process)
    monkeypatch.setattr(worker_pool, "workers", lambda ranks: 1)
    found = parallel.run(task, pictures=True, quiet=True)
    assert asked == [[0, 1, 2], [1], [2]]
    reasons = ("none of a test", "the process crashed", "none of a test")
    assert found is not None and found.failures == []
    assert checks(found) == [f"NOT SOLVED: {why}" for why in reasons]
    assert [row["load [N]"] for row in rows(task.folder)] == ["100.0", "200.0", "300.0"]
    assert rh.load(task.folder).rows() == found.rows()
    asked.clear()
    parallel.run(task, pictures=False, quiet=True)
    assert asked == [[0, 1, 2], [1], [2]]


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
    """The last of three: it is named with its values."""
    line = refused(
        capsys, tmp_path / "out", "s1002_60e1", "--over", "wheelset.shift=0,30mm",
        "--set", "wheelset.back_to_back=1250",
    )  # fmt: skip
    assert "wheelset.shift [mm] = 30.0" in line


def test_the_mesh_of_several_loads_is_no_coarser_than_their_own(in_this_process) -> None:
    """So numbers differ from those of single runs by what the meshes differ: within the estimates
    of both."""
    table = rh.sweep(rh.find("sphere_on_plane"), load=["50N", "200N"], quiet=True)
    for result in table:
        one = solved(rh.find("sphere_on_plane").replace(load=result.load))
        assert result.passed and one.passed
        assert result.as_dict()["cost"]["dofs"] > one.as_dict()["cost"]["dofs"]
        off = abs(result.pressure.max / one.pressure.max - 1)
        assert 0 < off < result.estimate.pressure_max + one.estimate.pressure_max
        off = abs(result.patch.a / one.patch.a - 1)
        assert 0 < off < result.estimate.a + one.estimate.a


def test_loads_far_apart_have_meshes_of_their_own() -> None:
    """Within a patch, elements are at most about twice as long here as there."""
    given = ["100N", "1kN", "799N", "801N", "10kN", "8kN"]
    plans = {n: planned("hertz_ellipse", f"load={load}") for n, load in enumerate(given)}
    assert runner.group_by_mesh(plans) == [[0, 2], [3, 1], [5, 4]]


@pytest.mark.parametrize(
    ("case", "key", "given"),
    [("s1002_60e1", "wheelset.shift=6mm", ["1kN", "2kN"]),
     ("uic54_22t5_axle", "rail.inclination=1:40", ["20kN", "110kN"])],
    ids=["elements of another stretch", "the whole section"],
)  # fmt: skip
def test_loads_that_want_unlike_meshes_share_none(case: str, key: str, given: list[str]) -> None:
    scene = rh.find(case).replace([key, "effects.plasticity=off"])
    plans = {n: planning.make(scene.replace(load=load)) for n, load in enumerate(given)}
    assert runner.group_by_mesh(plans) == [[0], [1]]


@pytest.fixture
def two_loads(monkeypatch):
    """Plans of two loads that suit one mesh, by number; what is solved alone says so."""
    monkeypatch.setattr(pipeline, "solve", lambda *_: "alone")
    scene = rh.find("long_roller").replace(["mesh.patch_size=0.4"])
    loads = {4: "25kN", 2: "50kN"}
    return {number: planning.make(scene.replace(load=load)) for number, load in loads.items()}


def test_what_the_shared_mesh_suits_is_solved_on_it(two_loads) -> None:
    shared = dict(runner.solve_group(two_loads, [4, 2], Progress(quiet=True)))
    assert list(shared) == [4, 2] and "alone" not in shared.values()


@pytest.mark.parametrize(
    ("module", "name", "found"),
    [(refinement, "unplanned_yield", lambda level, comm: "it yields"),
     (mesh_solution, "_remesh_for_found_patch", lambda plan, fields: plan),
     (planning.Plan, "fits", lambda plan, free: False)],
    ids=["it yields", "another patch than the forecast one", "no memory"],
)  # fmt: skip
def test_what_the_shared_mesh_does_not_suit_is_solved_alone(
    module, name: str, found, two_loads, monkeypatch
) -> None:
    monkeypatch.setattr(module, name, found)
    alone = runner.solve_group(two_loads, [4, 2], Progress(quiet=True))
    assert [*alone] == [(4, "alone"), (2, "alone")]
