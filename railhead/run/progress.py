"""The progress of a run: on standard error, or told to a function."""

import time
from collections.abc import Callable
from datetime import timedelta
from typing import Self

from mpi4py import MPI
from rich.console import Console

from railhead.scene.scene import SceneError
from railhead.scene.units import show

Tell = Callable[[float, str], object]
"""Takes the seconds since the start and what is done now."""


class Progress:
    """Display of stage, Newton steps and number of finished jobs on standard error; a context
    manager.

    On a terminal one line is updated; elsewhere each message is a line.
    """

    def __init__(
        self, *, quiet: bool, since: float | None = None, tell: Tell | None = None
    ) -> None:
        """quiet: whether nothing is printed; since: start of the clock, s of time.perf_counter,
        None: now; tell: is called with seconds and text in the place of printing, None: nothing is
        called.
        """
        self._tell = tell
        quiet = quiet or tell is not None
        self._console = Console(stderr=True, quiet=quiet, highlight=False)
        self._live = self._console.is_terminal and not quiet
        self._status = self._console.status("")
        self._stage = ""
        self._counts: list[tuple[int, float]] = []  # finished jobs and the time of each call
        self._start = time.perf_counter() if since is None else since

    def __enter__(self) -> Self:
        """Start the line on a terminal."""
        if self._live:
            self._status.start()
            self._console.show_cursor()  # nothing shows it again where a signal ends the process
        return self

    def __exit__(self, *_: object) -> None:
        """Remove the line on a terminal."""
        self._status.stop()

    def _say(self, text: str) -> None:
        """Show a text with the elapsed seconds, or call `tell` with both."""
        elapsed = time.perf_counter() - self._start
        if self._tell is not None:
            self._tell(elapsed, text)
        if self._live:
            self._status.update(f"{text}  ({elapsed:.1f} s)")
        else:
            self._console.print(f"[{elapsed:6.1f} s] {text}", markup=False)

    def stage(self, name: str) -> None:
        """Show the name of a stage that begins."""
        self._stage = name
        self._say(name)

    def newton(self, step: int, residual: float) -> None:
        """Show the number of a finished Newton step and its relative residual."""
        self._say(f"{self._stage}: Newton step {step}, residual {residual:.1e}")

    def jobs(self, done: int, total: int) -> None:
        """Show the number of finished jobs (`done`), if larger than at the last call, and the
        remaining time at the pace since the first call.
        """
        if self._counts and done <= self._counts[-1][0]:
            return
        self._counts.append((done, time.perf_counter()))
        (first, start), (_, now) = self._counts[0], self._counts[-1]
        text = f"{done} of {total} done"
        if first < done < total:
            left = (now - start) * (total - done) / (done - first)
            text += f", {timedelta(seconds=round(left))} left"
        self._say(text)


def show_progress(*, quiet: bool, since: float | None = None, tell: Tell | None = None) -> Progress:
    """Progress display of a run, on the first MPI rank only; arguments as those of `Progress`.
    Raises SceneError for a `tell` that is no function.
    """
    if tell is not None and not callable(tell):
        raise SceneError("progress", f"{show(tell)} is no function; give one of seconds and text")
    if MPI.COMM_WORLD.rank:
        return Progress(quiet=True)
    return Progress(quiet=quiet, since=since, tell=tell)
