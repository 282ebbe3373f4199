"""Tables of numbers in text files: their rows, and what a header says of columns and units.

Separator and decimal mark are those with which the most lines are rows of numbers; of a long file
only some 50 lines are tried. A header line tells order and unit of the columns that a reader
wants. Without one there are as many columns as it wants, in its order and its own units.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")
COMMENT = re.compile(r"[#%!;*]|//")
UNIT_LINE = re.compile(r"\bunits?\b[ \t:=]*([^\W\d_]+)", re.IGNORECASE)
UNIT_IN_NAME = (r"\[(.*?)\]", r"\((.*)\)", r"[/_]\s*([^\W_][^_\s]*|°)\s*$")  # y [mm], (mm), _mm
LARGEST = 1e12  # of any unit: no table has such a number
LONGEST = 10_000  # characters of a line, at most
SHOWN = 40  # characters of a wrong line that a message repeats

BLANKS = r"\s+"
SOME = 50  # lines that tell the layout of a table, at most about
#: Separator (regular expression), decimal mark and name, in the order in which they are tried.
LAYOUTS = (
    (";", ".", "semicolons"),
    (";", ",", "semicolons, decimal commas"),
    ("\t", ".", "tabs"),
    ("\t", ",", "tabs, decimal commas"),
    (r",\s+", ",", "commas and blanks, decimal commas"),
    (",", ".", "commas"),
    (BLANKS, ".", "blanks"),
    (BLANKS, ",", "blanks, decimal commas"),
)
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
OTHER_UNITS = (
    *("km", "dm", "nm", "yd", "yard", "yards", "mil", "mils", "px", "deg", "°", "rad", "%"),
    *("n", "kn", "pa", "kpa", "mpa", "gpa", "psi", "ksi", "s", "kg"),
)


class FormatError(ValueError):
    """A file is not such a table. The message names the file, the line and what is allowed."""

    def __init__(self, name: str, line: int, text: str) -> None:
        """Message of the file name, the line number and the text."""
        super().__init__(f"{name}, line {line}: {text}")


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column that a reader wants.
    name: for messages.
    named: regular expression of the names that a header may give it: small letters, words parted by
        blanks, without unit.
    unit: in which it is wanted, and which a header without units means.
    factor: of a unit's name, how many `unit` it has; None for one of another kind.
    """

    name: str
    named: str
    unit: str
    factor: Callable[[str], float | None]


def mm_of(unit: str) -> float | None:
    """Millimetres in a unit of length; None for another name."""
    return MM_OF_UNIT.get(UNIT_OF_NAME.get(unit.lower(), ""))


@dataclass(frozen=True, kw_only=True)
class Table:
    """Numbers of the wanted columns of a file.
    layout: name of its separator and decimal mark.
    lines: (n,) line number of each row.
    rows: (n, k) numbers in the order in which columns are wanted, in the units of the file.
    units: (k,) unit of each column by the header, '' where it states none.
    at: number of the line that tells units, else of the first row.
    """

    layout: str
    lines: tuple[int, ...]
    rows: tuple[tuple[float, ...], ...]
    units: tuple[str, ...]
    at: int


