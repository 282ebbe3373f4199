"""Profiles that are drawn: points of arcs and lines, exact to the last digit that is written."""

import numpy as np
import pytest

from railhead.geometry import profiles
from railhead.geometry.measured import formats, smoothing
from railhead.geometry.measured import measured_profile as measured
from railhead.geometry.measured.smoothing import Smoothed

RAIL = profiles.rail_head("60E1")
JOINTS, RADII = np.array(RAIL.joints), np.array([13.0, 80.0, 300.0, 80.0, 13.0])
JUMP = 1 / 13 - 1 / 80


def rail(spacing: float, how: str = "even") -> np.ndarray:
    """Points of 60E1 so far apart: along it, across, or with steps of 0.3 to 1.7 times it."""
    y = np.linspace(*RAIL.domain, 200001)[5:-5]
    s = np.hypot(np.diff(y), np.diff(RAIL.height(y))).cumsum()
    steps = np.random.default_rng(1).uniform(0.3, 1.7, int(2 * s[-1] / spacing)) * spacing
    places = {
        "even": np.interp(np.arange(0, s[-1], spacing), s, y[1:]),
        "uneven": np.interp(steps.cumsum()[steps.cumsum() < s[-1]], s, y[1:]),
        "across": np.arange(np.ceil(y[0]), y[-1], spacing),
    }[how]
    return np.column_stack([places, RAIL.height(places)])


def drawn(points: np.ndarray, decimals: int, **keys: float) -> tuple[Smoothed, profiles.Profile]:
    digit = 10.0**-decimals
    return measured.from_points("rail", points.round(decimals), resolution=digit, **keys)


@pytest.mark.parametrize("how", ["even", "uneven", "across"])
@pytest.mark.parametrize(("spacing", "decimals"), [(0.1, 6), (0.25, 6), (0.5, 6), (0.25, 4)])
def test_the_curve_passes_through_the_points_and_arcs_meet_at_once(
    spacing: float, decimals: int, how: str
) -> None:
    """Curvatures are those of the arcs a little more than half a step beside the joints, within a
    twelfth of the jump from R80 to R13. A cubic spline through the points is off by 7 to 20 % of
    the jump there, and smoothing by 22 to 36 %."""
    smoothed, profile = drawn(rail(spacing, how), decimals)
    assert np.abs(smoothed.residual).max() < 1.2 * 10.0**-decimals
    beside = 0.6 * spacing + 0.05
    for joint, *radii in zip(JOINTS, RADII, RADII[1:], strict=False):
        found = profile.curvature(joint + np.array([-beside, beside]))
        np.testing.assert_allclose(found, 1 / np.array(radii), atol=JUMP / 12)


@pytest.mark.parametrize("spacing", [0.1, 0.5])
def test_three_decimals_leave_the_crown_round(spacing: float) -> None:
    """Three neighbouring points make a curvature that is off by more than the crown's own."""
    smoothed, profile = drawn(rail(spacing), 3)
    assert smoothed.rounding == pytest.approx(0.001) and np.abs(smoothed.residual).max() < 0.001
    crown = profile.curvature(np.linspace(-8, 8, 161))
    np.testing.assert_allclose(crown, 1 / 300, atol=0.1 / 300)


@pytest.mark.parametrize(
    ("noise", "digit", "is_drawn"),
    [(0.0, 1e-6, True), (0.0, 0.0, True), (0.002, 1e-5, False), (2e-4, 1e-3, True),
     (0.002, 1e-3, False), (1e-5, 1e-6, False)],
)  # fmt: skip
def test_noise_that_is_rounding_is_no_noise(noise: float, digit: float, is_drawn: bool) -> None:
    points = rail(0.25) + np.random.default_rng(2).normal(0, noise, (len(rail(0.25)), 2))
    points = points.round(6) if not digit else points.round(round(-np.log10(digit)))
    smoothed = smoothing.smooth(points, resolution=digit)
    assert bool(smoothed.rounding) is is_drawn
    assert smoothed.wavelength.any() is np.bool_(not is_drawn)


