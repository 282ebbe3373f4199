"""Files of profile instruments: which numbers are points, and what the file says of them.

MiniProf (.ban rail, .whl wheel, .mpt either: a header of any lines, then columns, perhaps in
sections with names in brackets), Simpack (.prr rail, .prw wheel: commented sections, points between
point.begin and point.end), and tables of text. Each format says what it defines of the axes: z of a
Simpack file counts downwards and y to the field side; y of a MiniProf wheel begins at the flange
back.

Separator and decimal mark of a table are those with which the most lines are rows of numbers; of a
long file only some 2000 lines are tried. The columns of y and z are those that a header line names;
without one the table must have two columns, y before z.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from railhead.geometry.measured import BODY_BY_EXTENSION, MINIPROF
from railhead.geometry.measured.smoothing import LEAST_POINTS
from railhead.theory.array_types import Array

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
COMMENT = re.compile(r"[#%!;*]|//")
COMMENTED_OUT = re.compile(r"[#%!\"]")  # by MiniProf and Simpack
ACROSS = ("y", "lateral", "lat", "across", "quer")
UP = ("z", "height", "vertical", "vert", "hoehe", "höhe", "elevation", "elev", "depth", "tiefe")
MM_OF_UNIT = {"mm": 1.0, "m": 1000.0, "inch": 25.4, "cm": 10.0, "um": 1e-3, "ft": 304.8}
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
LARGEST = 1e9  # of any unit: no profile has such a number
SHOWN = 40  # characters of a wrong line that a message repeats

SOME = 2000  # lines that tell the layout of a table, at most about
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
INSTRUMENT_LAYOUT = r"[\s,;]+", "."
FOLLOWING = 3  # lines of numbers that follow each other begin the points of a MiniProf file


class FormatError(ValueError):
    """A file is not a profile. The message names the file, the line and what is allowed there."""

    def __init__(self, name: str, line: int, text: str) -> None:
        """Message of the file name, the line number and the text."""
        super().__init__(f"{name}, line {line}: {text}")


@dataclass(frozen=True, kw_only=True)
class Table:
    """Points of a file, before they are turned into the axes of the project.
    points: (n, 2) of y, and z up or down, in the order and the unit of the file; of a Simpack file
        after the shifts and mirrors of its header.
    unit: unit that the file states, a key of UNIT_NAMES; '' where it states none, and of a table
        where the user gives it.
    body: 'rail', 'wheel', or '' where the file does not say.
    format: 'MiniProf', 'Simpack', or 'table by ' and the name of the separator.
    lines: (n,) line number of each point.
    outward: 1 or -1 where the format defines z: the sign of the z that points out of the metal.
    field: 1 or -1 where the format defines y: the sign of the y that points to the field side.
    placed: whether the format defines the origin.
    tape_circle: distance from the flange back to the tape circle that the header gives, mm.
    resolution: last digit of the numbers of its coarser column, in the unit of the file.
    """

    points: Array
    unit: str
    body: str
    format: str
    lines: tuple[int, ...]
    outward: int | None = None
    field: int | None = None
    placed: bool = False
    tape_circle: float | None = None
    resolution: float = 0.0


def read(path: Path, unit_is_given: bool = False) -> Table:
    """Points of a profile file; the extension selects the format.
    unit_is_given: the user gives the unit, so a header with an unknown unit is not refused.
    Raises FormatError for a file that is no profile or has fewer than 12 points, and OSError where
    it cannot be read.
    """
    name, lines, extension = path.name, _text(path).splitlines(), path.suffix.lower()
    body = BODY_BY_EXTENSION.get(extension, "")
    if extension in MINIPROF:
        found = _miniprof(name, lines, body)
    elif body:
        found = _simpack(name, lines, body)
    else:
        found = _table(name, lines, unit_is_given)
    if len(found.points) < LEAST_POINTS:
        text = f"ends after {len(found.points)} points; give at least {LEAST_POINTS}"
        raise FormatError(name, len(lines), text)
    return found


def _text(path: Path) -> str:
    """Text of a file in UTF-16 with a mark, UTF-8 or Latin-1. Raises FormatError for binary
    content.
    """
    data = path.read_bytes()
    marked = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        text = data.decode("utf-16" if marked else "utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\0" in text:
        raise FormatError(path.name, 1, "is no text; give points as text")
    return text


def _numbers(line: str, separator: str, decimal: str) -> list[float] | None:
    """Numbers with which a line begins, up to the first cell that is no number; None if there are
    fewer than two, or one is 1e9 (LARGEST) or more.
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
    return found if len(found) >= 2 and max(map(abs, found)) < LARGEST else None


