"""Killed, out of space, out of memory, two at once: an earlier result stays whole."""

import errno
import json
import os
import subprocess
import sys
import threading

import command
import killed
import pytest
from mpi4py import MPI

from railhead.planning import cost
from railhead.results import result_folder
from railhead.solver import compat

pytestmark = pytest.mark.system
SMALL_FILES = """
import resource
from mpi4py import MPI
resource.setrlimit(resource.RLIMIT_FSIZE, (2_000, 2_000))
from railhead.cli import main; main()"""
CASE = ["long_roller", "--no-pictures", "--quiet", "--out"]
NAMES = result_folder.MANIFEST
OLD = {"one": b"old", "two": b"old", NAMES: b"one\ntwo\n"}
NEW = {**killed.NEW, NAMES: b"one\nthree\n"}
MINE = {"mine": b"kept"}


def content(folder) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def make(folder, files: dict[str, bytes]) -> None:
    folder.mkdir(parents=True)
    for name, text in files.items():
        (folder / name).write_bytes(text)


def killed_before_each_line(action: str, there: dict[str, dict[str, bytes]], tmp) -> int:
    """Number of the first line that is not reached; before each one up to it a process was killed
    in a folder of its own, which held the folders `there` with their files."""
    for line in range(1, 200):
        (tmp / f"{line}").mkdir()
        for name, files in there.items():
            make(tmp / f"{line}" / name, files)
    done = subprocess.run(
        [sys.executable, killed.__file__, action, str(tmp)], capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    return int(done.stdout)


@pytest.mark.parametrize("there", [False, True])
def test_killed_while_a_result_is_replaced(tmp_path, there: bool) -> None:
    """The next command finds the earlier result or the new one, whole (nothing where there was
    nothing), with what somebody else put there, and leaves nothing else."""
    begun = {"result": OLD | MINE} if there else {}
    seen = []
    for line in range(1, killed_before_each_line("replace", begun, tmp_path) + 1):
        folder = tmp_path / f"{line}" / "result"
        result_folder.check_folder(folder, keeps=["mine"])
        found = content(folder) if folder.is_dir() else None
        assert found in ([OLD | MINE, NEW | MINE] if there else [None, NEW])
        assert os.listdir(folder.parent) == ([] if found is None else ["result"])
        seen.append(found)
    assert len(seen) > 20 and seen[0] != seen[-1]
    assert seen.index(seen[-1]) < len(seen) - 5  # killed while it tidies up, too


@pytest.mark.parametrize("new", [False, True])
def test_killed_while_the_next_command_finishes_that(tmp_path, new: bool) -> None:
    begun = {".result.earlier": OLD | MINE} | ({"result": NEW} if new else {})
    last = killed_before_each_line("settle", begun, tmp_path)
    for line in range(1, last + 1):
        folder = tmp_path / f"{line}" / "result"
        result_folder.settle(folder)
        assert content(folder) == (NEW if new else OLD) | MINE
        assert os.listdir(folder.parent) == ["result"]
    assert last > 10


def test_a_compilation_that_was_killed_is_not_waited_for(tmp_path) -> None:
    """ffcx would wait ten seconds for what nobody ends, and fail."""
    for name in ("libffcx_done.c", "libffcx_done.c.cached", "libffcx_killed.c"):
        (tmp_path / name).touch()
    with compat.alone(MPI.COMM_SELF, tmp_path):
        left = {path.name for path in tmp_path.iterdir()} - {compat.LOCK}
    assert left == {"libffcx_done.c", "libffcx_done.c.cached"}


def test_a_full_disk_leaves_the_earlier_result(tmp_path) -> None:
    folder = tmp_path / "result"
    make(folder, OLD)
    done = subprocess.run(
        [sys.executable, "-c", SMALL_FILES, "run", "--force", "--fast", "--set",
         "rail.extent=half-space", *CASE, str(folder)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr.strip().splitlines() == [f"railhead: NOT WRITTEN: {folder}: File too large"]
    assert content(folder) == OLD
    assert os.listdir(tmp_path) == ["result"]


def test_a_folder_that_refuses_files_is_one_line(tmp_path, monkeypatch, capsys) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(tmp_path / "out"))

    monkeypatch.setattr(result_folder.tempfile, "mkdtemp", refuse)
    assert command.status("run", *CASE, str(tmp_path / "out")) == 1
    errors = capsys.readouterr().err.strip()
    assert errors == f"railhead: NOT WRITTEN: {tmp_path / 'out'}: {os.strerror(errno.EROFS)}"
    assert os.listdir(tmp_path) == []


def test_read_only_folder_is_refused_before_anything_is_solved(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(result_folder.os, "access", lambda *_: False)
    assert command.status("run", *CASE, str(tmp_path / "out")) == 2


def test_memory_that_is_missing_ends_a_sequence(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.setattr(cost, "free_memory", lambda: 400_000_000)
    given = f"hertz_ellipse --accuracy 0.1% --no-pictures --json --out {tmp_path / 'out'}"
    assert command.status("run", *given.split()) == 1
    found = json.loads(capsys.readouterr().out)["accuracy"]
    assert not found["reached"] and found["reason"].startswith("memory")


def test_many_replacements_at_once_leave_one_whole_result(tmp_path) -> None:
    folder = tmp_path / "result"

    def write(number: int) -> None:
        for _ in range(30):
            with result_folder.replacing(folder) as work:
                for name in ("one", "two"):
                    (work / name).write_bytes(bytes([number]))

    threads = [threading.Thread(target=write, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    found = content(folder)
    assert found.pop(result_folder.MANIFEST) == b"one\ntwo\n"
    assert len(set(found.values())) == 1
    assert os.listdir(tmp_path) == ["result"]
