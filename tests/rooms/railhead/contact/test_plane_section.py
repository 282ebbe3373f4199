"""Which scenes are solved in two dimensions, and which are refused."""

import numpy as np
import pytest
from one_line import refusal

from railhead.contact import plane_section
from railhead.meshing.bodies import WHEEL
from railhead.planning import simulation_plan as planning
from railhead.scene import catalogue
from railhead.scene.scene import Scene

INF_RAIL = ["rail.profile=arc", "rail.crown_radius=inf"]
SPHERE = ["wheel.profile=arc", "wheel.transverse_radius=420"]


def scene(*assignments: str) -> Scene:
    return Scene(load=1e5).replace(assignments)


KINDS = {
    "54E1 under a cylinder": ([], "solid"),
    "flat crown under a cylinder": (INF_RAIL, "plane_along"),
    "nearly flat crown": (["rail.profile=arc", "rail.crown_radius=1e7"], "plane_along"),
    "patch within the crown": (["rail.profile=arc", "rail.crown_radius=3000"], "solid"),
    "straight bar on 54E1": (["wheel.rolling_radius=inf", "rail.length=100"], "plane_across"),
    "sphere on a plane": ([*INF_RAIL, *SPHERE], "axisymmetric"),
    "sphere on a bar": ([*INF_RAIL, *SPHERE, "rail.width=3"], "solid"),
    "sphere beside the middle": ([*INF_RAIL, *SPHERE, "wheelset.shift=3"], "solid"),
    "circular half-spaces": (
        ["rail.extent=half-space", "rail.profile=arc", "rail.crown_radius=420"],
        "axisymmetric",
    ),
    "crossed cylinders": (["rail.profile=arc", "rail.crown_radius=420"], "solid"),
    "sphere that rubs": ([*INF_RAIL, *SPHERE, "friction.coefficient=0.3"], "axisymmetric"),
    "sphere that is pushed": (
        [*INF_RAIL, *SPHERE, "friction.coefficient=0.3", "friction.force_along=1kN"],
        "solid",
    ),
    "circular, switched off": ([*INF_RAIL, *SPHERE, "effects.axisymmetry=off"], "solid"),
}


@pytest.mark.parametrize("assignments, kind", KINDS.values(), ids=KINDS)
def test_shapes_make_a_solid_a_section_or_a_body_of_revolution(
    assignments: list[str], kind: str
) -> None:
    assert plane_section.choose(scene(*assignments)).kind == kind


def test_a_ball_without_a_rim_is_held_between_its_tread_and_its_axle() -> None:
    """On a bar it is no body of revolution: its tread, 0.95 of the radius to each side, drops by
    0.688 of it, and half the radius more would pass the axle."""
    ball = ["wheel.profile=arc", "wheel.rolling_radius=50", "wheel.transverse_radius=50"]
    plan = planning.make(scene(*INF_RAIL, *ball, "rail.width=30", "load=2kN"))
    (wheel,) = (body for body in plan.parts() if body.tag == WHEEL)
    heights = np.concatenate([curve.points[:, 1] for curve in wheel.section])
    assert -heights.max() == pytest.approx((1 - 0.688) / 2 * 50, abs=0.05)


REFUSED = {
    "bar without a length": (["wheel.rolling_radius=inf"], "rail.length: not given"),
    "bar in three dimensions": (
        ["wheel.rolling_radius=inf", "rail.length=9", "effects.plane_strain=off"],
        "effects.plane_strain: 'off' is not allowed",
    ),
    "roller in three dimensions": (
        [*INF_RAIL, "effects.plane_strain=off"], "effects.plane_strain: 'off' is not allowed"
    ),
    "ellipse in plane strain": (
        ["effects.plane_strain=on"], "effects.plane_strain: 'on' is not allowed"
    ),
    "half-space ellipse": (
        ["rail.extent=half-space", "effects.plane_strain=on"], "half-spaces with an elliptic patch"
    ),
    "ellipse as a circle": (
        ["effects.axisymmetry=on"], "effects.axisymmetry: 'on' is not allowed: relative curvatures"
    ),
    "rolling sphere as a circle": (
        [*INF_RAIL, *SPHERE, "friction.coefficient=0.3", "rolling.spin=1e-4",
         "effects.axisymmetry=on"],
        "effects.axisymmetry: 'on' is not allowed: a tangential force or creepage turns",
    ),
    "tilted line": ([*INF_RAIL, "rail.inclination=1:20"], "rail.inclination: 0.05 is not allowed"),
    "conformal": (
        ["wheel.profile=arc", "wheel.transverse_radius=-300"], "line contact or a fully conformal"
    ),
    "circle in plane strain": (
        [*INF_RAIL, *SPHERE, "effects.plane_strain=on"],
        "plane_strain: 'on' is not allowed: the contact is a cir",
    ),
    "disc thicker than its radius": (
        [*INF_RAIL, "wheel.rim_depth=421"], "wheel.rim_depth: 421 is not allowed"
    ),
}  # fmt: skip


@pytest.mark.parametrize("assignments, words", REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_is_refused_in_one_line(assignments: list[str], words: str) -> None:
    assert words in refusal(lambda: planning.make(scene(*assignments)))


def test_plan_gives_reasons_and_fewer_unknowns() -> None:
    case = catalogue.find("sphere_on_plane")
    flat, solid = planning.make(case), planning.make(case.replace(["effects.axisymmetry=off"]))
    assert flat.effects["axisymmetry"].on and not solid.effects["axisymmetry"].on
    assert "0.125 1/mm along and across" in flat.effects["axisymmetry"].why
    assert solid.effects["axisymmetry"].override
    assert flat.at_resolution(6.0).unknowns < solid.at_resolution(6.0).unknowns / 5
    assert "70 mm long" in planning.make(scene(*INF_RAIL)).effects["plane_strain"].why


def test_contact_length_is_the_common_width() -> None:
    shifted = scene(*INF_RAIL, "wheel.width=60", "wheelset.shift=20")
    found = plane_section.choose(shifted)
    assert (found.length, found.centre) == (45.0, 12.5)
    assert planning.make(shifted).contact.origin == (0.0, 12.5, 0.0)


def test_a_narrow_bar_across_the_rail_has_no_length_that_makes_it_thin() -> None:
    bar = scene("wheel.rolling_radius=inf", "rail.length=100", "wheel.width=8")
    wheel = next(body for body in planning.make(bar).parts() if body.tag == WHEEL)
    assert max(float(curve.points[:, 0].max()) for curve in wheel.section) == pytest.approx(4.0)
