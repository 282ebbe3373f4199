"""Verdicts on passes: those of an independent program's increments."""

import json
from pathlib import Path

import pytest

from railhead.postprocess.pass_rows import verdict

LINE = json.loads((Path(__file__).parents[1] / "theory" / "data" / "passes.json").read_text())[
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


TURNS, GROWS = [0.00357, -0.00091, -0.00118, -0.00062], [0.00357, 0.0050, 0.0065, 0.0081]
FIFTH = [0.01198, 0.01413, 0.01322, 0.01314]  # at 5 k, kinematic, in contact
STEADY, FALLS = [0.011, 0.0105, 0.0102, 0.0101], [0.011, 0.0105, 0.0102, 0.0096]
MOVES = [0.02, 0.011, 0.0108, 0.0106]
# At 1.03 of the limit with traction 0.3 p, which ratchets from the sixth pass on.
CLOSE = [0.000728, 0.000713, 0.000733, 0.000767]
STILL_MOVES = [0.000685, 0.000553, 0.000465, 0.000406]
STANDS = [0.000685, 0.000553, 0.000465, 1e-6]
PERFECT, HARDENS = False, True
#: Increments of strain and of the surface's way, whether the steel hardens, what is said.
SAID = {
    "nothing yields": ([0.0], [0.0], PERFECT, "elastic"),
    "one pass without yield": ([1e-3, 0.0], [0.0] * 2, PERFECT, "undecided"),
    "two passes without yield": ([1e-3, 0.0, 0.0], [0.0] * 3, PERFECT, "shakes down"),
    "yields again": ([1e-3, 0.0, 1e-3], [0.0] * 3, PERFECT, "undecided"),
    "turns": (FIFTH, TURNS, PERFECT, "undecided"),
    "turns, hardens": (FIFTH, TURNS, HARDENS, "undecided"),
    "grows": (FIFTH, GROWS, PERFECT, "undecided"),
    "grows, hardens": (FIFTH, GROWS, HARDENS, "undecided"),
    "steady": (STEADY, MOVES, PERFECT, "ratchets"),
    "steady, hardens": (STEADY, MOVES, HARDENS, "undecided"),
    "falls": (FALLS, MOVES, PERFECT, "at the limit"),
    "falls, hardens": (FALLS, MOVES, HARDENS, "undecided"),
    "still moves": (CLOSE, STILL_MOVES, PERFECT, "undecided"),
    "still moves, hardens": (CLOSE, STILL_MOVES, HARDENS, "closed cycles"),
    "stands": (CLOSE, STANDS, PERFECT, "closed cycles"),
}


@pytest.mark.parametrize(("increments", "forward", "hardens", "said"), SAID.values(), ids=SAID)
def test_what_still_turns_grows_or_moves_is_no_steady_end(increments, forward, hardens, said):
    """What hardens without end neither ratchets nor is at a limit."""
    assert verdict(increments, forward, 1.0, 1e-7, hardens=hardens) == said
