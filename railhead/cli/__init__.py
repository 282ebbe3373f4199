"""The command `railhead`: its options, and the commands that are no run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from railhead.run import process

if TYPE_CHECKING:
    from railhead.scene.scene import Scene


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command, see `railhead.cli.commands.main`. Signals end it from the first import."""
    process.end_at_once()
    from railhead.cli import commands

    commands.main(arguments)


def run_case(scene: Scene) -> None:
    """What `python cases/<case>.py [options]` does: `railhead run` on that scene."""
    from railhead.cli import commands

    commands.main(["run", scene.name, *process.take_arguments()])
