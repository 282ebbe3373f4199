"""Tables of points as text, with any of the usual separators, decimal marks, comments, headers."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railhead.meshing.columns import ColumnError, chosen

Array = NDArray[np.float64]
NAMED_UNITS = {
    "mm": "mm", "millimetre": "mm", "millimeter": "mm", "millimetres": "mm", "millimeters": "mm",
    "m": "m", "metre": "m", "meter": "m", "metres": "m", "meters": "m",
    "in": "inch", "inch": "inch", "inches": "inch", '"': "inch", "″": "inch",
    "cm": "cm", "centimetre": "cm", "centimeter": "cm", "centimetres": "cm", "centimeters": "cm",
    "um": "um", "µm": "um", "μm": "um", "micron": "um", "microns": "um",
    "ft": "ft", "foot": "ft", "feet": "ft",
}  # fmt: skip
OTHER_UNITS = (
    "km", "dm", "nm", "yd", "yard", "yards", "mil", "mils", "thou", "px", "pixel",
    "deg", "degree", "degrees", "°", "rad", "radian", "radians", "grad", "gon",
)  # fmt: skip
COMMENT = re.compile(r"""#|%|!|//|\*|;|"(?![^"]*")|'(?![^']*')""")
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
RATE = r"(?:m?m|[km]?n|k?g|t|lbs?)"  # of a unit, as in 60 kg/m: names no column
WORD = r"([a-zµμ]+|\"|″|°)"
NAMED = rf"[\[(]\s*{WORD}\s*[\])]|(?:^|[\W_])(?!{RATE}/)[^\W\d_]+\d*\s*[/_]\s*{WORD}(?!\w)"
COLUMN = re.compile(rf"{NAMED}|^[\s\"']*{WORD}[\s\"']*$", re.IGNORECASE)  # y [mm], y/mm, mm
PLAIN = (
    rf"(?<![\d/])(?<!\d\s)\b(mm)\b|\bunits?\s*[:=]?\s*{WORD}"
    rf"|\bin\s+{WORD}(?=\s*(?:$|[,;.:)\]]))"
)
PROSE = re.compile(rf"(?:{NAMED})(?!\s*[:=,;]?\s*[-+]?\d)|{PLAIN}", re.IGNORECASE)
HEADS = re.compile(PLAIN, re.IGNORECASE)  # where the brackets of other columns may stand
TWICE = re.compile(r"\s*-?\d+(,\d+)?,-?\d{1,3}(,\d+)?\s*")  # 1,5,2,5 or 1,2,5
DECIMALS = re.compile(r"([^,]*,){3}|.*,.*,\d{3,}\s*$")  # four numbers, or many digits in the third
SHOWN = 40  # characters of a wrong line


class InstrumentError(ValueError):
    """The file is no profile: the text names it, the line, and what is allowed there."""

    def __init__(self, name: str, line: int, text: str) -> None:
        super().__init__(f"{name}, line {line}: {text}")


@dataclass(frozen=True)
class Table:
    """points (n, 2): first across, then up or down, in the order of the file and in its unit; unit:
    that the file states, '' where it states none, any text where another one overrules it; body:
    'rail', 'wheel' or '' where the file does not say; format and remarks: in words; lines: of the
    file where the points stand, if known."""

    points: Array
    unit: str
    body: str
    format: str
    remarks: tuple[str, ...] = ()
    lines: tuple[int, ...] = ()


def fields(line: str, separator: str, decimal: str) -> list[float] | None:
    """The numbers of a line, None unless it has two and all its fields until then are numbers."""
    if separator in (";", "\t", ","):
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    else:
        cells = re.split(separator, line.strip())
    numbers: list[float] = []
    for cell in cells:
        text = cell.strip().strip("\"'")
        if decimal == ",":
            text = "?" if "." in text else text.replace(",", ".")
        if not NUMBER.fullmatch(text):
            break
        numbers.append(float(text.upper().replace("D", "E")))
    return numbers if len(numbers) >= 2 and all(map(math.isfinite, numbers)) else None


#: Separator, decimal mark and name of dialects; the first that reads most lines is taken.
DIALECTS = (
    (";", ".", "semicolons"), (";", ",", "semicolons, decimal commas"),
    ("\t", ".", "tabs"), ("\t", ",", "tabs, decimal commas"),
    (r",\s+", ",", "commas and blanks, decimal commas"), (",", ".", "commas"),
    (r"\s+", ".", "blanks"), (r"\s+", ",", "blanks, decimal commas"),
)  # fmt: skip


