"""The command `railhead`: its options, and the commands that are no run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from railhead.run import process

if TYPE_CHECKING:
    from railhead.scene.scene import Scene


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command `railhead` with arguments, None: those of the process, and exit with its
    status. Ctrl-C ends the process at once, also during imports.
    """
    process.end_at_once()
    from railhead.cli import commands

    commands.main(arguments)


def run_case(scene: Scene) -> None:
    """Run `railhead run` on a shipped scene, with the options of the process, and exit with its
    status: `python cases/<case>.py`.
    """
    from railhead.cli import commands

    commands.main(["run", scene.name, *process.take_arguments()])
