"""Files that keys of a scene name: whether they can be read, pairs of numbers in them, and arrays.

A scene names its files, so an array that a script gives is written once into the cache of the user,
under a name made of its content; from there it is read, and copied into the result folder, as any
other file.
"""

import math
import os
from collections.abc import Iterator
from contextlib import suppress
from hashlib import sha256
from numbers import Real
from pathlib import Path
from typing import Any

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
    """The absolute path of a readable file with one of some extensions, small letters with a dot.
    Raises ValueError (one line) for another value.
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


def is_array(value: object) -> bool:
    """Whether a value of a key is neither a word nor a path nor a number: an array, if anything."""
    return value is not None and not isinstance(value, str | os.PathLike | Real)


def file_of(value: Any, kind: str, *columns: str) -> str:
    """Absolute path of a .csv file with the rows of an array (n, 2); its name is `kind` and twelve
    digits of the content's SHA-256.

    columns: header of each column.
    Raises ValueError (one line) for anything else, numbers that are not finite, and a cache that
    cannot be written.
    """
    import numpy as np

    given = [] if hasattr(value, "magnitude") else value  # of pint: its unit would be lost
    try:
        rows = np.asarray(np.ma.filled(given, np.nan)).astype(float, casting="same_kind")
    except (TypeError, ValueError):
        rows = np.empty(0)
    if rows.ndim != 2 or rows.shape[1] != 2 or not np.isfinite(rows).all():
        text = f"an array of shape (n, 2), {' and '.join(columns)}, with finite numbers"
        raise ValueError(f"{show(value)} is not allowed; give {text}")
    lines = (",".join(map(repr, row)) for row in rows.tolist())
    content = "\n".join([",".join(columns), *lines, ""]).encode()
    path = cache_folder() / "arrays" / f"{kind}-{sha256(content).hexdigest()[:12]}.csv"
    try:
        if not path.is_file():
            path.parent.mkdir(parents=True, exist_ok=True)
            part = path.with_suffix(f".{os.getpid()}")
            part.write_bytes(content)
            part.replace(path)
    except OSError as error:
        raise ValueError(f"the array cannot be kept in {path}: {error.strerror}") from None
    return str(path)


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