def _rows(
    name: str, lines: Sequence[str], span: range, layout: tuple[str, str], comment: re.Pattern[str]
) -> tuple[list[list[float]], tuple[int, ...]]:
    """Rows of numbers, one for each line of a span that is not empty or commented out, and the line
    number of each row (n,).
    name: file name, for messages.
    span: indices of the lines.
    layout: separator (regular expression) and decimal mark.
    comment: what begins a comment line.
    Raises FormatError for a line that is no row, and where there is none.
    """
    rows, where = [], []
    for i in span:
        line = lines[i].strip()
        if not line or comment.match(line):
            continue
        row = _numbers(line, *layout)
        if row is None:
            text = f"{line[:SHOWN]!r} is no point; give two numbers y, z, or begin a comment with "
            raise FormatError(name, i + 1, f"{text}{'#' if comment is COMMENT else '!'}")
        rows.append(row)
        where.append(i + 1)
    if not rows:
        text = "no points follow; give two numbers y, z a line"
        raise FormatError(name, max(min(span.start + 1, len(lines)), 1), text)
    return rows, tuple(where)


def _points(
    name: str, rows: Sequence[Sequence[float]], at_lines: Sequence[int], columns: Sequence[int]
) -> Array:
    """Points (n, 2) in two columns of the rows. Raises FormatError for a row that is too short.
    name, at_lines: file name, and line number of each row, for messages.
    columns: indices of both columns.
    """
    for line, row in zip(at_lines, rows, strict=True):
        if len(row) <= max(columns):
            text = f"has no number in column {max(columns) + 1}; give as many as in other lines"
            raise FormatError(name, line, text)
    return np.array([[row[column] for column in columns] for row in rows])


def _last_digit(points: Array) -> float:
    """Last digit of the numbers (n, 2) of both columns, the coarser one, 1e-16 at least: 10 to the
    power -d, where d decimals are enough for the numbers with the most digits before the point.
    """
    size = np.floor(np.log10(np.maximum(np.abs(points), 1e-9)))
    longest = [column[of == of.max()] for column, of in zip(points.T, size.T, strict=True)]
    for decimals in range(16):
        if any(np.allclose(each, each.round(decimals), 1e-15, 0.0) for each in longest):
            return float(10.0**-decimals)
    return 1e-16


def _miniprof(name: str, lines: Sequence[str], body: str) -> Table:
    """Table of a MiniProf file, in mm. Lines of any kind come first; the points begin where three
    (FOLLOWING) lines of numbers follow each other. Points are the columns X and Y of the header's
    ColumnDef, else the first two. Lines that begin with #, % or a quotation mark are commented out.
    name: file name, for messages; body: 'rail' or 'wheel' by the extension, or ''.
    Raises FormatError for a file without points or with two profiles, and for a line that is no
    point.
    """
    numeric = [_numbers(re.sub(r"^\s*[#%\"]", "", line), *INSTRUMENT_LAYOUT) for line in lines]

    def points_from(begin: int) -> int:
        """Index of the first line of points at or behind a line; that of the end without one."""
        behind = range(begin, len(lines))
        return next((i for i in behind if all(numeric[i : i + FOLLOWING])), len(lines))

    start = points_from(0)
    end = next((i for i in range(start, len(lines)) if lines[i].startswith("[")), len(lines))
    if points_from(end) < len(lines):
        text = "begins another profile; give a file with one"
        raise FormatError(name, points_from(end) + 1, text)
    header = dict(line.split("=", 1) for line in lines[:start] if "=" in line)
    rows, at_lines = _rows(name, lines, range(start, end), INSTRUMENT_LAYOUT, COMMENTED_OUT)
    found, promised = len([*filter(None, numeric[start:end])]), header.get("XYPoints", "").strip()
    if promised.isdecimal() and found < int(promised):
        text = f"ends after {found} of the {promised} points of its header; give the whole file"
        raise FormatError(name, end, text)
    names = [column.strip().upper() for column in header.get("ColumnDef", "X,Y").split(",")]
    columns = [names.index(column) for column in ("X", "Y") if column in names]
    tape = header.get("WheelDiameterTaperline", "").strip()
    points = _points(name, rows, at_lines, columns if len(columns) == 2 else [0, 1])
    return Table(
        points=points,
        unit="mm",
        body=body,
        format="MiniProf",
        lines=at_lines,
        outward=1 if body == "wheel" else None,
        field=1 if body == "wheel" else None,
        placed=True,
        tape_circle=float(tape) if NUMBER.fullmatch(tape) else None,
        resolution=_last_digit(points),
    )


