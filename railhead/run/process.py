"""Settings of the process that a command runs in: signals, streams, threads, memory."""

import atexit
import ctypes
import gc
import io
import os
import signal
import sys
from contextlib import suppress
from typing import Any

MPI_VARIABLES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK")  # set by launchers of MPI
RANK_VARIABLES = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK")  # hold the rank of a process


def end_at_once() -> None:
    """Let SIGINT (Ctrl-C) end this process at once, as SIGTERM does: by the system's default.
    Python's own handler would wait until a call into a library returns, which can be minutes.
    Where SIGINT is ignored (a job in the background), it stays ignored."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def prepare() -> None:
    """Set up a process that only runs a command, before numpy and MPI are loaded: streams that can
    be written to, environment variables, and freed memory kept for the next arrays. Characters that
    a stream does not know are escaped, and what standard error does not take is left out. There is
    one BLAS thread, unless OMP_NUM_THREADS is set. Under MPI the process is killed when its
    launcher ends.
    """
    for name in ("stdout", "stderr"):
        stream, own = getattr(sys, name), getattr(sys, f"__{name}__")
        if stream is None:  # closed by who started it: libraries write to it
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        elif stream is own and name == "stdout":
            stream.reconfigure(errors="backslashreplace")
        elif stream is own:
            raw = io.BufferedWriter(_Errors(2, "w", closefd=False))
            sys.stderr = io.TextIOWrapper(raw, stream.encoding, "backslashreplace", None, True)
    # Small dense blocks only: more BLAS threads cost more than they bring. Before numpy loads.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    # Alone (not under mpirun) Open MPI would start a daemon first, for processes that join later.
    os.environ.setdefault("OMPI_MCA_ess_singleton_isolated", "1")
    if under_mpi():
        # Launchers of MPI give the first process a terminal of its own, whatever they write to.
        os.environ.setdefault("TTY_COMPATIBLE", "0")
    libc = ctypes.CDLL(None)
    if under_mpi() and hasattr(libc, "prctl"):
        # Ranks of Open MPI 5 live on where mpirun is killed; Linux ends them (PR_SET_PDEATHSIG).
        libc.prctl(1, signal.SIGKILL)
    # What is alive at the end dies with the process: no search for cycles among it.
    atexit.register(gc.freeze)
    # Keep freed memory instead of returning it to the system for every temporary array: a fifth of
    # the time of a run otherwise goes into fresh pages (mallopt(3): M_TRIM_THRESHOLD,
    # M_MMAP_THRESHOLD).
    if hasattr(libc, "mallopt"):
        libc.mallopt(-1, 2**31 - 1)
        libc.mallopt(-3, 2**30)


class _Errors(io.FileIO):
    """Standard error that leaves out what cannot be written, as on a full disk."""

    def write(self, content: Any, /) -> int:
        """Write bytes; returns their number."""
        with suppress(OSError):
            super().write(content)
        return len(content)


def under_mpi() -> bool:
    """Whether a launcher of MPI (mpirun) started this process."""
    return any(name in os.environ for name in MPI_VARIABLES)


def rank() -> int:
    """MPI rank of this process from the environment, without loading MPI; 0 without mpirun."""
    return next((int(os.environ[name]) for name in RANK_VARIABLES if name in os.environ), 0)


def take_arguments() -> list[str]:
    """Arguments of the command, removed from sys.argv, because PETSc and dolfinx would read them,
    too, and fail at text that is not UTF-8.
    """
    words = sys.argv[1:]
    del sys.argv[1:]
    return words


def release_memory() -> None:
    """Return freed memory to the operating system."""
    libc = ctypes.CDLL(None)
    if hasattr(libc, "malloc_trim"):
        libc.malloc_trim(0)
