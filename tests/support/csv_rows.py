"""Tables that the program writes."""

import csv


def rows(file) -> list[dict[str, str]]:
    """The rows of a table by its first line, with or without a byte order mark."""
    return list(csv.DictReader(file.read_text(encoding="utf-8-sig").splitlines()))
