"""How many processes a run is worth, and which it may have."""

import os
import shutil

import command
import psutil
import pytest

from railhead.cli import launch
from railhead.planning import simulation_plan
from railhead.results import pipeline
from railhead.scene import catalogue
from railhead.scene.scene import SceneError

THESIS = catalogue.find("hertz_ellipse")
ROOM = shutil.disk_usage("/")._replace(free=launch.TEMPORARY_BYTES - 1)  # too little


@pytest.fixture
def eight(monkeypatch) -> None:
    """A machine with eight cores, none of them started by MPI."""
    monkeypatch.setattr(psutil, "cpu_count", lambda logical=True: 8)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)))
    for name in os.environ.keys() - command.environment().keys():
        monkeypatch.delenv(name)


@pytest.mark.parametrize(
    ("asked", "processes"),
    [([], 1), (["mesh.patch_size=0.25"], 2), (["accuracy=0.07%"], 1), (["mesh.patch_size=0.1"], 8)],
    ids=["default", "240 000", "190 000", "3 800 000"],
)
def test_large_meshes_are_worth_more_processes(eight, asked, processes) -> None:
    """100 000 unknowns each."""
    assert launch.number_of_processes(simulation_plan.make(THESIS.replace(asked))) == processes


def test_no_more_than_the_process_may_use(eight, monkeypatch) -> None:
    fine = simulation_plan.make(THESIS.replace(["mesh.patch_size=0.1"]))
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {3, 4, 5})
    assert launch.number_of_processes(fine) == 3
    monkeypatch.setattr(launch.shutil, "disk_usage", lambda _: ROOM)
    assert launch.number_of_processes(fine) == 1


def test_what_mpi_started_starts_no_more(eight, monkeypatch, capsys, tmp_path) -> None:
    def solve(*_) -> None:
        raise SceneError("load", "is solved in this process")

    monkeypatch.setattr(launch, "restart", lambda *_: pytest.fail("started"))
    monkeypatch.setattr(pipeline, "solve", solve)
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    given = "run", "long_roller", "--ranks", "2", "--quiet", "--out", str(tmp_path / "out")
    assert "is solved in this process" in command.refused(capsys, *given)


@pytest.mark.parametrize(
    ("name", "found", "ranks", "words"),
    [
        ("which", lambda _: "mpirun", "1000", "1000 is not allowed; give at most 8"),
        ("which", lambda _: None, "2", "2 is not allowed without mpirun"),
        ("disk_usage", lambda _: ROOM, "2", "2 is not allowed with less than 32 MB free in"),
    ],
    ids=["processors", "no mpirun", "Open MPI would wait for ever"],
)
def test_ranks_that_cannot_start_are_refused(
    name, found, ranks, words, eight, here, monkeypatch, capsys
) -> None:
    monkeypatch.setattr(launch.shutil, name, found)
    line = command.refused(capsys, "run", "long_roller", "--ranks", ranks)
    assert line.startswith(f"railhead: --ranks: {words}") and os.listdir(here) == []


def test_a_mesh_that_does_not_fit_starts_no_processes(eight, capsys, monkeypatch) -> None:
    monkeypatch.setattr(launch, "restart", lambda *_: pytest.fail("started"))
    assert command.status("run", "hertz_ellipse", "--set", "mesh.patch_size=0.02") == 2
    assert "GB free" in capsys.readouterr().err
