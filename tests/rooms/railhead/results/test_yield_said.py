"""Is it safe against yield? One entry of summary.json, one sentence, one picture."""

import pytest
from solved import solved

import railhead as rh
from railhead.results.report import terminal

FAST = ["effects.finite_bodies=off", "effects.plasticity=off"]


@pytest.mark.parametrize(
    ("load", "state"), [(2e4, "elastic"), (1e5, "shakes down"), (2e5, "ratchets")]
)
def test_a_load_is_held_against_first_yield_and_shakedown(load: float, state: str) -> None:
    """First yield at 22.1 kN; both ratios of loads grow as the load."""
    result = solved(rh.find("uic54_22t5_axle").replace([f"load={load}", *FAST]))
    found = result.summary["result"]["yield"]
    assert found["shakedown"] == state
    assert found["load_over_first_yield"] == pytest.approx(load / 22.11e3, rel=2e-3)
    ratios = found["p0_over_k"] / found["shakedown_limit_p0_over_k"]
    assert found["load_over_shakedown"] == pytest.approx(ratios**3)
    text = " ".join(terminal.recorded(result.show).export_text().split())
    assert f"can shake down (p0/k {found['p0_over_k']:.3g}" in text and f"): {state}." in text


def test_nothing_is_said_of_yield_without_a_yield_stress() -> None:
    assert not solved("hertz_ellipse", "effects.finite_bodies=off").summary["result"]["yield"]


def test_of_two_patches_the_one_with_the_largest_pressure_counts() -> None:
    """S1002 beyond its jump: a narrow corner patch, which yields first at p0/k 3.0 as an ellipse
    of its shape; it was judged by the shape of the other patch and by Hertz's law of loads."""
    changes = ["wheelset.shift=5.05", "rail.steel=R260", *FAST]
    found = solved(rh.find("s1002_60e1").replace(changes)).summary["result"]["yield"]
    assert (found["first_yield_p0_over_k"], found["shakedown_limit_p0_over_k"]) == pytest.approx(
        (3.0, 6.0), rel=0.05
    )
    assert found["shakedown"] == "shakes down" and found["load_over_shakedown"] < 1
