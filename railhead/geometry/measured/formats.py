"""Files of profile instruments: which numbers are points, and what the file says of them.

MiniProf (.ban rail, .whl wheel, .mpt either: a header of any lines, then columns, perhaps in
sections with names in brackets), Simpack (.prr rail, .prw wheel: commented sections, points between
point.begin and point.end), and tables of text (`geometry.tables`). Each format says what it defines
of the axes: z of a Simpack file counts downwards and y to the field side; y of a MiniProf wheel
begins at the flange back. A table whose header names no columns has two, y before z.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from railhead.geometry import tables
from railhead.geometry.measured import BODY_BY_EXTENSION, MINIPROF, SIMPACK
from railhead.geometry.measured.smoothing import LEAST_POINTS
from railhead.geometry.tables import (
    MM_OF_UNIT,
    NUMBER,
    SHOWN,
    UNIT_NAMES,
    UNIT_OF_NAME,
    Column,
    FormatError,
    mm_of,
    numbers,
)
from railhead.theory.array_types import Array

COMMENTED_OUT = re.compile(r"[#%!\"]")  # by MiniProf and Simpack
INSTRUMENT_LAYOUT = r"[\s,;]+", "."
FOLLOWING = 3  # lines of numbers that follow each other begin the points of a MiniProf file
Y, Z, X = (
    Column(name=name, named=f"({words})( .*)?", unit="mm", factor=mm_of)
    for name, words in (
        ("y", "y|lateral|lat|across|quer"),
        ("z", "z|height|vertical|vert|hoehe|höhe|elevation|elev|depth|tiefe"),
        ("y", "x"),
    )
)
WANTED = (Y, Z), (X, Z), (X, replace(Y, name="z"))
"""Columns across and up: y and z, without y x and z, without z x and y."""


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
    name, lines, extension = path.name, tables.lines_of(path), path.suffix.lower()
    body = BODY_BY_EXTENSION.get(extension, "")
    if extension in MINIPROF:
        found = _miniprof(name, lines, body)
    elif extension in SIMPACK:
        found = _simpack(name, lines, body)
    else:
        found = replace(_table(name, lines, unit_is_given), body=body)
    if len(found.points) < LEAST_POINTS:
        text = f"ends after {len(found.points)} points; give at least {LEAST_POINTS}"
        raise FormatError(name, len(lines), text)
    return found


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
    numeric = [numbers(re.sub(r"^\s*[#%\"]", "", line), *INSTRUMENT_LAYOUT) for line in lines]

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
    layout = INSTRUMENT_LAYOUT, COMMENTED_OUT
    rows, at_lines = tables.rows_of(name, lines, range(start, end), *layout)
    found, promised = len([*filter(None, numeric[start:end])]), header.get("XYPoints", "").strip()
    if promised.isdecimal() and found < int(promised):
        text = f"ends after {found} of the {promised} points of its header; give the whole file"
        raise FormatError(name, end, text)
    names = [column.strip().upper() for column in header.get("ColumnDef", "X,Y").split(",")]
    columns = [names.index(column) for column in ("X", "Y") if column in names]
    tape = header.get("WheelDiameterTaperline", "").strip()
    points = np.array(
        tables.columns_of(name, rows, at_lines, columns if len(columns) == 2 else [0, 1])
    )
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
    rows, at_lines = tables.rows_of(name, lines, span, INSTRUMENT_LAYOUT, COMMENTED_OUT)
    listed = np.array(tables.columns_of(name, rows, at_lines, (0, 1)))
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
    found = tables.read(name, lines, *WANTED, titles=True)
    stated = dict.fromkeys(each for each in found.units if each)
    units = dict.fromkeys(UNIT_OF_NAME.get(each.lower(), each) for each in stated)
    if not unit_is_given and (len(units) > 1 or any(unit not in UNIT_NAMES for unit in units)):
        text = f"the columns are in {' and '.join(units)}; give both in one of "
        raise FormatError(name, found.at, text + ", ".join(UNIT_NAMES))
    points = np.array(found.rows)
    return Table(
        points=points,
        unit="" if unit_is_given else "".join(units),
        body="",
        format=f"table by {found.layout}",
        lines=found.lines,
        resolution=_last_digit(points),
    )
