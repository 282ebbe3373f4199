"""gmsh in a process of its own, as it may crash or hang where surfaces cut themselves; memory."""

import ctypes
import math
import multiprocessing
import resource
import signal
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

PR_SET_PDEATHSIG = 1  # Linux: a signal for when the parent is gone
M_PERTURB = -6  # glibc: what fills memory that is freed, and, inverted, memory that is allocated
_context = multiprocessing.get_context("fork")


class IsolatedProcessError(RuntimeError):
    """Raised where work in a child process gives no result; the text says in one line why: an
    exception, a crash or the time limit.
    """


def run(
    work: Callable[..., Any],
    *arguments: Any,
    seconds: float,
    meanwhile: Callable[[], object] = lambda: None,
) -> Any:
    """Call `work(*arguments)` in a forked child process and return its result.

    work: function whose result can be pickled.
    seconds: time limit of the child, measured after `meanwhile`.
    meanwhile: called in this process while the child runs, before the wait begins; its exceptions
        pass through.
    Raises IsolatedProcessError where `work` raises, crashes or takes longer than `seconds`. The
    child is ended in every case. (Not by pebble, whose thread prints a traceback where a signal
    ends child and parent together.)
    """
    mine, its = _context.Pipe()
    process = _context.Process(target=_serve, args=(its, work, arguments), daemon=True)
    process.start()
    its.close()
    try:
        meanwhile()
        if not mine.poll(seconds):
            raise IsolatedProcessError(f"not done after {seconds:.0f} s")
        found, problem = mine.recv()
    except EOFError:
        process.join()
        raise IsolatedProcessError(f"it crashed (signal {-(process.exitcode or 0)})") from None
    finally:
        process.kill()
        process.join()
    if problem:
        raise IsolatedProcessError(problem)
    return found


def address_space() -> float:
    """Bytes that this process may still map within its limit of address space (ulimit -v); inf
    without a limit. Near that limit libraries crash or hang.
    """
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    return math.inf if limit == resource.RLIM_INFINITY else limit - mapped


def die_with_parent() -> None:
    """Let Linux kill this process (SIGKILL) when the thread that started it has ended."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def zero_new_memory() -> None:
    """Let memory that this process allocates from now on hold zeros, as fresh pages do.

    gmsh's optimiser of tetrahedra (HXT) reads memory that it has not written to. Without zeros its
    mesh depends on what that memory held before. Nothing is done where the C library has no
    `mallopt`.
    """
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        libc.mallopt(M_PERTURB, 0xFF)


def _serve(connection: Connection, work: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    """Body of the child process: call `work(*arguments)` and send (result, '') or, after an
    exception, (None, its text in one line).

    connection: end of the pipe to the parent process. SIGTERM and SIGINT get their default action,
    new memory holds zeros, and the process dies with its parent.
    """
    die_with_parent()
    zero_new_memory()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, signal.SIG_DFL)
    try:
        connection.send((work(*arguments), ""))
    except Exception as error:  # gmsh raises bare Exception
        connection.send((None, " ".join(str(error).split()) or type(error).__name__))
