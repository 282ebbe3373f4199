"""Processes that are killed before each line of the result folder's code, one after the other.

    python killed.py replace|settle FOLDER

A process of its own, as a fork copies the page table: that of the tests has a gigabyte.
"""

import os
import shutil
import signal
import sys
from itertools import count
from pathlib import Path

from railhead.results import result_folder

FILES = result_folder.__file__, shutil.__file__
NEW = {"one": b"new", "three": b"new"}


def replace(folder: Path) -> None:
    """Put NEW in the place of a result."""
    with result_folder.replacing(folder) as work:
        for name, content in NEW.items():
            (work / name).write_bytes(content)


def killed(line: int, action, folder: Path) -> bool:
    """Call `action` in a child that is killed before so many lines of FILES are executed; False
    where it ends before that."""
    left = line

    def trace(frame, event, _):
        nonlocal left
        if frame.f_code.co_filename not in FILES:
            return None
        if event == "line":
            left -= 1
            if left == 0:
                os.kill(os.getpid(), signal.SIGKILL)
        return trace

    if (child := os.fork()) == 0:
        try:
            sys.settrace(trace)
            action(folder)
        finally:
            os._exit(0)
    return os.WIFSIGNALED(os.waitpid(child, 0)[1])


if __name__ == "__main__":
    does = {"replace": replace, "settle": result_folder.settle}[sys.argv[1]]
    print(next(n for n in count(1) if not killed(n, does, Path(sys.argv[2], f"{n}", "result"))))
