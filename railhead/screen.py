"""Where tables go: standard output, text, or a notebook."""

from __future__ import annotations

import io
from collections.abc import Callable

from rich.console import Console

WIDTH = 120  # characters where there is no terminal


def standard() -> Console:
    """Standard output."""
    console = Console()
    return console if console.is_terminal else Console(width=WIDTH)


def errors() -> Console:
    """Standard error."""
    return Console(stderr=True)


def text(show: Callable[[Console], None]) -> str:
    """What `show` prints."""
    console = _recording()
    show(console)
    return console.export_text()


def html(show: Callable[[Console], None]) -> str:
    """The same with its colours, for a notebook."""
    console = _recording()
    show(console)
    return console.export_html(inline_styles=True)


def _recording() -> Console:
    return Console(file=io.StringIO(), width=WIDTH, record=True)
