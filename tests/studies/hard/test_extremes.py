"""Numbers from 1e-300 to 1e300: a solution, or one line that says what is allowed."""

import math

import pytest
from solved import passed, solved

from railhead.planning import simulation_plan
from railhead.scene import catalogue
from railhead.scene.scene import SceneError

EXTREMES = [10.0**n for n in (-300, -12, -6, -3, 6, 15, 300)]
KEYS = [
    "load",
    "approach",
    "mesh.patch_size",
    "solver.gamma_factor",
    "rail.crown_radius",
    "wheel.rolling_radius",
    "wheel.transverse_radius",
    "rail.young_modulus",
    "wheel.young_modulus",
    "rail.length",
    "rail.depth",
    "rail.width",
    "wheel.width",
    "wheel.rim_depth",
    "wheel.segment_length",
]
CASES = ["hertz_ellipse", "two_cylinders", "uic54_thesis"]


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("case", CASES)
def test_a_plan_is_finite_or_refused_in_one_line(case: str, key: str) -> None:
    for value in EXTREMES:
        try:
            made = simulation_plan.make(catalogue.find(case).replace([f"{key}={value!r}"]))
        except SceneError as error:
            assert len(str(error).splitlines()) == 1
            continue
        numbers = [made.patch_size, made.reach, made.hertz.p0, *made.zone, made.seconds]
        assert made.unknowns >= 0 and min(numbers) > 0 and all(map(math.isfinite, numbers))


@pytest.mark.parametrize(
    "case, assignments",
    [
        ("long_roller", ["load=1e-3"]),
        ("hertz_ellipse", ["load=1e-9"]),
        ("sphere_on_plane", ["load=1e-15"]),
        ("sphere_on_plane", ["load=1e12", "wheel.young_modulus=1e13"]),
    ],
)
def test_small_and_large_scenes_are_hertz(case, assignments) -> None:
    """Pressure and area within the default accuracy of 1 %."""
    off = passed(case, *assignments).as_dict()["difference"]
    assert abs(off["pressure"]["max_MPa"]) < 0.01 and abs(off["patch"]["area_mm2"]) < 0.01


def test_a_noisy_pressure_is_no_nan() -> None:
    """A state far from converged, whose squared pressure is no concave parabola."""
    result = solved("sphere_on_plane", "solver.gamma_factor=1e12")
    assert "converged" in result.failed and result.as_dict()["result"]
