"""A run by finite elements for the page: the command in a process group of its own."""

import asyncio
import os
import signal
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import AsyncIterator
from contextlib import suppress

PATIENCE = 3.0  # s between asking processes to end and killing them
START = (
    "from railhead.meshing.isolated_process import die_with_parent; die_with_parent(); "
    "from railhead.cli import main; main()"
)


class Run:
    """One `railhead run` at a time.

    status: exit status of the last one; None before, and while one runs.
    """

    def __init__(self) -> None:
        """Nothing runs."""
        self._process: Process | None = None

    @property
    def status(self) -> int | None:
        """As of the class."""
        return self._process.returncode if self._process else None

    async def lines(self, words: list[str]) -> AsyncIterator[str]:
        """Run the command with these arguments, after the end of another that still runs; the lines
        that it prints to standard error.
        """
        await self.stop()
        process = self._process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-c", START, *words),
            stdin=DEVNULL,
            stdout=DEVNULL,
            stderr=PIPE,
            start_new_session=True,
        )
        assert process.stderr is not None
        async for line in process.stderr:
            yield line.decode(errors="replace").rstrip()
        await process.wait()

    async def stop(self) -> None:
        """End the command with all that it started, if it runs."""
        process = self._process
        if process is None or process.returncode is not None:
            return
        os.killpg(process.pid, signal.SIGTERM)
        try:
            await asyncio.wait_for(process.wait(), PATIENCE)
        except TimeoutError:
            pass
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
