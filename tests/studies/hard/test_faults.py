"""Killed, out of space, out of memory, two at once: an earlier result stays whole."""

import errno
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from railhead import results
from railhead.cli import main
from railhead.planning import machine

SCRIPT = "from railhead.cli import main; main()"
SMALL_FILES = f"""
import resource
from mpi4py import MPI
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
{SCRIPT}"""
CASE = ["hertz_ellipse", "--set", "mesh.patch_size=1.2", "--no-pictures", "--quiet", "--out"]


def start(folder: Path, *more: str, script: str = SCRIPT) -> subprocess.Popen:
    """The command on a small case."""
    return subprocess.Popen(
        [sys.executable, "-c", script, "run", *CASE, str(folder), *more],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def earlier(tmp_path_factory) -> Path:
    """A complete result, in a folder of its own."""
    folder = tmp_path_factory.mktemp("faults") / "result"
    done = start(folder)
    _, errors = done.communicate(timeout=120)
    assert done.returncode == 0, errors
    return folder


@pytest.mark.parametrize("seconds", [0.4, 1.4, 2.2])
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL])
def test_killed_while_it_runs(earlier: Path, seconds: float, how: signal.Signals) -> None:
    before = content(earlier)
    running = start(earlier)
    time.sleep(seconds)
    running.send_signal(how)
    running.communicate(timeout=60)
    after = content(earlier)
    if running.returncode:
        assert running.returncode in (-how, 128 + how)
        assert after == before or how == signal.SIGKILL  # in the moment after the exchange
    assert set(after) == set(before)
    assert json.loads(after["summary.json"])["checks"]["passed"]
    if how == signal.SIGTERM:
        assert os.listdir(earlier.parent) == [earlier.name]


