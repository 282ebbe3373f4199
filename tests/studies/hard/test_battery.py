"""The quick part of the battery of hard cases; `railhead study hard-cases` runs all of it."""

import math

import pytest

from studies.hard.case import CaseErrors, Deviation, HardCase
from studies.hard.hard_cases import QUICK


@pytest.mark.slow
@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.key)
def test_hard_case_keeps_its_rule(case: HardCase) -> None:
    found = case.solve()
    assert case.fault(found) == "", found


RIGHT = {"max_MPa": Deviation(0.005, 0.01), "area_mm2": Deviation(0.009, 0.01)}


def measured(**changes) -> CaseErrors:
    return CaseErrors(**{"deviations": RIGHT, "newton": 4, "krylov": 40} | changes)


@pytest.mark.parametrize(
    "rule, found, fault",
    [
        ({}, measured(), ""),
        ({}, measured(deviations={}), "held against nothing"),
        ({}, measured(deviations=RIGHT | {"x": Deviation(0.02, 0.01)}), "x off by 0.02"),
        ({}, measured(deviations={"x": Deviation(math.nan, 0.01)}), "x off by nan"),
        ({}, measured(deviations={"x": Deviation(0.1, 0.0)}), "x off by 0.1"),
        ({}, measured(failed=("flux_rail",)), "failed: flux_rail"),
        ({}, measured(newton=11), "11 Newton steps"),
        ({"krylov": 9}, measured(), "10 Krylov iterations"),
        ({"refusable": True}, measured(failed=("flux_rail",)), ""),
        ({"refusable": True}, measured(deviations={"x": Deviation(0.2, 0.1)}), "x off by 0.2"),
        ({"known": "flux_rail"}, measured(failed=("converged", "flux_rail")), ""),
        ({"known": "flux_rail"}, measured(failed=("converged",)), "flux_rail should fail"),
        ({"known": "flux_rail"}, measured(), "flux_rail should fail; status 0"),
        ({"known": "load:"}, measured(failed=("load: 5 makes a patch",)), ""),
    ],
)
def test_every_part_of_the_rule_can_fail(rule, found: CaseErrors, fault: str) -> None:
    said = HardCase("group", "name", "reason", "reference", lambda: found, **rule).fault(found)
    assert (fault in said) if fault else not said
