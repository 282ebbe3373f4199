"""The rule that turns checks into verdicts."""

import pytest

from studies.thesis.claims import (
    ClaimCheck,
    Finding,
    Grade,
    Verdict,
    equation,
    itself,
    number,
    read_claims,
)


def finding(*grades: Grade) -> Finding:
    return Finding([ClaimCheck("x", 1.0, 1.0, grade) for grade in grades])


H, C, F, X = Grade.HOLDS, Grade.CLOSE, Grade.FAILS, Grade.CONTRADICTS


@pytest.mark.parametrize(
    ("grades", "verdict"),
    [
        ((H, H), Verdict.CORRECT),
        ((H, C), Verdict.APPROXIMATE),
        ((H, F), Verdict.PARTLY),
        ((C, F), Verdict.PARTLY),
        ((F, F), Verdict.WRONG),
        ((X,), Verdict.INCONSISTENT),
        ((C, X), Verdict.INCONSISTENT),
        ((H, X), Verdict.PARTLY),
        ((), Verdict.OPEN),
    ],
)
def test_verdict_follows_from_the_grades(grades, verdict) -> None:
    assert finding(*grades).verdict == verdict


def test_what_cannot_be_computed_has_no_verdict_whatever_its_checks() -> None:
    assert Finding(finding(H, F).checks, not_computable="garbled").verdict == Verdict.OPEN


@pytest.mark.parametrize(
    ("thesis", "exact", "grade"),
    [
        ("3.46", 3.4649, H),  # half a unit of the last digit
        (3.46, 3.4649, C),  # computed, not printed: 0.14 %
        ("3.46", 3.4652, C),
        (1.0, 1.0009, H),
        (1.0, 1.019, C),
        (1.0, 1.03, F),
        ("4.76e-4", 4.7619e-4, H),
        ("0", 1.0, F),
        (0.0, 0.0, H),
    ],
)
def test_grade_of_a_number(thesis, exact, grade) -> None:
    assert number("x", thesis, exact).grade == grade


def test_equations_and_self_contradictions() -> None:
    assert equation("x", [1, 2], [1, 2]).grade == H
    assert equation("x", [1, 2], [1, 2.1]).grade == F
    assert itself("x", "3.46", 3.4641).grade == H
    assert itself("x", "3.46", 3.4659).grade == X


def test_all_claims_are_read_in_order() -> None:
    claims = read_claims()
    assert [claim.id for claim in claims] == list(range(1, 90))
    assert {claim.chapter for claim in claims} == {"1", "2", "3", "4", "5", "6", "7", "all"}
    assert (claims[52].claim, claims[52].printed) == ("a", "4.34 mm")


@pytest.mark.parametrize(
    ("ours", "grade"), [(None, H), (1.0, H), (1.01, H), (0.985, C), (1.029, C), (0.96, F), (2.0, F)]
)
def test_finite_elements_can_overturn_a_number(ours, grade) -> None:
    assert number("x", 1.0, 1.0, ours=ours).grade == grade
