"""The command `railhead sweep` in tests: what it is given and what it leaves behind."""

import csv
import io
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path

import command
import pytest

from railhead.sweeps import worker_pool

SIX = ("--over", "load=50kN,80kN,110kN", "--over", "wheel.rolling_radius=420mm,460mm")

ROLLER = ("long_roller", "--set", "mesh.patch_size=0.4", "--quiet")


KEYS = {"load": "load [N]", "wheel.rolling_radius": "wheel.rolling_radius [mm]"}


@contextmanager
def one_after_the_other(ranks: int, jobs: int = 0):
    """As `worker_pool.submitting`, with jobs that are done at once in this process."""

    def submit(*job) -> Future:
        future: Future = Future()
        future.set_result(worker_pool.attempt(*job))
        return future

    yield submit


def sweep(*arguments: str) -> int:
    return command.status("sweep", *arguments)


def refused(capsys, folder, *arguments: str) -> str:
    """One line on standard error, status 2, nothing solved or written."""
    assert sweep(*arguments, "--out", str(folder)) == 2
    out, err = capsys.readouterr()
    *before, line = err.splitlines()
    assert out == "" and all("planning" in each for each in before) and not folder.exists()
    return line


def rows(folder) -> list[dict[str, str]]:
    raw = (folder / "sweep.csv").read_bytes()
    assert raw.startswith(b"\xef\xbb\xbf") and raw.count(b"\r\n") == raw.count(b"\n")
    return list(csv.DictReader(io.StringIO(raw.decode("utf-8-sig"))))


def solved_sweep(folder: Path, *arguments: str) -> Path:
    """The folder of a sweep that passes, solved without processes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker_pool, "submitting", one_after_the_other)
        assert sweep(*arguments, "--out", str(folder)) == 0
    return folder
