"""A crash or a hang of gmsh is an error in one line, not the end of the process."""

import os
import signal
import time

import pytest

from railhead.meshing import isolated_process


def double(value: int) -> int:
    return 2 * value


def crash() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def refuse() -> None:
    raise ValueError("two\nlines")


def test_what_the_work_gives_comes_back() -> None:
    assert isolated_process.run(double, 21, seconds=60) == 42


def test_the_parent_works_meanwhile() -> None:
    """The child waits for a word that only the parent's own work gives."""
    asked, told = os.pipe()
    found = isolated_process.run(
        os.read, asked, 1, seconds=20, meanwhile=lambda: os.write(told, b"y")
    )
    assert found == b"y"


@pytest.mark.parametrize(
    "work, arguments, seconds, why",
    [
        (crash, (), 60, r"it crashed \(signal 9\)"),
        (refuse, (), 60, "^two lines$"),
        (time.sleep, (60,), 0.1, "not done after 0 s"),
    ],
)
def test_what_goes_wrong_is_one_line(work, arguments, seconds: float, why: str) -> None:
    with pytest.raises(isolated_process.IsolatedProcessError, match=why):
        isolated_process.run(work, *arguments, seconds=seconds)
