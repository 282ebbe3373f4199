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
    hardens = bool(case["H_over_E"])
    assert verdict(increments, forward, 1.0, 1e-7, hardens=hardens) == expected
    assert verdict(increments[:2], forward[:2], 1.0, 1e-7, hardens=hardens) == "undecided"
    for count in range(3, 10):  # nothing else is ever said for sure before
        early = verdict(increments[:count], forward[:count], 1.0, 1e-7, hardens=hardens)
        assert early in (expected, "undecided")


def test_nothing_that_yields_is_elastic():
    assert verdict([0.0], [0.0], 1.0, 1e-7, hardens=False) == "elastic"
    assert verdict([1e-3, 0.0], [0.0, 0.0], 1.0, 1e-7, hardens=False) == "undecided"
    assert verdict([1e-3, 0.0, 0.0], [0.0, 0.0, 0.0], 1.0, 1e-7, hardens=False) == "shakes down"
    assert verdict([1e-3, 0.0, 1e-3], [0.0, 0.0, 0.0], 1.0, 1e-7, hardens=False) != "shakes down"


@pytest.mark.parametrize(
    "forward",
    [[0.00357, -0.00091, -0.00118, -0.00062], [0.00357, 0.0050, 0.0065, 0.0081]],
    ids=["turns", "grows"],
)
def test_a_surface_that_still_turns_or_grows_is_undecided(forward):
    """Kinematic hardening at 5 k in contact: the fourth pass looked like ratchetting."""
    increments = [0.01198, 0.01413, 0.01322, 0.01314]
    for hardens in (True, False):
        assert verdict(increments, forward, 1.0, 1e-7, hardens=hardens) == "undecided"


@pytest.mark.parametrize(
    ("last", "perfect"), [(0.0101, "ratchets"), (0.0096, "at the limit")], ids=["steady", "falls"]
)
def test_what_hardens_without_end_neither_ratchets_nor_is_at_a_limit(last, perfect):
    increments, forward = [0.011, 0.0105, 0.0102, last], [0.02, 0.011, 0.0108, 0.0106]
    assert verdict(increments, forward, 1.0, 1e-7, hardens=False) == perfect
    assert verdict(increments, forward, 1.0, 1e-7, hardens=True) == "undecided"


def test_a_surface_that_still_moves_is_no_closed_cycle_of_perfect_plasticity():
    """At 1.03 of the limit with traction 0.3 p, which ratchets from the sixth pass on."""
    increments = [0.000728, 0.000713, 0.000733, 0.000767]
    forward = [0.000685, 0.000553, 0.000465, 0.000406]
    assert verdict(increments, forward, 1.0, 1e-7, hardens=False) == "undecided"
    assert verdict(increments, forward, 1.0, 1e-7, hardens=True) == "closed cycles"
    assert verdict(increments, [*forward[:3], 1e-6], 1.0, 1e-7, hardens=False) == "closed cycles"
