"""The command `railhead`, run in this process or in one of its own."""

import json
import os
import subprocess
import sys

import pytest

from railhead.cli import main

START = [sys.executable, "-c", "from railhead.cli import main; main()"]
LEFT = ("OMPI_", "PMIX_", "ORTE_", "COLUMNS")  # of Open MPI, and of a terminal
ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def environment() -> dict[str, str]:
    """That of this process without what Open MPI and a terminal leave there."""
    return {name: value for name, value in os.environ.items() if not name.startswith(LEFT)}


def status(*arguments: str) -> int:
    """Exit status of the command in this process."""
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    return int(ended.value.code or 0)


def told(capsys: pytest.CaptureFixture[str], *arguments: str, ends: int = 0) -> dict:
    """What a command with --json, which ends with that status, prints."""
    assert status(*arguments, "--json") == ends
    return json.loads(capsys.readouterr().out)


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """The one line on standard error of a command that ends with status 2 and prints nothing."""
    assert status(*arguments) == 2
    out, errors = capsys.readouterr()
    (line,) = errors.strip().splitlines()
    assert out == ""
    return line


def process(*arguments: str, cwd, **changes: str) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own, in a folder, with changes of the environment."""
    return subprocess.run(
        [*START, *arguments], cwd=cwd, env=environment() | changes, capture_output=True, text=True,
        check=False, timeout=300,
    )  # fmt: skip


def until(running: subprocess.Popen[str], words: str) -> None:
    """Wait for a line with these words on standard error of a process that runs."""
    while words not in running.stderr.readline():
        assert running.poll() is None
