"""The wheel is lowered until the undeformed surfaces just touch."""

import numpy as np
import pytest

from meshing import placement, profiles
from meshing.surfaces import ExactGap, ParabolicGap, RailSurface, WheelSurface

PAIRS = [
    (profiles.rail_head("54E1"), profiles.cone(0, 67, "cylinder"), 0.0),
    (profiles.rail_head("54E1", 1 / 20), profiles.cone(1 / 20, 67, "cone20"), 0.0),
    (profiles.rail_head("54E1", 1 / 40), profiles.cone(1 / 20, 67, "cone20"), 2.0),
    (profiles.rail_head("60E1", 1 / 40), profiles.s1002(), 1.0),
    (profiles.single_radius(80, 30), profiles.single_radius(-330, 60), 3.0),
]


@pytest.mark.parametrize("rail, wheel, shift", PAIRS)
def test_bodies_touch_and_nowhere_overlap(rail, wheel, shift) -> None:
    touch = placement.lower(rail, wheel, 420.0, shift)
    surface = WheelSurface(wheel, 420.0, shift, touch.axle_height)
    y = np.linspace(-30, 30, 20001)
    distance = surface.height(np.zeros_like(y), y) - rail.height(y)
    assert np.nanmin(distance) > -1e-9
    at = np.array([touch.y])
    assert surface.height(0 * at, at) == pytest.approx(touch.z, abs=1e-9)
    assert rail.slope(at) == pytest.approx(-wheel.slope(at - shift), abs=1e-9)


def test_contact_positions_known_from_geometry() -> None:
    """54E1 and a 1:20 cone: on the axis if inclined 1:20, 11.34 mm on R80 if not."""
    cone = profiles.cone(1 / 20, 67, "cone20")
    inclined = placement.lower(profiles.rail_head("54E1", 1 / 20), cone, 420.0)
    assert inclined.y == pytest.approx(0.0, abs=1e-9)
    assert 1 / inclined.curvature_y == pytest.approx(300, rel=1e-9)
    assert 1 / inclined.curvature_x == pytest.approx(420 * np.sqrt(1 + 1 / 400), rel=1e-9)
    upright = placement.lower(profiles.rail_head("54E1"), cone, 420.0)
    assert upright.y == pytest.approx(-11.34, abs=0.005)
    assert 1 / upright.curvature_y == pytest.approx(80, rel=1e-9)


def test_profiles_that_do_not_overlap_are_refused() -> None:
    with pytest.raises(placement.PlacementError, match="do not overlap"):
        placement.lower(profiles.rail_head("54E1"), profiles.cone(0, 20, "short"), 420.0, 80.0)


@pytest.mark.parametrize("rail, wheel, shift", PAIRS)
def test_exact_gap_is_hertz_gap_near_the_contact(rail, wheel, shift) -> None:
    """To second order: half the relative curvature times the squared distance."""
    touch = placement.lower(rail, wheel, 420.0, shift)
    bodies = (
        RailSurface(rail),
        WheelSurface(wheel, 420.0, shift, touch.axle_height),
    )
    x, s = 0.2, 0.1
    for slave, master in (bodies, bodies[::-1]):
        cosine = np.cos(touch.angle)
        points = np.array([[x, touch.y, 0.0], [0.0, touch.y + s * cosine, 0.0]])
        gap, normal = ExactGap(slave, master)(points)
        expected = [touch.curvature_x * x**2 / 2, touch.curvature_y * s**2 / 2]
        np.testing.assert_allclose(gap, expected, rtol=2e-2)
        np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-12)


def test_gap_end_point_lies_on_the_master() -> None:
    rail, wheel = profiles.rail_head("54E1"), profiles.cone(0, 67, "cylinder")
    touch = placement.lower(rail, wheel, 420.0)
    surface = WheelSurface(wheel, 420.0, 0.0, touch.axle_height)
    y = np.linspace(-25, 25, 21)
    x = np.linspace(-30, 30, 21)
    points = np.column_stack([x, y, rail.height(y)])
    gap, normal = ExactGap(RailSurface(rail), surface)(points)
    hit = points + gap[:, None] * normal
    np.testing.assert_allclose(surface.height(hit[:, 0], hit[:, 1]), hit[:, 2], atol=1e-10)


def test_a_normal_that_misses_the_master_has_an_infinite_gap() -> None:
    rail = RailSurface(profiles.rail_head("54E1"))
    narrow = WheelSurface(profiles.cone(0, 5, "narrow"), 420.0, 0.0, 420.0)
    gap, _ = ExactGap(rail, narrow)(np.array([[0.0, 20.0, 0.0]]))
    assert np.isinf(gap).all()


def test_parabolic_gap_is_hertz_own() -> None:
    gap, normal = ParabolicGap(1 / 420, 1 / 300, -1)(np.array([[2.0, 3.0, 0.0]]))
    assert gap == pytest.approx(4 / 840 + 9 / 600)
    np.testing.assert_array_equal(normal, [[0, 0, -1]])
