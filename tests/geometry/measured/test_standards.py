"""Whole sections, wild points near an end, uneven steps, and shapes that are no rail or wheel."""

import numpy as np
import pytest

from railhead.geometry import outlines, profiles
from railhead.geometry.measured import measured_profile as measured
from railhead.geometry.measured import standards
from railhead.geometry.measured.formats import FormatError
from railhead.geometry.measured.measured_profile import Measured


def even(points: np.ndarray, spacing: float) -> np.ndarray:
    """Points (n, 2) that far apart along straight lines, mm."""
    s = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    places = np.arange(0, s[-1], spacing)
    return np.column_stack([np.interp(places, s, column) for column in points.T])


def section(spacing: float, begin: float = 0.0) -> np.ndarray:
    """54E1 all round, clockwise from that part of its outline on."""
    curves = outlines.rail_section("54E1", "section", half=False)
    points = even(np.concatenate([curve.sampled() for curve in curves]), spacing)
    return np.roll(points, -int(begin * len(points)), axis=0)


def head(spacing: float, deep: float = 14.0) -> np.ndarray:
    outline = standards._outline("60E1")[0]
    return even(outline[outline[:, 1] > -deep], spacing)


def wheel(spacing: float) -> np.ndarray:
    return even(standards._outline("S1002")[0], spacing)


def read(tmp_path, points: np.ndarray, body: str, header: str = "y [mm],z [mm]") -> Measured:
    file = tmp_path / f"{body}.csv"
    np.savetxt(file, points, delimiter=",", header=header, comments="")
    return measured.read(file, body)


def close(found: Measured, name: str, atol: float) -> None:
    """Heights of a head within 30 mm of its middle are those of the standard."""
    y = np.linspace(-30, 30, 121)
    truth = profiles.rail_head(name).height(y)
    np.testing.assert_allclose(found.profile.height(y), truth, atol=atol)


@pytest.mark.parametrize("begin, back, flip", [(0.0, False, 1), (0.3, True, 1), (0.3, False, -1)])
def test_the_profile_of_a_whole_section_is_its_head(
    begin: float, back: bool, flip: int, tmp_path
) -> None:
    """The underside of the foot is longer, and the way round may run either way."""
    points = section(0.5, begin)[:: -1 if back else 1] * [1, flip]
    found = read(tmp_path, points, "rail")
    assert "cut off 45 mm below its top" in found.remarks
    close(found, "54E1", 5e-3)


@pytest.mark.parametrize("begin, back", [(0.0, True), (0.6, False)])
def test_the_profile_of_a_closed_head_is_its_top(begin: float, back: bool, tmp_path) -> None:
    """Not the line that closes it below, which faces upwards on the way back."""
    half = head(0.5, 30.0)
    closed = even(np.concatenate([half, half[:1]]), 0.5)
    points = np.roll(closed, -int(begin * len(closed)), axis=0)[:: -1 if back else 1]
    found = read(tmp_path, points, "rail")
    close(found, "60E1", 5e-3)


@pytest.mark.parametrize("deepest", [-60.0, -147.0])
def test_web_and_foot_are_cut_off(deepest: float, tmp_path) -> None:
    points = section(0.5, 0.5)
    found = read(tmp_path, points[points[:, 1] > deepest], "rail")
    close(found, "54E1", 5e-3)


@pytest.mark.parametrize(
    ("points", "body", "first", "count", "off"),
    [
        (wheel(0.25), "wheel", 5, 3, -2.0), (wheel(0.1), "wheel", 2, 3, 2.0),
        (head(0.5, 30.0), "rail", 0, 8, 2.0), (head(0.5), "rail", 1, 3, -2.0),
    ],
)  # fmt: skip
def test_wild_points_near_an_end_do_not_carry_the_curve_away(
    points: np.ndarray, body: str, first: int, count: int, off: float, tmp_path
) -> None:
    """Its domain reached from there to 1e10 mm, or its matrix was singular."""
    points = points.copy()
    points[first : first + count, 1] += off
    with pytest.raises(FormatError, match="delete") as caught:
        read(tmp_path, points, body)
    line = int(str(caught.value).split("line ")[1].split(":")[0])
    assert line <= first + count + 8


@pytest.mark.parametrize("dense, sparse", [(0.02, 4.9), (0.05, 3.0)])
def test_few_points_on_straight_parts_are_no_gap(dense: float, sparse: float, tmp_path) -> None:
    """As chords of one tolerance make them: averaged over the dense ones' number they were."""
    fine = head(dense, 30.0)
    steep = np.flatnonzero(fine[:, 1] < -16)
    stride = int(sparse / dense)
    kept = np.setdiff1d(np.arange(len(fine)), steep)
    points = fine[np.sort(np.concatenate([kept, steep[::stride]]))]
    found = read(tmp_path, points, "rail")
    close(found, "60E1", 2e-3)


def other(radii: tuple[float, ...], ends: tuple[float, ...], deep: float) -> np.ndarray:
    """Half heads of arcs up to these y, mirrored, that deep."""
    angle, at, points = 0.0, np.zeros(2), [np.zeros((1, 2))]
    for radius, end in zip(radii, (*ends, None), strict=True):
        centre = at - radius * np.array([np.sin(angle), np.cos(angle)])
        stop = np.arctan(20.0) if end is None else np.arcsin((end - centre[0]) / radius)
        turn = np.linspace(angle, stop, 200)
        points.append(centre + radius * np.column_stack([np.sin(turn), np.cos(turn)]))
        angle, at = stop, points[-1][-1]
    half = np.concatenate(points)
    half = half[half[:, 1] > -deep]
    return even(np.concatenate([half[::-1] * [-1, 1], half]), 0.5)


@pytest.mark.parametrize("deep", [14.0])
@pytest.mark.parametrize(
    ("radii", "ends"),
    [
        ((300, 80, 13), (10.2, 23.5)), ((200, 70, 13), (12, 25.5)), ((305, 79.4, 12.7), (9.5, 23)),
        ((254, 31.75, 14.3), (13, 31)), ((254, 31.75, 9.5), (12.5, 29.5)),
    ],
)  # fmt: skip
def test_other_rails_are_within_the_tolerance(radii, ends, deep: float, tmp_path) -> None:
    """49E1, 60E2, 56E1, 136RE and 115RE, nearly, worn by 3 mm on one side."""
    points = other(radii, ends, deep)
    points[:, 1] -= 3.0 * np.exp(-(((points[:, 0] - 20) / 6) ** 2))
    assert read(tmp_path, points, "rail").profile.domain[1] > 25


def test_a_standard_does_not_slip_off_other_shapes() -> None:
    """Where nothing is compared nothing is off, so the weighted fit ended there."""
    points = other((80,), (), 30.0)
    for laid in standards.all_laid(even(points, standards.STEP), "rail"):
        assert np.isfinite(laid.loss).sum() * standards.STEP > 20 and np.isfinite(laid.misfit)
