"""Real signals: the command ends soon, with 128 + number, silently, and leaves nothing behind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import outside
import pytest

COMMAND = "from railhead.start import main; main()"
STUDY = f"""
from pathlib import Path
from railhead import catalogue, refine, study
from railhead.progress import Progress

class Long:
    STUDY = "meshes for long"
    def main(self, out, *, quick):
        (out / "page.md").write_text("begun")
        with Progress(quiet=False) as progress:
            refine.run(catalogue.find("hertz_ellipse").replace(["mesh.patch_size=0.2"]), progress)

study.names = lambda: ["long"]
study.load = lambda name: Long()
{COMMAND}"""
DEAF = f"""
import sys
from collections import deque
from itertools import repeat
from railhead import study

class Long:
    STUDY = "keeps the interpreter's lock, as PETSc does"
    def main(self, out, *, quick):
        (out / "page.md").write_text("begun")
        print("begun", file=sys.stderr, flush=True)
        deque(repeat(0, 10**11), maxlen=0)  # minutes in one call

study.names = lambda: ["long"]
study.load = lambda name: Long()
{COMMAND}"""
FINE = ["run", "hertz_ellipse", "--set", "mesh.patch_size=0.2", "--no-pictures"]


def start(folder: Path, script: str, *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", script, *arguments, "--out", str(folder / "out")],
        env=outside.environment(),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a job in the background
    )  # fmt: skip


def wait_until_heard(running: subprocess.Popen[str]) -> None:
    """Until the command handles SIGTERM, the last of the signals that it comes to hear; before that
    the system and Python end it as they end any other."""
    status, bit = Path(f"/proc/{running.pid}/status"), 1 << (signal.SIGTERM - 1)
    while not int(status.read_text().split("SigCgt:")[1].split()[0], 16) & bit:
        assert running.poll() is None
        time.sleep(1e-3)


def ended(running: subprocess.Popen[str], number: signal.Signals) -> tuple[float, str]:
    """Seconds from the signal to the end, and what was said after it."""
    begun = time.monotonic()
    running.send_signal(number)
    _, errors = running.communicate(timeout=120)
    return time.monotonic() - begun, errors


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize(
    "script, arguments",
    [(COMMAND, [*FINE, "--ranks", "1"]), (COMMAND, [*FINE, "--ranks", "2"]),
     (STUDY, ["study", "long"])],
    ids=["run", "ranks", "study"],
)  # fmt: skip
def test_meshing_ends_soon(script, arguments, number, tmp_path) -> None:
    """gmsh takes some 20 s for this mesh."""
    running = start(tmp_path, script, *arguments)
    assert running.stderr is not None
    while "meshing" not in running.stderr.readline():
        assert running.poll() is None
    time.sleep(1.0)
    seconds, errors = ended(running, number)
    assert seconds < 6
    assert running.returncode == 128 + number
    assert "Traceback" not in errors
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
def test_a_library_that_keeps_the_lock_is_killed_and_leaves_nothing(number, tmp_path) -> None:
    """Killed from outside, too, nothing is left."""
    running = start(tmp_path, DEAF, "study", "long")
    assert running.stderr is not None and running.stderr.readline() == "begun\n"
    assert os.listdir(tmp_path) != []
    time.sleep(0.5)  # until it is in the call
    seconds, errors = ended(running, number)
    assert seconds < 6 and errors == ""
    assert running.returncode == -signal.SIGKILL
    time.sleep(0.5)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    "seconds, number",
    [(0.0, signal.SIGTERM), (0.05, signal.SIGINT), (0.35, signal.SIGTERM), (0.65, signal.SIGINT),
     (1.05, signal.SIGTERM), (1.55, signal.SIGINT), (2.15, signal.SIGTERM),
     *(pytest.param(seconds, number, marks=pytest.mark.slow)
       for number, several in ((signal.SIGTERM, (0.05, 0.65, 1.55)),
                               (signal.SIGINT, (0.0, 0.35, 1.05, 2.15)))
       for seconds in several)],
)  # fmt: skip
def test_imports_end_silently(seconds: float, number: signal.Signals, tmp_path: Path) -> None:
    running = start(tmp_path, COMMAND, *FINE)
    wait_until_heard(running)
    time.sleep(seconds)
    took, errors = ended(running, number)
    assert took < 6
    assert running.returncode == 128 + number
    assert "Traceback" not in errors and "Exception" not in errors
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_the_command_hears_before_it_forks(number: signal.Signals, tmp_path: Path) -> None:
    """A signal that comes during its first milliseconds is heard as any later one."""
    script = f"import os; os.fork = lambda: os.kill(os.getpid(), {number:d}); {COMMAND}"
    running = start(tmp_path, script, *FINE)
    _, errors = running.communicate(timeout=120)
    assert running.returncode == 128 + number and errors == ""


def test_an_ignored_interrupt_stays_ignored(tmp_path: Path) -> None:
    """As of a job in the background of a script."""
    script = f"import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); {COMMAND}"
    small = ["run", "hertz_ellipse", "--set", "mesh.patch_size=1.2", "--no-pictures"]
    running = start(tmp_path, script, *small)
    wait_until_heard(running)
    time.sleep(1.5)
    _, errors = ended(running, signal.SIGINT)
    assert running.returncode == 0, errors
