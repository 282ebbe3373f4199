"""How many processes a run is worth, and the same numbers from two of them."""

import json
import os
import shutil
import subprocess
import sys

import outside
import psutil
import pytest

from railhead import catalogue, launch, process
from railhead.cli import main
from railhead.planning import plan

THESIS = catalogue.find("hertz_ellipse")


@pytest.fixture
def eight(monkeypatch) -> None:
    """A machine with eight cores, none of them started by MPI."""
    monkeypatch.setattr(psutil, "cpu_count", lambda logical=True: 8)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)))
    for name in os.environ.keys() - outside.environment().keys():
        monkeypatch.delenv(name)


@pytest.mark.parametrize(
    ("asked", "processes"),
    [([], 1), (["mesh.patch_size=0.25"], 2), (["accuracy=0.06%"], 1), (["mesh.patch_size=0.1"], 8)],
    ids=["default", "240 000", "190 000", "3 800 000"],
)
def test_large_meshes_are_worth_more_processes(eight, asked, processes) -> None:
    """100 000 unknowns each."""
    assert launch.suited(plan.make(THESIS.replace(asked))) == processes


def test_no_more_than_the_process_may_use(eight, monkeypatch) -> None:
    fine = plan.make(THESIS.replace(["mesh.patch_size=0.1"]))
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {3, 4, 5})
    assert launch.suited(fine) == 3
    monkeypatch.setattr(launch.shutil, "which", lambda _: None)
    assert launch.suited(fine) == 1


def test_what_mpi_started_starts_no_more(eight, monkeypatch) -> None:
    assert not process.started()
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    assert process.started()


def test_no_more_than_there_are_processors(eight, capsys, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(psutil, "cpu_count", lambda logical=True: 4)
    with pytest.raises(SystemExit) as ended:
        main(["run", "long_roller", "--ranks", "1000"])
    assert ended.value.code == 2 and os.listdir(tmp_path) == []
    assert capsys.readouterr().err == "railhead: --ranks: 1000 is not allowed; give at most 4\n"


@pytest.mark.parametrize("ranks", ["1.5", "two", "0"])
def test_ranks_are_whole_numbers(ranks: str, tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main(["run", "long_roller", "--ranks", ranks])
    assert ended.value.code == 2 and os.listdir(tmp_path) == []
    said = capsys.readouterr().err
    assert "--ranks" in said and ranks in said and ("from 1 on" in said or "x>=1" in said)


def test_ranks_without_mpirun_are_refused(eight, tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(launch.psutil, "cpu_count", lambda logical=True: 4)
    monkeypatch.setattr(launch.shutil, "which", lambda name: None)
    with pytest.raises(SystemExit) as ended:
        main(["run", "long_roller", "--ranks", "2"])
    assert ended.value.code == 2 and os.listdir(tmp_path) == []
    assert "--ranks: 2 is not allowed without mpirun" in capsys.readouterr().err


PLAN = "['plan', 'sphere_on_plane']"


@pytest.mark.parametrize("by_hand", [True, False], ids=["mpirun", "--ranks"])
def test_what_goes_into_a_file_is_plain_text(by_hand: bool) -> None:
    """mpirun gives its first process a terminal."""
    launcher, environment = launch.under_mpirun(2, outside.environment())
    program = f"from railhead.cli import main; main({PLAN})"
    if not by_hand:
        launcher, program = [], f"from railhead import launch; launch.restart(2, {PLAN})"
    command = [*launcher, sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert "mean_dilatation" in done.stdout and "\x1b" not in done.stdout


def test_without_room_for_temporary_files_there_is_one_process(
    eight, tmp_path, monkeypatch, capsys
) -> None:
    """Open MPI would wait for ever."""
    monkeypatch.chdir(tmp_path)
    full = shutil.disk_usage(tmp_path)._replace(free=launch.ROOM - 1)
    monkeypatch.setattr(launch.shutil, "disk_usage", lambda _: full)
    assert launch.suited(plan.make(THESIS.replace(["mesh.patch_size=0.1"]))) == 1
    with pytest.raises(SystemExit) as ended:
        main(["run", "long_roller", "--ranks", "2"])
    assert ended.value.code == 2 and os.listdir(tmp_path) == []
    said = capsys.readouterr().err
    assert "--ranks: 2 is not allowed with less than 32 MB free in" in said


def test_a_cache_that_cannot_be_written_is_one_line_on_several_ranks(tmp_path) -> None:
    (tmp_path / "file").touch()
    program = "from railhead.cli import main; main(['run', 'sphere_on_plane', '--no-pictures'])"
    launcher, environment = launch.under_mpirun(2, outside.environment())
    environment["XDG_CACHE_HOME"] = str(tmp_path / "file")
    done = subprocess.run(
        [*launcher, sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True,
        env=environment, timeout=120,
    )  # fmt: skip
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert done.stderr.count("NOT WRITTEN") == 1


def test_processes_of_mpi_refuse_in_one_line() -> None:
    program = "from mpi4py import MPI; from railhead.cli import main; main(['run', 'nosuch'])"
    launcher, environment = launch.under_mpirun(2, outside.environment())
    command = [*launcher, sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 2
    said = [line for line in done.stderr.splitlines() if "nosuch" in line]
    assert len(said) == 1 and said[0].startswith("railhead: case: 'nosuch' is unknown")
    assert "Traceback" not in done.stderr  # Open MPI 5 tells of its network and of the status


def test_a_mesh_that_does_not_fit_starts_no_processes(eight, capsys, monkeypatch) -> None:
    monkeypatch.setattr(launch, "restart", lambda *_: pytest.fail("started"))
    with pytest.raises(SystemExit) as ended:
        main(["run", "hertz_ellipse", "--set", "mesh.patch_size=0.002"])
    assert ended.value.code == 2
    assert "GB free" in capsys.readouterr().err


COMMAND = [sys.executable, "-c", "from railhead.start import main; main()", "run"]


def test_two_ranks_on_request(tmp_path) -> None:
    """The command itself starts them; its numbers are those of one."""
    found = []
    for ranks in ("1", "2"):
        case = ["long_roller", "--no-pictures", "--json", "--ranks", ranks]
        done = subprocess.run(
            [*COMMAND, *case], cwd=tmp_path, env=outside.environment(), capture_output=True
        )
        assert done.returncode == 0, done.stderr
        found.append(json.loads(done.stdout))
        assert found[-1] == json.loads((tmp_path / "results/long_roller/summary.json").read_text())
    one, two = found
    assert (one["cost"]["ranks"], two["cost"]["ranks"]) == (1, 2)
    assert two["result"]["pressure"]["max_MPa"] == pytest.approx(
        one["result"]["pressure"]["max_MPa"], rel=1e-6
    )


def test_a_killed_command_leaves_no_ranks(tmp_path) -> None:
    """As a batch system or `timeout -s KILL` ends it."""
    case = ["hertz_ellipse", "--set", "mesh.patch_size=0.2", "--no-pictures", "--ranks", "2"]
    running = subprocess.Popen(
        [*COMMAND, *case], cwd=tmp_path, env=outside.environment(), stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert running.stderr is not None
    while "meshing" not in running.stderr.readline():
        assert running.poll() is None
    started = psutil.Process(running.pid).children(recursive=True)
    assert len(started) >= 2
    running.kill()
    running.wait()
    _, alive = psutil.wait_procs(started, timeout=5)
    for rank in alive:
        rank.kill()
    assert alive == []
