"""One command at a time in a process of its own, and what it cost."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

LIMIT = 900.0  # seconds
THREADS = 1
ACCOUNT = Path(__file__).with_name("account.py")
LAST = 300  # characters of what a failing command said last
LATE = 124  # status of `timeout` where it ended the command
LIBRARIES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
Cost = dict[str, float]
"""Of a whole process with all that it waits for: seconds by the clock and cpu_seconds of the
processor, peak_bytes of memory of the largest."""


class FailedError(RuntimeError):
    """A command gave nothing; the text says why, in one line."""


def run(command: Sequence[str], folder: Path, limit: float = LIMIT) -> Cost:
    """Run a command in a folder, with THREADS threads for each library. FailedError: it takes
    longer than `limit` (s) or its status is not 0."""
    done = subprocess.run(
        [sys.executable, "-I", str(ACCOUNT), "cost.json", "timeout", f"{limit:g}", *command],
        cwd=folder,
        env=os.environ | dict.fromkeys(LIBRARIES, str(THREADS)) | {"PYTHONWARNINGS": "ignore"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=True,
        text=True,
        errors="replace",
    )
    cost: Cost = json.loads((folder / "cost.json").read_text(encoding="utf-8"))
    if (status := cost.pop("status")) == LATE:
        raise FailedError(f"not back after {limit:g} s")
    if status:
        lines = [" ".join(line.split()) for line in done.stdout.splitlines() if line.strip()]
        raise FailedError((lines or [f"status {status}"])[-1][-LAST:])
    return cost
