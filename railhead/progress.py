"""What a run says while it works: a line on a terminal, plain lines elsewhere, or nothing."""

from __future__ import annotations

import time
from contextlib import ExitStack
from types import TracebackType
from typing import Self

from rich.console import Console

from railhead import process


class Progress:
    """Stage and Newton step on standard error. Use as a context manager. since: when what it tells
    of began (time.perf_counter), now unless given."""

    def __init__(self, *, quiet: bool, since: float | None = None) -> None:
        self._console = Console(stderr=True, quiet=quiet, highlight=False)
        self._live = self._console.is_terminal and not quiet
        self._status = self._console.status("")
        self._stage = ""
        self._start = time.perf_counter() if since is None else since
        self._running = ExitStack()

    def __enter__(self) -> Self:
        if self._live:
            self._status.start()
        self._running.enter_context(process.undoing(self._status.stop))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._running.close()
        self._status.stop()

    def _say(self, text: str) -> None:
        elapsed = time.perf_counter() - self._start
        if self._live:
            self._status.update(f"{text}  ({elapsed:.1f} s)")
        else:
            self._console.print(f"[{elapsed:6.1f} s] {text}", markup=False)

    def stage(self, name: str) -> None:
        """A new stage begins."""
        self._stage = name
        self._say(name)

    def newton(self, step: int, residual: float) -> None:
        """A Newton step is done."""
        self._say(f"{self._stage}: Newton step {step}, residual {residual:.1e}")
