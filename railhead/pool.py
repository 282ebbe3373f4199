"""Jobs side by side, one process a core, each with one thread: a job that hangs, raises or crashes
ends alone. Under mpirun the ranks but the first work, on as many machines as it uses."""

from __future__ import annotations

import multiprocessing
import os
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as LateError
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from pebble import ProcessExpired, ProcessPool

from railhead.meshing.apart import die_with_parent
from railhead.process import prepare

T = TypeVar("T")
JOBS_PER_PROCESS = 8  # memory that libraries keep is given back with the process


@dataclass(frozen=True)
class Attempt(Generic[T]):
    """What a job gave and its seconds (0 where its process crashed); fault: why it gave nothing, in
    one line, else empty; trace: of the exception that it raised, if it did."""

    found: T | None
    seconds: float
    fault: str = ""
    trace: str = ""


Submit = Callable[..., "Future[Attempt[Any]]"]


def attempts(
    work: Callable[..., T],
    jobs: Sequence[tuple[Any, ...]],
    limits: Sequence[float | None] | None = None,
    processes: int | None = None,
) -> Iterator[Attempt[T]]:
    """work(*job) for each job, in their order, each within its limit (s; None: without).

    `work` and what it takes and gives are pickled.
    """
    with _processes(processes) as pool:
        all_limits = limits or [None] * len(jobs)
        futures = [
            pool.schedule(_attempt, args=(work, job), timeout=limit)
            for job, limit in zip(jobs, all_limits, strict=True)
        ]
        try:
            for future, limit in zip(futures, all_limits, strict=True):
                yield _result(future, limit)
        finally:
            pool.stop()


@contextmanager
def submitting(ranks: int) -> Iterator[Submit | None]:
    """Takes work and its arguments and gives the future of its Attempt. With several ranks, to be
    called on all of them, it is None on those that work."""
    if ranks > 1:
        from mpi4py.futures import MPICommExecutor

        with MPICommExecutor() as executor:
            if executor is None:
                yield None
            else:
                yield lambda work, *job: executor.submit(_attempt, work, job)
        return
    with _processes() as pool:
        try:
            yield lambda work, *job: pool.schedule(_attempt, args=(work, job))
        finally:
            pool.stop()


def workers(ranks: int) -> int:
    """How many jobs of `submitting` run side by side."""
    return ranks - 1 if ranks > 1 else os.cpu_count() or 1


def outcome(future: Future[Attempt[T]]) -> Attempt[T]:
    """Of a future that is done."""
    return _result(future, None)


def _processes(count: int | None = None) -> ProcessPool:
    return ProcessPool(
        count or os.cpu_count() or 1,
        max_tasks=JOBS_PER_PROCESS,
        initializer=_single,
        context=multiprocessing.get_context("spawn"),
    )


def _single() -> None:
    """One thread in this process, which ends with its parent and is no rank; neither numpy nor MPI
    is loaded yet."""
    die_with_parent()
    for name in [name for name in os.environ if name.startswith(("OMPI_", "PMIX_"))]:
        del os.environ[name]
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    prepare()


def _attempt(work: Callable[..., T], job: tuple[Any, ...]) -> Attempt[T]:
    start = time.perf_counter()
    try:
        return Attempt(work(*job), time.perf_counter() - start)
    except Exception as error:
        line = " ".join(f"{type(error).__name__}: {error}".split())
        return Attempt(None, time.perf_counter() - start, line, traceback.format_exc())


def _result(future: Future[Attempt[T]], limit: float | None) -> Attempt[T]:
    try:
        return future.result()
    except LateError:
        return Attempt(None, limit or 0.0, f"not back after {limit:g} s")
    except ProcessExpired:
        return Attempt(None, 0.0, "the process crashed")
