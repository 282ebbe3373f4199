"""Heights that are added to surfaces: their slopes, and maps from files."""

from pathlib import Path

import numpy as np
import pytest
from one_line import refusal

from railhead.geometry.placement import upright
from railhead.geometry.profiles import single_radius
from railhead.geometry.surfaces import (
    Cosine,
    FreshFlat,
    Height,
    Map,
    RailSurface,
    RoundedFlat,
    WheelSurface,
    read_map,
)

X, Y = np.linspace(-20.0, 20.0, 9), np.linspace(-10.0, 10.0, 6)
MAP = Map(length=20.0, position=0.3, x=X, y=Y, height=np.outer(np.sin(X / 9), np.cos(Y / 7)))
HEIGHTS = [
    Cosine(length=30.0, position=2.0, amplitude=0.1),
    RoundedFlat(length=30.0, position=1.0, depth=0.3),
    FreshFlat(length=30.0, position=-1.0, radius=450.0),
    MAP,
]


@pytest.mark.parametrize("height", HEIGHTS)
def test_slopes_are_those_of_the_height(height: Height) -> None:
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(-25, 25, 40), np.linspace(-12, 12, 8)))
    step, (_, along, across) = 1e-5, height(x, y)
    differences = [
        (height(x + dx, y + dy)[0] - height(x - dx, y - dy)[0]) / (2 * step)
        for dx, dy in ((step, 0.0), (0.0, step))
    ]
    np.testing.assert_allclose(along, differences[0], atol=1e-8)
    np.testing.assert_allclose(across, differences[1], atol=1e-8)


@pytest.mark.parametrize("height", HEIGHTS)
def test_gradients_of_true_surfaces_are_those_of_their_values(height: Height) -> None:
    crown = single_radius(300.0, 35.0)
    surfaces = RailSurface(crown, height), WheelSurface(crown, 450.0, upright(450.0), height)
    points = np.random.default_rng(1).uniform([-9, -9, -1], [9, 9, 1], (30, 3))
    for surface in surfaces:
        gradient = surface.implicit(points)[1]
        for axis, move in enumerate(1e-5 * np.eye(3)):
            change = surface.implicit(points + move)[0] - surface.implicit(points - move)[0]
            np.testing.assert_allclose(gradient[:, axis], change / 2e-5, atol=1e-7)


def test_a_map_is_the_wave_that_it_was_sampled_from() -> None:
    """Samples 2.5 mm apart, a 24th of a wave. A cubic spline is off by 5/384 h^4 and h^3/24 times
    the fourth derivative: 6e-5 of the amplitude, and 8e-5 of it a mm."""
    x, at = np.arange(-90.0, 91.0, 2.5), np.linspace(-40.0, 40.0, 333)
    waves = Cosine(length=60.0, amplitude=0.05)
    heights = waves(x, 0 * x)[0][:, None]
    sampled = Map(length=10.0, position=0.0, x=x, y=np.zeros(1), height=heights)
    for found, exact, within in zip(
        sampled(at, at), waves(at, at), (6.2e-5, 8e-5, 1e-12), strict=True
    ):
        np.testing.assert_allclose(found, exact, atol=0.05 * within)


def test_a_fresh_flat_is_a_chord_of_the_wheel() -> None:
    """The surface of the wheel in the flat is a plane at R cos(length/2R) from the axle."""
    height = FreshFlat(length=60.0, radius=450.0)
    turn = np.linspace(-0.06, 0.06, 7)
    distance = 450.0 + height(450.0 * turn, 0 * turn)[0]
    np.testing.assert_allclose(distance * np.cos(turn), 450.0 * np.cos(30 / 450), rtol=1e-14)
    assert height.range == pytest.approx(60**2 / 8 / 450, rel=2e-3)


def written(path: Path, rows: np.ndarray, **more: str) -> Path:
    np.savetxt(path, rows, delimiter=",", **more)
    return path


def test_text_and_arrays_make_the_same_map(tmp_path: Path) -> None:
    x, y = np.meshgrid(X, Y)
    rows = np.column_stack([x.ravel(), y.ravel(), MAP.height.T.ravel()])
    shuffled = rows[np.random.default_rng(2).permutation(len(rows))]
    text = read_map(written(tmp_path / "a.csv", shuffled, header="x,y,height", fmt="%.17g"), 0.3)
    np.savez(tmp_path / "a.npz", x=X, y=Y, height=MAP.height)
    for found in (text, read_map(tmp_path / "a.npz", 0.3)):
        assert np.array_equal(found.height, MAP.height) and found.position == 0.3
        assert found.length == pytest.approx(16.0)  # four of the smallest steps


@pytest.mark.parametrize(
    "rows, said",
    [
        (np.ones((4, 2)), "line 1: has no number in column 3"),
        ([[k, 0, 0] for k in range(3)], "3 places along"),
        ([[k, k, 0] for k in range(4)], "no grid of 4 x by 4 y"),
        ([[k % 4, 0, 0] for k in range(8)], "no grid of 4 x by 1 y"),
        ([[k, 0, np.inf] for k in range(4)], "no number in column 3"),
    ],
)
def test_rows_that_are_no_map_are_refused(rows, said: str, tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", np.array(rows, dtype=float))
    assert said in refusal(lambda: read_map(path, 0.0), ValueError)