def lines_of(path: Path) -> list[str]:
    """Lines of a file in UTF-16 with a mark, UTF-8 or Latin-1. Raises FormatError for binary
    content, a line of more than 10 000 characters (LONGEST), and what is no regular file, OSError
    where it cannot be read.
    """
    if path.exists() and not path.is_file():
        raise FormatError(path.name, 1, "is no regular file; give one")
    data = path.read_bytes()
    marked = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        text = data.decode("utf-16" if marked else "utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\0" in text:
        raise FormatError(path.name, 1, "is no text; give points as text")
    lines = text.splitlines()
    for number, line in enumerate(lines, 1):
        if len(line) > LONGEST:
            text = f"has {len(line)} characters; give {LONGEST} at most, and each row its line"
            raise FormatError(path.name, number, text)
    return lines


def numbers(line: str, separator: str, decimal: str) -> list[float] | None:
    """Numbers with which a line begins, up to the first cell that is no number; None if there are
    fewer than two, or one is 1e12 (LARGEST) or more.
    separator: regular expression between cells; decimal: '.' or ','.
    """
    found: list[float] = []
    cells = line.split() if separator == BLANKS else re.split(separator, line.strip())
    for cell in cells:
        text = cell.strip(" \"'")
        if decimal == ",":
            text = "?" if "." in text else text.replace(",", ".")
        if not NUMBER.fullmatch(text):
            break
        found.append(float(text))
    return found if len(found) >= 2 and max(map(abs, found)) < LARGEST else None


def rows_of(
    name: str,
    lines: Sequence[str],
    span: range,
    layout: tuple[str, str],
    comment: re.Pattern[str],
    what: str = "two numbers y, z",
) -> tuple[list[list[float]], tuple[int, ...]]:
    """Rows of numbers, one for each line of a span that is not empty or commented out, and the line
    number of each row (n,).
    name: file name, for messages.
    span: indices of the lines.
    layout: separator (regular expression) and decimal mark.
    comment: what begins a comment line. what: the numbers of a row, for messages.
    Raises FormatError for a line that is no row, and where there is none.
    """
    rows, where = [], []
    for i in span:
        line = lines[i].strip()
        if not line or comment.match(line):
            continue
        row = numbers(line, *layout)
        if row is None:
            text = f"{line[:SHOWN]!r} is no point; give {what}, or begin a comment with "
            raise FormatError(name, i + 1, f"{text}{'#' if comment is COMMENT else '!'}")
        rows.append(row)
        where.append(i + 1)
    if not rows:
        text = f"no points follow; give {what} a line"
        raise FormatError(name, max(min(span.start + 1, len(lines)), 1), text)
    return rows, tuple(where)


def columns_of(
    name: str, rows: Sequence[Sequence[float]], at_lines: Sequence[int], columns: Sequence[int]
) -> tuple[tuple[float, ...], ...]:
    """Numbers of some columns of the rows. Raises FormatError for a row that is too short.
    name, at_lines: file name, and line number of each row, for messages.
    columns: their indices.
    """
    for line, row in zip(at_lines, rows, strict=True):
        if len(row) <= max(columns):
            text = f"has no number in column {max(columns) + 1}; give as many as in other lines"
            raise FormatError(name, line, text)
    return tuple(tuple(row[column] for column in columns) for row in rows)


def read(name: str, lines: Sequence[str], *wanted: Sequence[Column], titles: bool = False) -> Table:
    """The table in the lines of a text file, with the columns that its header names, or its only
    ones.
    name: file name, for messages.
    wanted: columns; of several choices the first one that a line names. Without a header the first.
    titles: whether lines before the rows may say anything; else they name the columns, or are
        comments without brackets.
    Raises FormatError for lines that are no rows, and columns that are unclear.
    """
    full = [(i, line.strip()) for i, line in enumerate(lines) if line.strip()]
    data = [(i, line) for i, line in full if not COMMENT.match(line)]
    some = [line for _, line in data[:: 1 + len(data) // SOME]]
    separator, decimal, words = max(
        LAYOUTS, key=lambda each: sum(numbers(line, *each[:2]) is not None for line in some)
    )
    start = next((i for i, line in data if numbers(line, separator, decimal)), len(lines))
    names = [column.name for column in wanted[0]]
    what = f"{'two' if len(names) == 2 else 'three'} numbers {', '.join(names)}"
    rows, at_lines = rows_of(
        name, lines, range(start, len(lines)), (separator, decimal), COMMENT, what
    )
    header = [(i + 1, line) for i, line in full if i < start]
    count = max(map(len, rows))
    named = _named(name, header, separator, count, wanted)
    spoken = [line for i, line in full if i < start and (not COMMENT.match(line) or "[" in line)]
    title = "" if titles else " ".join(spoken)
    if not named and (title or count > len(wanted[0])):
        text = f"{title[:SHOWN]!r} does not name them" if title else f"has {count} columns"
        text += f"; give a header line that names {' and '.join(names)}"
        raise FormatError(name, start + 1, text)
    at, columns, units = named or (start + 1, range(len(wanted[0])), [""] * len(wanted[0]))
    stated = [match[1] for _, line in header if (match := UNIT_LINE.search(line))]
    return Table(
        layout=words,
        lines=at_lines,
        rows=columns_of(name, rows, at_lines, columns),
        units=tuple(units if any(units) else stated[:1] * len(units) or units),
        at=at,
    )


def in_units(name: str, table: Table, wanted: Sequence[Column]) -> Iterator[tuple[float, ...]]:
    """Rows of a table in the units in which its columns are wanted; name: of the file. Raises
    FormatError for a unit of another kind, and for one that some columns of a kind state alone.
    """
    factors = [
        column.factor(unit) if unit else 1.0
        for column, unit in zip(wanted, table.units, strict=True)
    ]
    stated = {column.unit for column, unit in zip(wanted, table.units, strict=True) if unit}
    for column, unit, factor in zip(wanted, table.units, factors, strict=True):
        if factor is None or (not unit and column.unit in stated):
            text = f"is in {unit[:SHOWN]!r}" if unit else "has no unit, and others have"
            text = f"{column.name} {text}; give it in {column.unit or 'numbers'}"
            raise FormatError(name, table.at, text)
    for row in table.rows:
        yield tuple(a * b for a, b in zip(row, factors, strict=True) if b is not None)


def _named(
    name: str,
    header: Sequence[tuple[int, str]],
    separator: str,
    count: int,
    wanted: Sequence[Sequence[Column]],
) -> tuple[int, list[int], list[str]] | None:
    """Number of the last header line that names all columns of a choice, their indices, and their
    units ('': none). None where no line does.
    name: file name, for messages.
    header: (line number, text) of each line before the rows.
    separator: regular expression between cells. count: number of columns of the rows.
    Raises FormatError where the line names one of them twice, or fewer than `count` columns.
    """
    below: list[str] = []
    for at, line in reversed(header):
        bare = re.sub(r"(?<!\s)\s+(?=[\[(])", "", line.lstrip("#%!;*/ ")).strip()
        cells = [cell.strip(" \"'") for cell in re.split(separator, bare)]
        for choice in wanted:
            known = [_split(cell, choice) for cell in cells]
            found = [
                [i for i, (word, _) in enumerate(known) if re.fullmatch(column.named, word)]
                for column in choice
            ]
            if not all(found):
                continue
            if len(cells) < count or any(len(each) > 1 for each in found):
                what = " and one ".join(column.name for column in choice)
                text = f"names several columns alike, or fewer than the {count} of the points; "
                raise FormatError(name, at, f"{text}give a header that names one {what}")
            columns = [each[0] for each in found]
            units = [known[i][1] for i in columns]
            if not any(units) and len(below) == len(cells):  # names, then units
                units = [_split(f"/{below[i].strip('[]()')}", choice)[1] for i in columns]
            return at, columns, units
        below = cells
    return None


def _split(cell: str, choice: Sequence[Column]) -> tuple[str, str]:
    """Name, in small letters, and unit of a cell of a header. In square brackets is a unit, else
    what one of the columns knows as such, or another one (OTHER_UNITS).
    """
    for pattern in UNIT_IN_NAME:
        match = re.search(pattern, cell)
        unit = match[1].strip() if match else ""
        known = unit.lower() in OTHER_UNITS or any(column.factor(unit) for column in choice)
        if match and (match[0][0] == "[" or known):
            return _words(cell[: match.start()]), unit if unit not in ("-", "1") else ""
    return _words(cell), ""


def _words(text: str) -> str:
    """The words of a text in small letters, parted by blanks."""
    return " ".join(re.split(r"[\W_]+", text.lower())).strip()
