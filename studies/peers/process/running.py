"""One command at a time in a process of its own, and what it cost."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

LIMIT = 900.0  # seconds
THREADS = 1
ACCOUNT = Path(__file__).with_name("account.py")
LAST = 300  # characters of what a failing command said last


class FailedError(RuntimeError):
    """A command gave nothing; the text says why, in one line."""


@dataclass(frozen=True)
class Cost:
    """Of a whole process with all that it waits for: seconds by the clock and of the processor,
    peak memory of the largest."""

    seconds: float
    cpu_seconds: float
    peak_bytes: int


def run(command: Sequence[str], folder: Path, limit: float = LIMIT) -> Cost:
    """Run a command in a folder, with THREADS threads for each library. FailedError: it takes
    longer than `limit` (s) or its status is not 0."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    environment = os.environ | {name: str(THREADS) for name in names} | {"PYTHONWARNINGS": "ignore"}
    (folder / "cost.json").unlink(missing_ok=True)
    with (folder / "said.txt").open("wb") as said:
        process = subprocess.Popen(
            [sys.executable, "-I", str(ACCOUNT), "cost.json", *command],
            cwd=folder,
            env=environment,
            stdout=said,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            process.wait(limit)
        except subprocess.TimeoutExpired:
            raise FailedError(f"not back after {limit:g} s") from None
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
    return _cost(folder)


def _cost(folder: Path) -> Cost:
    lines = (folder / "said.txt").read_text(encoding="utf-8", errors="replace").split("\n")
    last = next((" ".join(line.split()) for line in reversed(lines) if line.strip()), "")[-LAST:]
    if not (folder / "cost.json").exists():
        raise FailedError(last or "it could not be started")
    cost = json.loads((folder / "cost.json").read_text(encoding="utf-8"))
    if (status := cost.pop("status")) != 0:
        raise FailedError(last or f"status {status}")
    return Cost(**cost)