def _simpack(name: str, lines: Sequence[str], body: str) -> Table:
    """Table of a Simpack file. Shifts, rotation, bounds and mirrors of the header are applied in
    order, as Simpack does. Raises FormatError for a file that has no points or is cut off, or whose
    header has a word where a number belongs.
    name: file name, for messages.
    body: 'rail' or 'wheel', by the extension; the header's type, if it has one, counts instead.
    """
    bare = [line.split("!")[0].strip() for line in lines]
    if "point.begin" not in bare:
        text = "ends without point.begin; give Simpack's sections"
        raise FormatError(name, max(len(lines), 1), text)
    begin = bare.index("point.begin")
    if "point.end" not in bare[begin:]:
        raise FormatError(name, len(lines), "ends without point.end; give the whole file")
    keys: dict[str, tuple[int, str]] = {}
    for at, line in enumerate(bare[:begin], 1):
        key, equals, value = line.partition("=")
        if equals:  # `type` comes twice: first in the header
            keys.setdefault(key.strip(), (at, value.strip()))

    def number(key: str, default: float = 0.0) -> float:
        """Number of a header key, or the default where the header lacks it. Raises FormatError for
        a value that is no finite number, and for a unit's factor of 0.
        """
        line, text = keys.get(key, (0, str(default)))
        value = float(text) if NUMBER.fullmatch(text) else math.nan
        if not math.isfinite(value) or (value == 0 and key.startswith("units.")):
            raise FormatError(name, line, f"{key} = {text[:SHOWN]!r}; give a number")
        return value

    span = range(begin + 1, bare.index("point.end", begin))
    rows, at_lines = _rows(name, lines, span, INSTRUMENT_LAYOUT, COMMENTED_OUT)
    listed = _points(name, rows, at_lines, (0, 1))
    points = listed + [number("shift.y"), number("shift.z")]
    turn = number("rotate") / number("units.ang.f", 1.0)
    c, s = math.cos(turn), math.sin(turn)
    points = points @ np.array([[c, s], [-s, c]])
    for axis, letter in enumerate("yz"):
        low, high = number(f"bound.{letter}.min", 1.0), number(f"bound.{letter}.max")
        if low < high:
            inside = np.flatnonzero((points[:, axis] >= low) & (points[:, axis] <= high))
            points, at_lines = points[inside], tuple(at_lines[i] for i in inside)
        if number(f"mirror.{letter}"):
            points[:, axis] *= -1
    factor = number("units.len.f", 1000.0)
    unit = next((each for each, mm in MM_OF_UNIT.items() if abs(factor * mm - 1000) < 10), "")
    if not unit:
        text = f"units.len.f = {factor:g} is the factor of no unit; give 1000 for mm, 1 for m"
        raise FormatError(name, keys["units.len.f"][0], text)
    kind = {"0": "rail", "1": "wheel"}.get(keys.get("type", (0, ""))[1], body)
    return Table(
        points=points,
        unit=unit,
        body=kind,
        format="Simpack",
        lines=at_lines,
        outward=-1 if kind == "rail" else 1,
        field=1,
        placed=True,
        resolution=_last_digit(listed),
    )


