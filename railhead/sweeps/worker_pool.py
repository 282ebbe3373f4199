"""Jobs side by side: one process for each core, each with one thread.

A job that hangs, raises or crashes ends alone. Under mpirun all ranks but the first do the jobs, on
as many machines as mpirun uses.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as LimitExceededError
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.context import SpawnContext, SpawnProcess
from types import ModuleType
from typing import Any, Generic, TypeVar

from pebble import ProcessExpired, ProcessPool

from railhead.meshing.isolated_process import die_with_parent
from railhead.run.process import prepare

T = TypeVar("T")
JOBS_PER_PROCESS = 8  # jobs of a process before it ends and its memory is freed


@dataclass(frozen=True)
class Attempt(Generic[T]):
    """Outcome of a job.

    value: return value of the job; None where it raised, crashed or took longer than its limit.
    seconds: duration of the job; 0 where its process crashed, the limit where it took longer.
    fault: reason why there is no value, in one line; else empty.
    """

    value: T | None
    seconds: float
    fault: str = ""


Submit = Callable[..., "Future[Attempt[Any]]"]
"""Starts work(*arguments) in another process, called with `work` and its arguments."""


def attempts(
    work: Callable[..., T],
    jobs: Sequence[tuple[Any, ...]],
    limits: Sequence[float | None] | None = None,
) -> Iterator[Attempt[T]]:
    """Call work(*job) for each job in other processes, side by side; yields the outcomes in the
    order of jobs.

    limits: longest duration of each job in s; None for no limit. `work`, its arguments and its
        return value are pickled.
    """
    limits = limits or [None] * len(jobs)
    with _processes() as pool:
        futures = [
            pool.schedule(_attempt, args=(work, *job), timeout=limit)
            for job, limit in zip(jobs, limits, strict=True)
        ]
        yield from map(outcome, futures, limits)


@contextmanager
def submitting(ranks: int) -> Iterator[Submit | None]:
    """A function submit(work, *arguments) that starts a job and returns the future of its Attempt.

    ranks: number of MPI ranks. With several ranks, call this on all of them: ranks that do the jobs
        get None, after the last job.
    """
    if ranks > 1:
        from mpi4py.futures import MPICommExecutor

        with MPICommExecutor() as executor:
            yield executor and (lambda *job: executor.submit(_attempt, *job))
        return
    with _processes() as pool:
        yield lambda *job: pool.schedule(_attempt, args=job)


def workers(ranks: int) -> int:
    """Number of jobs that run at the same time. ranks: number of MPI ranks; with one, the cores of
    this machine.
    """
    return ranks - 1 if ranks > 1 else os.cpu_count() or 1


def outcome(future: Future[Attempt[T]], limit: float | None = None) -> Attempt[T]:
    """Wait for a submitted job and return its outcome. limit: longest duration of the job in s, or
    None.
    """
    try:
        return future.result()
    except LimitExceededError:
        return Attempt(None, limit or 0.0, f"not back after {limit:g} s")
    except ProcessExpired:
        return Attempt(None, 0.0, "the process crashed")


@contextmanager
def _processes() -> Iterator[ProcessPool]:
    """Pool of processes, one for each core; stopped at the end of the block."""
    with ProcessPool(
        os.cpu_count() or 1, max_tasks=JOBS_PER_PROCESS, initializer=_single, context=_Context()
    ) as pool:
        try:
            yield pool
        finally:
            pool.stop()


class _Process(SpawnProcess):
    """A new process that does not import the script that runs here, which would start it again."""

    def start(self) -> None:
        """Start the process, which imports no more than the modules of its jobs."""
        script = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            super().start()
        finally:
            sys.modules["__main__"] = script


class _Context(SpawnContext):
    """Context of `multiprocessing` with such processes."""

    Process = _Process


def _single() -> None:
    """Set up a new process before numpy and MPI are loaded: one thread, no MPI rank, terminated
    with its parent.
    """
    die_with_parent()
    for name in [name for name in os.environ if name.startswith(("OMPI_", "PMIX_"))]:
        del os.environ[name]
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    prepare()


def _attempt(work: Callable[..., T], *job: Any) -> Attempt[T]:
    """Outcome of work(*job) in this process; an exception becomes its text."""
    start = time.perf_counter()
    try:
        return Attempt(work(*job), time.perf_counter() - start)
    except Exception as error:
        line = " ".join(f"{type(error).__name__}: {error}".split())
        return Attempt(None, time.perf_counter() - start, line)
