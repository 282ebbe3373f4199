"""What an answer says beside its numbers: side forces of steep contacts, hollow and
fresh flats, and whether it is safe against yield: one entry of summary.json and one sentence."""

import math

import numpy as np
import pytest
from solved import solved

from railhead.results.report import terminal

FAST = ["effects.finite_bodies=off", "effects.plasticity=off"]
FLAT = [
    "load=10kN", "rail.profile=arc", "rail.crown_radius=300", "wheel.profile=cylinder",
    "wheel.rolling_radius=450", "wheel.surface.kind=flat", "wheel.surface.length=100",
    "wheel.surface.position=3 deg", "rail.inclination=0", *FAST,
]  # fmt: skip


def printed(result) -> str:
    return " ".join(terminal.recorded(result.show).export_text().split())


def test_a_flange_that_carries_the_load_needs_a_side_force_in_equilibrium_with_it() -> None:
    """The pressure is normal to the patch: side force over load is the tangent of its angle."""
    result = solved("s1002_60e1", "wheelset.shift=6.5", *FAST)
    (patch,) = result.summary["result"]["patches"]
    side = result.summary["result"]["side_force_N"]
    assert side == pytest.approx(result.load * math.tan(patch["contact_angle_rad"]), rel=0.01)
    assert "to the field side. The axle must push the wheel with as much" in printed(result)
    assert "Steep contact" not in printed(solved("uic54_22t5_axle", *FAST))


@pytest.mark.parametrize(("depth", "hollow"), [(1.1, False), (1.15, True)])
def test_a_flat_deeper_than_its_length_squared_over_two_pi_squared_r_is_called_hollow(
    depth: float, hollow: bool
) -> None:
    """100^2/(2 pi^2 450) = 1.126 mm."""
    text = printed(solved("uic54_thesis", *FLAT, f"wheel.surface.depth={depth}"))
    assert ("beyond L^2/(2 pi^2 R) = 1.126 mm, is a hollow" in text) is hollow


@pytest.mark.parametrize(("middle", "told"), [(300.0, True), (0.0, False)])
def test_a_map_that_the_patch_does_not_meet_is_said(tmp_path, middle: float, told: bool) -> None:
    """A dent 0.01 mm deep, 40 mm wide, from -20 to 20 mm about its middle."""
    x, y = np.linspace(-20, 20, 41), np.linspace(-30, 30, 7)
    height = np.outer(-0.005 * (1 + np.cos(np.pi * x / 20)), np.ones(7))
    np.savez(tmp_path / "dent.npz", x=x + middle, y=y, height=height)
    given = ["rail.surface.kind=map", f"rail.surface.file={tmp_path / 'dent.npz'}"]
    text = printed(solved("uic54_thesis", *FLAT[:5], "rail.inclination=0", *FAST, *given))
    assert ("the patch does not meet what is added" in text) is told


def test_advice_on_a_fresh_flat_is_to_round_it_not_to_mesh_its_edges() -> None:
    result = solved("uic54_thesis", *FLAT, "wheel.surface.length=50")
    advice = result.summary["checks"]["advice"]
    assert "wheel cut" not in advice and "sharp edges" in advice["grid_error"]
    assert "sharp edges" in printed(result)


@pytest.mark.parametrize(("shift", "told"), [(5.0, True), (4.6, False), (3.0, False)])
def test_an_answer_beside_a_jump_of_contact_has_what_both_sides_have(
    shift: float, told: bool
) -> None:
    """`locate` has the jump of S1002 on 60E1 at 4.992 mm, to the flange root."""
    text = printed(solved("s1002_60e1", f"wheelset.shift={shift}", *FAST))
    assert ("jumps at a shift of 4.9918 mm, 0.0082 mm away" in text) is told
    if told:
        for at in (4.9, 5.1):
            other = solved("s1002_60e1", f"wheelset.shift={at}", *FAST)
            assert f"{other.pressure.max:.4g} MPa at {at} mm" in text


@pytest.mark.parametrize(
    ("load", "state"), [(2e4, "elastic"), (1e5, "shakes down"), (2e5, "ratchets")]
)
def test_a_load_is_held_against_first_yield_and_shakedown(load: float, state: str) -> None:
    """First yield at 22.1 kN; both ratios of loads grow as the load."""
    result = solved("uic54_22t5_axle", f"load={load}", *FAST)
    found = result.summary["result"]["yield"]
    assert found["shakedown"] == state
    assert found["load_over_first_yield"] == pytest.approx(load / 22.11e3, rel=2e-3)
    ratios = found["p0_over_k"] / found["shakedown_limit_p0_over_k"]
    assert found["load_over_shakedown"] == pytest.approx(ratios**3)
    text = printed(result)
    assert f"can shake down (p0/k {found['p0_over_k']:.3g}" in text and f"): {state}." in text


def test_nothing_is_said_of_yield_without_a_yield_stress() -> None:
    assert not solved("hertz_ellipse", "effects.finite_bodies=off").summary["result"]["yield"]


def test_of_two_patches_the_one_with_the_largest_pressure_counts() -> None:
    """S1002 beyond its jump: a narrow corner patch, which yields first at p0/k 3.0 as an ellipse
    of its shape; it was judged by the shape of the other patch and by Hertz's law of loads."""
    changes = ["wheelset.shift=5.05", "rail.steel=R260", *FAST]
    found = solved("s1002_60e1", *changes).summary["result"]["yield"]
    assert (found["first_yield_p0_over_k"], found["shakedown_limit_p0_over_k"]) == pytest.approx(
        (3.0, 6.0), rel=0.05
    )
    assert found["shakedown"] == "shakes down" and found["load_over_shakedown"] < 1
