"""Safe use of the disk cache of compiled forms.

ffcx takes the C file NAME.c for a lock, which NAME.c.cached releases, and gives up after ten
seconds. A process that is killed while it compiles leaves that lock. The lock of this module is
released by the system whatever ends a process. So the process that holds it knows that no other one
of this program compiles, and removes C files that were left.
"""

from __future__ import annotations

import fcntl
import logging
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from mpi4py import MPI

LOCK = "railhead.lock"


@contextmanager
def alone(comm: MPI.Comm, folder: Path) -> Iterator[None]:
    """Context in which no other process of this program compiles into a cache folder; other
    processes wait. C files that killed processes left unfinished there are removed.

    comm: ranks that compile together; only rank 0 takes the lock. folder: cache folder.
    An error on rank 0 is raised on all ranks. A folder that cannot be written to is left as it is.
    dolfinx 0.5 and setuptools log each form at INFO; such messages are suppressed in the context.
    """
    disabled = logging.root.manager.disable
    with ExitStack() as held:
        held.callback(logging.disable, disabled)
        logging.disable(max(disabled, logging.INFO))
        refused: OSError | None = None
        if comm.rank == 0:
            try:
                held.enter_context(_locked(folder))
                _remove_unfinished(folder)
            except OSError as error:
                refused = error
        problem: Exception | None = None
        try:
            yield
        except Exception as error:
            problem = error
        # Of several ranks dolfinx tells a RuntimeError only.
        cause = problem if isinstance(problem, OSError) else problem and refused
        if problem := comm.bcast(cause) or problem:
            raise problem


def _remove_unfinished(folder: Path) -> None:
    """Remove the C files of ffcx in a folder whose compilation did not end: those without a file
    NAME.c.cached beside them.
    """
    for source in folder.glob("libffcx_*.c"):
        if not source.with_suffix(".c.cached").exists():
            source.unlink(missing_ok=True)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Context that holds the lock file of a folder, which is made if it is missing; waits until no
    other process holds it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / LOCK, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
