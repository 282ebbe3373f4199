"""Tables that Excel opens by a double click and everything else reads: comma-separated values with
decimal points, in UTF-8 with its mark, lines ending in CR LF."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping

ENCODING = "utf-8-sig"


def encoded(rows: Iterable[Mapping[str, object]]) -> bytes:
    """Bytes of a .csv file: a line for each row, columns in the order of their first appearance;
    None is an empty cell.
    """
    rows = list(rows)
    columns = dict.fromkeys(name for row in rows for name in row)
    file = io.StringIO(newline="")
    writer = csv.DictWriter(file, list(columns))
    writer.writeheader()
    writer.writerows(rows)
    return file.getvalue().encode(ENCODING)
