"""Which columns of a table are across and up: by their names, else by what runs beside what."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ACROSS = ("y", "lateral", "lat", "across", "quer")
UP = ("z", "height", "vertical", "vert", "hoehe", "höhe", "elevation", "elev", "depth", "tiefe")
ALONG = "x"  # beside z; without it x is across and y up
NOMINAL = re.compile(r"nom|soll|ref|theo|target|design")  # columns of what should be
OTHER = re.compile(r"(?<!\w)(phi|theta|alpha|angle|winkel)|diam|durchmesser")  # no y, no z
VALUE = re.compile(r"[+-]?\.?\d")  # no name: a line of a key and its value
RUNS = 0.9  # of the way up and down a column that it goes from end to end: it runs one way
SECTION = 0.1  # of the way across that the points of one section go along the rail, at most
NUMBERED = 150  # points and more are no whole millimetres across a wheel, ...
EVEN, WIDE = 3.0, 25.0  # nor is what goes beside them in steps as even, and as far, a height
SCATTER = 1.0  # mean square of steps over the variance: 2 of random numbers


class ColumnError(ValueError):
    """No two columns are surely y and z; at: the line that heads them, 0 where none does."""

    def __init__(self, at: int, text: str) -> None:
        super().__init__(f"{text}; give a header that names y and z")
        self.at = at


def chosen(header: Sequence[tuple[int, Sequence[str]]], rows: Array) -> tuple[int, int, int]:
    """Columns of y and z, and the line that names them, 0 where none does. header: lines before the
    points, as number and cells; rows (n, m). Raises ColumnError where others could be meant."""
    lines = [(at, [cell.strip("\"' ").lower() for cell in cells]) for at, cells in header]
    lines = [(at, names) for at, names in lines if not any(map(VALUE.match, names))]
    lines.reverse()  # what stands above is about something else
    for way in (_both_named, _one_named):
        for at, names in lines:
            if found := way(at, names, rows):
                for column in found:
                    if len(names) > column and OTHER.search(names[column]):
                        raise ColumnError(at, f"heads an angle or a diameter, {names[column]!r}")
                return *found, at
    return *_unnamed(rows), 0


def _known(names: Sequence[str]) -> tuple[list[str], list[int], list[int]]:
    """First words of names, '' of nominal ones, and which of them are y and which z."""
    heads = ["" if NOMINAL.search(name) else re.split(r"\W|_", name)[0] for name in names]
    across, up = ([i for i, head in enumerate(heads) if head in each] for each in (ACROSS, UP))
    return heads, across, up


def _both_named(at: int, names: Sequence[str], rows: Array) -> tuple[int, int] | None:
    """Where a line names one y and one z. Raises ColumnError where x may be across, too."""
    heads, across, up = _known(names)
    if len(across) != 1 or len(up) != 1:
        return None
    present = range(rows.shape[1])
    along = [i for i in present if heads[i] == ALONG] if across[0] in present else []
    for column in along:
        if _runs(rows[:, column]) and _far(rows, column, across[0]):
            if _runs(rows[:, across[0]]) or _far(rows, across[0], column):
                text = "names x and y, which both run, so that either may be across"
                raise ColumnError(at, text)
            return column, up[0]
    return across[0], up[0]


def _one_named(at: int, names: Sequence[str], rows: Array) -> tuple[int, int] | None:
    """Where a line has a word for each column, of which one is known. Raises ColumnError."""
    (heads, across, up), count = _known(names), rows.shape[1]
    if len(names) != count:
        return None  # words
    if count == 2:
        return (0, 1) if any(map(OTHER.search, names)) else None
    if max(len(across), len(up)) > 1:
        raise ColumnError(at, "names several columns across, or up")
    if up:  # which stands beside it
        return (up[0] - 1, up[0]) if up[0] else (1, 0)
    if across and heads.count(ALONG) == 1:
        return heads.index(ALONG), across[0]
    real = [i for i in range(count) if not NOMINAL.search(names[i])]
    if across:
        beside = [(across[0] + i) % count for i in range(1, count)]
        height = next((i for i in beside if i in real), beside[0])
        _check_height(at, across[0], height, rows)
        return across[0], height
    if len(real) < count:
        if len(real) != 2:
            raise ColumnError(at, "names nominal columns, and not two others")
        return real[0], real[1]
    return None


def _unnamed(rows: Array) -> tuple[int, int]:
    """The first two, or those behind a running number. Raises ColumnError."""
    if rows.shape[1] < 3:
        return 0, 1
    left, right = rows[:, 0], rows[:, 1]
    found = 0, 1
    if _runs(left) and _runs(right):
        steps = np.abs(np.diff(right))
        across_it = steps.max() < EVEN * np.median(steps) and steps.sum() >= WIDE
        counts = left[0] in (0, 1) and (np.diff(left) == 1).all()
        if not (counts and (len(left) > NUMBERED or across_it)):
            raise ColumnError(0, "begins two columns that run one way, so that either may be y")
        found = 1, 2
    _check_height(0, *found, rows)
    return found


def _check_height(at: int, across: int, up: int, rows: Array) -> None:
    """Raises ColumnError where what stands beside y is constant or scatters."""
    z = rows[np.argsort(rows[:, across], kind="stable"), up]
    if np.mean(np.diff(z) ** 2) >= SCATTER * np.var(z):
        raise ColumnError(at, f"has no height in column {up + 1}: it is constant or scatters")


def _far(rows: Array, column: int, other: int) -> bool:
    """Whether a column goes farther than that of the other that belongs to one section."""
    return bool(np.ptp(rows[:, column]) > SECTION * np.ptp(rows[:, other]))


def _runs(column: Array) -> bool:
    return bool(abs(column[-1] - column[0]) > RUNS * float(np.abs(np.diff(column)).sum()))
