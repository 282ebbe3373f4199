"""Whole sections, wild points near an end, uneven steps, and shapes that are no rail or wheel."""

import numpy as np
import pytest
from profile_points import crown, even, read, wheel

from railhead.geometry import outlines
from railhead.geometry.measured import standards
from railhead.geometry.measured.formats import FormatError

MIDDLE = np.linspace(-30, 30, 121)


def section(spacing: float, begin: float = 0.0) -> np.ndarray:
    """54E1 all round, clockwise from that part of its outline on."""
    curves = outlines.rail_section("54E1", "section", half=False)
    points = even(np.concatenate([curve.sampled() for curve in curves]), spacing)
    return np.roll(points, -int(begin * len(points)), axis=0)


def head(spacing: float, deep: float = 14.0) -> np.ndarray:
    outline = standards._outline("60E1")[0]
    return even(outline[outline[:, 1] > -deep], spacing)


def closed(begin: float) -> np.ndarray:
    """A head with the line that closes it below, from that part of its outline on."""
    half = head(0.5, 30.0)
    points = even(np.concatenate([half, half[:1]]), 0.5)
    return np.roll(points, -int(begin * len(points)), axis=0)


def sparse_below(dense: float, sparse: float) -> np.ndarray:
    """A head whose steep parts have few points, as chords of one tolerance make them."""
    fine = head(dense, 30.0)
    steep = fine[:, 1] < -16
    return fine[~steep | (np.cumsum(steep) % int(sparse / dense) == 1)]


OPEN = section(0.5, 0.5)  # begins at the foot
#: Points, the standard that they are, to how many mm, and whether they are cut off.
HEADS = {
    "section": (section(0.5), "54E1", 5e-3, True),
    "section, the other way round": (section(0.5, 0.3)[::-1], "54E1", 5e-3, True),
    "section upside down": (section(0.5, 0.3) * [1, -1], "54E1", 5e-3, True),
    "head and web": (OPEN[OPEN[:, 1] > -60.0], "54E1", 5e-3, True),
    "without its underside": (OPEN[OPEN[:, 1] > -147.0], "54E1", 5e-3, True),
    "closed head, the other way round": (closed(0.0)[::-1], "60E1", 5e-3, False),
    "closed head": (closed(0.6), "60E1", 5e-3, False),
    "closed head, upside down": (closed(0.6) * [1, -1], "60E1", 5e-3, False),
    "few points on steep parts": (sparse_below(0.02, 4.9), "60E1", 2e-3, False),
    "more points on steep parts": (sparse_below(0.05, 3.0), "60E1", 2e-3, False),
}


@pytest.mark.parametrize(("points", "name", "atol", "is_cut"), HEADS.values(), ids=HEADS)
def test_the_profile_of_a_section_or_a_head_is_its_top(
    points, name, atol, is_cut, tmp_path
) -> None:
    """Not the underside of a foot, which is longer, nor the line that closes a head, which faces
    upwards on the way back. Either way round; few points on straight parts are no gap."""
    found = read(tmp_path, points, "rail")
    assert ("cut off 45 mm below its top" in found.remarks) == is_cut
    np.testing.assert_allclose(found.profile.height(MIDDLE), crown(MIDDLE, name)[:, 1], atol=atol)


@pytest.mark.parametrize(
    ("points", "body", "first", "count", "off"),
    [
        (even(wheel(), 0.25), "wheel", 5, 3, -2.0), (even(wheel(), 0.1), "wheel", 2, 3, 2.0),
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
    assert int(str(caught.value).split("line ")[1].split(":")[0]) <= first + count + 8


def test_a_standard_does_not_slip_off_other_shapes() -> None:
    """Where nothing is compared nothing is off, so the weighted fit ended there."""
    turn = np.linspace(-0.85, 0.85, 400)
    ball = 80.0 * np.column_stack([np.sin(turn), np.cos(turn) - 1])
    laid = standards.nearest(even(ball, standards.STEP), "rail")
    assert np.isfinite(laid.loss).sum() * standards.STEP > 20 and np.isfinite(laid.misfit)
