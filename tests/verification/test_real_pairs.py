"""Real profiles against boundary elements on the same gap, where no Hertz ellipse exists."""

import pytest

from railhead.cases.s1002_60e1 import SCENE
from railhead.results.pipeline import run
from railhead.scene import catalogue


def test_tread_and_gauge_corner_are_two_patches_of_the_right_size() -> None:
    """S1002 on 60E1, shifted by 5 mm: two tangent planes, 10 degrees apart."""
    scene = SCENE.replace(["wheelset.shift=5", "mesh.patch_size=0.6", "effects.plasticity=off"])
    summary = run(scene).summary
    assert summary["checks"]["passed"]
    result, half_space = summary["result"], summary["half_space"]
    tread, corner = result["patches"]
    assert tread["load_share"] + corner["load_share"] == pytest.approx(1, abs=1e-9)
    assert tread["area_mm2"] + corner["area_mm2"] == pytest.approx(result["patch"]["area_mm2"])
    assert result["patch"]["area_mm2"] == pytest.approx(half_space["patch"]["area_mm2"], rel=0.04)
    assert result["pressure"]["max_MPa"] == corner["max_MPa"]
    assert corner["max_MPa"] == pytest.approx(half_space["pressure"]["max_MPa"], rel=0.04)
    assert tread["contact_angle_rad"] == pytest.approx(0.127, abs=0.005)
    assert corner["contact_angle_rad"] == pytest.approx(0.300, abs=0.005)


def test_a_yawed_wheel_has_the_patch_of_the_straight_one() -> None:
    """Yaw of a cylinder on a straight crown turns the patch and keeps its size to second order."""
    thesis = ["rail.profile=54E1", "rail.inclination=0", "wheel.profile=cylinder"]
    scene = SCENE.replace([*thesis, "mesh.patch_size=0.7", "wheelset.yaw=20 mrad"])
    summary = run(scene).summary
    assert summary["checks"]["passed"]
    assert not summary["plan"]["effects"]["symmetry_x"]["on"]
    difference = summary["difference"]
    assert difference["pressure"]["max_MPa"] == pytest.approx(0, abs=0.01)
    assert difference["patch"]["area_mm2"] == pytest.approx(0, abs=0.01)


def test_bound_covers_the_ridge_at_a_joint_of_two_arcs() -> None:
    """54E1 at 1:40: the patch crosses the R300-R80 joint, where the pressure has a ridge.
    Half-spaces do not turn under the load as the head does."""
    choice = ["rail.inclination=1:40", "accuracy=4%", "effects.rail_section=off"]
    choice += ["effects.plasticity=off"]
    scene = catalogue.find("uic54_22t5_axle").replace(choice)
    summary = run(scene).summary
    assert summary["checks"]["passed"] and not summary["checks"]["hertzian"]
    assert len(summary["accuracy"]["levels"]) == 1  # the laws do not reach a coarser mesh
    found, other = summary["result"]["pressure"], summary["half_space"]["pressure"]
    turned = summary["half_space"]["allowance"]["max_MPa"]
    error = abs(found["max_MPa"] / other["max_MPa"] - 1)
    assert 0.015 < turned["twist"] < 0.02
    assert error < summary["accuracy"]["bound"]["max_MPa"] + turned["total"]
    assert summary["accuracy"]["bound"]["max_MPa"] < 0.04
