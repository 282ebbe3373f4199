"""Smoothing along arc length, and the profile that comes of it."""

import os
import re

import numpy as np
import pytest
from profile_points import crown, even, read, refused, wheel
from scipy.integrate import trapezoid

from railhead.geometry import profiles
from railhead.geometry.measured import measured_profile as measured
from railhead.geometry.measured import smoothing, standards
from railhead.geometry.measured.orientation import Orientation


def arc(radius: float, angle: float, spacing: float) -> np.ndarray:
    """Points (n, 2) along a circle about (0, -radius), from -angle to angle."""
    turn = np.arange(-angle, angle, spacing / radius)
    return radius * np.column_stack([np.sin(turn), np.cos(turn) - 1])


def noisy(points: np.ndarray, sigma: float, seed: int) -> np.ndarray:
    return points + np.random.default_rng(seed).normal(0, sigma, points.shape)


def rail(name: str = "60E1", spacing: float = 0.25) -> np.ndarray:
    y = np.linspace(*profiles.rail_head(name).domain, 40001)
    return even(crown(y[10:-10], name), spacing)


@pytest.mark.parametrize("sigma", [0.002, 0.02])
@pytest.mark.parametrize("spacing", [0.1, 0.5])
def test_noise_is_estimated_from_the_points(sigma: float, spacing: float) -> None:
    """500 points tell it to 10 %: three standard deviations of a median."""
    points = arc(80.0, 250 * spacing / 80, spacing)
    assert np.median(smoothing.noise(noisy(points, sigma, 1))) == pytest.approx(sigma, rel=0.1)