def table(name: str, lines: Sequence[str], overruled: bool = False) -> Table:
    """The points in the lines of a file of that name; overruled: the unit is given otherwise, so
    that none which the file states is refused. Raises InstrumentError."""
    full = [(i, line) for i, line in enumerate(lines, 1) if line.strip()]
    parts = [(i, line) for i, line in full if not COMMENT.match(line.lstrip())]
    separator, decimal, words = max(
        DIALECTS, key=lambda d: sum(fields(line, d[0], d[1]) is not None for _, line in parts)
    )
    rows = [(i, line, fields(line, separator, decimal)) for i, line in parts]
    first = next((i for i, _, row in rows if row), 0)
    if not first:
        where = parts[0][0] if parts else 1
        raise InstrumentError(name, where, "is no point; give two numbers y, z a line")
    lined = [line for _, line, row in rows if row]
    twice = all(map(TWICE.fullmatch, lined)) and any(map(DECIMALS.match, lined))
    if separator == "," and twice:
        text = "commas separate and are decimal marks too; separate by semicolons, tabs or blanks"
        raise InstrumentError(name, first, text)
    for i, line, row in rows:
        if row is None and i > first:
            text = "is no point; give two numbers y, z, or begin a comment with #"
            raise InstrumentError(name, i, f"{line.strip()[:SHOWN]!r} {text}")
    header = [(i, line) for i, line in full if i < first]
    points = [(i, row) for i, _, row in rows if row]
    *columns, named = _columns(name, header, separator, [row for _, row in points], first)
    for i, row in points:
        if len(row) <= max(columns):
            text = f"has no number in column {max(columns) + 1}; give as many as in other lines"
            raise InstrumentError(name, i, text)
    values = np.array([[row[column] for column in columns] for _, row in points])
    most, remarks = max(len(row) for _, row in points), []
    if columns != [0, 1] or most > 2:
        remarks = [f"columns {columns[0] + 1} and {columns[1] + 1} of {most}"]
    unit = _unit(name, header, separator, columns, named, overruled)
    at = tuple(i for i, _ in points)
    return Table(values, unit, "", f"table by {words}", tuple(remarks), at)


def _columns(
    name: str, header: Sequence[tuple[int, str]], separator: str,
    rows: Sequence[Sequence[float]], first: int,
) -> tuple[int, int, int]:  # fmt: skip
    """Of y and z, and the line that names them. Raises InstrumentError, of the header or the first
    line of points."""
    count = min(map(len, rows))
    cells = [(at, _cells(line.rstrip("\"' \n"), separator)) for at, line in header]
    try:
        return chosen(cells, np.array([row[:count] for row in rows]))
    except ColumnError as error:
        raise InstrumentError(name, error.at or first, str(error)) from None


def _cells(line: str, separator: str) -> list[str]:
    """Of a line before the points; a bracket belongs to the word before it."""
    return re.split(separator, re.sub(r"\s+(?=[\[(])", "", line.lstrip("#%!;*/ ").rstrip()))


def _unit(
    name: str, header: Sequence[tuple[int, str]], separator: str, columns: Sequence[int],
    named: int, overruled: bool,
) -> str:  # fmt: skip
    """That lines before the points state: first those that head the two columns, from the one that
    names them on."""
    allowed = ", ".join(dict.fromkeys(NAMED_UNITS.values()))
    for i, line in [each for each in header if each[0] >= named]:
        ways = (_cells(line, each) for each in (separator, r"[;,\t]"))
        cells = next((way for way in ways if len(way) > max(columns)), [])
        texts = [cells[column].strip() for column in columns] if cells else []
        if any(NUMBER.fullmatch(text) for text in texts):
            continue
        words = [word for text in texts for word in _words(COLUMN, text)]
        units = list(dict.fromkeys(NAMED_UNITS.get(word, word) for word in words))
        if not overruled and (len(units) > 1 or any(unit in OTHER_UNITS for unit in units)):
            text = f"the columns are in {' and '.join(units)}; give both in one of {allowed}"
            raise InstrumentError(name, i, text)
        if units:
            return " and ".join(units)
    for i, line in header:
        heads = i < named and len(re.split(r"[;,\t]", line)) > 1
        for word in _words(HEADS if heads else PROSE, line):
            if word in NAMED_UNITS:
                return NAMED_UNITS[word]
    return ""


def _words(pattern: re.Pattern[str], text: str) -> list[str]:
    """Units that a text names in that way."""
    found = (next(filter(None, match.groups())).lower() for match in pattern.finditer(text))
    return [word for word in found if word in NAMED_UNITS or word in OTHER_UNITS]
