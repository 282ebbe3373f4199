"""Profiles of rail and wheel against their published dimensions, and as smooth functions."""

import numpy as np
import pytest

from railhead.contact import placed_bodies
from railhead.geometry import outlines, profiles

HEIGHT = {"54E1": 159.0, "60E1": 172.0}


def polygon(name: str, sharp_below: float = 0.0) -> np.ndarray:
    """Fine polygon (n, 2) of the whole section, y to the right and z from the foot bottom."""
    section = outlines.sharpened(outlines.rail_section(name, "section", half=False), sharp_below)
    return np.concatenate([curve.sampled()[:-1] for curve in section]) + [0.0, HEIGHT[name]]


def section_properties(points: np.ndarray) -> tuple[float, float, float, float]:
    """Area, height of the centroid, second moments about the centroid's axes (mm)."""
    y, z = points.T
    y1, z1 = np.roll(y, -1), np.roll(z, -1)
    cross = y * z1 - y1 * z
    area = cross.sum() / 2
    zc = ((z + z1) * cross).sum() / (6 * area)
    ix = ((z * z + z * z1 + z1 * z1) * cross).sum() / 12 - area * zc**2
    iy = ((y * y + y * y1 + y1 * y1) * cross).sum() / 12
    return abs(area), zc, abs(ix), abs(iy)


@pytest.mark.parametrize("name", ["54E1", "60E1"])
def test_section_has_the_published_area_centroid_and_inertia(name: str) -> None:
    published = profiles.json_data("rails.json")[name]["published"]
    area, zc, ix, iy = section_properties(polygon(name))
    assert (area / 100, zc, ix / 10000.0, iy / 10000.0) == pytest.approx(
        (published["A_cm2"], published["yc_mm"], published["Ix_cm4"], published["Iy_cm4"]),
        rel=0.0005,
    )


@pytest.mark.parametrize("name", ["54E1", "60E1"])
def test_sharp_corners_leave_the_section_as_stiff(name: str) -> None:
    before = section_properties(polygon(name))
    after = section_properties(polygon(name, placed_bodies.SHARP_BELOW))
    gain = dict(zip(("area", "centroid", "ix", "iy"), np.divide(after, before) - 1, strict=True))
    corners = ((3, 72.896), (4, 85.91), (2, 90))  # radius and turn of the drawing, on both sides
    turns = [(r, np.radians(t) / 2) for r, t in corners]
    gained = 2 * sum(r**2 * (np.tan(t) - t) for r, t in turns)
    assert after[0] - before[0] == pytest.approx(gained, rel=1e-2) and abs(gain["centroid"]) < 1e-3
    assert 0 < gain["ix"] < 0.002 and 0 < gain["iy"] < 0.01


@pytest.mark.parametrize(
    ("profile", "apart", "turn"),
    [(profiles.rail_head("54E1"), 1e-6, 1e-6), (profiles.rail_head("60E1"), 1e-6, 1e-6),
     (profiles.s1002(), 2e-4, 5e-6)],
    ids=lambda each: getattr(each, "name", ""),
)  # fmt: skip
def test_joints_are_tangent(profile: profiles.Profile, apart: float, turn: float) -> None:
    """Of S1002 as far as the published coefficients go: 0.12 um and 2 urad."""
    for joint, *pieces in zip(profile.joints, profile.pieces, profile.pieces[1:], strict=False):
        left, right = ([float(p.derivative(np.array(joint), k)) for k in (0, 1)] for p in pieces)
        assert left[0] == pytest.approx(right[0], abs=apart)
        assert np.arctan(left[1]) == pytest.approx(np.arctan(right[1]), abs=turn)


@pytest.mark.parametrize(
    "profile",
    [
        profiles.rail_head("54E1"),
        profiles.rail_head("60E1", 1 / 40),
        profiles.single_radius(300, 35),
        profiles.single_radius(-330, 35),
        profiles.cone(1 / 20, 60, "cone20"),
        profiles.s1002(),
        profiles.rolled(profiles.single_radius(80, 30), 1 / 20),
    ],
    ids=lambda profile: profile.name,
)
def test_slope_and_curvature_are_the_derivatives_of_the_height(profile: profiles.Profile) -> None:
    start, end = profile.domain
    y = np.linspace(start + 1, end - 1, 400)
    y = y[[min((abs(v - j) for j in profile.joints), default=1) > 0.01 for v in y]]
    y = y[np.abs(profile.slope(y)) < 3]
    h = 1e-4
    slope = (profile.height(y + h) - profile.height(y - h)) / (2 * h)
    np.testing.assert_allclose(profile.slope(y), slope, rtol=1e-5, atol=1e-7)
    bend = (profile.slope(y + h) - profile.slope(y - h)) / (2 * h)
    np.testing.assert_allclose(
        profile.curvature(y), -bend / (1 + slope**2) ** 1.5, rtol=1e-4, atol=1e-7
    )
