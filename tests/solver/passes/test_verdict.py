"""Verdicts on passes: those of an independent program's increments."""

import json
from pathlib import Path

import pytest

from railhead.solver.passes.verdict import verdict

LINE = json.loads((Path(__file__).parents[2] / "theory" / "data" / "passes.json").read_text())[
    "line"
]
EXPECTED = {
    (3.6, 0, 0): "shakes down",
    (4.0, 0, 0): "at the limit",
    (4.5, 0, 0): "ratchets",
    (5.0, 0.03, 0): "closed cycles",
    (3.1, 0, 0.2): "shakes down",
    (4.0, 0, 0.2): "ratchets",
}


@pytest.mark.parametrize("case", LINE, ids=lambda case: f"{case['p0_over_k']}-{case['traction']}")
def test_ten_passes_tell_all_and_two_tell_nothing(case):
    increments = [each["dq"] for each in case["passes"]]
    forward = [each["forward"] for each in case["passes"]]
    expected = EXPECTED[case["p0_over_k"], case["H_over_E"], case["traction"]]
    assert verdict(increments, forward, 1.0, 1e-7) == expected
    assert verdict(increments[:2], forward[:2], 1.0, 1e-7) == "undecided"
    for count in range(3, 10):  # nothing else is ever said for sure before
        early = verdict(increments[:count], forward[:count], 1.0, 1e-7)
        assert early in (expected, "undecided")


def test_nothing_that_yields_is_elastic():
    assert verdict([0.0], [0.0], 1.0, 1e-7) == "elastic"
    assert verdict([1e-3, 0.0], [0.0, 0.0], 1.0, 1e-7) == "undecided"
    assert verdict([1e-3, 0.0, 0.0], [0.0, 0.0, 0.0], 1.0, 1e-7) == "shakes down"
    assert verdict([1e-3, 0.0, 1e-3], [0.0, 0.0, 0.0], 1.0, 1e-7) != "shakes down"
