"""Jobs side by side: one process for each core, each with one thread.

A job that raises or crashes ends alone. Under mpirun all ranks but the first do the jobs, on
as many machines as mpirun uses.
"""

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.context import SpawnContext, SpawnProcess
from types import ModuleType
from typing import Any, Generic, TypeVar

from pebble import ProcessExpired, ProcessPool

from railhead.meshing.isolated_process import die_with_parent
from railhead.run.process import prepare
from railhead.scene.scene import SceneError

T = TypeVar("T")
CRASHED = "the process crashed"
JOBS_PER_PROCESS = 8  # jobs of a process before it ends and its memory is freed


@dataclass(frozen=True)
class Attempt(Generic[T]):
    """Outcome of a job.

    value: return value of the job; None where it raised or crashed.
    fault: reason why there is no value, in one line; else empty.
    """

    value: T | None
    fault: str = ""


Job = Future[Attempt[Any]]
Submit = Callable[..., Job]
"""Starts work(*arguments) in another process, called with `work` and its arguments."""


def on_first(comm: Any, work: Callable[[Submit], T], jobs: int = JOBS_PER_PROCESS) -> T | None:
    """The value of work(submit) on the first MPI rank of a communicator, None on the others, which
    do the jobs that it submits. What it raises of SceneError and OSError is raised on all
    (collective). jobs: as of `processes`.
    """
    value, problem = None, None
    with submitting(comm.size, jobs) as submit:
        try:
            value = None if submit is None else work(submit)
        except (SceneError, OSError) as error:
            problem = error
    if (problem := comm.bcast(problem)) is not None:
        raise problem
    return value


@contextmanager
def submitting(ranks: int, jobs: int = JOBS_PER_PROCESS) -> Iterator[Submit | None]:
    """A function submit(work, *arguments) that starts a job and returns the future of its Attempt.

    ranks: number of MPI ranks. With several ranks, call this on all of them: ranks that do the jobs
        get None, after the last job. jobs: as of `processes`.
    """
    if ranks > 1:
        from mpi4py.futures import MPICommExecutor

        import_module("railhead.solver")  # PETSc starts on all ranks at once, or waits for ever
        with MPICommExecutor() as executor:
            yield executor and (lambda *job: executor.submit(attempt, *job))
        return
    with processes(jobs) as pool:
        yield lambda *job: pool.schedule(attempt, args=job)


def workers(ranks: int) -> int:
    """Number of jobs that run at the same time. ranks: number of MPI ranks; with one, the cores of
    this machine.
    """
    return ranks - 1 if ranks > 1 else os.cpu_count() or 1


def outcome(future: Future[Attempt[T]]) -> Attempt[T]:
    """Wait for a submitted job and return its outcome."""
    try:
        return future.result()
    except (ProcessExpired, BrokenExecutor):  # the last one: several have crashed
        return Attempt(None, CRASHED)


def together(
    submit: Submit | None, work: Callable[..., T], jobs: Iterable[tuple[Any, ...]]
) -> Iterator[T]:
    """Values of work(*job) for each job, in their order, each when it is there; all jobs are solved
    side by side. submit: starts a job; None: one after the other in this process. One whose process
    crashes is tried once more. Raises ValueError with the reason of one that fails.
    """
    if submit is None:
        yield from (work(*job) for job in jobs)
        return
    for job, future in [(job, submit(work, *job)) for job in jobs]:
        found = outcome(future)
        if found.fault == CRASHED:
            found = outcome(submit(work, *job))
        if found.value is None:
            raise ValueError(found.fault)
        yield found.value


@contextmanager
def processes(jobs: int = JOBS_PER_PROCESS, count: int = 0) -> Iterator[ProcessPool]:
    """Pool of processes, stopped at the end of the block. jobs: of a process before it ends; 0: no
    limit. count: of processes; 0: one for each core.
    """
    # Where a signal ends this process, a process of multiprocessing warns of what it tidies up.
    os.environ.setdefault("PYTHONWARNINGS", "ignore:resource_tracker")
    with ProcessPool(
        count or os.cpu_count() or 1, max_tasks=jobs, initializer=_single, context=_Context()
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
    """Context of `multiprocessing` whose processes are `_Process`."""

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


def attempt(work: Callable[..., T], *job: Any) -> Attempt[T]:
    """Outcome of work(*job) in this process; an exception becomes its text."""
    try:
        return Attempt(work(*job))
    except Exception as error:
        return Attempt(None, " ".join(f"{type(error).__name__}: {error}".split()))