def _table(name: str, lines: Sequence[str], unit_is_given: bool) -> Table:
    """Table from the lines of a text file of two or more columns.
    name: file name, for messages.
    unit_is_given: the user gives the unit, so a header with an unknown unit is not refused.
    Raises FormatError for lines that are no points, and columns or units that are unclear.
    """
    full = [(i, line.strip()) for i, line in enumerate(lines) if line.strip()]
    data = [(i, line) for i, line in full if not COMMENT.match(line)]
    some = [line for _, line in data[:: 1 + len(data) // SOME]]
    separator, decimal, words = max(
        LAYOUTS, key=lambda each: sum(_numbers(line, *each[:2]) is not None for line in some)
    )
    start = next((i for i, line in data if _numbers(line, separator, decimal)), len(lines))
    span = range(start, len(lines))
    rows, at_lines = _rows(name, lines, span, (separator, decimal), COMMENT)
    header = [(i + 1, line) for i, line in full if i < start]
    count = max(map(len, rows))
    named = _columns(name, header, separator, count)
    if not named and count > 2:
        text = f"has {count} columns; give a header line that names y and z"
        raise FormatError(name, start + 1, text)
    at, columns, units = named or (start + 1, (0, 1), [])
    if not unit_is_given and (len(units) > 1 or any(unit not in UNIT_NAMES for unit in units)):
        text = f"the columns are in {' and '.join(units)}; give both in one of "
        raise FormatError(name, at, text + ", ".join(UNIT_NAMES))
    stated = [match[1].lower() for _, line in header if (match := UNIT_LINE.search(line))]
    units = units or [UNIT_OF_NAME[each] for each in stated if each in UNIT_OF_NAME][:1]
    points = _points(name, rows, at_lines, columns)
    return Table(
        points=points,
        unit="" if unit_is_given else "".join(units),
        body="",
        format=f"table by {words}",
        lines=at_lines,
        resolution=_last_digit(points),
    )


def _columns(
    name: str, header: Sequence[tuple[int, str]], separator: str, count: int
) -> tuple[int, tuple[int, int], list[str]] | None:
    """Number of the last header line that names the columns across and up; the indices of both; and
    their different units (none, one or two). None where no line names both.
    Columns y and z are these two. Without z they are x and y, without y they are x and z.
    name: file name, for messages.
    header: (line number, text) of each line before the points.
    separator: regular expression between cells.
    count: number of columns of the points.
    Raises FormatError where the line names one of them twice, or fewer than `count` columns.
    """
    below: list[str] = []
    for at_line, line in reversed(header):
        bare = re.sub(r"\s+(?=[\[(])", "", line.lstrip("#%!;*/ "))  # a bracket is of its word
        cells = [cell.strip(" \"'") for cell in re.split(separator, bare.strip().lower())]
        words = [re.split(r"[\W_]", cell)[0] for cell in cells]
        across, up, along = (
            [i for i, word in enumerate(words) if word in known] for known in (ACROSS, UP, ("x",))
        )
        if along and not (across and up):  # x is across where there is no y, or no z beside it
            across, up = along, up or across
        if across and up:
            at = at_line
            break
        below = cells
    else:
        return None
    if len(across) > 1 or len(up) > 1 or len(cells) < count:
        text = f"names several columns across or up, or fewer than the {count} of the points; "
        raise FormatError(name, at, text + "give a header that names one y and one z")
    columns = across[0], up[0]
    units: dict[str, None] = {}
    for column in columns:
        text = cells[column]
        if len(below) == len(cells):  # names, then units
            text += f" /{below[column].strip('[]()')}"
        found = (UNIT_OF_NAME.get(word, word) for word in UNIT.findall(text))
        units |= dict.fromkeys([each for each in found if each in (*UNIT_NAMES, *OTHER_UNITS)][:1])
    return at, columns, [*units]
