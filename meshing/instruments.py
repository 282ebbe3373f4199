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

from railhead.meshing import dialects
from railhead.meshing.dialects import NUMBER, SHOWN, InstrumentError, Table
from railhead.meshing.suffixes import BODIES

Array = NDArray[np.float64]
LEAST_POINTS = 12
BLANKS = r"[\s,;]+"


def read(path: Path, overruled: bool = False) -> Table:
    """The points of a file; overruled: as in `dialects.table`. Raises InstrumentError, OSError."""
    lines, suffix = _text(path).splitlines(), path.suffix.lower()
    found = _read(path.name, lines, suffix, overruled)
    if len(found.points) < LEAST_POINTS:
        text = f"ends after {len(found.points)} points; give at least {LEAST_POINTS}"
        raise InstrumentError(path.name, len(lines), text)
    return found


def _read(name: str, lines: Sequence[str], suffix: str, overruled: bool) -> Table:
    if suffix not in BODIES:
        return dialects.table(name, lines, overruled)
    instrument = _miniprof if suffix in (".ban", ".whl") else _simpack
    found = instrument(name, lines)
    if found.body and found.body != BODIES[suffix]:
        text = f"the header says {found.body}; a {suffix} file is of a {BODIES[suffix]}"
        raise InstrumentError(name, 1, text)
    return replace(found, body=BODIES[suffix])


def _text(path: Path) -> str:
    data = path.read_bytes()
    marked = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    for coding in ("utf-16",) if marked else ("utf-8-sig", "latin-1"):
        try:
            text = data.decode(coding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise InstrumentError(path.name, 1, "is no text; give points as text")


def _miniprof(name: str, lines: Sequence[str]) -> Table:
    """Lines that begin with a quotation mark are commented out; XYPoints may count them too."""
    empty = next((i for i, line in enumerate(lines) if not line.strip()), len(lines))
    header = dict(line.split("=", 1) for line in lines[:empty] if "=" in line)
    if not header:
        text = "is no header; give MiniProf's lines key=value and an empty line before the points"
        raise InstrumentError(name, 1, text)
    points, where, out = _points(name, lines, empty, len(lines), '"!%#')
    names = [column.strip().upper() for column in header.get("ColumnDef", "X,Y").split(",")]
    columns = [names.index(column) for column in ("X", "Y") if column in names]
    if len(columns) < 2 or max(columns) >= points.shape[1]:
        columns = [0, 1]
    remarks = [f"{out} {'line' if out == 1 else 'lines'} commented out"] if out else []
    count = header.get("XYPoints", "").strip()
    if count.isdigit() and int(count) not in (len(points), len(points) + out):
        remarks.append(f"the header says {count} points")
    return Table(points[:, columns], "mm", "", "MiniProf", tuple(remarks), tuple(where))


def _simpack(name: str, lines: Sequence[str]) -> Table:
    """Keys until point.begin; the shifts, the rotation, the bounds and the mirrors that they ask
    for are done in this order, as Simpack does them."""
    where = {line.split("!")[0].strip(): i for i, line in enumerate(lines)}
    begin, end = where.get("point.begin"), where.get("point.end", -1)
    if begin is None:
        text = "ends without point.begin; give Simpack's sections"
        raise InstrumentError(name, max(len(lines), 1), text)
    if end < begin:
        text = "ends without point.end; give the whole file"
        raise InstrumentError(name, len(lines), text)
    keys: dict[str, tuple[int, str]] = {}
    for i, line in enumerate(lines[:begin]):
        key, equals, value = line.split("!")[0].partition("=")
        if equals:  # `type` comes twice: first in the header
            keys.setdefault(key.strip(), (i + 1, value.strip()))

    def number(key: str, default: float = 0.0) -> float:
        line, text = keys.get(key, (0, str(default)))
        if not NUMBER.fullmatch(text):
            raise InstrumentError(name, line, f"{key} = {text[:SHOWN]!r}; give a number")
        return float(text)

    points, where_points, out = _points(name, lines, begin + 1, end, "!")
    at = np.array(where_points)
    points = points[:, :2] + [number("shift.y"), number("shift.z")]
    turn = number("rotate") / number("units.ang.f", 1.0)
    c, s = math.cos(turn), math.sin(turn)
    points = points @ np.array([[c, s], [-s, c]])
    for axis, letter in enumerate("yz"):
        low, high = number(f"bound.{letter}.min", 1.0), number(f"bound.{letter}.max")
        if low < high:
            inside = (points[:, axis] >= low) & (points[:, axis] <= high)
            points, at = points[inside], at[inside]
        if number(f"mirror.{letter}"):
            points[:, axis] *= -1
    unit = {1000: "mm", 1: "m", 39: "inch"}.get(int(number("units.len.f", 1000.0)), "")
    body = {"0": "rail", "1": "wheel"}.get(keys.get("type", (0, ""))[1], "")
    done = [f"{key} done" for key in ("shift.y", "shift.z", "rotate", "mirror.y", "mirror.z")
            if number(key)]  # fmt: skip
    remarks = [f"{out} {'line' if out == 1 else 'lines'} commented out"] if out else []
    return Table(points, unit, body, "Simpack", (*remarks, *done), tuple(int(i) for i in at))


def _points(
    name: str, lines: Sequence[str], start: int, end: int, comment: str
) -> tuple[Array, list[int], int]:
    """Rows of numbers (n, m) between two lines, their lines, and how many were commented out."""
    rows, where, out = [], [], 0
    for i in range(start, end):
        line = lines[i].strip()
        if line and line[0] in comment:
            out += dialects.fields(line[1:].split("!")[0].strip(), BLANKS, ".") is not None
        elif line:
            row = dialects.fields(line.split("!")[0].strip(), BLANKS, ".")
            if row is None:
                text = f"{line[:SHOWN]!r} is no point; give two numbers y, z"
                raise InstrumentError(name, i + 1, text)
            rows.append(row)
            where.append(i + 1)
    if not rows:
        text = "no points follow; give two numbers y, z a line"
        raise InstrumentError(name, min(start + 1, len(lines)), text)
    width = min(map(len, rows))
    return np.array([row[:width] for row in rows]), where, out
