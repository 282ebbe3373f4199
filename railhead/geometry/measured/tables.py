"""Tables of points as text.

Separator and decimal mark are those that make most lines rows of numbers. The columns of y and z
are those that a header line names; without one the table must have two columns, y before z.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
COMMENT = re.compile(r"[#%!;*]|//")
ACROSS = ("y", "lateral", "lat", "across", "quer")
UP = ("z", "height", "vertical", "vert", "hoehe", "höhe", "elevation", "elev", "depth", "tiefe")
UNIT_NAMES = {
    "mm": ("mm", "millimetre", "millimeter", "millimetres", "millimeters"),
    "m": ("m", "metre", "meter", "metres", "meters"),
    "inch": ("in", "inch", "inches"),
    "cm": ("cm", "centimetre", "centimeter", "centimetres", "centimeters"),
    "um": ("um", "µm", "μm", "micron", "microns"),
    "ft": ("ft", "foot", "feet"),
}
UNIT_OF_NAME = {name: unit for unit, names in UNIT_NAMES.items() for name in names}
OTHER_UNITS = ("km", "dm", "nm", "yd", "yard", "yards", "mil", "mils", "px", "deg", "°", "rad")
UNIT = re.compile(r"[\[(/_]\s*([^\W\d_]+|°)")  # in a name: y [mm], y/mm, y_mm
UNIT_LINE = re.compile(r"\bunits?\s*[:=]?\s*([^\W\d_]+)", re.IGNORECASE)
SHOWN = 40  # characters of a wrong line that a message repeats

#: Separator (regular expression), decimal mark and name, in the order in which they are tried.
LAYOUTS = (
    (";", ".", "semicolons"),
    (";", ",", "semicolons, decimal commas"),
    ("\t", ".", "tabs"),
    ("\t", ",", "tabs, decimal commas"),
    (r",\s+", ",", "commas and blanks, decimal commas"),
    (",", ".", "commas"),
    (r"\s+", ".", "blanks"),
    (r"\s+", ",", "blanks, decimal commas"),
)


class FormatError(ValueError):
    """A file is not a profile. The message names the file, the line and what is allowed there."""

    def __init__(self, name: str, line: int, text: str) -> None:
        """Message of the file name, the line number and the text."""
        super().__init__(f"{name}, line {line}: {text}")


@dataclass(frozen=True, kw_only=True)
class Table:
    """Points of a file, before they are turned into the axes of the project.
    points: (n, 2) of y, and z up or down, in the order and the unit of the file.
    unit: unit that the file states; '' where it states none.
    body: 'rail', 'wheel', or '' where the file does not say.
    format: name of the format.
    remarks: what was left out or computed while reading.
    lines: (n,) line number of each point.
    """

    points: Array
    unit: str
    body: str
    format: str
    remarks: tuple[str, ...]
    lines: tuple[int, ...]


def numbers(line: str, separator: str, decimal: str) -> list[float] | None:
    """Numbers with which a line begins, up to the first cell that is no number; None if there are
    fewer than two, or one is not finite.
    separator: regular expression between cells; decimal: '.' or ','.
    """
    found: list[float] = []
    for cell in re.split(separator, line.strip()):
        text = cell.strip(" \"'")
        if decimal == ",":
            text = "?" if "." in text else text.replace(",", ".")
        if not NUMBER.fullmatch(text):
            break
        found.append(float(text))
    return found if len(found) >= 2 and all(map(math.isfinite, found)) else None


def read(name: str, lines: Sequence[str], unit_is_given: bool) -> Table:
    """Table from the lines of a text file of two or more columns.
    name: file name, for messages.
    unit_is_given: the user gives the unit, so a header with an unknown unit is not refused.
    Raises FormatError for lines that are no points, and columns or units that are unclear.
    """
    full = [(at, line.strip()) for at, line in enumerate(lines, 1) if line.strip()]
    data = [(at, line) for at, line in full if not COMMENT.match(line)]
    separator, decimal, words = max(
        LAYOUTS, key=lambda each: sum(numbers(line, *each[:2]) is not None for _, line in data)
    )
    rows = [(at, line, numbers(line, separator, decimal)) for at, line in data]
    points = [(at, row) for at, _, row in rows if row]
    first = points[0][0] if points else 0
    for at, line, row in rows or [(1, "", None)]:
        if row is None and at > first:
            text = "is no point; give two numbers y, z, or begin a comment with #"
            raise FormatError(name, at, f"{line[:SHOWN]!r} {text}")
    header = [(at, line) for at, line in full if at < first]
    count = max(len(row) for _, row in points)
    named = _columns(name, header, separator, count)
    if not named and count > 2:
        raise FormatError(
            name, first, f"has {count} columns; give a header line that names y and z"
        )
    at, columns, units = named or (first, (0, 1), [])
    for line_number, row in points:
        if len(row) <= max(columns):
            text = f"has no number in column {max(columns) + 1}; give as many as in other lines"
            raise FormatError(name, line_number, text)
    if not unit_is_given and (len(units) > 1 or any(unit not in UNIT_NAMES for unit in units)):
        text = f"the columns are in {' and '.join(units)}; give both in one of "
        raise FormatError(name, at, text + ", ".join(UNIT_NAMES))
    stated = [match[1].lower() for _, line in header if (match := UNIT_LINE.search(line))]
    units = units or [UNIT_OF_NAME[each] for each in stated if each in UNIT_OF_NAME][:1]
    return Table(
        points=np.array([[row[column] for column in columns] for _, row in points]),
        unit=" and ".join(units),
        body="",
        format=f"table by {words}",
        remarks=(f"columns {columns[0] + 1} and {columns[1] + 1} of {count}",) * (count > 2),
        lines=tuple(at for at, _ in points),
    )


def _columns(
    name: str, header: Sequence[tuple[int, str]], separator: str, count: int
) -> tuple[int, tuple[int, int], list[str]] | None:
    """Line number of the last header line that names y and z, indices of these two columns, and the
    units that stand over them; None where no line names them.
    header: (line number, text) before the points; count: columns of the points.
    Raises FormatError where a header names several such columns, or fewer columns than there are.
    """
    for index, (at, line) in reversed([*enumerate(header)]):
        cells = _cells(line, separator)
        words = [re.split(r"[\W_]", cell)[0] for cell in cells]
        across, up, along = (
            [i for i, word in enumerate(words) if word in known] for known in (ACROSS, UP, ("x",))
        )
        if along and not (across and up):  # x is across where there is no y, or no z beside it
            across, up = along, up or across
        if not (across and up):
            continue
        if len(across) > 1 or len(up) > 1 or len(cells) < count:
            text = f"names several columns across or up, or fewer than the {count} of the points; "
            raise FormatError(name, at, text + "give a header that names one y and one z")
        columns = across[0], up[0]
        below = _cells(header[index + 1][1], separator) if index + 1 < len(header) else []
        if len(below) == len(cells):  # names, then units
            cells = [f"{cells[i]} /{unit.strip('[]()')}" for i, unit in enumerate(below)]
        units = dict.fromkeys(_unit(cells[column]) for column in columns)
        return at, columns, [*filter(None, units)]
    return None


def _cells(line: str, separator: str) -> list[str]:
    """Cells of a header line in lower case; a bracket belongs to the word before it."""
    text = re.sub(r"\s+(?=[\[(])", "", line.lstrip("#%!;*/ ").strip()).lower()
    return [cell.strip(" \"'") for cell in re.split(separator, text)]


def _unit(head: str) -> str:
    """Unit in a column's name, by its name in `UNIT_NAMES` or `OTHER_UNITS`; '' for none."""
    found = [UNIT_OF_NAME.get(word, word) for word in UNIT.findall(head)]
    return next((word for word in found if word in UNIT_NAMES or word in OTHER_UNITS), "")
