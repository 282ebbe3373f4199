"""What the mesh is refined around, before anything is meshed."""

import math

import numpy as np
import pytest
from solved import planned

from railhead.cases.s1002_60e1 import SCENE as MANCHESTER
from railhead.planning import forecast
from railhead.planning import simulation_plan as planning
from railhead.theory.elastic.hertz import Ellipse


@pytest.mark.parametrize("name", ["uic54_thesis", "uic54_22t5_axle", "hertz_ellipse"])
def test_hertz_is_the_forecast_where_the_gap_is_his_parabola(name: str) -> None:
    plan = planned(name)
    assert plan.forecast.hertzian
    (zone,) = plan.forecast.zones
    assert (zone.a, zone.b) == (plan.hertz.a, plan.hertz.b) and plan.grading.also == ()


@pytest.mark.parametrize(
    ("name", "keys", "exact"),
    [
        ("hertz_ellipse", [], True),
        ("uic54_thesis", [], True),
        ("uic54_22t5_axle", [], True),
        ("cone20_uninclined_uic54", [], False),  # the gap is 1.5 % off within the patch
        ("uic54_thesis", ["load=300kN"], False),  # the head ends 3.5 half lengths beside it
        ("two_cylinders", [], False),
    ],
)
def test_a_patch_is_an_ellipse_where_the_gap_is_a_parabola_and_bodies_end_far_away(
    name: str, keys: list[str], exact: bool
) -> None:
    assert planned(name, *keys).parabolic == exact


def test_manchester_patch_has_two_lobes_and_the_published_pressure_and_area() -> None:
    """CONTACT (A-2.2, central): 338.3 MPa, 51.64 mm2 counted in cells, approach 0.01596 mm."""
    plan = planned(MANCHESTER)
    assert isinstance(plan.hertz, Ellipse)
    patch = plan.context.half_spaces.pressed(MANCHESTER.load, 128)
    assert patch.max_pressure == pytest.approx(338.3, rel=0.01)
    assert patch.area == pytest.approx(51.64, rel=0.04)
    assert patch.approach == pytest.approx(0.01596, rel=0.01)
    assert plan.forecast.zones[0].b > 1.3 * plan.hertz.b


def test_tread_and_gauge_corner_share_the_load() -> None:
    plan = planned(MANCHESTER, "wheelset.shift=5")
    tread, corner = plan.forecast.zones
    assert (tread.angle, corner.angle) == pytest.approx((0.127, 0.3), abs=0.002)
    (other,) = plan.grading.also
    assert 0.5 * plan.patch_size <= other.size < plan.patch_size
    centres = np.array([tread.centre, corner.centre])
    assert plan.forecast.touching(centres).all()
    assert not plan.forecast.touching(centres.mean(axis=0)[None]).any()


def test_a_forecast_that_fails_says_why(half_spaces_fail) -> None:
    plan = planning.make(MANCHESTER)
    assert plan.forecast.hertzian
    assert plan.summary()["forecast"] == {
        "hertzian": True,
        "reason": "boundary elements: no bounded contact found",
    }
    section = plan.effects["rail_section"]
    assert section.called_for and "cannot be judged (no bounded contact found)" in section.why
    assert planned("uic54_thesis").summary()["forecast"] == {"hertzian": True, "reason": ""}


# Lines of a patch on which the relative curvature jumps.

CROSSING = "rail.inclination=1:40"  # the contact point is 2.5 mm from the R300-R80 joint


def test_the_mesh_is_finer_along_the_joint_in_the_patch_and_nowhere_else() -> None:
    plan = planned("uic54_22t5_axle", CROSSING)
    grading, rail = plan.grading, plan.contact.profiles["rail"][0]
    (zone,), (line,) = plan.forecast.zones, grading.also
    assert line.centre[1] in rail.joints and line.centre[2] == rail.height(line.centre[1])
    across = (line.centre[1] - zone.centre[1]) / (zone.b * math.cos(zone.angle))
    assert (line.a / zone.a) ** 2 + across**2 == pytest.approx(1)  # as long as the patch there
    assert line.size == forecast.RIDGE_SHARE * grading.size
    assert grading.at(*line.centre[1:]) == pytest.approx(line.size)
    assert grading.at(line.centre[1] + 3 * grading.size, line.centre[2]) == grading.size


def test_the_width_of_the_profiles_bounds_the_elements_of_long_bodies() -> None:
    """A soft wheel's patch is 90 mm long and its bodies a metre: elements as large as a quarter of
    that cut through the fillets of the head, and meshing did not end."""
    plan = planned("uic54_22t5_axle", "wheel.young_modulus=300", "load=75e3")
    assert plan.reach > 500 and plan.coarsest < 25
    assert (
        planned("uic54_22t5_axle").coarsest == forecast.COARSEST * planned("uic54_22t5_axle").reach
    )


@pytest.mark.parametrize(
    "assignments",
    [
        (),  # the patch lies on R300 alone
        (CROSSING, "mesh.cell=hexahedron"),
    ],
)
def test_without_a_joint_in_the_patch_or_with_hexahedra_nothing_is_finer(
    assignments: tuple[str, ...],
) -> None:
    assert planned("uic54_22t5_axle", *assignments).grading.also == ()
