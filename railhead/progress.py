"""What a run says while it works: a line on a terminal, plain lines elsewhere, or nothing."""

from __future__ import annotations

import time
from contextlib import ExitStack
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn
from rich.progress import Progress as Bars

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


class Bar:
    """How many of `total` jobs are done and how long the others will take: a bar on a terminal,
    plain lines elsewhere, on standard error. Use as a context manager. done: before it began."""

    def __init__(self, total: int, *, done: int = 0, quiet: bool = False) -> None:
        console = Console(stderr=True, quiet=quiet, highlight=False)
        self._console, self._live = console, console.is_terminal and not quiet
        columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"))
        self._bars = Bars(*columns, console=console, disable=not self._live)
        self._task = self._bars.add_task("", total=total, completed=done)
        self._total, self._before, self._done = total, done, done
        self._start = time.perf_counter()
        self._running = ExitStack()

    def __enter__(self) -> Self:
        self._bars.start()
        self._running.enter_context(process.undoing(self._bars.stop))
        return self

    def __exit__(self, *_: object) -> None:
        self._running.close()
        self._bars.stop()

    def reach(self, done: int) -> None:
        """So many are done now."""
        if done <= self._done:
            return
        self._done = done
        elapsed = time.perf_counter() - self._start
        left = elapsed * (self._total - done) / (done - self._before)
        said = f"{_duration(left)} left" if done < self._total else f"{_duration(elapsed)}"
        self._bars.update(self._task, completed=done, description=said)
        if not self._live:
            self._console.print(f"[{elapsed:6.1f} s] {done} of {self._total}, {said}", markup=False)


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"
