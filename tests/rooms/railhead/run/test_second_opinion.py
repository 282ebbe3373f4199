"""Half-spaces beside a solved mesh: what they take from it, and on which patches they roll."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from friction_cases import MU, friction_found

import railhead as rh
from railhead.contact import closed_forms
from railhead.half_spaces import shearing
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.half_spaces.shearing import Motion
from railhead.planning import simulation_plan as planning
from railhead.results import checks
from railhead.results.report import terminal
from railhead.run.half_space_answer import boundary_elements
from studies.mechanics import fastsim


def ellipse(*keys: str) -> planning.Plan:
    return planning.make(rh.find("hertz_ellipse").replace([f"friction.coefficient={MU}", *keys]))


def hertz(plan: planning.Plan, cells: int):
    return shearing.patches(plan.context.half_spaces, plan.hertz, cells)


def pressure(plan: planning.Plan):
    return plan.context.half_spaces.pressure(1e4)


@pytest.fixture(scope="module")
def two() -> planning.Plan:
    """S1002 on 60E1, shifted by 5 mm: tread and gauge corner, 10 degrees apart."""
    scene = rh.find("s1002_60e1").replace(
        wheelset={"shift": 5.0}, effects={"plasticity": "off"}, rolling={"spin": 1e-4},
        friction={"coefficient": MU},
    )  # fmt: skip
    return planning.make(scene)


@pytest.fixture(scope="module")
def patches(two: planning.Plan):
    return shearing.patches(two.context.half_spaces, pressure(two), 32)


def test_what_sticks_in_any_patch_is_the_patch_of_the_force_that_is_left() -> None:
    """S1002 on 60E1, central, is no ellipse: at half of mu N the patch of half the load
    sticks (Ciavarella 1998, Jaeger 1998)."""
    scene = rh.find("s1002_60e1").replace(effects={"plasticity": "off"})
    plan = planning.make(scene.replace(friction={"coefficient": MU}))
    pair = plan.context.half_spaces
    whole, half = (pair.pressed(load, 128) for load in (1e4, 5e3))
    limit = MU * whole.force
    found = friction_found(limit, force=(0.5 * limit, 0.0))
    answer = boundary_elements(plan.context.half_spaces, found, whole, (24, 48))
    share = half.area / whole.area
    assert answer["stick_share"] == pytest.approx(share, abs=0.03)
    assert abs(share - 0.5 ** (2 / 3)) > 0.01 and "shift_along_mm" not in answer


def test_unlike_bodies_are_extrapolated_and_say_how_far() -> None:
    """A rigid wheel at a creepage of 0.001: 0.228 of mu N from 64 and 96 cells."""
    plan = ellipse("wheel.young_modulus=inf", "rolling.creepage_along=0.1%")
    found = friction_found(MU * 25e3, (1e-3, 0.0, 0.0))
    coarse = boundary_elements(plan.context.half_spaces, found, plan.hertz, (16, 32))
    assert coarse["force_along_N"] / 7500 == pytest.approx(0.237, abs=0.03)
    assert 0.005 < coarse["grid_error"] < 0.05
    assert abs(coarse["force_along_N"] / 7500 - 0.228) < coarse["grid_error"]
    assert "shift_along_mm" not in coarse


def test_two_patches_roll_as_their_ellipses_nearly_do(two: planning.Plan, patches) -> None:
    limit, pressed = MU * sum(each.pressed.force for each in patches), pressure(two)
    for motion in ((1e-4, 0.0, 0.0), (1e-3, 5e-4, 1e-4), (0.0, -3e-3, 0.0)):
        found = friction_found(limit, motion)
        answer = boundary_elements(two.context.half_spaces, found, pressed, (16, 32))
        (along, across, _), _ = fastsim.of_patches(patches, limit, two.context.half_spaces, motion)
        assert answer["force_along_N"] == pytest.approx(along, abs=0.05 * limit)
        assert answer["force_across_N"] == pytest.approx(across, abs=0.05 * limit)
    shifted = planning.make(two.scene.replace(rolling={"spin": 0.0}))
    with pytest.raises(ValueError, match=shearing.SEVERAL[:20]):
        boundary_elements(shifted.context.half_spaces, found, pressed, (16, 32))


def test_two_patches_of_unlike_bodies_share_a_force_as_under_its_creepage(two) -> None:
    scene = two.scene.replace(["wheel.young_modulus=1e6"])
    contact = replace(two.contact, scene=scene)
    pair = HalfSpacePair(contact, closed_forms.ellipse(scene, contact))
    pressed = pair.pressed(1e4)
    forced = shearing.sheared(pair, pressed, Motion(along=1e3), (16,))
    moves = Motion(creepage=forced.found[0].creepage)
    assert len(forced.patches) == 2 and moves.creepage.along > 0
    assert forced.forces[0] == pytest.approx(1e3, abs=0.1)
    moved = shearing.sheared(pair, pressed, moves, (16,))
    np.testing.assert_allclose(forced.forces[:2], moved.forces[:2], atol=2.0)


@pytest.mark.parametrize("wheel", [math.inf, pytest.param(3000.0, marks=pytest.mark.slow)])
def test_unlike_strips_are_signed(wheel: float) -> None:
    scene = rh.Scene(
        load=1e5,
        rail=rh.Rail(profile="arc", crown_radius=math.inf, extent="half-space", width=100),
        wheel=rh.Wheel(rolling_radius=420, width=100, young_modulus=wheel),
        friction={"coefficient": MU},
        rolling={"creepage_along": 3e-4},
    )
    result = rh.solve(scene, quiet=True)
    assert result.passed, result.failed
    summary = result.as_dict()
    other = summary["half_space_friction"]["boundary elements"]
    force = summary["result"]["friction"]["force_along_N"] / 3e4
    assert other["force_along_N"] / 3e4 == pytest.approx(force, abs=0.02)
    assert other["stick_share"] == pytest.approx(summary["result"]["friction"]["stick_share"],
                                                 abs=0.03)  # fmt: skip
    assert summary["checks"]["limits"]["second_opinion_friction"][0] == pytest.approx(
        checks.DEFAULT_TOLERANCE + other["grid_error"]
    )
    assert "t_gamma_N" not in other and "wear_number_N" not in summary["result"]["friction"]


@pytest.fixture(scope="module")
def strip() -> rh.Result:
    scene = rh.find("long_roller").replace(friction={"coefficient": MU, "force_along": 1e4})
    return rh.solve(scene, quiet=True)


def test_a_shift_beside_the_opinion_s_is_refused(strip: rh.Result) -> None:
    shift = strip.friction.shift_along
    for other, passes in ((0.97 * shift, True), (0.9 * shift, False)):
        second = {"boundary elements": {"shift_along_mm": other, "shift_across_mm": 0.0}}
        (judged,) = (
            each
            for each in checks.friction(strip.mesh_solution, {}, second)
            if "shift" in each.name
        )
        assert judged.passed == passes
    names = {
        each.name
        for each in checks.friction(strip.mesh_solution, {}, {"boundary elements": {"reason": ""}})
    }
    assert names == {"tangential_flux_rail", "tangential_flux_wheel"}


@pytest.mark.parametrize("part", ["force", "traction"])
def test_tangential_forces_that_the_stresses_do_not_carry_are_refused(
    strip: rh.Result, part: str
) -> None:
    """A force that was given and missed by a tenth of mu N, or stresses without their shear."""
    solved = strip.mesh_solution
    judged = checks.friction(solved, {}, None)
    assert all(check.passed and check.value < 1e-3 for check in judged if "flux" in check.name)
    if part == "force":
        scene = solved.plan.scene.replace(["friction.force_along=13.3kN"])
        context = replace(solved.plan.context, scene=scene)
        solved = replace(solved, plan=replace(solved.plan, context=context))
    else:
        solved = replace(solved, fields=solved.elastic_reference.fields)
    failed = {check.name for check in checks.friction(solved, {}, None) if not check.passed}
    assert failed == {"tangential_flux_rail", "tangential_flux_wheel"}


def test_what_is_not_known_is_said_below_the_table(strip: rh.Result) -> None:
    second = {"boundary elements": {"reason": "no reason"}, "Cattaneo": {"stick_share": 0.8348}}
    judged = checks.friction(strip.mesh_solution, {}, second)
    missing = checks.not_made(strip.mesh_solution, judged, {"reason": "a strip"}, second)
    assert missing == {"second_opinion": "a strip", "second_opinion_shift": "no reason"}
    summary = strip.as_dict()
    summary |= {"half_space_friction": second, "checks": summary["checks"] | {"not_made": missing}}
    text = terminal.recorded(partial(terminal.show_result, summary)).export_text()
    assert "Not checked: second_opinion_shift (no reason)." in " ".join(text.split())
    assert "0.8348" in text
