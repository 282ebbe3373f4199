"""Lines of a patch on which the relative curvature jumps."""

import math

import pytest

from railhead.planning import plan as planning
from railhead.planning import sizing
from railhead.planning.patch.ridges import ridges
from railhead.scene import catalogue

CROSSING = "rail.inclination=1:40"  # the contact point is 2.5 mm from the R300-R80 joint


def planned(*assignments: str) -> planning.Plan:
    return planning.make(catalogue.find("uic54_22t5_axle").replace(assignments))


def test_the_joint_in_the_patch_is_a_ridge_as_long_as_the_patch_there() -> None:
    plan = planned(CROSSING)
    (zone,), (line,) = plan.forecast.zones, ridges(plan.surfaces, plan.forecast.zones[0])
    rail = plan.contact.profiles["rail"][0]
    assert any(line.centre[1] == joint for joint in rail.joints)
    assert line.centre[2] == rail.height(line.centre[1])
    across = (line.centre[1] - zone.centre[1]) / (zone.b * math.cos(zone.angle))
    assert (line.a / zone.a) ** 2 + across**2 == pytest.approx(1)


def test_the_width_of_the_profiles_bounds_the_elements_of_long_bodies() -> None:
    """A soft wheel's patch is 90 mm long and its bodies a metre: elements as large as a quarter of
    that cut through the fillets of the head, and meshing did not end."""
    plan = planned("wheel.young_modulus=300", "load=75e3")
    assert plan.reach > 500
    assert plan.sizing.coarsest < 25
    assert planned().sizing.coarsest == sizing.COARSEST * planned().reach


def test_the_mesh_is_finer_along_it_and_nowhere_else() -> None:
    plan = planned(CROSSING)
    grading = plan.grading()
    (line,) = grading.also
    assert line.size == sizing.RIDGE_SHARE * grading.size
    assert grading.at(*line.centre[1:]) == pytest.approx(line.size)
    assert grading.at(line.centre[1] + 3 * grading.size, line.centre[2]) == grading.size


@pytest.mark.parametrize(
    "assignments",
    [
        (),  # the patch lies on R300 alone
        (CROSSING, "effects.true_profile=off"),
        (CROSSING, "mesh.cell=hexahedron"),
    ],
)
def test_no_ridge(assignments: tuple[str, ...]) -> None:
    assert planned(*assignments).grading().also == ()
