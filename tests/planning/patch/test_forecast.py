"""What the mesh is refined around, before anything is meshed."""

import pickle

import numpy as np
import pytest

from railhead.cases.s1002_60e1 import SCENE as MANCHESTER
from railhead.planning import plan as planning
from railhead.planning.plan import Plan
from railhead.planning.references import boundary_elements
from railhead.scene import catalogue
from railhead.theory.elastic.hertz import Ellipse


def planned(name: str, *assignments: str) -> Plan:
    return planning.make(catalogue.find(name).replace(assignments))


@pytest.mark.parametrize("name", ["uic54_thesis", "uic54_22t5_axle", "hertz_ellipse"])
def test_hertz_is_the_forecast_where_the_gap_is_his_parabola(name: str) -> None:
    plan = planned(name)
    assert plan.forecast.hertzian
    (zone,) = plan.forecast.zones
    assert (zone.a, zone.b) == (plan.estimate.a, plan.estimate.b)
    assert plan.grading().also == ()


def test_patch_over_the_joint_of_two_radii_is_not_the_local_ellipse() -> None:
    """110 kN on the R300-R80 joint: the patch reaches over it."""
    plan = planned("cone20_uninclined_uic54", "load=110kN")
    assert not plan.forecast.hertzian
    (zone,) = plan.forecast.zones
    assert zone.b > 1.02 * plan.estimate.b


def test_manchester_patch_has_two_lobes_and_the_published_pressure_and_area() -> None:
    """CONTACT (A-2.2, central): 338.3 MPa, 51.64 mm2 counted in cells, approach 0.01596 mm."""
    plan = planning.make(MANCHESTER)
    assert isinstance(plan.estimate, Ellipse)
    patch = boundary_elements.solve(plan.contact, plan.estimate, MANCHESTER.load, 128)
    assert patch.max_pressure == pytest.approx(338.3, rel=0.01)
    assert patch.area == pytest.approx(51.64, rel=0.04)
    assert patch.approach == pytest.approx(0.01596, rel=0.01)
    assert plan.forecast.zones[0].b > 1.3 * plan.estimate.b


def test_tread_and_gauge_corner_share_the_load() -> None:
    plan = planning.make(MANCHESTER.replace(["wheelset.shift=5"]))
    tread, corner = plan.forecast.zones
    assert tread.angle == pytest.approx(0.127, abs=0.002)
    assert corner.angle == pytest.approx(0.300, abs=0.002)
    (other,) = plan.grading().also
    assert 0.5 * plan.patch_size <= other.size < plan.patch_size
    centres = np.array([tread.centre, corner.centre])
    assert plan.forecast.touching(centres).all()
    assert not plan.forecast.touching(centres.mean(axis=0)[None]).any()


def test_plans_travel_between_processes() -> None:
    for plan in (planned("uic54_thesis"), planning.make(MANCHESTER)):
        again = pickle.loads(pickle.dumps(plan))
        points = np.random.default_rng(1).uniform(-8, 8, (200, 3)) * [1, 1, 0]
        np.testing.assert_array_equal(
            again.forecast.touching(points), plan.forecast.touching(points)
        )


def test_a_forecast_that_fails_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ValueError("no bounded contact found")

    monkeypatch.setattr(boundary_elements, "solve", fail)
    plan = planning.make(MANCHESTER)
    assert plan.forecast.hertzian
    assert plan.summary()["forecast"] == {
        "hertzian": True,
        "reason": "boundary elements: no bounded contact found",
    }
    section = plan.effects["rail_section"]
    assert section.called_for and "cannot be judged (no bounded contact found)" in section.why
    assert planned("uic54_thesis").summary()["forecast"] == {"hertzian": True, "reason": ""}
