"""Design profiles as files of points: the answer is that of the shapes that were sampled."""

import numpy as np
import pytest

import railhead as rh
from railhead.geometry import profiles

RAIL, WHEEL = profiles.rail_head("60E1"), profiles.s1002()
BASE = rh.find("s1002_60e1").replace(["effects.finite_bodies=off", "rail.inclination=1:40"])


def sampled(profile: profiles.Profile, step: float, path, digits: int) -> str:
    """A file of points `step` mm apart along the profile, rounded to some digits."""
    y = np.linspace(*profile.domain, 100_001)
    s = np.concatenate([[0], np.cumsum(np.hypot(np.diff(y), np.diff(profile.height(y))))])
    at = np.interp(np.arange(0, s[-1], step), s, y)
    points = np.column_stack([at, profile.height(at)])
    np.savetxt(path, points, f"%.{digits}f", ",", header="y [mm],z [mm]", comments="")
    return str(path)


@pytest.mark.parametrize("shift", [2.0, 6.0])
@pytest.mark.parametrize(
    ("step", "digits", "within", "open_to"),
    [(0.25, 6, 3e-3, 0.015), (0.25, 4, 5e-3, 0.03), (0.5, 6, 1e-2, 0.03)],
)
def test_points_of_a_drawing_give_the_answer_of_the_drawing(
    shift, step, digits, within, open_to, tmp_path
) -> None:
    """Largest pressure and area; the estimate covers the change and is small."""
    true = BASE.replace([f"wheelset.shift={shift}"])
    rail, wheel = (
        sampled(profile, step, tmp_path / f"{name}.csv", digits)
        for name, profile in (("rail", RAIL), ("wheel", WHEEL))
    )
    drawn = true.replace(
        [f"rail.profile={rail}", f"wheel.profile={wheel}", "rail.profile_mirror=off"]
    )
    one, other = (rh.solve(each, quiet=True).as_dict() for each in (true, drawn))
    bound = other["accuracy"]["bound"]
    for table, key in (("pressure", "max_MPa"), ("patch", "area_mm2")):
        change = abs(other["result"][table][key] / one["result"][table][key] - 1)
        assert change < within and change < bound[key] < open_to
