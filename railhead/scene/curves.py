"""Stress-strain curves in files: plastic strain and true stress (MPa), a row each."""

from __future__ import annotations

import csv

LEAST, MOST = 1e-6, 1e9  # MPa


def read(path: str) -> list[tuple[float, float]]:
    """The rows of a .csv file, a heading left out. Raises ValueError (one line) where there are
    less than two, a value is no number, the first strain is not 0, the strains do not grow, or the
    stress is not positive or falls (softening has no unique answer)."""
    found: list[tuple[float, float]] = []
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
        _check(path, number, (strain, stress), found)
        found.append((strain, stress))
    if len(found) < 2:
        raise ValueError(f"{path} has {len(found)} points; give at least two")
    return found


def _check(
    path: str, number: int, point: tuple[float, float], before: list[tuple[float, float]]
) -> None:
    strain, stress = point
    problem = ""
    if not before and strain != 0:
        problem = f"the first plastic strain is {strain:g}; give 0"
    elif before and not before[-1][0] < strain < float("inf"):
        problem = f"plastic strain {strain:g} does not grow; give ascending ones"
    elif not LEAST <= stress <= MOST:
        problem = f"stress {stress:g} is not allowed; give one from {LEAST:g} to {MOST:g} MPa"
    elif before and stress < before[-1][1]:
        problem = f"stress {stress:g} falls; give one that does not"
    if problem:
        raise ValueError(f"{path}, line {number}: {problem}")
