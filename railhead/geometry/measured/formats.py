"""Files of profile instruments: which numbers are points, and what the file says of them.

MiniProf (.ban rail, .whl wheel: header lines key=value, an empty line, then columns), Simpack (.prr
rail, .prw wheel: commented sections, points between point.begin and point.end), and tables of text.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from railhead.geometry.measured import tables
from railhead.geometry.measured.extensions import BODY_BY_EXTENSION
from railhead.geometry.measured.smoothing import LEAST_POINTS
from railhead.geometry.measured.tables import NUMBER, SHOWN, FormatError, Table

Array = NDArray[np.float64]
BLANKS = r"[\s,;]+"
SIMPACK_UNITS = {1000: "mm", 1: "m", 39: "inch"}  # by the whole part of units.len.f, units a metre


def read(path: Path, unit_is_given: bool = False) -> Table:
    """Points of a profile file; the extension selects the format.
    unit_is_given: the user gives the unit, so a header with an unknown unit is not refused.
    Raises FormatError for a file that is no profile, with fewer than 12 points or of the wrong
    body, and OSError.
    """
    lines, extension = _text(path).splitlines(), path.suffix.lower()
    body = BODY_BY_EXTENSION.get(extension, "")
    if not body:
        found = tables.read(path.name, lines, unit_is_given)
    elif extension in (".ban", ".whl"):
        found = _miniprof(path.name, lines)
    else:
        found = _simpack(path.name, lines)
    if len(found.points) < LEAST_POINTS:
        text = f"ends after {len(found.points)} points; give at least {LEAST_POINTS}"
        raise FormatError(path.name, len(lines), text)
    return replace(found, body=found.body or body)


def _text(path: Path) -> str:
    """Text of a file in UTF-16 with a mark, UTF-8 or Latin-1. Raises FormatError for binary
    content.
    """
    data = path.read_bytes()
    marked = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    for coding in ("utf-16",) if marked else ("utf-8-sig", "latin-1"):
        try:
            text = data.decode(coding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise FormatError(path.name, 1, "is no text; give points as text")


def _miniprof(name: str, lines: Sequence[str]) -> Table:
    """Table of a MiniProf file. Lines that begin with a quotation mark are commented out. Raises
    FormatError.
    """
    empty = next((i for i, line in enumerate(lines) if not line.strip()), len(lines))
    header = dict(line.split("=", 1) for line in lines[:empty] if "=" in line)
    if not header:
        text = "is no header; give MiniProf's lines key=value and an empty line before the points"
        raise FormatError(name, 1, text)
    values, at_lines, remarks = _rows(name, lines, empty, len(lines), '"!%#')
    names = [column.strip().upper() for column in header.get("ColumnDef", "X,Y").split(",")]
    columns = [names.index(column) for column in ("X", "Y") if column in names]
    if len(columns) < 2 or max(columns) >= values.shape[1]:
        columns = [0, 1]
    return Table(
        points=values[:, columns],
        unit="mm",
        body="",
        format="MiniProf",
        remarks=remarks,
        lines=at_lines,
    )


def _simpack(name: str, lines: Sequence[str]) -> Table:
    """Table of a Simpack file. Shifts, rotation, bounds and mirrors of the header are applied in
    order, as Simpack does. Raises FormatError.
    """
    bare = [line.split("!")[0].strip() for line in lines]
    begin = bare.index("point.begin") if "point.begin" in bare else -1
    if begin < 0:
        text = "ends without point.begin; give Simpack's sections"
        raise FormatError(name, max(len(lines), 1), text)
    if "point.end" not in bare[begin:]:
        raise FormatError(name, len(lines), "ends without point.end; give the whole file")
    keys: dict[str, tuple[int, str]] = {}
    for at, line in enumerate(bare[:begin], 1):
        key, equals, value = line.partition("=")
        if equals:  # `type` comes twice: first in the header
            keys.setdefault(key.strip(), (at, value.strip()))

    def number(key: str, default: float = 0.0) -> float:
        """Number of a header key, or the default. Raises FormatError where the value is none."""
        line, text = keys.get(key, (0, str(default)))
        if not NUMBER.fullmatch(text):
            raise FormatError(name, line, f"{key} = {text[:SHOWN]!r}; give a number")
        return float(text)

    values, at_lines, remarks = _rows(name, lines, begin + 1, bare.index("point.end", begin), "!")
    points = values[:, :2] + [number("shift.y"), number("shift.z")]
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
    done = [
        f"{key} done"
        for key in ("shift.y", "shift.z", "rotate", "mirror.y", "mirror.z")
        if number(key)
    ]
    return Table(
        points=points,
        unit=SIMPACK_UNITS.get(int(number("units.len.f", 1000.0)), ""),
        body={"0": "rail", "1": "wheel"}.get(keys.get("type", (0, ""))[1], ""),
        format="Simpack",
        remarks=(*remarks, *done),
        lines=at_lines,
    )


def _rows(
    name: str, lines: Sequence[str], start: int, end: int, comment: str
) -> tuple[Array, tuple[int, ...], tuple[str, ...]]:
    """Numbers (n, m) in the lines with indices from start up to, not including, end; the line
    number of each row (n,); and a remark on rows that are commented out, if any.
    comment: characters of which one begins a comment line.
    Raises FormatError for a line that is no row, and where there is none.
    """
    rows, where, out = [], [], 0
    for i in range(start, end):
        line = lines[i].strip()
        commented = line[:1] in comment
        row = tables.numbers(line[commented:].split("!")[0].strip(), BLANKS, ".")
        if line and commented:
            out += row is not None
        elif row:
            rows.append(row)
            where.append(i + 1)
        elif line:
            text = f"{line[:SHOWN]!r} is no point; give two numbers y, z"
            raise FormatError(name, i + 1, text)
    if not rows:
        text = "no points follow; give two numbers y, z a line"
        raise FormatError(name, min(start + 1, len(lines)), text)
    width = min(map(len, rows))
    remarks = (f"{out} line{'s' * (out > 1)} commented out",) if out else ()
    return np.array([row[:width] for row in rows]), tuple(where), remarks
