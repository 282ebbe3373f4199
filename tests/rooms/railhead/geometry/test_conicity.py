"""Rolling radii over the shift, and the equivalent conicity: closed forms, motions, EN 15302."""

import math
from pathlib import Path

import numpy as np
import pytest

from railhead.geometry import profiles
from railhead.geometry.placement import ProfilePair
from railhead.geometry.wheelset import WheelsetOnTrack, motion, rolling_radii

TABLE = Path(__file__).parent / "data" / "en15302.csv"
RADIUS = 460.0  # mm


def swing(amplitude: float, shifts: np.ndarray, differences: np.ndarray) -> float:
    """Equivalent conicity of a rolling radius difference."""
    return motion(amplitude, shifts, 460 + differences, 460 + 0 * differences)[0]


def alike(rail: profiles.Profile, wheel: profiles.Profile, **more: float) -> WheelsetOnTrack:
    pair = ProfilePair(rail, wheel, RADIUS)
    return WheelsetOnTrack(right=pair, left=pair, **more)


def test_the_equivalent_conicity_is_that_of_the_motion() -> None:
    """Of cones their own; of D = 2 k y^3 the closed form by the beta function; a wheelset that is
    driven outward does not swing, one that nothing turns back has none."""
    y = np.linspace(-10.0, 10.0, 801)
    for amplitude in (0.5, 6.0, 10.0):
        assert swing(amplitude, y, 0.1 * y) == pytest.approx(0.05, rel=1e-9)
    half = math.gamma(0.25) * math.gamma(0.5) / math.gamma(0.75) / 4  # of du/sqrt(1 - u^4), 0 to 1
    exact = math.pi**2 / 8 * 0.001 * 6.0**2 / half**2
    assert swing(6.0, y, 2e-3 * y**3) == pytest.approx(exact, rel=1e-4)
    assert math.isnan(swing(6.0, y, -0.1 * y)) and math.isnan(swing(0.0, y, 0.1 * y))
    short = y[y <= 5.0]
    assert math.isnan(swing(8.0, short, 0.1 * short)) and swing(6.0, y, 0 * y) == 0.0


def test_unlike_sides_swing_about_the_place_where_their_radii_are_equal() -> None:
    """Cones of other radii: the motion is that of like ones, beside the middle."""
    y = np.linspace(-10.0, 10.0, 41)
    assert swing(4.0, y, 0.1 * y + 0.45) == pytest.approx(0.05, rel=1e-9)
    assert math.isnan(swing(6.0, y, 0.1 * y + 0.45))  # beyond -10 mm


def test_a_jump_turns_the_wheelset_back_at_once() -> None:
    """D = +-J: y runs on parabolas, of which the quarter has the length sqrt(2 a e r/J). A straight
    line through the jump, 0.25 mm to each side, is another motion."""
    y, jump = np.array([-5.0, 0.0, 0.0, 5.0]), np.array([-0.8, -0.8, 0.8, 0.8])
    for amplitude in (0.5, 3.0):
        exact = math.pi**2 * 0.8 / (16 * amplitude)
        assert swing(amplitude, y, jump) == pytest.approx(exact, rel=1e-4)
    assert swing(0.5, np.array([-5.0, -0.25, 0.25, 5.0]), jump) < 0.98 * math.pi**2 * 0.8 / 8


@pytest.mark.parametrize(
    ("column", "known"),
    [
        (1, {1.0: 0.025, 2.4: 0.025, 2.6: 0.075, 3.0: 0.245, 4.0: 0.319, 6.0: 0.284}),
        (2, {1.0: 0.137, 2.0: 0.104, 2.8: 0.090, 3.0: 0.132, 4.0: 0.225, 6.0: 0.307}),
    ],
    ids=["like wheels with a jump", "unlike wheels"],
)
def test_the_reference_results_of_the_standard_are_met(column: int, known: dict) -> None:
    """Annex E of EN 15302: conicities, to three digits, of differences 0.1 mm apart. The standard
    joins its differences by straight lines as well."""
    table = np.genfromtxt(TABLE, delimiter=",", skip_header=3)
    shifts, difference = table[:, 0], table[:, column]
    found = {amplitude: swing(amplitude, shifts, difference) for amplitude in known}
    assert found == pytest.approx(known, abs=1e-3)


def test_a_cone_without_roll_has_its_own_conicity_at_every_amplitude() -> None:
    """With the roll that follows it is larger by 1 - slope (R + r)/b in its denominator."""
    rail, cone = profiles.rail_head("54E1", 1 / 20), profiles.cone(1 / 20, 60, "cone20")
    flat = rolling_radii(alike(rail, cone, roll=0.0), 8.0).conicities
    assert set(flat) == {n / 10 for n in range(5, 81)}
    assert list(flat.values()) == pytest.approx([0.05] * len(flat), rel=1e-6)
    rolled = rolling_radii(alike(rail, cone), 8.0).conicities
    assert rolled[1.0] == pytest.approx(0.05 / (1 - 0.05 * (300 + RADIUS) / 750), rel=2e-3)


@pytest.mark.parametrize(("wheel", "rail"), [(330.0, 300.0), (500.0, 80.0), (150.0, 100.0)])
def test_arcs_have_the_conicity_of_their_radii(wheel: float, rail: float) -> None:
    """A hollow wheel on a round crown, which touch at a slope: gamma R_w/(R_w - R_r), without roll.
    The wheel is an arc about a point above the rail's, both on the normal of the contact."""
    gamma = 0.05
    c, s = math.cos(math.atan(gamma)), math.sin(math.atan(gamma))
    crown = profiles.rolled(profiles.single_radius(rail, 30.0), gamma)
    tread = profiles.Arc(-40.0, 40.0, wheel * s, -wheel * c, wheel, 1)
    found = rolling_radii(alike(crown, profiles.Profile("arc", (flipped(tread),)), roll=0.0), 2.0)
    assert found.conicities[0.5] == pytest.approx(gamma * wheel / (wheel - rail), rel=5e-3)


def flipped(arc: profiles.Arc) -> profiles.Arc:
    """An arc of a profile that is hollow, from the one that is round."""
    return profiles.Arc(arc.start, arc.end, arc.centre_y, -arc.centre_z, arc.radius, -1)


def test_the_motion_of_unlike_wheels_has_its_middle_where_the_radii_are_equal() -> None:
    """A cone whose wheels differ by 0.15 mm in radius: 0.05 everywhere, about 1.5 mm."""
    shifts = np.linspace(-8.0, 8.0, 161)
    for amplitude in (1.0, 3.0):
        found = motion(amplitude, shifts, 460 + 0.1 * (shifts - 1.5), np.full(161, 460.0))
        assert found == pytest.approx((0.05, 1.5), rel=1e-6)
