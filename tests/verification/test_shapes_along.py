"""Surfaces that vary along the rail beside closed forms and boundary elements of other programs."""

import math

import pytest

import railhead as rh
from railhead.scene.scene import Scene

STEEL = {"young_modulus": 209920.0, "poisson_ratio": 0.28}
FLAT = {"kind": "flat", "length": 100.18, "depth": 0.9}
WHEEL = {"rolling_radius": 450.0, **STEEL}
BASE = Scene(
    load=10e3,
    rail={"profile": "arc", "crown_radius": 300.0, **STEEL},
    wheel=WHEEL,
    effects={"finite_bodies": "off"},
)
FINITE = {"effects.finite_bodies": "auto"}

ROUNDED = {5: (4.73, 686.7, 21.9), 3: (10.65, 643.6, 23.4), 0: (0.0, 373.0, 39.9)}
"""Degrees from the middle of the flat -> contact ahead of the axle (mm), largest pressure (MPa) and
area (mm2), by boundary elements on the exact shape that share no code with this program; two of
their grids differ by 0.01 %."""


def rounded(degrees: int, pressure_within: float, **changes: object) -> rh.Result:
    """The answer for a flat so many degrees from its middle, which meets ROUNDED."""
    ahead, pressure, area = ROUNDED[degrees]
    flat = {"surface": {**FLAT, "position": f"{degrees} deg"}}
    found = rh.solve(BASE.replace(wheel=flat, **changes))
    result = found.summary["result"]
    assert result["surface_shape"]["position_mm"] == pytest.approx(ahead, abs=0.03)
    assert result["pressure"]["max_MPa"] == pytest.approx(pressure, rel=pressure_within)
    assert result["patch"]["area_mm2"] == pytest.approx(area, rel=0.01) and found.passed
    return found


@pytest.mark.parametrize("degrees", ROUNDED)
def test_a_rounded_flat_by_half_spaces(degrees: int) -> None:
    rounded(degrees, 0.005)


@pytest.mark.parametrize(
    "degrees", [3, *(pytest.param(each, marks=pytest.mark.slow) for each in (5, 0))]
)
def test_a_rounded_flat_by_finite_elements(degrees: int) -> None:
    """Within the asked 1 %; both methods within their estimates."""
    found = rounded(degrees, 0.01, accuracy=0.01, **FINITE)
    assert found.summary["accuracy"]["bound"]["max_MPa"] < 0.01


def test_small_patches_on_crests_and_in_troughs_are_hertzian() -> None:
    """Curvature along 1/R with that of the waves, amplitude (2 pi / length)^2, added or taken off:
    exact Hertz of a wheel of another radius. At 50 N the patch is 0.02 of the wave long."""
    curvature = 0.05 * (2 * math.pi / 60.0) ** 2
    waves = {"kind": "cosine", "length": 60.0, "amplitude": 0.05}
    for position, radius in ((0.0, 1 / (1 / 450 + curvature)), (30.0, 1 / (1 / 450 - curvature))):
        scene = BASE.replace(["load=50"], rail={"surface": {**waves, "position": position}})
        found = rh.solve(scene)
        like = rh.solve(BASE.replace(["load=50", f"wheel.rolling_radius={radius!r}"]))
        assert found.plan.effects["surface_shape"].on and not like.plan.effects["surface_shape"].on
        hertz = like.summary["hertz"]
        for key, part in (("max_MPa", "pressure"), ("area_mm2", "patch")):
            value = found.summary["result"][part][key]
            assert value == pytest.approx(hertz[part][key], rel=0.004)
