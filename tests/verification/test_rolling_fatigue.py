"""Stresses of fatigue below rolling contacts against paths of exact stresses."""

import math

import numpy as np
import pytest
from solved import planned, solved

from railhead.results import pipeline, summary
from railhead.theory import fatigue
from railhead.theory.elastic.subsurface import EllipsoidalPressure
from railhead.theory.friction import sliding

SLIPS = "rolling.creepage_along=0.02", "friction.coefficient=0.3"


def exact(hertz, mu: float, depths: list[float], lines=(0.0,)) -> np.ndarray:
    """Stresses (d, 2) of Dang Van and Findley, MPa, below Hertz's pressure that slides along x, at
    depths over the smaller half length; the largest of lines at s over b. Closed forms."""
    reach = 1.0 if isinstance(hertz, EllipsoidalPressure) else 3.0  # sliding.stress is exact there
    beside = np.cosh(np.linspace(0.0, reach, 60))
    x = hertz.a * np.concatenate([-beside[::-1], -np.cos(np.linspace(0, math.pi, 200)), beside])
    found = []
    for deep in depths:
        z = -deep * min(hertz.half_lengths)
        places = [np.column_stack([x, 0 * x + s * hertz.b, 0 * x + z]) for s in lines]
        paths = np.stack([sliding.stress(hertz, mu, 0.3, each) for each in places])
        paths = np.pad(paths, ((0, 0), (0, 1), (0, 0)))
        found.append([fatigue.dang_van(paths, 0.33)[0].max(), fatigue.findley(paths, 0.3)[0]])
    return np.array(found)


def at(result, depths: list[float]) -> np.ndarray:
    """The same of a result, between its depths."""
    own, patch = result.summary["result"]["fatigue"]["profile"], result.summary["result"]["patch"]
    places = np.array(depths) * min(patch["a_mm"], patch["b_mm"])
    keys = "dang_van_MPa", "findley_MPa"
    return np.column_stack([np.interp(places, own["depth_mm"], own[key]) for key in keys])


@pytest.mark.parametrize(("slips", "within"), [((), 0.01), (SLIPS, 0.02)])
def test_ellipse_of_half_spaces(slips, within) -> None:
    result, depths = solved("hertz_ellipse", "effects.finite_bodies=off", *slips), [0.2, 0.45, 0.7]
    patch = result.summary["result"]["patch"]
    p0 = result.summary["result"]["pressure"]["max_MPa"]
    hertz = EllipsoidalPressure(a=patch["a_mm"], b=patch["b_mm"], p0=p0)
    lines = 0.0, 0.4, 0.8
    assert at(result, depths) == pytest.approx(
        exact(hertz, 0.3 * bool(slips), depths, lines), rel=within
    )
    if slips:
        top = at(result, [0.01])[0]
        assert top == pytest.approx(exact(hertz, 0.3, [0.01], lines)[0], rel=0.01)
        own = result.summary["result"]["fatigue"]
        assert own["fi_subsurface_MPa"] == pytest.approx(p0 / 6 * 1.09, rel=2e-3)
        assert own["depth_mm"]["dang_van"] < 0.02 * min(patch["a_mm"], patch["b_mm"])


@pytest.mark.parametrize(("slips", "depths"), [((), [0.25, 0.5, 0.8]), (SLIPS, [0.01, 0.25, 0.5])])
def test_line_by_finite_elements(slips, depths) -> None:
    """Of a head 70 mm wide, which is no half-space: 2 % of its pressure's closed form."""
    result, hertz = solved("long_roller", *slips), planned("long_roller").hertz
    assert at(result, depths) == pytest.approx(exact(hertz, 0.3 * bool(slips), depths), rel=0.01)


@pytest.mark.parametrize(
    "case", [["hertz_ellipse"], ["long_roller", "rail.extent=half-space"]], ids=["ellipse", "line"]
)
def test_uniform_residual_stress_adds_its_hydrostatic_part_to_dang_van(case, monkeypatch) -> None:
    """The amplitude does not see a stress that stays: c times the mean of xx, yy and zz is added,
    and Findley's stress on a plane grows by k times the normal stress that stays on it, here the
    same on all planes."""
    read, left = summary.fatigue.read, []

    def with_residual(*given, **keys):
        left.append(keys.pop("residual"))
        bare = read(*given, **keys)
        stays = {name: np.zeros(6) for name in ("along", "all")}
        stays["along"][:2], stays["all"][:3] = (-150.0, 60.0), 80.0

        def uniform(stress):
            return lambda depth, across: np.tile(stress, (depth.size, across.size, 1))

        found = {
            name: read(*given, **keys, residual=uniform(each))["profile"]
            for name, each in stays.items()
        }
        more = [np.array(found["along"]["dang_van_MPa"]), np.array(found["all"]["findley_MPa"])]
        own = [np.array(bare["profile"][key]) for key in ("dang_van_MPa", "findley_MPa")]
        assert more[0] - own[0] == pytest.approx(0.33 * -90 / 3, abs=0.5)
        assert more[1] - own[1] == pytest.approx(0.3 * 80, abs=0.5)
        return bare

    monkeypatch.setattr(summary.fatigue, "read", with_residual)
    result = pipeline.run(planned(*case, "effects.finite_bodies=off").scene)
    assert left == [None] and "fatigue" in result.summary["result"]


def test_limits_are_those_of_the_scene_alone() -> None:
    fast = "effects.finite_bodies=off"
    free = solved("hertz_ellipse", fast, *SLIPS).summary["result"]["fatigue"]
    assert free["fi_surface"] is None and "dang_van_over_limit" not in free
    keys = "rail.dang_van=[0.5, 200]", "rail.findley=[0, 300]", "rail.yield_stress=400"
    given = solved("hertz_ellipse", fast, "effects.plasticity=off", *SLIPS, *keys).summary["result"]
    own = given["fatigue"]
    assert own["dang_van_MPa"] > free["dang_van_MPa"]  # behind a sliding wheel steel is pulled
    assert own["findley_MPa"] < free["findley_MPa"]
    assert (own["dang_van_over_limit"], own["findley_over_limit"]) == pytest.approx(
        (own["dang_van_MPa"] / 200, own["findley_MPa"] / 300)
    )
    assert own["fi_surface"] == pytest.approx(
        0.3 - 400 / math.sqrt(3) / given["pressure"]["max_MPa"], abs=2e-3
    )
