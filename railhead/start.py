"""The command's entry: signals end the process at once from the first import on."""

from railhead import process


def main() -> None:
    """Run the command; see `railhead.cli.main`."""
    process.end_at_once()
    from railhead import cli

    cli.main()
