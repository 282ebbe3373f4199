"""A page in the browser: wheel and rail that follow sliders, half-spaces at once, then a run.

The extra `page` brings aiohttp and plotly. Nothing else of the program imports this room; the
command `railhead page` starts it as a program of its own.
"""

import sys

import click

from railhead.cli import errors
from railhead.run import process


def main() -> None:
    """Serve the page with the arguments of the process, those of `railhead page`, until Ctrl-C;
    exits with status 0, or as `errors.told` says for a case that there is not and a port in use.
    """
    process.prepare()
    case, port, shown = process.take_arguments()
    try:
        from railhead.page import server

        server.serve(case, int(port), opened=shown == "open")
    except (ValueError, OSError, click.ClickException) as error:
        sys.exit(errors.told(error))
    sys.exit(errors.SOLVED)
