"""The process of the command: how it is set up, and how signals end it.

SIGTERM and SIGINT end it cleanly where Python runs, and soon where it does not.

Python's handlers wait until a call into a library returns, which can be long.
A thread is told of every signal at once, and ends the process where that takes too long.
"""

from __future__ import annotations

import ctypes
import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

SIGNALS = (signal.SIGTERM, signal.SIGINT)
PATIENCE = 2.0  # seconds until the thread takes over
_undo: list[Callable[[], None]] = []


def prepare() -> None:
    """Set up a process that does nothing else than what the command does."""
    # Small dense blocks only: more BLAS threads cost more than they bring. Before numpy loads.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    # PETSc's signal handlers would take the place of the command's own (see cli.main).
    options = os.environ.get("PETSC_OPTIONS", "")
    if "-no_signal_handler" not in options:
        os.environ["PETSC_OPTIONS"] = f"{options} -no_signal_handler"
    # Keep freed memory instead of returning it to the system for every temporary array: a fifth of
    # the time of a run otherwise goes into fresh pages (mallopt(3): M_TRIM_THRESHOLD,
    # M_MMAP_THRESHOLD).
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        libc.mallopt(-1, 2**31 - 1)
        libc.mallopt(-3, 2**30)


@contextmanager
def undoing(action: Callable[[], None]) -> Iterator[None]:
    """A signal inside the block raises SystemExit, or calls `action` and ends the process."""
    _undo.append(action)
    try:
        yield
    finally:
        _undo.remove(action)


@contextmanager
def prompt() -> Iterator[None]:
    """Exit with 128 + number on SIGTERM and SIGINT, at once where there is nothing to undo."""
    outer = signal.getsignal(signal.SIGTERM) is _handle
    if outer or threading.current_thread() is not threading.main_thread():
        yield
        return
    heard = [number for number in SIGNALS if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, _handle) for number in heard}
    told, tell = os.pipe()
    os.set_blocking(tell, False)
    fd = signal.set_wakeup_fd(tell, warn_on_full_buffer=False)
    over = threading.Event()
    threading.Thread(target=_watch, args=(told, over), daemon=True).start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(fd)
        for number, handler in before.items():
            signal.signal(number, handler)
        over.set()
        os.close(tell)


def _handle(number: int, _: object) -> None:
    if not _undo:
        os._exit(128 + number)
    raise SystemExit(128 + number)


def _watch(told: int, over: threading.Event) -> None:
    """Wait for one of the signals, or the end of the pipe."""
    while read := os.read(told, 1):
        number = read[0]
        if number in SIGNALS and not over.wait(PATIENCE):
            for action in reversed(_undo):
                action()
            os._exit(128 + number)
    os.close(told)
