"""Cases in processes of their own: one that hangs or crashes ends alone."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from multiprocessing.connection import Connection
from threading import local

from cases.hard.case import Case, Measured

START = 60.0  # seconds a new process may take to begin
_context = multiprocessing.get_context("spawn")


@dataclass(frozen=True)
class Outcome:
    """A case with what it gave (None if it ended without), why it fails, and its seconds."""

    case: Case
    measured: Measured | None
    fault: str
    seconds: float


def _serve(connection: Connection) -> None:
    os.environ["OMP_NUM_THREADS"] = "1"
    from cases.hard.battery import CASES

    connection.send("ready")
    with contextlib.suppress(EOFError):  # the study has ended
        while True:
            key = connection.recv()
            try:
                connection.send(CASES[key].solve())
            except Exception as error:
                connection.send(" ".join(f"{type(error).__name__}: {error}".split()))


class Worker:
    """A process that solves cases one after the other and is replaced when it is lost."""

    def __init__(self) -> None:
        self._process: multiprocessing.process.BaseProcess | None = None
        self._ends: Connection

    def _start(self) -> None:
        self._ends, theirs = _context.Pipe()
        self._process = _context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()
        if not self._ends.poll(START) or self._ends.recv() != "ready":
            raise RuntimeError("the process for hard cases does not start")

    def stop(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None

    def run(self, case: Case) -> Outcome:
        """Solve a case within its time limit."""
        if self._process is None:
            self._start()
        start = time.perf_counter()
        answer: Measured | str = f"not back after {case.seconds:g} s"
        self._ends.send(case.key)
        try:
            if self._ends.poll(case.seconds):
                answer = self._ends.recv()
            else:
                self.stop()
        except EOFError:
            self.stop()
            answer = "the process crashed"
        seconds = time.perf_counter() - start
        if isinstance(answer, str):
            return Outcome(case, None, answer, seconds)
        return Outcome(case, answer, case.fault(answer), seconds)


def outcomes(cases: Iterable[Case], processes: int = 2) -> Iterator[Outcome]:
    """Solve all cases, some at a time, in order."""
    mine = local()
    workers: list[Worker] = []

    def solve(case: Case) -> Outcome:
        if not hasattr(mine, "worker"):
            mine.worker = Worker()
            workers.append(mine.worker)
        outcome: Outcome = mine.worker.run(case)
        return outcome

    try:
        with ThreadPoolExecutor(processes) as pool:
            yield from pool.map(solve, cases)
    finally:
        for worker in workers:
            worker.stop()
