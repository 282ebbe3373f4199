"""Stress-strain curves in files: plastic strain and true stress (MPa), a row each."""

from __future__ import annotations

import csv
import math

MIN_STRESS, MAX_STRESS = 1e-6, 1e9  # MPa


def read(path: str) -> list[tuple[float, float]]:
    """Points (plastic strain, true stress in MPa) of a .csv file; a heading is left out.

    Raises ValueError (one line) for less than two points, a value that is no number, a first strain
    other than 0, strains that do not increase, and a stress out of range or below the one before it
    (softening has no unique answer).
    """
    points: list[tuple[float, float]] = []
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = list(csv.reader(file))
    except (UnicodeDecodeError, csv.Error):
        raise ValueError(f"{path} is no text; give plastic strain and stress, a row each") from None
    for number, row in enumerate(rows, 1):
        if not any(cell.strip() for cell in row):
            continue
        try:
            strain, stress = map(float, row)
        except ValueError:
            if number == 1:
                continue  # a heading
            raise ValueError(
                f"{path}, line {number}: {','.join(row)!r} is not a plastic strain and a "
                "stress; give two numbers"
            ) from None
        _check(path, number, (strain, stress), points)
        points.append((strain, stress))
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
