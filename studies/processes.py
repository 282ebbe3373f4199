"""Measurements in processes of their own: one command at a time, and what it costs.

`python -I processes.py REPORT.json COMMAND...` runs a command and writes its cost as /usr/bin/time
counts it, with all that it waits for. It must be a small process: the peak memory that the system
counts for a new process begins with the memory of the one that starts it. So the head of this file
imports nothing of railhead.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import TimeoutError as LimitExceededError
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

T = TypeVar("T")
LIMIT = 900.0  # seconds
THREADS = 1
LAST = 300  # characters of what a failing command said last
LATE = 124  # status of `timeout` where it ended the command
LIBRARIES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
Cost = dict[str, float]
"""Of a whole process with all that it waits for: seconds by the clock and cpu_seconds of the
processor, peak_bytes of memory of the largest."""


class FailedError(RuntimeError):
    """A command gave nothing; the text says why, in one line."""


def run(command: Sequence[str], folder: Path, limit: float = LIMIT) -> Cost:
    """Run a command in a folder, with THREADS threads for each library, and return its cost. Raises
    FailedError where it takes longer than `limit` (s) or its status is not 0.
    """
    done = subprocess.run(
        [sys.executable, "-I", __file__, "cost.json", "timeout", f"{limit:g}", *command],
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


def measured(module: str, argument: float, ranks: int = 1) -> dict[str, Any]:
    """What `python -m module argument` prints last, as JSON, started by mpirun for several ranks.

    Raises CalledProcessError where the process fails.
    """
    from railhead.cli import launch

    root = str(Path(__file__).parents[1])
    single = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": root}
    launcher, environment = launch.under_mpirun(ranks, single)
    command = [*launcher, sys.executable, "-m", module, str(argument)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


@dataclass(frozen=True)
class Timed(Generic[T]):
    """Outcome of a job.

    value: return value of the job; None where it raised, crashed or took longer than its limit.
    seconds: duration of the job; 0 where it raised or crashed, the limit where it took longer.
    fault: reason why there is no value, in one line; else empty.
    """

    value: T | None
    seconds: float
    fault: str = ""


def attempts(
    work: Callable[..., T],
    jobs: Sequence[tuple[Any, ...]],
    limits: Sequence[float | None] | None = None,
) -> Iterator[Timed[T]]:
    """Call work(*job) for each job in other processes, side by side; yields the outcomes in the
    order of jobs, and says each on standard error. limits: longest duration of each job in s; None
    for no limit."""
    from railhead.sweeps import worker_pool

    limits = limits or [None] * len(jobs)
    with worker_pool.processes() as pool:
        futures = [
            pool.schedule(worker_pool.attempt, args=(_timed, work, *job), timeout=limit)
            for job, limit in zip(jobs, limits, strict=True)
        ]
        for number, (future, limit) in enumerate(zip(futures, limits, strict=True), 1):
            try:
                done = worker_pool.outcome(future)
                value, seconds = done.value or (None, 0.0)
                ended = Timed(value, seconds, done.fault)
            except LimitExceededError:
                ended = Timed(None, limit or 0.0, f"not back after {limit:g} s")
            print(f"{number} of {len(jobs)}: {ended.fault or 'done'}", file=sys.stderr)
            yield ended


def values(work: Callable[..., list[T]], jobs: Sequence[tuple[Any, ...]]) -> list[T]:
    """What work(*job) lists for all jobs, see `attempts`. RuntimeError: one has no value."""
    done = list(attempts(work, jobs))
    if faults := [each.fault for each in done if each.value is None]:
        raise RuntimeError(faults[0])
    return [found for each in done for found in each.value or []]


def _timed(work: Callable[..., T], *job: Any) -> tuple[T, float]:
    """Value of work(*job), and the seconds that it takes."""
    start = time.perf_counter()
    return work(*job), time.perf_counter() - start


def answer(measure: Callable[[float], dict[str, Any] | None]) -> None:
    """The other end of `measured`: print what `measure` returns for the argument of the command;
    nothing where it returns None."""
    if (found := measure(float(sys.argv[1]))) is not None:
        print(json.dumps(found))


def account(report: str, *command: str) -> None:
    """Run a command and write its Cost and its exit status into the JSON file `report`."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    cost = {
        "seconds": time.perf_counter() - start,
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "peak_bytes": 1024 * usage.ru_maxrss,
        "status": os.waitstatus_to_exitcode(status),
    }
    Path(report).write_text(json.dumps(cost), encoding="utf-8")


if __name__ == "__main__":
    account(*sys.argv[1:])
