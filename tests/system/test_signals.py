"""Signals end the command at once, by the system's defaults, and its children with it; two
processes give what one gives."""

import json
import os
import signal
import subprocess
import sys
import time

import command
import psutil
import pytest
from solved import solved

from railhead.results import result_folder
from railhead.run import process
from railhead.scene.quantities import numeric_values

pytestmark = pytest.mark.system
COMMAND = "from railhead.cli import main; main()"
DEAF = f"""
import sys
from collections import deque
from itertools import repeat
from railhead.cli import study

class Long:
    STUDY = "keeps the interpreter's lock, as PETSc does"
    def main(self, out, *, quick):
        (out / "page.md").write_text("begun")
        print("begun", file=sys.stderr, flush=True)
        deque(repeat(0, 10**11), maxlen=0)  # minutes in one call

study.modules = lambda: dict(long=("long", ""))
sys.modules["long"] = Long()
{COMMAND}"""


def start(folder, script: str, *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", script, *arguments, "--out", str(folder / "out")],
        env=command.environment(),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a job in the background
    )  # fmt: skip


def ended(running: subprocess.Popen[str], number: signal.Signals) -> tuple[float, str]:
    """Seconds from the signal to the end, and what was said after it."""
    begun = time.monotonic()
    running.send_signal(number)
    _, errors = running.communicate(timeout=60)
    assert running.returncode == -number
    return time.monotonic() - begun, errors


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_meshing_at_once(tmp_path, number: signal.Signals) -> None:
    """gmsh, in a process of its own, takes some 20 s for this mesh."""
    running = start(tmp_path, COMMAND, "run", "hertz_ellipse", "--set", "mesh.patch_size=0.2",
                    "--no-pictures", "--ranks", "1")  # fmt: skip
    command.until(running, "meshing")
    while len(children := psutil.Process(running.pid).children()) < 1:
        time.sleep(0.01)
    seconds, errors = ended(running, number)
    assert seconds < 2 and errors == ""
    assert psutil.wait_procs(children, timeout=5)[1] == [] and os.listdir(tmp_path) == []


def test_sigint_ends_a_library_at_once_and_the_next_command_tidies_up(tmp_path) -> None:
    running = start(tmp_path, DEAF, "study", "long")
    assert running.stderr.readline() == "begun\n"
    time.sleep(0.2)  # until it is in the call
    result_folder.settle(tmp_path / "out")
    (work,) = tmp_path.iterdir()  # of a process that runs: it stays
    assert os.listdir(work) == ["page.md"]
    seconds, errors = ended(running, signal.SIGINT)
    assert seconds < 2 and errors == ""
    result_folder.check_folder(tmp_path / "out")
    assert os.listdir(tmp_path) == []


def test_an_ignored_interrupt_stays_ignored() -> None:
    """As of a job in the background of a script."""
    before = signal.getsignal(signal.SIGINT)
    try:
        for kind, then in [(signal.SIG_IGN, signal.SIG_IGN),
                           (signal.default_int_handler, signal.SIG_DFL)]:  # fmt: skip
            signal.signal(signal.SIGINT, kind)
            process.end_at_once()
            assert signal.getsignal(signal.SIGINT) is then
    finally:
        signal.signal(signal.SIGINT, before)


# Two processes under mpirun, started by the command itself.


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


@pytest.mark.parametrize("how", ["--fast", pytest.param("--quiet", marks=pytest.mark.slow)])
def test_a_sweep_under_mpirun_ends(tmp_path, how: str) -> None:
    """The second process solves: half-spaces, and bodies with a mesh."""
    start = ["mpirun", "-n", "2", *command.START, "sweep", "hertz_ellipse", how]
    keys = ["--set", "mesh.patch_size=3", "--over", "load=10kN,20kN", "--out", "swept"]
    done = subprocess.run([*start, *keys], cwd=tmp_path, check=False, timeout=60,
                          env=command.environment() | command.ROOT)  # fmt: skip
    assert done.returncode in (0, 1)
    assert len((tmp_path / "swept/sweep.csv").read_text().splitlines()) == 3
