"""Creepage from where the wheelset stands: against rigid kinematics and hand-made cases."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import railhead as rh
from railhead.geometry import rolls
from railhead.geometry.solid import pair, place
from railhead.meshing.placement import Touch
from railhead.meshing.wheelset import Track
from railhead.planning import plan as planning
from railhead.planning.effects import friction
from railhead.scene.scene import SceneError
from railhead.solver.setup import Setup, Side
from railhead.theory.rolling import Creepage

POSITIONS = [(0.0, 0.0), (4.0, 3e-3), (-4.0, -3e-3), (5.0, -8e-3), (-2.0, 1e-2)]


def scene(shift: float = 0.0, yaw: float = 0.0, **more: object) -> rh.Scene:
    """S1002 on 60E1 that rolls as it stands."""
    return rh.Scene(
        load=5e4,
        rail=rh.Rail(profile="60E1", inclination=1 / 40, gauge=1435),
        wheel=rh.Wheel(profile="S1002", rolling_radius=460),
        wheelset=rh.Wheelset(shift=shift, yaw=yaw),
        friction={"coefficient": 0.3},
        rolling={"from_wheelset": True},
    ).replace(**more)


def simple(rail: float = 300.0, wheel: str = "cone20", **wheelset: float) -> rh.Scene:
    """A cone or cylinder on a round rail."""
    return rh.Scene(
        load=25e3,
        rail=rh.Rail(profile="arc", crown_radius=rail),
        wheel=rh.Wheel(profile=wheel, rolling_radius=420),
        wheelset=rh.Wheelset(**wheelset),
        friction={"coefficient": 0.3},
        rolling={"from_wheelset": True},
    )


def stands(of: rh.Scene) -> dict:
    return planning.make(of).summary()["wheelset"]


def turned(touch: Touch, side: int, given: rh.Scene, roll: float, level: float) -> Creepage:
    """Of the wheelset as a rigid body in space: where its particles at and beside the contact are a
    moment later; side +1 as placed, -1 its mirror image in y = 0."""
    mirror = np.array([1.0, side, 1.0])
    axle = Rotation.from_euler("xz", [roll, given.wheelset.yaw]).apply([0.0, 1.0, 0.0])
    centre = np.array([0.0, given.wheelset.shift, level])
    crown = Track(given.wheelset.back_to_back, given.rail.gauge).crown(pair(given).rail)
    point = np.array([touch.x, touch.y + crown, touch.z]) * mirror
    c, s = np.cos(touch.angle), np.sin(touch.angle)
    along, across = np.array([1.0, 0.0, 0.0]), np.array([0.0, c, s]) * mirror
    step, nominal = 1e-4, given.wheel.rolling_radius  # of 1e-4 mm rolled

    def slip(particle: np.ndarray) -> np.ndarray:
        after, before = (
            centre
            + way * along
            + Rotation.from_rotvec(axle * way / nominal).apply(particle - centre)
            for way in (step, -step)
        )
        moved = (after - before) / (2 * step)
        return np.array([moved @ along, moved @ across])

    here, ahead, beside = slip(point), slip(point + along), slip(point + across)
    spin = ((ahead - here)[1] - (beside - here)[0]) / 2  # of (along - spin s, across + spin x)
    return Creepage(here[0], here[1], spin)


@pytest.mark.parametrize("shift, yaw", POSITIONS)
def test_both_wheels_creep_as_a_rigid_wheelset_does(shift: float, yaw: float) -> None:
    given = scene(shift, yaw)
    _, placed = place(given)
    for side, found in ((1, placed.right), (-1, placed.left)):
        touch = found.touches[0]
        exact = turned(touch, side, given, placed.roll, placed.height)
        first = rolls.creepage(touch, 460.0, side * yaw, side * placed.roll)
        second_order = 2 * yaw**2 + 1e-9
        assert first.along == pytest.approx(exact.along, abs=second_order)
        assert first.across == pytest.approx(exact.across, abs=second_order + 0.01 * abs(yaw))
        assert first.spin == pytest.approx(exact.spin, abs=second_order / 460)


def test_a_cone_towards_its_flange_runs_on_a_larger_radius() -> None:
    """1:20 on a round rail: 2 mm are 0.1 mm of radius, which pulls the surface back; the roll adds
    a twentieth."""
    here, there = stands(simple(shift=2.0)), stands(simple(shift=-2.0))
    centred = stands(simple())
    assert here["rolling_radius_mm"] - centred["rolling_radius_mm"] == pytest.approx(0.1, rel=0.07)
    assert here["creepage_along"] - centred["creepage_along"] == pytest.approx(-0.1 / 420, rel=0.07)
    assert there["creepage_along"] - centred["creepage_along"] == pytest.approx(0.1 / 420, rel=0.07)
    assert here["creepage_along_without_torque"] == pytest.approx(-0.1 / 420, rel=0.07)
    assert centred["creepage_along_without_torque"] == 0


def test_a_cone_spins_by_its_angle_and_a_cylinder_not_at_all() -> None:
    cone, cylinder = stands(simple()), stands(simple(wheel="cylinder"))
    assert cone["spin_per_mm"] == pytest.approx(-0.05 / 420, rel=0.01)
    assert [cylinder[key] for key in ("creepage_along", "creepage_across", "spin_per_mm")] == [
        0
    ] * 3


def test_yaw_pushes_the_surface_aside() -> None:
    """An axle turned from x to y rolls towards y; the track holds it, so its surface goes to -y."""
    for yaw in (2e-3, -2e-3):
        found = stands(simple(wheel="cylinder", yaw=yaw))
        assert found["creepage_across"] == pytest.approx(-yaw, rel=1e-3)
        assert found["creepage_along"] == pytest.approx(0.0, abs=1e-5)


def test_the_plan_says_the_numbers_and_their_formulas() -> None:
    plan = planning.make(scene(4.0, 3e-3))
    why, numbers = plan.effects["friction"].why, plan.summary()["wheelset"]
    for said in (
        f"along (r0 - r)/r0 = {numbers['creepage_along']:.4g}",
        f"across -yaw/cos(angle) = {numbers['creepage_across']:.4g}",
        f"spin -sin(angle - roll)/r0 = {numbers['spin_per_mm']:.4g} 1/mm",
    ):
        assert said in why
    by_hand = 3e-3 / np.cos(numbers["contact_angle_rad"])
    assert numbers["creepage_across"] == pytest.approx(-by_hand)
    by_hand = np.sin(numbers["contact_angle_rad"] - numbers["roll_rad"]) / 460
    assert numbers["spin_per_mm"] == pytest.approx(-by_hand)
    by_hand = (460 - numbers["rolling_radius_mm"]) / 460
    assert numbers["creepage_along"] == pytest.approx(by_hand)
    assert "wheelset" not in rh.plan(simple().replace(rolling={"from_wheelset": False})).as_dict()


@pytest.mark.parametrize("key, value", [("creepage_along", 0.0), ("creepage_across", 1e-3),
                                        ("spin", 1e-4), ("force_across", 10.0)])  # fmt: skip
def test_what_the_wheelset_gives_is_not_given_twice(key: str, value: float) -> None:
    with pytest.raises(SceneError) as refused:
        scene(rolling={key: value})
    assert (
        str(refused.value) == f"rolling.{key}: is not allowed beside from_wheelset, which gives it"
    )


def test_a_torque_gives_the_force_along_in_the_place_of_its_creepage() -> None:
    plan = planning.make(scene(4.0, 3e-3, rolling={"force_along": 2e3, "speed": 20}))
    wheel = Side(2, 2, 2, plan.material(2))
    rub = friction.apply(Setup(wheel, wheel, 2, plan.surfaces.gap(2), 2), plan).rub
    given = plan.summary()["wheelset"]
    assert rub is not None and rub.free == ((0, 2000.0),)
    assert list(rub.known) == [0.0, given["creepage_across"], given["spin_per_mm"]]
    assert given["creepage_across"] < 0 and given["spin_per_mm"] < 0
    both = friction.apply(
        Setup(wheel, wheel, 2, plan.surfaces.gap(2), 2), planning.make(scene(4.0))
    )
    assert both.rub is not None and both.rub.free == () and both.rub.known[0] < 0


@pytest.mark.parametrize("case, what", [("hertz_ellipse", "half-spaces have no wheelset"),
                                        ("long_roller", "a section has no wheelset")])  # fmt: skip
def test_without_a_wheelset_it_is_one_line(case: str, what: str) -> None:
    given = rh.find(case).replace(friction={"coefficient": 0.3}, rolling={"from_wheelset": True})
    with pytest.raises(SceneError) as refused:
        rh.plan(given)
    assert str(refused.value).startswith(f"rolling.from_wheelset: true is not allowed: {what}")


def test_a_further_contact_creeps_as_its_own_radius_says() -> None:
    """Tread and flange root: the motion at the first, its spin and the height tell the second."""
    given = scene(5.0)
    contact = planning.make(given).contact
    first, *others = contact.touches(0.05)
    assert others
    known, angle = rolls.of(contact).creepage, first.angle
    for other in others:
        beside = np.cos(angle) * (other.y - first.y) + np.sin(angle) * (other.z - first.z)
        place = np.array([[0.0, other.y, other.z]])
        told = known.along - known.spin * beside + rolls.off_plane(contact, place)[0]
        assert abs(told - (460 - other.radius) / 460) < 2e-6 < abs(rolls.off_plane(contact, place))
