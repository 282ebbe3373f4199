"""The process of the command: how it is set up, and how signals end it.

SIGTERM and SIGINT end it cleanly where Python runs, and soon where it does not.

Python's handlers wait until a call into a library returns, which can be minutes, and no thread runs
where the library keeps the interpreter's lock (PETSc). A process beside it is told of every signal
at once, kills where that takes too long, and removes what was begun.
"""

from __future__ import annotations

import atexit
import ctypes
import gc
import os
import select
import shutil
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

SIGNALS = (signal.SIGINT, signal.SIGTERM)  # in the order in which they are heard
PATIENCE = 2.0  # seconds until the process is killed
BEGUN, ENDED = b"\xfe", b"\xff"  # of a folder, whose path follows; other bytes are signals
INSIDE = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK")  # what launchers of MPI leave behind
RANKS = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK")  # in the environment under mpirun
SHOW_CURSOR = b"\x1b[?25h"
_undo: list[Callable[[], None]] = []
_deferred: list[int] | None = None  # signals that were heard in a block of `deferring`
_tell: int | None = None  # the end of the pipe to the process beside this one


def prepare() -> None:
    """Set up a process that does nothing else than what the command does."""
    for name in ("stdout", "stderr"):  # closed by who started it: libraries write to them
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    # Small dense blocks only: more BLAS threads cost more than they bring. Before numpy loads.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    # Alone (not under mpirun) Open MPI would start a daemon first, for processes that join later.
    os.environ.setdefault("OMPI_MCA_ess_singleton_isolated", "1")
    if started():
        # Launchers of MPI give the first process a terminal of its own, whatever they write to.
        os.environ.setdefault("TTY_COMPATIBLE", "0")
    # What is alive at the end dies with the process: no search for cycles among it.
    atexit.register(gc.freeze)
    # Keep freed memory instead of returning it to the system for every temporary array: a fifth of
    # the time of a run otherwise goes into fresh pages (mallopt(3): M_TRIM_THRESHOLD,
    # M_MMAP_THRESHOLD).
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        libc.mallopt(-1, 2**31 - 1)
        libc.mallopt(-3, 2**30)


def started() -> bool:
    """Whether a launcher of MPI started this process."""
    return any(name in os.environ for name in INSIDE)


def rank() -> int:
    """Of this process among those that a launcher of MPI started, before MPI is loaded."""
    return next((int(os.environ[name]) for name in RANKS if name in os.environ), 0)


def arguments() -> list[str]:
    """Of the command. They are taken away: dolfinx would read them too, and fails at what is no
    UTF-8."""
    given = sys.argv[1:]
    del sys.argv[1:]
    return given


def trim() -> None:
    """Give memory that is free back to the system, where other processes look for it."""
    libc = ctypes.CDLL(None)
    if hasattr(libc, "malloc_trim"):
        libc.malloc_trim(0)


@contextmanager
def undoing(action: Callable[[], None]) -> Iterator[None]:
    """A signal inside the block raises SystemExit, or calls `action` and ends the process."""
    _undo.append(action)
    try:
        yield
    finally:
        _undo.remove(action)


@contextmanager
def deferring() -> Iterator[None]:
    """A signal inside the block is obeyed when it ends."""
    global _deferred
    heard = _deferred = []
    try:
        yield
    finally:
        _deferred = None
    if heard:
        _handle(heard[0], None)


@contextmanager
def unfinished(folder: Path) -> Iterator[None]:
    """The folder is removed if the process dies inside the block, however it does."""
    _say(BEGUN, folder)
    try:
        yield
    finally:
        _say(ENDED, folder)


def _say(what: bytes, folder: Path) -> None:
    if _tell is not None:
        os.write(_tell, what + os.fsencode(folder) + b"\0")


@contextmanager
def prompt() -> Iterator[None]:
    """Exit with 128 + number on SIGTERM and SIGINT, at once where there is nothing to undo; be
    killed after PATIENCE where a library does not return."""
    global _tell
    outer = signal.getsignal(signal.SIGTERM) is _handle
    if outer or threading.current_thread() is not threading.main_thread():
        yield
        return
    # Before the fork: it takes milliseconds, in which a signal would end Python as it ends any.
    heard = [number for number in SIGNALS if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, _handle) for number in heard}
    told, tell = os.pipe()
    child = os.fork()
    if not child:
        os.close(tell)
        _watch(told, os.getppid())
    os.close(told)
    os.set_blocking(tell, False)
    fd = signal.set_wakeup_fd(tell, warn_on_full_buffer=False)
    _tell = tell
    try:
        yield
    finally:
        _tell = None
        signal.set_wakeup_fd(fd)
        for number, handler in before.items():
            signal.signal(number, handler)
        os.close(tell)
        os.waitpid(child, 0)


def _handle(number: int, _: object) -> None:
    if _deferred is not None:
        _deferred.append(number)
        return
    if not _undo:
        os._exit(128 + number)
    raise SystemExit(128 + number)


def _watch(told: int, parent: int) -> None:
    """Until the parent is gone: kill it where it does not end after a signal, then remove what it
    left unfinished. Never returns."""
    try:
        os.setsid()
        for number in SIGNALS:
            signal.signal(number, signal.SIG_IGN)
        signal.set_wakeup_fd(-1)
        begun: set[str] = set()
        rest, late = b"", float("inf")
        while True:
            wait = None if late == float("inf") else max(late - time.monotonic(), 0.0)
            if not select.select([told], [], [], wait)[0]:
                os.kill(parent, signal.SIGKILL)
                if sys.stderr is not None and os.isatty(2):
                    os.write(2, SHOW_CURSOR)
                late = float("inf")
                continue
            if not (read := os.read(told, 4096)):
                break
            rest += read
            while rest:
                if rest[:1] not in (BEGUN, ENDED):
                    if rest[0] in SIGNALS:
                        late = min(late, time.monotonic() + PATIENCE)
                    rest = rest[1:]
                elif b"\0" in rest:
                    said, rest = rest.split(b"\0", 1)
                    change = begun.add if said[:1] == BEGUN else begun.discard
                    change(os.fsdecode(said[1:]))
                else:
                    break
        for folder in begun:
            shutil.rmtree(folder, ignore_errors=True)
    finally:
        os._exit(0)
