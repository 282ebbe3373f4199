"""The command's entry: signals are heard before anything heavy is imported."""

from railhead.process import prompt


def main() -> None:
    """Run the command; see `railhead.cli.main`."""
    with prompt():
        from railhead import cli

        cli.main()
