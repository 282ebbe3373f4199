"""The wheel is lowered until the undeformed surfaces just touch."""

import numpy as np
import pytest
from one_line import refusal

from railhead.geometry import placement, profiles
from railhead.geometry.placement import Pose, ProfilePair, turned, upright
from railhead.geometry.surfaces import ExactGap, RailSurface, WheelSurface, along

PAIRS = [
    (ProfilePair(profiles.rail_head("54E1"), profiles.cone(0, 67, "cylinder"), 420.0), 0.0),
    (
        ProfilePair(profiles.rail_head("54E1", 1 / 20), profiles.cone(1 / 20, 67, "cone20"), 420.0),
        0.0,
    ),
    (
        ProfilePair(profiles.rail_head("54E1", 1 / 40), profiles.cone(1 / 20, 67, "cone20"), 420.0),
        2.0,
    ),
    (ProfilePair(profiles.rail_head("60E1", 1 / 40), profiles.s1002(), 460.0), 1.0),
    (ProfilePair(profiles.single_radius(80, 30), profiles.single_radius(-330, 60), 420.0), 3.0),
]
TURNS = [(0.0, 0.0), (0.02, 0.004)]


def lowered(
    pair: ProfilePair, shift: float, yaw: float, roll: float
) -> tuple[placement.ContactPoint, Pose]:
    """First contact and the wheel's pose in contact."""
    hanging = Pose(turned(yaw, roll), np.array([0.0, shift, 0.0]))
    pose = Pose(hanging.rotation, np.array([0.0, shift, -pair.touches(hanging)[0].gap]))
    return pair.touches(pose)[0], pose


@pytest.mark.parametrize("yaw, roll", TURNS)
@pytest.mark.parametrize("pair, shift", PAIRS)
def test_bodies_touch_and_nowhere_overlap(pair, shift, yaw, roll) -> None:
    """In 3-D: no point of the wheel's surface lies below the rail's, and one lies on it."""
    touch, pose = lowered(pair, shift, yaw, roll)
    tread, turn = np.meshgrid(
        np.linspace(*pair.wheel.domain, 801), touch.axle_angle + np.linspace(-0.1, 0.1, 401)
    )
    radius = pair.rolling_radius + pair.wheel.height(tread)
    local = np.stack([radius * np.sin(turn), tread, -radius * np.cos(turn)], axis=-1)
    points = pose.outward(local.reshape(-1, 3))
    assert np.nanmin(points[:, 2] - pair.rail.height(points[:, 1])) > -1e-9
    at = np.array([[touch.x, touch.y, touch.z]])
    values, gradients = zip(
        *(surface.implicit(at) for surface in surfaces(pair, pose)), strict=True
    )
    assert values == pytest.approx(np.zeros((2, 1)), abs=1e-9)
    rail, wheel = (gradient[0] / np.linalg.norm(gradient[0]) for gradient in gradients)
    np.testing.assert_allclose(rail, -wheel, atol=1e-9)


def surfaces(pair: ProfilePair, pose: Pose) -> tuple[RailSurface, WheelSurface]:
    return RailSurface(pair.rail), WheelSurface(pair.wheel, pair.rolling_radius, pose)


def test_contact_positions_known_from_geometry() -> None:
    """54E1 and a 1:20 cone: on the axis if inclined 1:20, 11.34 mm on R80 if not."""
    cone = profiles.cone(1 / 20, 67, "cone20")
    inclined, _ = lowered(ProfilePair(profiles.rail_head("54E1", 1 / 20), cone, 420.0), 0, 0, 0)
    assert inclined.y == pytest.approx(0.0, abs=1e-9)
    assert (1 / inclined.curvature_y, 1 / inclined.curvature_x) == pytest.approx(
        (300, 420 * np.sqrt(1 + 1 / 400)), rel=1e-09
    )
    straight, _ = lowered(ProfilePair(profiles.rail_head("54E1"), cone, 420.0), 0, 0, 0)
    assert straight.y == pytest.approx(-11.34, abs=0.005)
    assert 1 / straight.curvature_y == pytest.approx(80, rel=1e-9)


def test_profiles_that_do_not_overlap_are_refused() -> None:
    pair = ProfilePair(profiles.rail_head("54E1"), profiles.cone(0, 20, "short"), 420.0)
    assert "over the rail" in refusal(
        lambda: pair.touches(upright(420.0, 80.0)), placement.PlacementError
    )


def test_two_contacts_are_both_found_and_their_gap_is_the_clearance() -> None:
    """S1002 on 60E1 touches at two points that differ by a few micrometres in height."""
    pair = ProfilePair(profiles.rail_head("60E1", 1 / 40), profiles.s1002(), 460.0)
    pose = upright(0.0, 750 - 753.0347)
    first, second = pair.touches(pose, 0.05)
    assert second.gap - first.gap == pytest.approx(0.0085, abs=5e-4)
    assert len(pair.touches(pose, 0.001)) == 1


@pytest.mark.parametrize("yaw, roll", TURNS)
@pytest.mark.parametrize("pair, shift", PAIRS)
def test_exact_gap_is_hertz_gap_near_the_contact(pair, shift, yaw, roll) -> None:
    """To second order: half the relative principal curvature times the squared distance."""
    touch, pose = lowered(pair, shift, yaw, roll)
    rail, wheel = surfaces(pair, pose)
    s = np.array([0.0, np.cos(touch.angle), np.sin(touch.angle)])
    c, t = np.cos(touch.orientation), np.sin(touch.orientation)
    axes = np.array([[c, 0, 0] + t * s, [-t, 0, 0] + c * s])
    at = np.array([touch.x, touch.y, touch.z]) + np.array([[0.2], [0.1]]) * axes
    expected = [touch.curvature_x * 0.2**2 / 2, touch.curvature_y * 0.1**2 / 2]
    for slave, master in ((rail, wheel), (wheel, rail)):
        gap, normal = ExactGap(slave, master)(at)
        np.testing.assert_allclose(gap, expected, rtol=2e-2)
        np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-12)


def test_a_rail_longer_than_the_wheel_is_high_has_no_gap_beyond_it() -> None:
    pair = PAIRS[0][0]
    rail, wheel = surfaces(pair, lowered(pair, 0.0, 0.0, 0.0)[1])
    x = np.linspace(1.05, 1.5, 400) * pair.rolling_radius
    y = np.linspace(-20, 20, 400)
    gap, _ = ExactGap(rail, wheel)(np.column_stack([x, y, pair.rail.height(y)]))
    assert np.isinf(gap).all()


def test_points_beside_the_slave_are_moved_onto_it() -> None:
    rail = RailSurface(profiles.rail_head("54E1"))
    wheel = WheelSurface(profiles.cone(0, 67, "cylinder"), 420.0, upright(420.0))
    off = np.array([[3.0, 5.0, 0.3]])
    assert ExactGap(rail, wheel).off_surface(off)[0] == pytest.approx(
        np.hypot(5.0, 300.3) - 300, abs=1e-4
    )
    down = np.array([[0.0, 0.0, -1.0]])
    assert along(rail, off, down)[0] == pytest.approx(0.3 + 300 - np.sqrt(300**2 - 25), abs=1e-12)
