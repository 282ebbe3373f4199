"""Every claim of the thesis is judged, by finite elements too."""

import math
from dataclasses import replace

import pytest

from railhead.scene import catalogue
from railhead.theory.elastic.hertz import point_contact
from studies.thesis import geometry, hertz, stress, thesis_study
from studies.thesis.claims import (
    ClaimCheck,
    Finding,
    Grade,
    Verdict,
    equation,
    itself,
    number,
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
    assert equation("x", [1, 2], [1, 2]).grade == H and equation("x", [1, 2], [1, 2.1]).grade == F
    assert itself("x", "3.46", 3.4641).grade == H and itself("x", "3.46", 3.4659).grade == X


@pytest.mark.parametrize(
    ("ours", "grade"), [(None, H), (1.0, H), (1.01, H), (0.985, C), (1.029, C), (0.96, F), (2.0, F)]
)
def test_finite_elements_can_overturn_a_number(ours, grade) -> None:
    assert number("x", 1.0, 1.0, ours=ours).grade == grade


DIFFERENT: dict[int, Verdict] = {}
"""Claims whose computed verdict is not the reference's, with ours."""


@pytest.fixture(scope="module")
def facts():
    return thesis_study.facts(catalogue.find(thesis_study.CASE))


def test_every_claim_is_judged_as_the_reference_does(facts) -> None:
    judged = thesis_study.judge(facts)
    assert len(judged) == len(thesis_study.RULES) == 89
    assert sum(len(each.RULES) for each in (geometry, hertz, stress)) == 89  # one rule a claim
    assert {c.id: f.verdict for c, f in judged if f.verdict != c.expected_verdict} == DIFFERENT
    harmless = {claim.id for claim, _ in judged if "harmless" in claim.expected}
    assert harmless == {claim.id for claim, finding in judged if finding.harmless} == {32, 47, 49}


def test_curved_track_of_the_thesis(facts, reference) -> None:
    for row in reference["curved_track"]:
        _, k4, theta, p0 = facts.at_angle(row["phi_rad"])
        expected = (row["K4_per_mm"], row["theta_deg"], row["p0_MPa"])
        assert (k4, theta, p0) == pytest.approx(expected, rel=1e-9)


def test_verdicts_follow_the_numbers(facts) -> None:
    """Twice the load: the printed numbers of the patch are wrong; a circle: equal stresses."""
    c = facts.ellipse
    doubled = point_contact(c.curvature_x, c.curvature_y, c.contact_modulus, 2 * c.load)
    circle = point_contact(c.curvature_y, c.curvature_y, c.contact_modulus, c.load)
    for ellipse, expected in (
        (doubled, dict.fromkeys((53, 55, 85), Verdict.WRONG) | {43: Verdict.CORRECT}),
        (circle, {61: Verdict.CORRECT, 71: Verdict.CORRECT, 57: Verdict.WRONG, 44: Verdict.WRONG}),
    ):
        changed = replace(facts, ellipse=ellipse)
        assert {i: thesis_study.RULES[i](changed).verdict for i in expected} == expected


def test_touches_on_the_real_profiles(facts) -> None:
    """A cone on the crown arc touches where the arc has its slope."""
    touch = -300 * math.sin(math.atan(1 / 20) - math.atan(1 / 40))
    assert facts.profiles["y cone20 1:40"] == pytest.approx(touch, abs=1e-6)
    assert facts.profiles["s1002_radius"] == pytest.approx(-319.89, abs=0.01)
    assert facts.profiles["s1002_convex_from"] == pytest.approx(14.0, abs=0.1)


# Formulas as printed, and turns.
