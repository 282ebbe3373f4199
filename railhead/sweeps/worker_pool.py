"""Jobs side by side, one process a core, each with one thread: a job that hangs, raises or crashes
ends alone. Under mpirun the ranks but the first work, on as many machines as it uses."""

from __future__ import annotations

import multiprocessing
import os
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as LateError
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from pebble import ProcessExpired, ProcessPool

from railhead.meshing.apart import die_with_parent
from railhead.run.process import prepare

T = TypeVar("T")
JOBS_PER_PROCESS = 8  # memory that libraries keep is given back with the process


@dataclass(frozen=True)
class Attempt(Generic[T]):
    """What a job returned.

    value: None where it did not end as it should.
    seconds: of the job, 0 where its process crashed.
    fault: why there is no value, in one line, else empty.
    """

    value: T | None
    seconds: float
    fault: str = ""


Submit = Callable[..., "Future[Attempt[Any]]"]


def attempts(
    work: Callable[..., T],
    jobs: Sequence[tuple[Any, ...]],
    limits: Sequence[float | None] | None = None,
) -> Iterator[Attempt[T]]:
    """work(*job) for each job, in their order, each within its limit (s; None: without).

    `work`, its arguments and its value are pickled.
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
    """A function of work and its arguments that returns the future of their Attempt. With several
    ranks, to be called on all of them, it is None on those that work."""
    if ranks > 1:
        from mpi4py.futures import MPICommExecutor

        with MPICommExecutor() as executor:
            yield executor and (lambda *job: executor.submit(_attempt, *job))
        return
    with _processes() as pool:
        yield lambda *job: pool.schedule(_attempt, args=job)


def workers(ranks: int) -> int:
    """How many jobs of `submitting` run side by side."""
    return ranks - 1 if ranks > 1 else os.cpu_count() or 1


def outcome(future: Future[Attempt[T]], limit: float | None = None) -> Attempt[T]:
    """Of a future, when it is done; limit: that it was given, s."""
    try:
        return future.result()
    except LateError:
        return Attempt(None, limit or 0.0, f"not back after {limit:g} s")
    except ProcessExpired:
        return Attempt(None, 0.0, "the process crashed")


@contextmanager
def _processes() -> Iterator[ProcessPool]:
    context = multiprocessing.get_context("spawn")
    with ProcessPool(
        os.cpu_count() or 1, max_tasks=JOBS_PER_PROCESS, initializer=_single, context=context
    ) as pool:
        try:
            yield pool
        finally:
            pool.stop()


def _single() -> None:
    """One thread in this process, which ends with its parent and is no rank; neither numpy nor MPI
    is loaded yet."""
    die_with_parent()
    for name in [name for name in os.environ if name.startswith(("OMPI_", "PMIX_"))]:
        del os.environ[name]
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    prepare()


def _attempt(work: Callable[..., T], *job: Any) -> Attempt[T]:
    start = time.perf_counter()
    try:
        return Attempt(work(*job), time.perf_counter() - start)
    except Exception as error:
        line = " ".join(f"{type(error).__name__}: {error}".split())
        return Attempt(None, time.perf_counter() - start, line)
