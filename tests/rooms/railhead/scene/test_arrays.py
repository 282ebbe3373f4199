"""Profiles and curves as arrays: kept as files, in the scene and in the result folder."""

import numpy as np
import pint
import pytest
from one_line import refusal

import railhead as rh

CURVE = [[0.0, 600.0], [0.1, 800.0]]
WRONG = (
    [], [1, 2], [[1, 2, 3]], [["a", "b"]], [[0, float("nan")]], [[1j, 2]], [[1, 2], [3]], {}, b"x",
    [[10**400, 1]], np.ma.array([[0, 1], [1, 2]], mask=[[0, 0], [1, 0]]), object(),
    [[0, 1], [1, 2]] * pint.UnitRegistry().m,
)  # fmt: skip


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch: pytest.MonkeyPatch):
    """The cache of the user is another folder."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def crown(radius: float) -> np.ndarray:
    """(n, 2) points of a rail head with a crown of this radius, mm."""
    y = np.linspace(-30.0, 30.0, 121)
    return np.column_stack([y, np.sqrt(radius**2 - y**2) - radius])


def test_an_array_is_read_as_a_file_of_the_same_points(tmp_path) -> None:
    points = crown(300.0)
    file = tmp_path / "head.csv"
    np.savetxt(file, points, delimiter=",", header="y_mm,z_mm", fmt="%.17g")
    given, read = rh.profile(points, "rail"), rh.profile(file, "rail")
    at = np.linspace(-25, 25, 51)
    assert np.array_equal(given.measured.profile.height(at), read.measured.profile.height(at))
    first = rh.Rail(profile=points)
    assert first == rh.Rail(profile=points.tolist()) != rh.Rail(profile=crown(301.0))
    inch = rh.profile(points / 25.4, "rail", ["rail.profile_unit=inch"])
    inches = inch.measured.profile.height(at)
    assert inches == pytest.approx(given.measured.profile.height(at), abs=1e-3)  # um: smoothing
    assert rh.Wheel(stress_strain=CURVE).curve == ((0.0, 600.0), (0.1, 800.0))


def test_a_result_folder_holds_the_arrays_and_runs_again(
    tmp_path, cache, in_this_process: None
) -> None:
    scene = rh.Scene(
        load="10 kN",
        rail=rh.Rail(profile=crown(300.0), stress_strain=CURVE),
        wheel=rh.Wheel(rolling_radius=460),
        effects=rh.Effects(finite_bodies="off"),
    )
    result = rh.solve(scene, quiet=True)
    exact = rh.plan(scene.replace(rail={"profile": "arc", "crown_radius": 300}), quiet=True)
    assert result.pressure.max == pytest.approx(exact.plan.hertz.p0, rel=0.02)
    result.save(tmp_path / "out", pictures=False)
    swept = rh.sweep(scene, {"rail.profile": [crown(300.0), crown(200.0)]}, quiet=True)
    assert result.pressure.max == swept[0].pressure.max < swept[1].pressure.max
    for file in cache.rglob("*.csv"):
        file.unlink()
    again = rh.find(tmp_path / "out" / "scene.toml")
    assert {path.parents[2] for path in again.files} == {tmp_path / "out"}
    assert rh.solve(again, quiet=True).pressure == result.pressure


@pytest.mark.parametrize("value", WRONG, ids=lambda value: repr(value)[:20])
def test_what_is_no_array_of_points_is_one_line(value: object) -> None:
    for call in (lambda: rh.Rail(profile=value), lambda: rh.Rail(stress_strain=value)):
        line = refusal(call, rh.SceneError)
        assert line.split(":")[0] in ("profile", "stress_strain")
        assert "give an array of shape (n, 2)" in line
    assert "may not fall" in refusal(
        lambda: rh.Rail(stress_strain=[[0, 2], [0.1, 1]]), rh.SceneError
    )


def test_a_cache_that_cannot_be_written_is_one_line(cache) -> None:
    cache.write_text("a file")
    line = refusal(lambda: rh.Rail(profile=crown(300.0)), rh.SceneError)
    assert "the array cannot be kept in" in line