def test_a_length_that_is_given_smooths_a_drawn_profile_too() -> None:
    smoothed, _ = drawn(rail(0.25), 6, wavelength=8.0)
    assert not smoothed.rounding and np.all(smoothed.wavelength == 8.0)


def test_half_of_the_points_tell_what_a_drawn_profile_leaves_open() -> None:
    """Every point is in one of the halves."""
    whole, even_ones, odd_ones = (
        drawn(rail(0.25), 6, stretch=stretch)[0].points for stretch in (1.0, 0.5, 2.0)
    )
    assert {tuple(point) for point in (*even_ones, *odd_ones)} == {tuple(each) for each in whole}
    assert len(even_ones) < 0.51 * len(whole) and len(odd_ones) < 0.51 * len(whole)


@pytest.mark.parametrize(
    ("form", "digit"),
    [("{:.4f}", 1e-4), ("{:.3e}", 1e-2), ("{:.6g}", 1e-4), ("{:.0f}", 1.0), ("{!r}", 1e-15)],
)
def test_the_last_digit_is_that_of_the_larger_numbers(form: str, digit: float, tmp_path) -> None:
    """Numbers of some length have more decimals where they are small."""
    file = tmp_path / "rail.csv"
    points = rail(0.25) * [1.0, 1.7]
    file.write_text("".join(f"{form},{form}\n".format(*map(float, each)) for each in points))
    assert formats.read(file).resolution == pytest.approx(digit)


@pytest.mark.parametrize(
    ("unit", "factor", "decimals", "digit"),
    [("m", 1e-3, 9, 1e-6), ("inch", 1 / 25.4, 6, 25.4e-6), ("m", 1e-3, 6, 1e-3)],
)
def test_digits_are_those_of_the_unit_of_the_file(unit, factor, decimals, digit, tmp_path) -> None:
    file = tmp_path / "rail.csv"
    header = f"y [{unit}],z [{unit}]"
    np.savetxt(file, rail(0.25) * factor, f"%.{decimals}f", ",", header=header, comments="")
    found = measured.read(file, "rail")
    assert found.smoothed.rounding == pytest.approx(digit)
    assert found.summary()["smoothing_mm"] == [0.0, 0.0]
    assert found.summary()["apart_mm"] == pytest.approx(0.25, rel=0.01)


def test_even_steps_across_have_few_digits_and_no_rounding() -> None:
    smoothed, _ = measured.from_points("rail", rail(0.5, "across").round(6), resolution=0.1)
    assert smoothed.rounding < 1e-5


def by_chords(tolerance: float) -> np.ndarray:
    """Points of 60E1 whose chords are so far off its arcs, mm, and that are sparse on its sides."""
    ends = [RAIL.domain[0] + 0.01, *JOINTS, RAIL.domain[1] - 0.01]
    points = [np.empty((0, 2))]
    for start, end, radius in zip(ends, ends[1:], RADII, strict=False):
        count = max(2, int((end - start) / np.sqrt(8 * radius * tolerance)))
        y = np.linspace(start, end, count + 1)[:-1]
        points.append(np.column_stack([y, RAIL.height(y)]))
    way = np.concatenate(points)
    return np.concatenate([way[0] + np.outer([12.0, 8.0, 4.0], [-1 / 20, -1.0]), way])


SPARSE = by_chords(0.002)
TWICE = np.sort(np.concatenate([np.arange(-35.5, 35.6, 0.25), JOINTS, JOINTS + 1e-3]))
AT_JOINTS = np.column_stack([TWICE, RAIL.height(TWICE)])


@pytest.mark.parametrize("decimals", [3, 6])
@pytest.mark.parametrize("points", [SPARSE, AT_JOINTS], ids=["by chords", "joints listed twice"])
def test_points_of_any_distance_make_the_arcs(points: np.ndarray, decimals: int) -> None:
    _, profile = drawn(points, decimals)
    middles = np.array([-30.0, -18.0, 0.0, 18.0, 30.0])
    np.testing.assert_allclose(profile.curvature(middles), 1 / RADII, rtol=0.05)
    np.testing.assert_allclose(profile.height(middles), RAIL.height(middles), atol=0.002)
