"""The process of the command: memory that is free is given back when somebody may need it."""

import ctypes
import subprocess
import sys

import pytest

from railhead.cli import commands, errors
from railhead.run import process

GIVEN_BACK = """
import psutil
from railhead.run import process

process.prepare()
taken = [bytearray(100_000) for _ in range(3000)]
del taken
size = psutil.Process().memory_info().rss
process.release_memory()
print(size - psutil.Process().memory_info().rss)
"""


def test_free_memory_is_given_back() -> None:
    told = subprocess.run(
        [sys.executable, "-c", GIVEN_BACK], capture_output=True, text=True, check=True
    )
    assert int(told.stdout) > 200e6


@pytest.mark.parametrize("name", process.RANK_VARIABLES)
def test_a_refusal_under_mpirun_is_said_once(name: str, monkeypatch, capsys) -> None:
    """MPI is not loaded yet where input is read."""
    monkeypatch.setitem(sys.modules, "mpi4py.MPI", None)
    for rank, lines in (("0", 1), ("1", 0)):
        monkeypatch.setenv(name, rank)
        errors.say("no scene")
        assert len(capsys.readouterr().err.splitlines()) == lines


def test_arguments_are_not_left_to_libraries(monkeypatch, capsys) -> None:
    """dolfinx ends with a traceback where one is no UTF-8."""
    monkeypatch.setattr(sys, "argv", ["railhead", "plan", "c\udcff.toml"])
    with pytest.raises(SystemExit) as ended:
        commands.main()
    assert ended.value.code == 2 and sys.argv == ["railhead"]
    assert "is no file" in capsys.readouterr().err


@pytest.mark.parametrize("rank", ["0", "1"])
def test_a_plan_under_mpirun_is_said_once(rank: str, monkeypatch, capsys) -> None:
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", rank)
    assert commands._status(["plan", "sphere_on_plane", "--json"]) == 0
    assert bool(capsys.readouterr().out) is (rank == "0")


def test_one_thread_of_blas_runs_the_tests_too() -> None:
    """However they are started: sums of more threads differ in the last digits."""
    assert ctypes.CDLL("libopenblas.so.0").openblas_get_num_threads() == 1
