"""Where steels yield: by name (data/steels.json, with sources), and by a curve in a file.

EN 13674-1 fixes strength and hardness of rail steels, not their yield: R260's was measured.
EN 13262 fixes the least yield strength of wheels. No hardening: no flow curve with a source was at
hand.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from railhead.scene.units import show

# steels of the standards without yield data here:
WITHOUT_DATA = ("R200", "R220", "R320Cr", "R350HT", "ER6", "ER9")
STEEL_MODULI = (180e3, 230e3)  # MPa, least and largest Young's modulus of a steel


@dataclass(frozen=True)
class Steel:
    """A steel without hardening.

    yield_stress: of uniaxial tension, MPa, at any plastic strain.
    kind: where the value comes from, in a few words.
    source: the publication.
    """

    yield_stress: float
    kind: str
    source: str


@cache
def by_name() -> dict[str, Steel]:
    """The steels of data/steels.json by name, read once."""
    text = (Path(__file__).parent / "data" / "steels.json").read_text(encoding="utf-8")
    return {name: Steel(**entry) for name, entry in json.loads(text).items()}


def is_steel(modulus: float) -> bool:
    """Whether a Young's modulus (MPa) lies in the range of steels, 180 to 230 GPa."""
    return STEEL_MODULI[0] <= modulus <= STEEL_MODULI[1]


def checked_name(value: object) -> str:
    """The argument, if it is the name of a steel in data/steels.json. Raises ValueError (one line)
    for anything else.
    """
    if isinstance(value, str) and value in by_name():
        return value
    allowed = f"give {', '.join(by_name())}"
    if value in WITHOUT_DATA:
        raise ValueError(f"no yield of {value} is known here; {allowed} or yield_stress")
    raise ValueError(f"{show(value)} is not allowed; {allowed}")


MIN_STRESS, MAX_STRESS = 1e-6, 1e9  # MPa


def read_pairs(path: str, first: str, second: str) -> Iterator[tuple[int, tuple[float, float]]]:
    """Numbers of the lines of a .csv file that hold pairs of numbers, and the pairs; a heading in
    the first line is left out. first, second: what the numbers are, for messages. Raises ValueError
    (one line) for a row that is not two numbers and for a file that is no text, OSError where it
    cannot be read.
    """
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = list(csv.reader(file))
    except (UnicodeDecodeError, csv.Error):
        raise ValueError(f"{path} is no text; give {first} and {second}, a row each") from None
    for number, row in enumerate(rows, 1):
        if not any(cell.strip() for cell in row):
            continue
        try:
            one, other = map(float, row)
        except ValueError:
            if number == 1:
                continue  # a heading
            text = f"{','.join(row)!r} is not a {first} and a {second}; give two numbers"
            raise ValueError(f"{path}, line {number}: {text}") from None
        yield number, (one, other)


def read_curve(path: str) -> list[tuple[float, float]]:
    """Points (plastic strain, true stress in MPa) of a .csv file; a heading in its first line is
    left out.

    Raises ValueError (one line) for fewer than two points, a row that is not two numbers, a first
    strain other than 0 and strains that do not increase. It raises it too for a stress out of range
    or below the one before it (softening has no unique answer), and for a file that is no text.
    Raises OSError where the file cannot be read.
    """
    points: list[tuple[float, float]] = []
    for number, pair in read_pairs(path, "plastic strain", "stress"):
        _check(path, number, pair, points)
        points.append(pair)
    if len(points) < 2:
        raise ValueError(f"{path} has {len(points)} points; give at least two")
    return points


def _check(
    path: str, number: int, point: tuple[float, float], before: list[tuple[float, float]]
) -> None:
    """Raise ValueError (one line) where a point (plastic strain, stress in MPa) cannot follow the
    points before it. path, number: file and line, for the message.
    """
    strain, stress = point
    last_strain, last_stress = before[-1] if before else (-math.inf, -math.inf)
    allowed = f"give one from {MIN_STRESS:g} to {MAX_STRESS:g} MPa"
    for wrong, problem in (
        (not before and strain != 0, f"the first plastic strain is {strain:g}; give 0"),
        (
            not last_strain < strain < math.inf,
            f"plastic strain {strain:g} does not grow; give ascending ones",
        ),
        (
            not MIN_STRESS <= stress <= MAX_STRESS,
            f"stress {stress:g} is not allowed; {allowed}",
        ),
        (stress < last_stress, f"stress {stress:g} falls; give one that does not"),
    ):
        if wrong:
            raise ValueError(f"{path}, line {number}: {problem}")