def test_killed_while_it_compiles(tmp_path: Path, monkeypatch) -> None:
    """The next run does not wait for a compilation that nobody ends."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    running = start(tmp_path / "first")
    cache, deadline = tmp_path / "cache/fenics/railhead", time.monotonic() + 60
    while not list(cache.glob("libffcx_*.c")) and time.monotonic() < deadline:
        time.sleep(0.01)
    running.kill()
    running.communicate(timeout=60)
    (left,) = cache.glob("libffcx_*.c")
    assert not left.with_suffix(".c.cached").exists()
    after = start(tmp_path / "second")
    _, errors = after.communicate(timeout=120)
    assert after.returncode == 0, errors
    assert left.with_suffix(".c.cached").exists()


@pytest.mark.parametrize("there", [False, True])
def test_killed_at_every_line_of_replacing(tmp_path: Path, there: bool) -> None:
    """At each moment the folder holds the earlier result or the new one, whole, or nothing where
    there was nothing."""
    names = results.MANIFEST
    old = {"one": b"old", "two": b"old", names: b"one\ntwo\n"}
    new = {"one": b"new", "three": b"new", names: b"one\nthree\n"}
    seen = []
    for line in range(1, 60):
        folder = tmp_path / f"{line}" / "result"
        if there:
            folder.mkdir(parents=True)
            for name, text in old.items():
                (folder / name).write_bytes(text)
        if (child := os.fork()) == 0:
            try:
                _replace_and_die(folder, new, line)
            finally:
                os._exit(0)
        _, status = os.waitpid(child, 0)
        found = content(folder) if folder.is_dir() else None
        assert found in ([old, new] if there else [None, new])
        seen.append(found)
        if not os.WIFSIGNALED(status):
            break
    assert len(seen) > 8 and seen[-1] == new and seen[0] != new


def _replace_and_die(folder: Path, files: dict[str, bytes], line: int) -> None:
    left = line

    def trace(frame, event, _):
        nonlocal left
        if frame.f_code.co_filename != results.__file__:
            return None
        if event == "line":
            left -= 1
            if left == 0:
                os.kill(os.getpid(), signal.SIGKILL)
        return trace

    sys.settrace(trace)
    with results.replacing(folder) as work:
        for name in ("one", "three"):
            (work / name).write_bytes(files[name])
    sys.settrace(None)


def test_disk_full(earlier: Path) -> None:
    before = content(earlier)
    running = start(earlier, script=SMALL_FILES)
    _, errors = running.communicate(timeout=120)
    assert running.returncode == 1
    assert errors.strip().splitlines() == ["railhead: NOT WRITTEN: File too large"]
    assert content(earlier) == before
    assert os.listdir(earlier.parent) == [earlier.name]


def test_full_tmpfs(earlier: Path, tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("no right to mount a file system")
    try:
        running = start(disk / "result")
        _, errors = running.communicate(timeout=120)
        left = os.listdir(disk)
    finally:
        subprocess.run(["umount", str(disk)], check=True)
    assert running.returncode == 1 and left == []
    assert errors.strip().splitlines() == ["railhead: NOT WRITTEN: No space left on device"]


@pytest.mark.parametrize("code", [errno.EROFS, errno.EACCES, errno.ENOSPC, errno.EDQUOT])
def test_folder_that_refuses_files(code, tmp_path, monkeypatch, capsys) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(code, os.strerror(code), str(tmp_path / "out"))

    monkeypatch.setattr(results.tempfile, "mkdtemp", refuse)
    with pytest.raises(SystemExit) as ended:
        main(["run", *CASE, str(tmp_path / "out")])
    assert ended.value.code == 1
    errors = capsys.readouterr().err.strip()
    assert errors == f"railhead: NOT WRITTEN: {tmp_path / 'out'}: {os.strerror(code)}"
    assert os.listdir(tmp_path) == []


def test_read_only_folder_is_refused_before_anything_is_solved(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(results.os, "access", lambda *_: False)
    with pytest.raises(SystemExit) as ended:
        main(["run", *CASE, str(tmp_path / "out")])
    assert ended.value.code == 2


@pytest.mark.parametrize("key", ["mesh.patch_size=0.002", "rail.crown_radius=0.001"])
def test_a_mesh_that_does_not_fit_into_memory_is_refused(key, tmp_path, capsys) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["run", "hertz_ellipse", "--set", key, "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "mesh.patch_size" in line and "GB" in line
    assert os.listdir(tmp_path) == []


def test_memory_that_is_missing_ends_a_sequence(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.setattr(machine, "free_memory", lambda: 400_000_000)
    with pytest.raises(SystemExit) as ended:
        main(["run", "hertz_ellipse", "--accuracy", "0.1%", "--no-pictures", "--json",
              "--out", str(tmp_path / "out")])  # fmt: skip
    assert ended.value.code == 1
    found = json.loads(capsys.readouterr().out)["accuracy"]
    assert not found["reached"] and found["reason"].startswith("memory")


def test_two_runs_into_one_folder_do_not_mix(earlier: Path) -> None:
    loads = ("25000.0", "30000.0")
    runs = [start(earlier, "--set", f"load={load}") for load in loads]
    for running in runs:
        _, errors = running.communicate(timeout=120)
        assert running.returncode == 0, errors
    load = json.loads((earlier / "summary.json").read_text())["scene"]["load"]
    assert str(load) in loads and f"load = {load}" in (earlier / "scene.toml").read_text()
    assert os.listdir(earlier.parent) == [earlier.name]


def test_many_replacements_at_once_leave_one_whole_result(tmp_path: Path) -> None:
    folder = tmp_path / "result"

    def write(number: int) -> None:
        for _ in range(30):
            with results.replacing(folder) as work:
                for name in ("one", "two"):
                    (work / name).write_bytes(bytes([number]))

    threads = [threading.Thread(target=write, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    found = content(folder)
    assert found.pop(results.MANIFEST) == b"one\ntwo\n"
    assert len(set(found.values())) == 1
    assert os.listdir(tmp_path) == ["result"]


def test_a_cache_that_cannot_be_written_is_named(tmp_path) -> None:
    file = tmp_path / "file"
    file.write_text("no folder")
    program = "from railhead.cli import main; main(['plan', 'hertz_ellipse'])"
    running = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | {"XDG_CACHE_HOME": str(file)},
        capture_output=True, text=True, check=False, cwd=tmp_path,
    )  # fmt: skip
    last = running.stderr.splitlines()[-1]
    assert running.returncode == 1
    assert "the cache of compiled forms; XDG_CACHE_HOME names another folder" in last
