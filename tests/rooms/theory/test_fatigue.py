"""Criteria of fatigue against stress paths whose answer is known in closed form."""

import math

import numpy as np
import pytest

from railhead.theory import fatigue
from railhead.theory.damage import STRIP
from railhead.theory.friction import sliding


def path(times: np.ndarray, **components) -> np.ndarray:
    """A path (1, t, 6) of one point, by functions of the time of each component."""
    names = "xx", "yy", "zz", "xy", "xz", "yz"
    zero = np.zeros_like
    return np.column_stack([components.get(name, zero)(times) for name in names])[None]


PHASE = np.linspace(0.0, 2 * math.pi, 721)


@pytest.mark.parametrize(("axis", "mean"), [("xx", 0.0), ("yy", 0.0), ("zz", 60.0)])
def test_tension_of_any_mean_and_axis(axis, mean) -> None:
    """Of s_m + s_a sin t: Dang Van s_a/2 + c (s_m + s_a)/3, Findley the largest over the angle of
    s_a/2 sin(2 u) + k (s_m + s_a) cos(u)^2."""
    pulls = path(PHASE, **{axis: lambda t: mean + 100.0 * np.sin(t)})
    stress, shear, normal = fatigue.dang_van(pulls, 0.4)
    assert (shear[0], stress[0]) == pytest.approx(
        (50.0, 50.0 + 0.4 * (mean + 100.0) / 3), rel=0.002
    )
    assert abs(normal[0]["xyz".index(axis[0])]) == pytest.approx(math.sqrt(0.5), rel=1e-3)
    top = 0.25 * (mean + 100.0)
    found, plane = fatigue.findley(pulls, 0.5)
    assert found == pytest.approx(top + math.hypot(50.0, top), rel=1e-4)
    angle = math.atan2(50.0, top) / 2
    assert abs(plane["xyz".index(axis[0])]) == pytest.approx(math.cos(angle), abs=2e-3)


def test_a_shear_that_turns_has_the_amplitude_of_its_circle() -> None:
    """xz = cos t, yz = sin t: the largest shear stress is 1 at any time, and half a chord of the
    circle on the surface is 1; a shear with a mean of 3 keeps its amplitude."""
    turns = path(PHASE, xz=np.cos, yz=np.sin)
    assert fatigue.dang_van(turns, 0.3)[0] == pytest.approx(1.0, rel=2e-3)
    assert fatigue.findley(turns, 0.0)[0] == pytest.approx(1.0, rel=1e-4)
    shifted = path(PHASE, xy=lambda t: 3.0 + np.cos(t))
    assert fatigue.dang_van(shifted, 0.0)[0] == pytest.approx(1.0, rel=2e-3)
    assert fatigue.findley(shifted, 0.0)[0] == pytest.approx(1.0, rel=1e-4)


# Shear amplitude and Dang Van's stress with c = 0.33, shear amplitude and Findley's with k = 0.3,
# over p0: by another program, on planes 5 degrees apart.
LINES = {
    (0.0, 0.25): (0.2264, 0.1364, 0.2258, 0.2258),
    (0.0, 0.5): (0.2500, 0.1625, 0.2500, 0.2500),
    (0.0, 0.786): (0.2363, 0.1609, 0.2362, 0.2362),
    (0.3, 0.25): (0.2563, 0.1858, 0.2556, 0.2790),
    (0.3, 0.5): (0.2571, 0.1832, 0.2568, 0.2698),
}


def test_a_line_rolls_or_slides_over_a_half_space() -> None:
    beside = np.cosh(np.linspace(0.0, 3.5, 120))
    x = np.concatenate([-beside[::-1], -np.cos(np.linspace(0.0, math.pi, 301)), beside])
    for (mu, deep), known in LINES.items():
        points = STRIP.half_width * np.column_stack([x, 0 * x, 0 * x - deep])
        passes = np.pad(sliding.stress(STRIP, mu, 0.3, points), ((0, 1), (0, 0)))[None] / STRIP.p0
        stress, shear, _ = fatigue.dang_van(passes, 0.33)
        found = (
            shear[0],
            stress[0],
            fatigue.findley(passes, 0.0)[0],
            fatigue.findley(passes, 0.3)[0],
        )
        assert found == pytest.approx(known, rel=6e-3), (mu, deep)
