"""Jobs of a study side by side, one process a core, each with one thread: a job that hangs, raises
or crashes ends alone."""

from __future__ import annotations

import multiprocessing
import os
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import TimeoutError as LateError
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from pebble import ProcessExpired, ProcessFuture, ProcessPool

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


def attempts(
    work: Callable[..., T],
    jobs: Sequence[tuple[Any, ...]],
    limits: Sequence[float | None] | None = None,
    processes: int | None = None,
) -> Iterator[Attempt[T]]:
    """work(*job) for each job, in their order, each within its limit (s; None: without).

    `work` and what it takes and gives are pickled.
    """
    with ProcessPool(
        processes or os.cpu_count() or 1,
        max_tasks=JOBS_PER_PROCESS,
        initializer=_single,
        context=multiprocessing.get_context("spawn"),
    ) as pool:
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


def _single() -> None:
    """One thread in this process, which ends with its parent; numpy is not loaded yet."""
    die_with_parent()
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    prepare()


def _attempt(work: Callable[..., T], job: tuple[Any, ...]) -> Attempt[T]:
    start = time.perf_counter()
    try:
        return Attempt(work(*job), time.perf_counter() - start)
    except Exception as error:
        line = " ".join(f"{type(error).__name__}: {error}".split())
        return Attempt(None, time.perf_counter() - start, line, traceback.format_exc())


def _result(future: ProcessFuture, limit: float | None) -> Attempt[T]:
    try:
        found: Attempt[T] = future.result()
    except LateError:
        return Attempt(None, limit or 0.0, f"not back after {limit:g} s")
    except ProcessExpired:
        return Attempt(None, 0.0, "the process crashed")
    return found
