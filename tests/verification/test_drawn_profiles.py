"""Design profiles as files of points: the answer is that of the shapes that were sampled."""

import numpy as np
import pytest
from solved import solved

import railhead as rh
from railhead.geometry import profiles

RAIL, WHEEL = profiles.rail_head("60E1"), profiles.s1002()
BASE = rh.find("s1002_60e1").replace(["effects.finite_bodies=off", "rail.inclination=1:40"])


def sampled(profile: profiles.Profile, step: float, path, digits: int, spread: float) -> str:
    """A file of points `step` mm apart along the profile, rounded to some digits. spread: share of
    the step by which single steps are longer or shorter, at random, at most."""
    y = np.linspace(*profile.domain, 100_001)
    s = np.concatenate([[0], np.cumsum(np.hypot(np.diff(y), np.diff(profile.height(y))))])
    steps = step * np.random.default_rng(3).uniform(1 - spread, 1 + spread, int(2 * s[-1] / step))
    places = np.concatenate([[0], steps.cumsum()])
    at = np.interp(places[places < s[-1]], s, y)
    points = np.column_stack([at, profile.height(at)])
    np.savetxt(path, points, f"%.{digits}f", ",", header="y [mm],z [mm]", comments="")
    return str(path)


EVEN = [(0.25, 6, 0.003, 0.015), (0.25, 4, 0.005, 0.03), (0.5, 6, 0.01, 0.03)]
UNEVEN = [(0.25, 6, 0.003, 0.02), (0.5, 6, 0.01, 0.03), (0.25, 3, 0.05, 0.25)]


@pytest.mark.parametrize(
    ("shift", "spread", "drawing"),
    [
        *((shift, 0.0, each) for shift in (2.0, 6.0) for each in EVEN),
        *((shift, 0.7, each) for shift in (1.0, 5.0) for each in UNEVEN),
    ],
)
def test_points_of_a_drawing_give_the_answer_of_the_drawing(
    shift, spread, drawing, tmp_path
) -> None:
    """Largest pressure and area; the estimate covers the change and is small. At 1 mm the patch
    lies where R300 meets R80, at 5 mm the largest pressure where R80 meets R13: there a spline
    through points 0.5 mm apart is off by 5 %, smoothing by 8 to 10 %."""
    step, digits, within, open_to = drawing
    true = BASE.replace([f"wheelset.shift={shift}"])
    rail, wheel = (
        sampled(profile, step, tmp_path / f"{name}.csv", digits, spread)
        for name, profile in (("rail", RAIL), ("wheel", WHEEL))
    )
    drawn = true.replace(
        [f"rail.profile={rail}", f"wheel.profile={wheel}", "rail.profile_mirror=off"]
    )
    one, other = (solved(each).as_dict() for each in (true, drawn))
    bound = other["accuracy"]["bound"]
    for table, key in (("pressure", "max_MPa"), ("patch", "area_mm2")):
        change = abs(other["result"][table][key] / one["result"][table][key] - 1)
        assert change < within and change < bound[key] < open_to