def test_noise_of_heights_is_less_across_a_steep_face() -> None:
    points = arc(80.0, 1.3, 0.25)
    points[:, 1] += np.random.default_rng(2).normal(0, 0.01, len(points))
    sigma = smoothing.noise(points)
    assert sigma[len(points) // 2] == pytest.approx(0.01, rel=0.2)
    assert sigma[0] < 0.5 * 0.01  # cos 75 degrees is 0.26


@pytest.mark.parametrize("spacing, width", [(0.1, 3), (0.25, 3), (0.5, 2)])
def test_noise_that_a_gauge_has_filtered_is_no_shape(spacing: float, width: int) -> None:
    """Means of so many neighbours hold as much of long waves as the noise before: the crown of R300
    is as round as with that noise, where it had seemed to be wavy."""
    random, points = np.random.default_rng(8), rail(spacing=spacing)
    noise = random.normal(0, 0.01, (2, len(points) + width - 1))
    for own in noise:
        own = np.convolve(own, np.ones(width) / width, "valid")
        _, profile = measured.from_points("rail", points + np.column_stack([0 * own, own]))
        crown = profile.curvature(np.linspace(-8, 8, 401))
        assert crown.min() > 0 and crown.max() < 1 / 150


@pytest.mark.parametrize("spacing", [0.1, 0.25, 0.5])
def test_independent_noise_is_not_taken_for_filtered(spacing: float) -> None:
    for seed in range(5):
        assert smoothing.filtered(noisy(rail(spacing=spacing), 0.01, seed)) == 1


@pytest.mark.parametrize("wavelength", [6.0, 15.0])
def test_waves_of_the_smoothing_length_keep_half_of_their_height(wavelength: float) -> None:
    x = np.arange(0, 120, 0.1)
    wave = 1e-3 * np.sin(2 * np.pi * x / wavelength)
    found = smoothing.smooth(np.column_stack([x, wave]), wavelength)
    s = np.linspace(30, 90, 600, endpoint=False)  # whole waves
    curve = found.curve(s)
    kept = curve[:, 1] @ np.sin(2 * np.pi * curve[:, 0] / wavelength) * 2 / len(s)
    assert kept == pytest.approx(0.5e-3, rel=0.02)


@pytest.mark.parametrize("angle", [0.3, -1.2])
def test_smoothing_turns_with_the_profile(angle: float) -> None:
    """The steep face is smoothed as the flat one."""
    points = noisy(rail(), 0.01, 3)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    one, other = smoothing.smooth(points), smoothing.smooth(points @ turn)
    places = np.linspace(0, one.length, 300)
    np.testing.assert_allclose(one.curve(places) @ turn, other.curve(places), atol=1e-6)


def test_smoothing_is_longer_where_the_profile_is_plain() -> None:
    """The crown of R300 against the corner of R13."""
    smoothed, _ = measured.from_points("rail", noisy(rail(), 0.01, 4))
    across = smoothed.curve(smoothed.places)[:, 0]
    crown = np.median(smoothed.wavelength[np.abs(across) < 5])
    assert crown > 2 * np.median(smoothed.wavelength[np.abs(across + 27) < 2])


@pytest.mark.parametrize("sigma, spacing", [(0.0, 0.25), (0.002, 0.5), (0.02, 0.1), (0.02, 0.5)])
def test_curvature_does_not_spike(sigma: float, spacing: float) -> None:
    """Nowhere half as sharp again as the corner of R13, and hollow nowhere; the crown of R300 stays
    convex and flatter than R150. Three neighbouring points make up to ten times that of R13."""
    for seed in range(2):
        _, profile = measured.from_points("rail", noisy(rail("54E1", spacing), sigma, seed))
        curvature = profile.curvature(np.linspace(*measured.inner(profile), 4001))
        assert curvature.max() < 1.5 / 13 and curvature.min() > -0.01
        crown = profile.curvature(np.linspace(-8, 8, 401))
        assert crown.min() > 0 and crown.max() < 1 / 150


MEASURED = noisy(rail(), 0.002, 5)
LISTED = {
    "backwards": (MEASURED[::-1], 0.005),
    "in any order": (MEASURED[np.random.default_rng(1).permutation(len(MEASURED))], 0.005),
    "dense": (noisy(rail(spacing=0.01), 0.01, 6), 0.01),
    "twice each": (np.repeat(rail(), 2, axis=0), 1e-3),
}


@pytest.mark.parametrize(("points", "atol"), LISTED.values(), ids=LISTED)
def test_points_may_be_listed_in_any_way(points: np.ndarray, atol: float) -> None:
    y = np.linspace(-25, 25, 51)
    _, found = measured.from_points("rail", points)
    np.testing.assert_allclose(found.height(y), profiles.rail_head("60E1").height(y), atol=atol)


@pytest.mark.parametrize(("slope", "is_kept"), [(12.0, True), (40.0, False)])
def test_faces_are_kept_up_to_a_limit(slope: float, is_kept: bool) -> None:
    """The limit is 1:22."""
    points = rail()[8:-8]
    down = np.arange(0.25, 15.0, 0.25)
    left = np.column_stack([points[0, 0] - down / slope, points[0, 1] - down])[::-1]
    right = np.column_stack([points[-1, 0] + down / slope, points[-1, 1] - down])
    _, profile = measured.from_points("rail", np.concatenate([left, points, right]))
    reach = 14.0 / slope if is_kept else 0.0
    assert profile.domain[1] - points[-1, 0] == pytest.approx(reach, abs=0.15)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (rail()[:9], "has 9 points; give at least 12"),
        (np.column_stack([np.zeros(50), np.arange(50)]), "upwards"),
    ],
)
def test_points_that_are_no_profile_are_refused(points: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        measured.from_points("rail", points)


def test_a_rolled_file_is_the_rolled_profile(tmp_path) -> None:
    file = tmp_path / "rail.csv"
    np.savetxt(file, rail("54E1"), delimiter=",")
    found = measured.read(file, "rail", slope=1 / 20).profile
    y = np.linspace(-25, 25, 51)
    truth = profiles.rail_head("54E1", 1 / 20)
    np.testing.assert_allclose(found.height(y), truth.height(y), atol=1e-3)
    np.testing.assert_allclose(found.slope(y), truth.slope(y), atol=5e-3)


def test_a_file_that_changes_is_read_again(tmp_path) -> None:
    file = tmp_path / "rail.csv"
    np.savetxt(file, rail("54E1"), delimiter=",")
    before = measured.read(file, "rail")
    np.savetxt(file, rail("60E1"), delimiter=",")
    os.utime(file, ns=(1, 1))
    assert len(measured.read(file, "rail").points) != len(before.points)


def test_wear_is_what_the_nearest_standard_has_more(tmp_path) -> None:
    """A gauge corner ground off by a plane: depth and area are known in closed form."""
    points = rail("60E1")
    towards = np.array([-1.0, 1.0]) / np.sqrt(2)
    depth = points @ towards
    cut = depth.max() - 1.5
    worn = points - np.maximum(depth - cut, 0)[:, None] * towards
    found = standards.nearest(read(tmp_path, worn, "rail").resampled(standards.STEP), "rail")
    chord = points[depth > cut]
    along = chord @ np.array([1.0, 1.0]) / np.sqrt(2)
    assert found.name == "60E1" and found.largest_loss == pytest.approx(1.5, abs=0.05)
    assert found.lost_area == pytest.approx(
        float(trapezoid(chord @ towards - cut, along)), rel=0.05
    )


@pytest.mark.parametrize("name", ["54E1", "60E1"])
def test_an_unworn_canted_head_has_no_wear(name: str, tmp_path) -> None:
    points = noisy(rail(name), 0.005, 7) @ np.array([[0.9997, 0.025], [-0.025, 0.9997]])
    found = standards.nearest(read(tmp_path, points, "rail").resampled(standards.STEP), "rail")
    assert found.name == name and found.largest_loss < 0.02


def test_the_wear_of_a_wheel_is_against_s1002(tmp_path) -> None:
    worn = wheel(np.linspace(-68, 59, 600))
    worn[:, 1] -= 2.0 * np.exp(-((worn[:, 0] / 15) ** 2) / 2)
    found = standards.nearest(read(tmp_path, worn, "wheel").resampled(standards.STEP), "wheel")
    assert found.name == "S1002" and found.largest_loss == pytest.approx(2.0, abs=0.05)
    assert found.y[found.worst] == pytest.approx(0.0, abs=1.0)
    assert found.lost_area == pytest.approx(2.0 * 15 * np.sqrt(2 * np.pi), rel=0.05)


def wild(count: int, off: float) -> np.ndarray:
    """A head where so many points from y = -20 mm on stand off, mm."""
    points = rail()
    first = int(np.argmin(np.abs(points[:, 0] + 20)))
    points[first : first + count, 1] += off
    return points


def test_a_curve_far_longer_than_the_way_through_its_points_is_refused() -> None:
    """A spike on a line, a way of 34 mm: the curve loops to 143 mm. A scan of 60E1 with noise of
    0.2 mm made so long a one that no memory held it."""
    points = np.column_stack([np.linspace(0, 30, 120), 2.0 * (np.arange(120) == 60)])
    points = noisy(points, 0.002, 9)
    with pytest.raises(ValueError, match="makes no smooth curve here"):
        smoothing.smooth(points)


HEAD = rail()
WHOLE_MM, FAR = rail(), rail()
WHOLE_MM[:, 0] = np.round(WHOLE_MM[:, 0])
FAR[70] = 1e300
APART = np.tile([[0, 0.01], [0, 0]], (len(HEAD), 1))
ANY, LATER = range(1, 10_000), range(len(HEAD) + 1, 2 * len(HEAD) + 1)
#: Points, what is said, and in which lines.
REFUSED = {
    "columns the other way": ((HEAD * [1, 2])[:, ::-1], "give y before z", ANY),
    "there and back": (np.concatenate([HEAD, HEAD[::-1] + [0, 0.003]]), "same place twice", LATER),
    "twice": (np.concatenate([HEAD, HEAD + [0.01, 0.003]]), "same place twice", ANY),
    "two heights": (np.repeat(HEAD, 2, axis=0) + APART,
                    "rounded y: points at the same y have different heights", ANY),
    "y in whole mm": (WHOLE_MM, "rounded y.* give more digits", ANY),
    "two wild points": (wild(2, 3.0), "makes no smooth curve here; delete points", range(89, 95)),
    "a gap": (np.delete(HEAD, slice(100, 150), axis=0), "has a gap of 12.7 mm", [100]),
    "a far point": (FAR, "is no point", [71]),
}  # fmt: skip


@pytest.mark.parametrize(("points", "words", "lines"), REFUSED.values(), ids=REFUSED)
def test_points_of_no_profile_are_refused_and_their_line_is_named(
    points, words, lines, tmp_path
) -> None:
    """A scan there and back was taken for noise, and for wear of 0.2 mm."""
    message = refused(tmp_path, points)
    found = re.match(rf"rail\.csv, line (\d+): .*{words}", message)
    assert found and int(found[1]) in lines, message


@pytest.mark.parametrize("header", ["y (yd),z (yd)", "y/mm,z/um", "# in unit: m\ny,z"])
def test_a_unit_that_is_given_overrules_the_file(header: str, tmp_path) -> None:
    y, file = np.linspace(-25, 25, 51), tmp_path / "rail.csv"
    np.savetxt(file, rail(), delimiter=",", header=header, comments="")
    found = measured.read(file, "rail", Orientation(unit="mm"))
    assert "in mm (as given)" in found.remarks
    truth = profiles.rail_head("60E1").height(y)
    np.testing.assert_allclose(found.profile.height(y), truth, atol=2e-3)


@pytest.mark.parametrize("count, off", [(2, 0.4), (9, -0.4), (9, 1.0)])
def test_wild_points_side_by_side_are_kept(count: int, off: float, tmp_path) -> None:
    """They hide each other: the curve turned back at them and half the head was lost."""
    points = noisy(wild(count, off), 0.002, 9)
    assert np.ptp(read(tmp_path, points, "rail").profile.domain) > 0.98 * np.ptp(points[:, 0])


def test_half_a_smoothing_length_may_leave_a_corner_unread() -> None:
    """What noise leaves open on the crown is known where a flake on the corner, which bends the
    curve back under half the length, ends the profile."""
    points = rail(spacing=0.1)
    off = np.linalg.norm(points - points[int(np.argmin(np.abs(points[:, 0] - 32.5)))], axis=1)
    points = points + 0.6 * np.exp(-((off / 0.3) ** 2) / 2)[:, None] * np.array([0.8, 0.6])
    whole, left = (measured.from_points("rail", points, 2.0, each)[1] for each in (1.0, 0.5))
    assert whole.domain[1] > 35 and left.domain[0] < -35
    assert 25 < left.domain[1] < whole.domain[1] - measured.CUT
