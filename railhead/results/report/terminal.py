"""Where tables go: standard output, text, or a notebook."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Callable

from rich.console import Console

WIDTH = 80  # characters where there is no terminal


def standard() -> Console:
    """Console on standard output, WIDTH characters wide where that is no terminal."""
    console = Console()
    return console if console.is_terminal else Console(width=WIDTH)


def errors() -> Console:
    """Console on standard error."""
    return Console(stderr=True)


def labelled(console: Console, line: str, indent: int = 11) -> None:
    """Print a line that begins with a label; continuation lines are indented by `indent`
    characters.
    """
    below = " " * indent
    said = textwrap.fill(
        line,
        console.width,
        subsequent_indent=below,
        break_long_words=False,
        break_on_hyphens=False,
    )
    console.print(said, markup=False, highlight=False, soft_wrap=True)


def text(show: Callable[[Console], None]) -> str:
    """Text that `show` prints on a console."""
    console = _recording()
    show(console)
    return console.export_text()


def html(show: Callable[[Console], None]) -> str:
    """HTML with colours of the text that `show` prints on a console, for notebooks."""
    console = _recording()
    show(console)
    return console.export_html(inline_styles=True)


def _recording() -> Console:
    """Console that records its output."""
    return Console(file=io.StringIO(), width=WIDTH, record=True)
