"""A coefficient of friction that depends on the angle of the rail's surface."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from solved import friction, solved

import railhead as rh

CROWN = 80.0
PAIRS = [[0, 0.2], [4, 0.6]]
KINDS = {
    "half-spaces": {"effects.finite_bodies": "off"},
    "solids": {"mesh.patch_size": "2 mm"},
    "unlike solids": {"mesh.patch_size": "2.5 mm", "wheel.poisson_ratio": 0.25},
}


def slides(kind: str, coefficient: object) -> rh.Result:
    """A wheel that slips everywhere on the middle of a round rail."""
    scene = rh.Scene(
        load=60e3,
        rail=rh.Rail(profile="arc", crown_radius=CROWN),
        wheel=rh.Wheel(profile="arc", rolling_radius=420, transverse_radius=-120),
        friction={"coefficient": coefficient},
        rolling={"creepage_along": 0.2},
    )
    return solved(scene.replace(**KINDS[kind]))


@pytest.mark.parametrize("kind", KINDS)
def test_what_slips_everywhere_carries_the_integral_over_hertz_s_pressure(kind: str) -> None:
    """p over the chords is 3 N/(4 b) (1 - y^2/b^2), the angle at y on the circle -asin(y/R); only
    the side of the gauge, y < 0, has more than 0.2."""
    found = slides(kind, PAIRS)
    b = found.as_dict()["hertz"]["patch"]["b_mm"]

    def integral(arm: float) -> float:
        """Of mu p (1 - arm + arm y) over N."""

        def share(t: float) -> float:
            angle = -math.asin(t * b / CROWN)
            mu = np.interp(math.degrees(angle), *zip(*PAIRS, strict=True))
            return float(0.75 * (1 - t * t) * mu * (1 - arm - arm * CROWN * angle))

        return float(quad(share, -1, 1)[0])

    answer, within = friction(found), 2e-3 if kind == "half-spaces" else 0.01
    assert answer["force_along_N"] / 60e3 == pytest.approx(integral(0), rel=within)
    assert answer["coefficient"] == pytest.approx(integral(0), rel=within)
    assert answer["moment_Nmm"] / 60e3 == pytest.approx(-integral(1), rel=10 * within)


@pytest.mark.parametrize("kind", KINDS)
def test_pairs_of_one_coefficient_are_that_number(kind: str) -> None:
    one, other = (friction(slides(kind, each)) for each in (0.3, [[-3, 0.3], [2, 0.3]]))
    for name in ("force_along_N", "limit_N", "traction_max_MPa"):
        assert other[name] == pytest.approx(one[name], rel=1e-12)


def test_level_bodies_have_the_coefficient_of_no_angle() -> None:
    """Half-spaces, and a section along the rail."""
    for case, size in (("hertz_ellipse", None), ("long_roller", "0.5 mm")):
        scene = rh.find(case).replace(rolling={"creepage_along": 1e-3}, mesh={"patch_size": size})
        scene = scene.replace(effects={"finite_bodies": "auto" if size else "off"})
        one, other = (
            friction(solved(scene.replace(friction={"coefficient": each})))
            for each in (0.3, [[-10, 0.2], [10, 0.4]])
        )
        assert other["force_along_N"] == pytest.approx(one["force_along_N"], rel=1e-9)
