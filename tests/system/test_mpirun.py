"""Two processes under mpirun, started by the command itself."""

import json
import subprocess
from pathlib import Path

import command
import psutil
import pytest
from solved import solved

pytestmark = pytest.mark.system


def test_two_ranks_give_what_one_gives(tmp_path: Path) -> None:
    """The same numbers, each line once, and in a file or a pipe as plain text, though mpirun gives
    its first process a terminal; where a check fails, status 1 as well."""
    done = command.process("run", "long_roller", "--set", "mesh.patch_size=3", "--ranks", "2",
                           "--no-pictures", cwd=tmp_path)  # fmt: skip
    assert done.returncode == 1 and "CHECK FAILED: elements_across" in done.stderr
    assert done.stdout.count("written to") == 1 and "\x1b" not in done.stdout
    two = json.loads((tmp_path / "results/long_roller/summary.json").read_text())
    one = solved("long_roller", "mesh.patch_size=3")
    assert two["cost"]["ranks"] == 2
    assert two["result"]["pressure"]["max_MPa"] == pytest.approx(one.pressure.max, rel=1e-6)


def test_a_cache_that_cannot_be_written_is_one_line_on_several_ranks(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    cache = str(tmp_path / "file")
    done = command.process(
        "run", "long_roller", "--json", "--ranks", "2", cwd=tmp_path, XDG_CACHE_HOME=cache
    )
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert done.stderr.count("NOT WRITTEN") == 1 and done.stdout == ""
    assert "the cache of compiled forms; XDG_CACHE_HOME names another folder" in done.stderr


def test_a_killed_command_leaves_no_ranks(tmp_path: Path) -> None:
    """As a batch system or `timeout -s KILL` ends it."""
    case = ["hertz_ellipse", "--set", "mesh.patch_size=0.2", "--no-pictures", "--ranks", "2"]
    running = subprocess.Popen(
        [*command.START, "run", *case], cwd=tmp_path, env=command.environment(),
        stdout=subprocess.DEVNULL,
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
