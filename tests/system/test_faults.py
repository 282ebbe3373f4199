"""Killed, out of space, out of memory, two at once: an earlier result stays whole."""

import errno
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import command
import killed
import pytest
from mpi4py import MPI

from railhead.meshing import isolated_process
from railhead.planning import cost
from railhead.postprocess.pictures import render
from railhead.results import pipeline, result_folder
from railhead.scene import catalogue
from railhead.scene.scene import Scene
from railhead.solver import compat
from railhead.solver.algebra import linear

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


def forms(folder) -> set[str]:
    return {path.name for path in folder.glob("libffcx_*")}


@pytest.mark.parametrize("name", ["libffcx_cut.so", "libffcx_killed.c"])
def test_a_form_that_is_not_as_it_was_finished_is_removed(tmp_path, name: str) -> None:
    """ffcx would wait ten seconds for a C file that nobody finishes, and load a cut library."""
    with compat.alone(MPI.COMM_SELF, tmp_path):
        for each in ("libffcx_done.c", "libffcx_done.so", "libffcx_cut.c", "libffcx_cut.so"):
            (tmp_path / each).write_text("whole")
    finished = forms(tmp_path)
    (tmp_path / name).write_text("")
    with compat.alone(MPI.COMM_SELF, tmp_path):
        damaged = {"libffcx_cut.c", "libffcx_cut.so"} if "cut" in name else set()
        assert forms(tmp_path) == finished - damaged


def test_a_machine_without_a_compiler_is_one_line(tmp_path) -> None:
    done = command.process("run", *CASE, "out", cwd=tmp_path, PATH="", XDG_CACHE_HOME=str(tmp_path))
    (line,) = done.stderr.splitlines()
    assert done.returncode == 1 and line.startswith("railhead: NOT WRITTEN: ")
    assert "no form can be compiled: " in line and "gcc' " in line  # of distutils, or the system's
    assert not (tmp_path / "out").exists()


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
    assert content(folder) == OLD and os.listdir(tmp_path) == ["result"]


def test_read_only_folder_is_refused_before_anything_is_solved(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(result_folder.os, "access", lambda *_: False)
    assert command.status("run", *CASE, str(tmp_path / "out")) == 2


def test_the_one_mesh_of_an_accuracy_that_has_no_memory_is_refused(
    tmp_path, monkeypatch, capsys
) -> None:
    monkeypatch.setattr(cost, "free_memory", lambda: 400_000_000)
    given = f"hertz_ellipse --accuracy 0.1% --no-pictures --json --out {tmp_path / 'out'}"
    assert command.status("run", *given.split()) == 2
    said = capsys.readouterr().err
    assert said.startswith("railhead: accuracy: ") and "0.4 GB free" in said
    assert not (tmp_path / "out").exists()


LIMITED = """
import resource
from mpi4py import MPI
resource.setrlimit(resource.RLIMIT_AS, (600_000_000, 600_000_000))
from railhead.cli import main; main()"""


def test_a_limit_of_address_space_is_one_line(tmp_path) -> None:
    """The BLAS tries for ever to map its 128 MB."""
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, "run", *CASE, str(tmp_path / "out")],
        capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (1, "railhead: NOT SOLVED: out of memory\n")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    "error",
    [
        MemoryError("Unable to allocate 1.27 MiB"),
        ImportError("libpetsc.so: failed to map segment from shared object"),
        RuntimeError("error code 55\n[0] Out of memory. Allocated: 0"),
        OSError(errno.ENOMEM, os.strerror(errno.ENOMEM)),
    ],
)
def test_memory_that_is_missing_on_the_way_is_one_line(
    tmp_path, monkeypatch, capsys, error: Exception
) -> None:
    def refuse(*_: object) -> None:
        raise error

    monkeypatch.setattr(pipeline, "solve", refuse)
    assert command.status("run", *CASE, str(tmp_path / "out")) == 1
    assert capsys.readouterr().err == "railhead: NOT SOLVED: out of memory\n"


def test_a_limit_of_address_space_counts_as_memory(monkeypatch) -> None:
    monkeypatch.setattr(isolated_process, "address_space", lambda: 1e8)
    monkeypatch.setattr(cost, "address_space", lambda: 1e8)
    assert cost.free_memory() == 100_000_000
    monkeypatch.delitem(sys.modules, "pyvista", raising=False)
    with pytest.raises(MemoryError, match="graphics"):
        render.load_pyvista()


def test_mumps_that_cannot_allocate_is_no_linear_solver_that_stalls(monkeypatch) -> None:
    monkeypatch.setattr(linear, "NOT_ALLOCATED", (0,))  # which is success
    rows = [0, 1, 2], [0, 1], [1.0, 1.0]
    matrix = linear.PETSc.Mat().createAIJ((2, 2), csr=rows, comm=linear.PETSc.COMM_SELF)
    matrix.assemble()
    pc = linear.PETSc.PC().create(linear.PETSc.COMM_SELF)
    pc.setOperators(matrix)
    with pytest.raises(MemoryError):
        linear.factorise(pc, symmetric=True)


def test_standard_error_that_is_full_leaves_the_status(tmp_path) -> None:
    with open("/dev/full", "w") as full:
        for case, status in (("hertz_ellipse", 0), ("nothing", 2)):
            arguments = ["run", case, "--fast", "--no-pictures", f"--out={tmp_path / 'out'}"]
            done = subprocess.run([*command.START, *arguments], stderr=full, check=False)
            assert done.returncode == status
    assert (tmp_path / "out" / "summary.json").is_file()


def test_names_that_the_output_does_not_know_are_escaped(tmp_path) -> None:
    keys = 'load = 1000\n[rail]\nextent = "half-space"\nprofile = "arc"\ncrown_radius = 300\n'
    (tmp_path / "輪.toml").write_text(keys, encoding="utf-8")
    done = command.process("plan", "輪.toml", cwd=tmp_path, PYTHONIOENCODING="latin-1")
    assert done.returncode == 0 and done.stdout.startswith("plan of \\u8f2a")


def test_a_command_in_a_folder_in_use_is_refused(tmp_path, capsys) -> None:
    folder = str(tmp_path / "out")
    with result_folder.claimed(tmp_path / "link" / ".." / "out"):
        line = command.refused(capsys, "run", *CASE, folder)
    assert (
        line
        == f"railhead: --out: {folder!r} is in use by another command; wait for it, or give another"
    )
    assert os.listdir(tmp_path) == []
    assert command.status("run", "hertz_ellipse", "--fast", *CASE[1:], folder) == 0


def test_results_of_other_scenes_at_once_are_all_kept(tmp_path) -> None:
    """As of two commands without --out."""
    folder = tmp_path / "result"

    def write(number: int) -> None:
        for count in range(5):
            scene = Scene(load=1 + number + 10 * count)
            with result_folder.result(folder, "run", scene, {}, aside=True):
                pass

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(write, range(4)))
    loads = [catalogue.find(path / "scene.toml").load for path in tmp_path.iterdir()]
    assert sorted(loads) == sorted(1 + n + 10 * count for n in range(4) for count in range(5))
