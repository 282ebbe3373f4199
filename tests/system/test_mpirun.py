"""Two processes under mpirun, started by the command itself."""

import json
import subprocess

import command
import psutil
import pytest
from solved import solved

from railhead.scene.quantities import numeric_values

pytestmark = pytest.mark.system


def test_two_ranks_give_what_one_gives(tmp_path) -> None:
    """The same numbers, each line once, and in a file or a pipe as plain text, though mpirun gives
    its first process a terminal; where a check fails, status 1 as well."""
    keys = "mesh.patch_size=3", "solver.tolerance=1e-9"
    sets = [part for key in keys for part in ("--set", key)]
    done = command.process("run", "hertz_ellipse", *sets, "--ranks", "2", "--no-pictures",
                           cwd=tmp_path)  # fmt: skip
    assert done.returncode == 1 and "CHECK FAILED: elements_across" in done.stderr
    assert done.stdout.count("written to") == 1 and "\x1b" not in done.stdout
    two = json.loads((tmp_path / "results/hertz_ellipse/summary.json").read_text())
    one = solved("hertz_ellipse", *keys).summary
    assert two["cost"]["ranks"] == 2 and two["cost"]["dofs"] == one["cost"]["dofs"]
    assert numeric_values(two["result"]) == pytest.approx(numeric_values(one["result"]), rel=1e-6)


@pytest.mark.parametrize("how", ["--fast", "--quiet"])
def test_a_sweep_under_mpirun_ends(tmp_path, how: str) -> None:
    """The second process solves: half-spaces, and bodies with a mesh."""
    start = ["mpirun", "-n", "2", *command.START, "sweep", "hertz_ellipse", how]
    keys = ["--set", "mesh.patch_size=3", "--over", "load=10kN,20kN", "--out", "swept"]
    done = subprocess.run([*start, *keys], cwd=tmp_path, check=False, timeout=60,
                          env=command.environment() | command.ROOT)  # fmt: skip
    assert done.returncode in (0, 1)
    assert len((tmp_path / "swept/sweep.csv").read_text().splitlines()) == 3


def test_a_killed_command_leaves_no_ranks(tmp_path) -> None:
    """As a batch system or `timeout -s KILL` ends it."""
    case = ["hertz_ellipse", "--set", "mesh.patch_size=0.2", "--no-pictures", "--ranks", "2"]
    running = subprocess.Popen(
        [*command.START, "run", *case], cwd=tmp_path, env=command.environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    command.until(running, "meshing")
    started = psutil.Process(running.pid).children(recursive=True)
    assert len(started) >= 2
    running.kill()
    running.wait()
    _, alive = psutil.wait_procs(started, timeout=5)
    for rank in alive:
        rank.kill()
    assert alive == []
