"""Passes as people read them: the section below the middle, the table, and the verdict in words."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from railhead.postprocess.pass_rows import (
    Passes,
    RailState,
    extrapolated,
    rail_state,
    rate,
    verdict,
    words,
)
from railhead.solver.material import Hardening, Material
from railhead.solver.plasticity.block import Block
from railhead.solver.plasticity.rolling_block import RollingBlock


def test_below_the_middle_are_means_of_the_nearest_points():
    stress, strain = np.arange(36.0).reshape(3, 2, 6), np.arange(6.0).reshape(3, 2)
    state = RailState(
        y=np.array([-0.1, 0.1, 0.3]),
        depth=np.array([1.0, 3.0]),
        stress=stress,
        strain=strain,
        across=np.zeros(1),
        up=np.zeros(1),
    )
    found, mean = state.below()
    assert found.tolist() == stress[:2].mean(axis=0).tolist() and mean.tolist() == [1.0, 2.0]


@pytest.mark.parametrize("half", [True, False])
def test_the_section_is_read_at_its_points(half):
    """Stress and strain that are their own coordinates come back at y and depth, mirrored where
    half of the section was solved.
    """
    y = np.array([0.0, 1.0, 2.0]) if half else np.array([-2.0, -1.0, 1.0])
    axes = np.array([-1.0, 0.0, 1.0]), y, np.array([-2.0, -1.0, 0.0])
    rolling = RollingBlock(Block(axes, Material(207e3, 0.3, Hardening.linear(480.0)), half))
    state, places = rolling.start, rolling.streams.places
    residual = np.zeros_like(state.residual)
    residual[:, 1], residual[:, 2], residual[:, 3] = *places.T, np.sqrt(2) * places[:, 0]
    residual[:, 4], residual[:, 5] = np.sqrt(2) * places[:, 1], np.sqrt(2) * places[:, 0]
    history = replace(state.history, equivalent=-places[:, 1])
    left = rail_state(rolling, replace(state, residual=residual, history=history))
    assert (np.diff(left.y) > 0).all() and (np.diff(left.depth) > 0).all() and left.depth[0] > 0
    assert left.strain == pytest.approx(np.broadcast_to(left.depth, left.strain.shape))
    assert left.stress[:, 0, 2] == pytest.approx(-np.full(len(left.y), left.depth[0]))
    expected = np.abs(left.y) if half else left.y
    assert left.stress[:, 0, 1] == pytest.approx(expected)
    assert left.stress[:, 0, 3] == pytest.approx(left.y)  # xy and yz are odd
    assert left.stress[:, 0, 5] == pytest.approx(left.y)
    assert left.stress[0, :, 4] == pytest.approx(-left.depth) and len(left.y) == (12 if half else 6)


def test_the_table_has_the_place_in_two_columns():
    row = {"strain_increment_max": 0.01, "place_mm": [0.5, -3.0]}
    found = Passes(rows=[row, row], verdict="ratchets").table()
    assert [each["pass"] for each in found] == [1, 2]
    assert (found[1]["place_across_mm"], found[1]["place_depth_mm"]) == (0.5, 3.0)
    assert "place_mm" not in found[0]


@pytest.mark.parametrize(
    ("hardening", "text"),
    [
        (Hardening.linear(480.0), "(perfect plasticity: real steel lies between it and linear kin"),
        (Hardening.linear(480.0, 6e3, 1.0), "(kinematic hardening, which never ratchets for ever"),
        (Hardening.linear(480.0, 6e3), "(isotropic hardening, which always shakes down"),
    ],
)
def test_the_words_name_the_hardening_law_and_tractions(hardening, text):
    axis = np.linspace(-1, 0, 2)
    rolling = RollingBlock(Block((axis, axis), Material(207e3, 0.3, hardening)))
    rows = [{"strain_increment_max": 0.004, "forward_mm": -0.0012}]
    said = words("ratchets", rows, rolling, tractions=False)
    assert said.startswith("ratchets: the surface moves by -0.0012 mm a pass (") and text in said
    assert said.endswith("; no tractions act)")
    dragged = words("ratchets", rows, rolling, tractions=True)
    assert "the tractions of elastic bodies act, one way: yield does not change them" in dragged
    assert words("elastic", rows, rolling, tractions=False) == (
        "elastic: nothing yields; no tractions act"
    )


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


#: Of an independent program: C 40 GPa, g 100 at p0/k 5; two back stresses and isotropic growth.
ONE = (
    [0.0088482, 0.0090853, 0.0093518, 0.0092485, 0.0092451],
    [-0.00058982, -0.0013251, -0.00071483, -0.00069422, -0.00068929],
)
TWO = (
    [0.014192, 0.013651, 0.013132, 0.012673, 0.012283, 0.011936, 0.011632, 0.011366],
    [-0.0037259, -0.0029588, -0.0026031, -0.0023771, -0.00222, -0.0021005, -0.0020055, -0.001926],
)


def test_steel_that_recalls_ratchets_from_where_later_passes_change_little():
    """A rate that falls as 1/n is never steady, however slowly it falls."""

    def said(increments, forward):
        return verdict(increments, forward, 1.0, 1e-7, hardens=False, recalls=True)

    assert said(*ONE) == "ratchets"
    assert said(*(each[:3] for each in ONE)) == "not steady after 3 passes"
    assert said(*TWO) == "not steady after 8 passes"
    falls = [1e-2 / number for number in range(1, 51)]
    assert said([0.01] * 50, falls) == "not steady after 50 passes"
    assert said([0.01] * 50, [1e-9 * each for each in falls]) == "closed cycles"


def test_a_rate_has_the_name_of_its_rule_and_what_later_passes_may_add():
    names = "strain_increment_max", "shear_increment_max", "forward_mm"
    rows = [dict(zip(names, (0.01, 0.001, each), strict=True)) for each in (0.4, 0.2, 0.1)]
    law = Hardening.linear(480.0).cyclic([(4e4, 100.0)], 5)
    found = rate(rows, 1e-7, 1.0, law)
    assert found["rule"] == "Jiang and Sehitoglu's rule, exponent 5"
    assert found["forward_mm_per_pass"] == 0.1 and found["strain_per_pass"] == 0.01
    assert found["estimate"] == pytest.approx(1.0)  # 0.05 + 0.025 + ... of 0.1
    grows = [row | {"forward_mm": each} for row, each in zip(rows, (0.1, 0.2, 0.4), strict=True)]
    assert rate(grows, 1e-7, 1.0, law)["estimate"] is None


def test_passes_that_ratchet_go_on_to_many_wheels_and_others_say_why_not():
    """Strain at each point, forward displacement, and the error of the rate."""
    strain = [np.array([[0.03, 0.02]]), np.array([[0.031, 0.022]])]
    empty = dict.fromkeys(("y", "depth", "stress", "across", "up"), np.zeros(1))
    sections = [RailState(strain=each, **empty) for each in strain]
    rows = [{"forward_mm": each} for each in (0.5, 0.2, 0.1)]
    found = Passes(
        rows=rows, verdict="ratchets", rate={"estimate": 0.04}, sections=sections, words="ratchets"
    )
    many = extrapolated(found, 103)
    assert many.extrapolated == {
        "wheels": 103,
        "strain_max": pytest.approx(0.222),
        "forward_mm": pytest.approx(0.8 + 10),
        "estimate": 0.04,
    }
    assert many.words.endswith("within 4.0%, if each adds what the last pass did")
    for verdict_, said in (("undecided", "not extrapolated"), ("shakes down", "the surface stays")):
        other = extrapolated(replace(found, verdict=verdict_, rate=None), 103)
        assert other.extrapolated.keys() == {"wheels", "reason"}
        assert said in other.words
