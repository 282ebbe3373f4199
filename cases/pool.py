"""Jobs of a study side by side, one process a core, each with one thread: a job that hangs, raises
or crashes ends alone."""

from __future__ import annotations

import multiprocessing
import os
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from multiprocessing.connection import Connection
from threading import local
from typing import Any, Generic, TypeVar

T = TypeVar("T")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
JOBS_PER_PROCESS = 8  # memory that libraries keep is given back with the process
_context = multiprocessing.get_context("spawn")


@dataclass(frozen=True)
class Attempt(Generic[T]):
    """What a job gave and its seconds; fault: why it gave nothing, in one line, else empty;
    trace: of the exception that it raised, if it did."""

    found: T | None
    seconds: float
    fault: str = ""
    trace: str = ""


def _serve(connection: Connection, work: Callable[..., Any]) -> None:
    for _ in range(JOBS_PER_PROCESS):
        try:
            job = connection.recv()
        except EOFError:
            return  # the study has ended
        try:
            connection.send((work(*job), "", ""))
        except Exception as error:
            line = " ".join(f"{type(error).__name__}: {error}".split())
            connection.send((None, line, traceback.format_exc()))


class _Worker:
    """A process that does one job after the other and is replaced when it is lost or worn."""

    def __init__(self, work: Callable[..., Any]) -> None:
        self._work, self._left = work, 0
        self._process: multiprocessing.process.BaseProcess | None = None
        self._ends: Connection

    def stop(self) -> None:
        """End the process."""
        self._left = 0
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None

    def run(self, job: tuple[Any, ...], limit: float | None) -> Attempt[Any]:
        """Do a job within its time limit (s)."""
        if not self._left:
            self.stop()
            self._ends, theirs = _context.Pipe()
            self._process = _context.Process(target=_serve, args=(theirs, self._work), daemon=True)
            self._process.start()
            theirs.close()
            self._left = JOBS_PER_PROCESS
        self._left -= 1
        start = time.perf_counter()
        try:
            self._ends.send(job)
            if self._ends.poll(limit):
                found, fault, trace = self._ends.recv()
            else:
                self.stop()
                found, fault, trace = None, f"not back after {limit:g} s", ""
        except (EOFError, BrokenPipeError, ConnectionResetError):
            self.stop()
            found, fault, trace = None, "the process crashed", ""
        return Attempt(found, time.perf_counter() - start, fault, trace)


def attempts(
    work: Callable[..., T],
    jobs: Sequence[tuple[Any, ...]],
    limits: Sequence[float | None] | None = None,
    processes: int | None = None,
) -> Iterator[Attempt[T]]:
    """work(*job) for each job, in their order, each within its limit (s; None: without).

    `work` and what it takes and gives are pickled.
    """
    mine, workers = local(), []
    kept = {key: os.environ.get(key) for key in ONE_THREAD}

    def do(job: tuple[Any, ...], limit: float | None) -> Attempt[T]:
        if not hasattr(mine, "worker"):
            mine.worker = _Worker(work)
            workers.append(mine.worker)
        attempt: Attempt[T] = mine.worker.run(job, limit)
        return attempt

    os.environ.update(ONE_THREAD)
    try:
        with ThreadPoolExecutor(processes or os.cpu_count() or 1) as pool:
            yield from pool.map(do, jobs, limits or [None] * len(jobs))
    finally:
        for worker in workers:
            worker.stop()
        for key, value in kept.items():
            if value is None:
                os.environ.pop(key, None)
            else:
                os.environ[key] = value
