"""The rail's surface developed around its contacts: every point counted once."""

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from railhead.cases.s1002_60e1 import SCENE as MANCHESTER
from railhead.contact import closed_forms, solid
from railhead.half_spaces import pressing
from railhead.half_spaces.surface import develop
from railhead.run.half_space_answer import beside, frictionless
from railhead.run.mesh_solution import MeshSolution
from railhead.scene import catalogue

SEEN_TWICE = ["wheel.profile=S1002", "rail.inclination=1:40", "wheelset.shift=2", "load=70kN"]


def thesis(*assignments: str):
    return catalogue.find("uic54_thesis").replace(assignments)


def located(scene):
    contact = solid.locate(scene)
    return contact, closed_forms.ellipse(scene, contact)


def solved(scene, cells: int = 64):
    return pressing.HalfSpacePair(*located(scene)).pressed(scene.load, cells)


def second_opinion(scene) -> dict[str, Any]:
    pair = pressing.HalfSpacePair(*located(scene))
    return frictionless(pair, pair.pressed(scene.load, 128))


def test_a_patch_seen_from_two_planes_is_counted_once() -> None:
    """70 kN at contact angles 0.12 and 0.26: finite elements find 1190 MPa and 95.5 mm2."""
    found = second_opinion(thesis(*SEEN_TWICE))
    assert (found["pressure"]["max_MPa"], found["patch"]["area_mm2"]) == pytest.approx(
        (1190, 95.5), rel=0.03
    )
    assert found["load_N"] == pytest.approx(70e3, rel=1e-6)
    assert sum(each["load_share"] for each in found["patches"]) == pytest.approx(1, abs=2e-3)
    assert sum(each["area_mm2"] for each in found["patches"]) == pytest.approx(
        found["patch"]["area_mm2"], rel=5e-3
    )


def test_tread_and_gauge_corner_are_listed_with_their_own_planes() -> None:
    found = second_opinion(MANCHESTER.replace(["wheelset.shift=5"]))
    tread, corner = found["patches"]
    assert corner["contact_angle_rad"] == pytest.approx(0.300, abs=0.005)
    assert corner["max_MPa"] == found["pressure"]["max_MPa"] > 2 * tread["max_MPa"]
    assert (found["patch"]["a_mm"], found["patch"]["b_mm"]) == (tread["a_mm"], tread["b_mm"])
    rail = solid.rail_profile(MANCHESTER)
    for each in (tread, corner):
        _, y, z = each["centre_mm"]
        assert z == pytest.approx(float(rail.height(y)), abs=1e-6)
    assert set(found["grid_error"]) == {"max_MPa", "area_mm2", "a_mm", "b_mm"}


def test_one_ellipse_is_hertz() -> None:
    """A wheel on a crown of one radius, on a slope: the load's normal part and Hertz's ellipse."""
    scene = thesis("rail.profile=arc", "rail.crown_radius=80", "rail.inclination=1:20")
    contact, ellipse = located(scene)
    found = solved(scene, 128)
    assert found.max_pressure == pytest.approx(ellipse.p0, rel=2e-3)
    assert found.area == pytest.approx(ellipse.area, rel=3e-3)
    assert found.approach * math.cos(contact.touch.angle) == pytest.approx(
        ellipse.approach, rel=2e-3
    )


def test_a_patch_that_was_not_looked_for_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search starts at the first contact alone; the gauge corner then lies in the rail."""
    scene = MANCHESTER.replace(["wheelset.shift=5"])
    expected = solved(scene)
    monkeypatch.setattr(pressing, "FIRST_REACH", 1e-3)
    found = solved(scene)
    assert len(found.patches) == len(expected.patches) == 2
    assert found.max_pressure == pytest.approx(expected.max_pressure, rel=1e-3)


@pytest.mark.parametrize(
    ("assignments", "finer"),
    [
        pytest.param(("wheelset.shift=5",), 512, marks=pytest.mark.slow),
        (("wheelset.shift=5", "load=100kN"), 256),
        pytest.param(("wheelset.shift=5", "load=100kN"), 512, marks=pytest.mark.slow),
        pytest.param(("wheelset.shift=8",), 512, marks=pytest.mark.slow),
    ],
)
def test_second_opinion_does_not_hang_on_its_grid(assignments: tuple[str, ...], finer: int) -> None:
    """Tread, gauge corner and flange: 128 cells against two and four times as many, within 1 %."""
    pair = pressing.HalfSpacePair(*located(MANCHESTER.replace(assignments)))
    load = pair.contact.scene.load
    found, fine = (pair.pressed(load, cells) for cells in (128, finer))
    assert (found.max_pressure, found.area) == pytest.approx(
        (fine.max_pressure, fine.area), rel=0.01
    )


def test_developed_rail_keeps_lengths_and_normals() -> None:
    scene = thesis("rail.profile=arc", "rail.crown_radius=80", "wheelset.shift=3")
    surface = develop(solid.locate(scene))
    s = np.linspace(-20, 20, 41)
    points, angle = surface.points(0 * s, s), surface.angle(s)
    turn = np.arcsin(points[:, 1] / 80)
    np.testing.assert_allclose(np.diff(turn) * 80, 1.0, rtol=1e-4)
    np.testing.assert_allclose(angle, -turn, atol=1e-12)
    assert np.isinf(surface.gap(np.zeros(1), np.array([500.0]))).all()
    assert surface.gap(np.zeros(1), np.zeros(1)) == pytest.approx(0, abs=1e-9)


def test_a_second_opinion_that_fails_says_why(half_spaces_fail) -> None:
    contact, ellipse = located(MANCHESTER)
    context = SimpleNamespace(half_spaces=pressing.HalfSpacePair(contact, ellipse))
    plan = SimpleNamespace(contact=contact, context=context, scene=contact.scene)
    load = SimpleNamespace(load=10e3, friction=None)
    mesh_solution = SimpleNamespace(plan=plan, solution=load, ellipse=ellipse, findings=object())
    reason = {"reason": "boundary elements: no bounded contact found"}
    assert beside(cast(MeshSolution, mesh_solution)) == (reason, None)
