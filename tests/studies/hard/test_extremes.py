"""Numbers from 1e-300 to 1e300: a solution, or one line that says what is allowed."""

import math

import command
import pytest
from solved import passed, solved

from railhead.planning import simulation_plan
from railhead.scene import catalogue
from railhead.scene.scene import Scene, SceneError

BODIES = ("length", "depth", "width"), ("width", "rim_depth", "segment_length")
EXTREMES = [10.0**n for n in (-300, -30, -12, -6, -3, 6, 9, 15, 300)]
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
CASES = [
    "hertz_ellipse",
    "two_cylinders",
    "uic54_thesis",
    *(
        pytest.param(case, marks=pytest.mark.slow)
        for case in ("sphere_on_plane", "roller_on_block")
    ),
]


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("case", CASES)
def test_a_plan_is_finite_or_refused_in_one_line(case: str, key: str) -> None:
    for value in EXTREMES:
        try:
            made = simulation_plan.make(catalogue.find(case).replace([f"{key}={value!r}"]))
        except SceneError as error:
            assert len(str(error).splitlines()) == 1
            continue
        numbers = [made.patch_size, made.reach, made.estimate.p0, *made.zone, made.seconds]
        assert made.unknowns >= 0 and min(numbers) > 0 and all(map(math.isfinite, numbers))


@pytest.mark.parametrize(
    "case, assignment, words",
    [
        ("uic54_thesis", "load=1e-300", "give a force from 1e-40 to 1e15 N"),
        ("uic54_thesis", "load=1e-39", "give a larger one, half lengths below"),
        ("uic54_thesis", "load=1e-10", "give a larger one, half lengths below"),
        ("long_roller", "load=1e-6", "give a larger one, half lengths below"),
        ("sphere_on_plane", "load=1e-20", "give a larger one, half lengths below 1e-06 mm"),
        ("sphere_on_plane", "approach=1e-20", "give a larger one"),
        ("sphere_on_plane", "approach=1e300", "give a length from 1e-21"),
        ("sphere_on_plane", "wheel.young_modulus=1e300", "from 1e-12 to 1e15 MPa"),
        ("sphere_on_plane", "wheel.young_modulus=1e-12", "give a smaller one"),
        ("sphere_on_plane", "mesh.patch_size=1e-300", "give a length from 1e-9 to 1e6 mm"),
        ("sphere_on_plane", "mesh.patch_size=1e200", "give a length from 1e-9 to 1e6 mm"),
        ("two_cylinders", "wheel.width=1e-9", "give a length from 0.001 to 1e6 mm"),
    ],
)
def test_what_cannot_be_computed_is_refused(case, assignment, words, tmp_path, capsys) -> None:
    given = ("run", case, "--set", assignment, "--out", str(tmp_path / "out"))
    assert words in command.refused(capsys, *given) and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "case, assignments",
    [
        pytest.param("uic54_thesis", ["load=1e-3"], marks=pytest.mark.slow),
        ("long_roller", ["load=1e-3"]),
        ("hertz_ellipse", ["load=1e-9"]),
        ("sphere_on_plane", ["load=1e-15"]),
        pytest.param(
            "sphere_on_plane", ["load=1e-12", "wheel.young_modulus=1e-11"], marks=pytest.mark.slow
        ),
        ("sphere_on_plane", ["load=1e12", "wheel.young_modulus=1e13"]),
    ],
)
def test_small_and_large_scenes_are_hertz(case, assignments) -> None:
    """Pressure and area within the default accuracy of 1 %."""
    result = passed(case, *assignments)
    off = result.as_dict()["difference"]
    assert abs(off["pressure"]["max_MPa"]) < 0.01 and abs(off["patch"]["area_mm2"]) < 0.01


def test_a_noisy_pressure_is_no_nan() -> None:
    """A state far from converged, whose squared pressure is no concave parabola."""
    result = solved("sphere_on_plane", "solver.gamma_factor=1e12")
    assert "converged" in result.failed and result.as_dict()["result"]


def test_lengths_of_bodies_have_a_range() -> None:
    for table, keys in zip(("rail", "wheel"), BODIES, strict=True):
        for key in keys:
            profile = {"profile": "arc", "crown_radius": 80} if table == "rail" else {}
            with pytest.raises(SceneError, match=f"^{table}.{key}: .* from 0.001 to 1e6 mm$"):
                Scene.from_mapping({"load": 1, table: {**profile, key: 1e-4}})
