"""Files that keys of a scene name: whether they can be read, and pairs of numbers in them."""

import math
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from railhead.geometry import tables
from railhead.geometry.tables import Column
from railhead.scene.units import FRACTION, STRESS, WEAR_RATE, QuantityKind, show, to_base

MIN_STRESS, MAX_STRESS = 1e-6, 1e9  # MPa, of a stress-strain curve
Pair = tuple[float, float]


def readable(path: str) -> bool:
    """Whether a path is a readable file whose name is valid Unicode, as TOML needs it."""
    is_text = path.encode(errors="ignore").decode() == path
    return is_text and os.path.isfile(path) and os.access(path, os.R_OK)


def existing(value: object, suffixes: tuple[str, ...]) -> str:
    """Absolute path of a file, of which is checked that it can be read and has one of the allowed
    suffixes. suffixes: small letters with the dot, such as ".csv"; the file's may be in capitals.
    Raises ValueError, with a text of one line, where this is not so.
    """
    path = os.path.abspath(str(value))
    if not path.lower().endswith(suffixes) or not readable(path):
        kind = " or ".join(suffixes)
        raise ValueError(f"{show(value)} is not a readable {kind} file; give one that exists")
    return path


def cache_folder() -> Path:
    """The folder of the program in the cache of the user, which need not exist."""
    root = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "railhead"


def _column(name: str, named: str, kind: QuantityKind, unit: str = "") -> Column:
    """A column of a kind of quantity, wanted in a unit; '': the kind's base unit."""

    def factor(text: str) -> float | None:
        """How many of the unit a text has; None for another kind."""
        with suppress(ValueError):
            return to_base(f"1 {text}", kind) / (to_base(f"1 {unit}", kind) if unit else 1.0)
        return None

    return Column(name=name, named=named, unit=unit or kind.unit, factor=factor)


CURVE = (
    _column(
        "plastic strain", "((true|equivalent) )?plastic strain|strain|ep(s|silon)?( p)?", FRACTION
    ),
    _column("stress", "((true|flow|yield) )?stress|sigma", STRESS),
)
"""Columns of a curve of plastic strain and true stress."""
TEST = (
    _column("strain", "((true|total|axial|engineering) )?strain|e(ps(ilon)?)?", FRACTION),
    _column("stress", "((true|axial|engineering) )?stress|s(igma)?", STRESS),
)
"""Columns of a test of a bar: its whole strain and its stress."""
LAW = (
    _column("T-gamma/A", "(t ?gamma|tγ)( (a|over the area|per area))?|density", STRESS, "N/mm2"),
    _column("rate", "(wear )?rate|mass|wear", WEAR_RATE),
)
"""Columns of a law of wear."""


def read_pairs(path: str, wanted: tuple[Column, Column]) -> Iterator[tuple[int, Pair]]:
    """Line numbers and pairs of numbers, in the wanted units, of a table in a file. Raises
    ValueError (one line) as `tables.read` and for first numbers that do not rise, OSError where it
    cannot be read.
    """
    file, last = Path(path), -math.inf
    table = tables.read(file.name, tables.lines_of(file), wanted)
    pairs = tables.in_units(file.name, table, wanted)
    for number, (one, other) in zip(table.lines, pairs, strict=True):
        if not last < one:
            text = f"{wanted[0].name} {one:g} does not rise; give rising ones"
            raise ValueError(f"{path}, line {number}: {text}")
        last = one
        yield number, (one, other)


def read_curve(path: str) -> tuple[Pair, ...]:
    """Points (plastic strain, true stress in MPa) of a .csv file, by its header in other units.

    Raises ValueError (one line) for fewer than two points, and for what `read_pairs` refuses. So it
    does for a first strain other than 0, and for a stress out of range or below the one before it
    (softening has no unique answer). Raises OSError where the file cannot be read.
    """
    points: list[Pair] = []
    least = MIN_STRESS
    for number, (strain, stress) in read_pairs(path, CURVE):
        if strain != 0 and not points:
            text = f"the first plastic strain is {strain:g}; give 0"
            raise ValueError(f"{path}, line {number}: {text}")
        if not least <= stress <= MAX_STRESS:
            allowed = f"give {least:g} to {MAX_STRESS:g} MPa, as it may not fall"
            raise ValueError(f"{path}, line {number}: stress {stress:g} is not allowed; {allowed}")
        points.append((strain, stress))
        least = stress
    if len(points) < 2:
        raise ValueError(f"{path} has {len(points)} points; give at least two")
    return tuple(points)


def read_test(path: str) -> list[Pair]:
    """Rows (strain, stress in MPa) of a test of a bar in a table, by its header in other units.
    Raises ValueError (one line) as `tables.read`, OSError where the file cannot be read.
    """
    file = Path(path)
    table = tables.read(file.name, tables.lines_of(file), TEST)
    return [(one, other) for one, other in tables.in_units(file.name, table, TEST)]


def wear_pairs(path: str) -> tuple[Pair, ...]:
    """Pairs of a law of wear in a .csv file: T-gamma over the area, N/mm2, positive and rising, and
    worn mass, ug per m and mm2, not negative, by its header in other units. Raises ValueError (one
    line) for other content.
    """
    found = []
    for number, (density, mass) in read_pairs(path, LAW):
        if not (density > 0 and mass >= 0):
            text = f"{density:g}, {mass:g} is not allowed; give T-gamma/A above 0 and rates of 0"
            raise ValueError(f"{path}, line {number}: {text} or more")
        found.append((density, mass))
    return tuple(found)
