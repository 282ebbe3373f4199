"""Statements of the thesis, checks of them, and the rule that turns checks into a verdict.

A rule computes the checks of one claim; the verdict follows from their grades. Where a claim cannot
be computed, why is typed.
"""

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum, StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from studies.thesis.facts import Facts

EXACT = 1e-3  # relative difference that passes as rounding
CLOSE = 2e-2  # relative difference of an approximation
SOLVED = 1e-2  # more that a number may differ from finite elements: their bodies are no half-spaces
CLOSE_CURVE = 0.1  # the same of a drawn curve, relative to the pressure


class Verdict(StrEnum):
    """What the checks say about a claim."""

    CORRECT = "correct"
    APPROXIMATE = "approximate"
    PARTLY = "partly correct"
    INCONSISTENT = "inconsistent"
    WRONG = "wrong"
    OPEN = "not computable"


#: Verdict by the first word of the reference's.
EXPECTED = {
    "correct": Verdict.CORRECT,
    "good": Verdict.APPROXIMATE,
    "approximate": Verdict.APPROXIMATE,
    "partly": Verdict.PARTLY,
    "unsimplified": Verdict.PARTLY,
    "inconsistent": Verdict.INCONSISTENT,
    "wrong": Verdict.WRONG,
    "not": Verdict.OPEN,
    "unsupported": Verdict.OPEN,
    "ambiguous": Verdict.OPEN,
}


class Grade(IntEnum):
    """Outcome of one check; CONTRADICTS: fails against another number of the thesis itself."""

    CONTRADICTS = -1
    FAILS = 0
    CLOSE = 1
    HOLDS = 2


@dataclass(frozen=True)
class Claim:
    """One statement of the thesis.

    id: its number in the table of claims.
    where: chapters in which it appears.
    claim: the statement in words.
    printed: its number or formula as printed.
    expected: verdict of the reference table.
    """

    id: int
    where: str
    claim: str
    printed: str
    expected: str

    @property
    def expected_verdict(self) -> Verdict:
        """Verdict of the reference table as a `Verdict`, by the first word of it."""
        return EXPECTED[self.expected.split()[0]]

    @property
    def chapter(self) -> str:
        """Number of the first chapter that the claim appears in; 'all' for the work as a whole."""
        return next((letter for letter in self.where if letter.isdigit()), "all")


@dataclass(frozen=True)
class ClaimCheck:
    """A value of the thesis beside the exact one.

    what: name of the quantity.
    thesis: value of the thesis.
    exact: exact value.
    grade: how near both are.
    unit: unit of the values.
    ours: value of finite elements or of another computation; None: there is none.
    """

    what: str
    thesis: float | str
    exact: float | str
    grade: Grade
    unit: str = ""
    ours: float | str | None = None


@dataclass(frozen=True)
class Finding:
    """What was computed about a claim.

    checks: values of the thesis beside the exact ones.
    note: a remark.
    not_computable: why the claim cannot be computed; empty if it can.
    effect: largest relative effect of an error on the results; None: not known.
    """

    checks: Sequence[ClaimCheck]
    note: str = ""
    not_computable: str = ""
    effect: float | None = None

    @property
    def verdict(self) -> Verdict:
        """All checks hold: correct, or approximate where one is only close; some fail: partly
        correct; all: wrong; inconsistent where none holds and one contradicts the thesis itself."""
        grades = [check.grade for check in self.checks]
        if self.not_computable or not grades:
            return Verdict.OPEN
        if min(grades) > Grade.FAILS:
            return Verdict.CORRECT if min(grades) == Grade.HOLDS else Verdict.APPROXIMATE
        if Grade.CONTRADICTS in grades and Grade.HOLDS not in grades:
            return Verdict.INCONSISTENT
        return Verdict.PARTLY if max(grades) > Grade.FAILS else Verdict.WRONG

    @property
    def harmless(self) -> bool:
        """Whether the results stay within rounding in spite of the error."""
        return self.effect is not None and self.effect < EXACT


Rule = Callable[[Facts], Finding]
"""Computes the checks of one claim."""


def number(
    what: str, thesis: float | str, exact: float, unit: str = "", ours: float | None = None
) -> ClaimCheck:
    """Check of a number of the thesis. As printed (a string) it holds within half a unit of its
    last digit, too. Where there are finite elements (ours), the worse of both grades counts."""
    value = float(thesis)
    grade = grade_number(value, exact)
    if isinstance(thesis, str) and abs(value - exact) <= half_last_digit(thesis):
        grade = Grade.HOLDS
    if ours is not None:
        grade = min(grade, grade_number(value, ours, SOLVED))
    return ClaimCheck(what, value, exact, grade, unit, ours)


def grade_number(value: float, exact: float, more: float = 0.0) -> Grade:
    """HOLDS within EXACT (and `more`) of the exact value, CLOSE within CLOSE (and `more`) of it."""
    if math.isclose(value, exact, rel_tol=EXACT + more, abs_tol=1e-12):
        return Grade.HOLDS
    return Grade.CLOSE if math.isclose(value, exact, rel_tol=CLOSE + more) else Grade.FAILS


def half_last_digit(printed: str) -> float:
    """Half a unit of the last digit of a printed number, a little widened against rounding."""
    mantissa, _, exponent = printed.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 0.5000001 * 10.0 ** (int(exponent or 0) - decimals)


def equation(
    what: str, printed: ArrayLike, exact: ArrayLike, ours: ArrayLike | None = None
) -> ClaimCheck:
    """Check of an equation by the values of its sides; it shows the largest difference of their
    entries. ours: values of the exact side by another computation."""
    off = _apart(printed, exact)
    grade = Grade.HOLDS if off < 1e-9 else Grade.FAILS
    text = "equal" if grade == Grade.HOLDS else f"off by {off:.3g}"
    agrees = None if ours is None else f"{_apart(ours, exact):.0e} from exact"
    return ClaimCheck(what, text, "-", grade, "", agrees)


def statement(
    what: str,
    thesis: float | str,
    exact: float | str,
    holds: bool,
    unit: str = "",
    ours: float | str | None = None,
) -> ClaimCheck:
    """Check of something that holds or not, with the numbers that show it."""
    return ClaimCheck(what, thesis, exact, Grade.HOLDS if holds else Grade.FAILS, unit, ours)


def itself(what: str, printed: str, implied: float, unit: str = "") -> ClaimCheck:
    """Check of a printed number against what the thesis's own numbers imply."""
    agrees = abs(float(printed) - implied) <= half_last_digit(printed)
    return ClaimCheck(
        what, float(printed), implied, Grade.HOLDS if agrees else Grade.CONTRADICTS, unit
    )


def read_claims() -> list[Claim]:
    """All claims in the order of their numbers."""
    with (Path(__file__).parent / "data" / "claims.csv").open(newline="", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [Claim(int(row.pop("id")), **row) for row in rows]


def _apart(one: ArrayLike, other: ArrayLike) -> float:
    return float(np.max(np.abs(np.asarray(one, dtype=float) - np.asarray(other, dtype=float))))
