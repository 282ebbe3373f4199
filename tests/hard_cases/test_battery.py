"""The quick part of the battery of hard cases; `railhead study hard-cases` runs all of it."""

import pytest

from cases.hard.battery import CASES, QUICK
from cases.hard.case import Case, Measured


@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.key)
def test_hard_case_keeps_its_rule(case: Case) -> None:
    found = case.solve()
    assert case.fault(found) == "", found


def test_few_rules_are_known_limits() -> None:
    ruled = [case for case in CASES.values() if case.ruled]
    assert sum(bool(case.known) for case in ruled) <= 0.05 * len(ruled)


@pytest.mark.parametrize(
    "found, fault",
    [
        (Measured(0.005), ""),
        (Measured(0.02), "deviation"),
        (Measured(float("nan")), "deviation"),
        (Measured(0.0, balance=2e-6), "balance"),
        (Measured(0.0, balance=float("nan")), "balance"),
        (Measured(0.0, converged=False), "not converged"),
        (Measured(0.0, newton=11), "11 Newton steps"),
    ],
)
def test_every_part_of_the_rule_can_fail(found: Measured, fault: str) -> None:
    case = Case("group", "name", "reason", "reference", 0.01, lambda: found)
    assert (fault in case.fault(found)) if fault else not case.fault(found)
