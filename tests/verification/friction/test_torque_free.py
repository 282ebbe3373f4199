"""A wheelset that rolls without torque: the Manchester benchmark, mirrors, unlike wheels."""

import csv
import math
from pathlib import Path

import pytest
from one_line import refusal
from solved import friction, passed

import railhead as rh
from railhead.half_spaces import torque_free

HERE = Path(__file__).parent
PROFILES = HERE.parents[1] / "rooms" / "railhead" / "geometry" / "data"
MU = 0.3


def positions() -> dict[float, dict[str, float]]:
    """Rows of CONTACT by shift, mm."""
    lines = (HERE / "data" / "manchester_a22_right.csv").read_text().splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return {float(row["shift_mm"]): {key: float(row[key]) for key in row} for row in rows}


def scene(shift: float, yaw: float, side: str = "right") -> rh.Scene:
    """Half-spaces of CONTACT's two files, which are canted."""
    return rh.find("s1002_60e1").replace(
        rail={"profile": str(PROFILES / "MBench_UIC60_v3.ban"), "inclination": 0},
        wheel={"profile": str(PROFILES / "MBench_S1002_v3.prw")},
        friction={"coefficient": MU},
        rolling={"from_wheelset": True, "axle": "torque_free"},
        wheelset={"shift": shift, "yaw": yaw, "side": side},
        effects={"finite_bodies": "off", "plasticity": "off"},
    )


@pytest.mark.parametrize("shift", [0.0, 0.5, 4.0, 7.0, 10.0])
def test_forces_and_moment_are_those_of_contact(shift: float) -> None:
    """Within 5 % of mu N, the moment, about CONTACT's point, of that times the half length.
    Stresses are not asked for: at shift 0 the largest one lies in a patch of few cells."""
    given = positions()[shift]
    result = passed(scene(shift, given["yaw_rad"]).replace(quantities=["patch", "forces"]))
    found, patch = friction(result), result.as_dict()["result"]["patch"]
    within, touch = 0.05 * MU * given["normal_N"], result.plan.contact.touch
    assert (found["force_along_N"], found["force_across_N"]) == pytest.approx(
        (given["along_N"], given["across_N"]), abs=within
    )
    aside = (touch.y - given["y_mm"]) / math.cos(given["angle_rad"])
    moment = found["moment_Nmm"] - aside * found["force_along_N"]
    half = max(patch["a_mm"], patch["b_mm"])
    assert moment == pytest.approx(given["moment_Nmm"], abs=half * within)
    radius = result.as_dict()["plan"]["wheelset"]["axle_radius_mm"]
    assert radius == pytest.approx(2000 / given["speed"], abs=0.05)


def wheelset(result: rh.Result) -> dict[str, float]:
    """How the wheelset stands and rolls."""
    return result.as_dict()["plan"]["wheelset"]


def unlike() -> rh.Scene:
    """Cylinders on round rails: one has a smaller radius, and friction grows up the rail."""
    return rh.Scene(
        load=80e3,
        rail=rh.Rail(profile="arc", crown_radius=300),
        wheel=rh.Wheel(rolling_radius=460),
        wheelset=rh.Wheelset(yaw=2e-3, shift=4, other_radius=459.5),
        friction={"coefficient": [[-1, 0.2], [1, 0.4]]},
        rolling={"from_wheelset": True, "axle": "torque_free"},
        effects={"finite_bodies": "off", "plasticity": "off"},
    )


@pytest.mark.parametrize("given", [scene(4.0, 0.0096), unlike()], ids=["Manchester", "unlike"])
def test_the_force_that_pulls_a_wheelset_without_torque_is_what_it_dissipates(given) -> None:
    """Power is force times speed; of the answers of each side, on finer grids than the axle's."""
    sides = [passed(each) for each in (given, given.opposite)]
    one, other = map(wheelset, sides)
    assert other["axle_radius_mm"] == pytest.approx(one["axle_radius_mm"], rel=1e-7)
    forces = [friction(each)["force_along_N"] for each in sides]
    dissipated = sum(friction(each)["t_gamma_N"] for each in sides)
    limit = sum(friction(each)["limit_N"] for each in sides)
    assert max(forces) > 0.05 * limit and sum(forces) == pytest.approx(dissipated, abs=2e-4 * limit)


def test_without_such_a_motion_the_answer_says_so_and_fails(monkeypatch) -> None:
    monkeypatch.setattr(torque_free, "BALANCE", -1.0)
    result = rh.solve(unlike(), quiet=True)
    assert result.summary["checks"]["failed"] == ["axle_torque"] and not result.passed
    assert "none without torque was found" in result.summary["plan"]["effects"]["friction"]["why"]


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"load": None, "approach": 0.05}, "rolling.axle: torque_free is not allowed with an"),
        ({"friction": {"coefficient": 0}}, "rolling.axle: torque_free is not allowed without"),
        ({"quantities": "patch"}, "quantities: rolling.axle torque_free needs the forces; add"),
        ({"effects": {"friction": "off"}}, "rolling.axle: torque_free is not allowed without"),
        ({"rolling": {"force_along": 10.0}}, "rolling.force_along: is not allowed beside an axle"),
        ({"rolling": {"from_wheelset": False}}, "rolling.axle: torque_free is not allowed without"),
    ],
)
def test_an_axle_without_torque_needs_load_and_friction_and_no_force(changed, said: str) -> None:
    assert refusal(lambda: unlike().replace(**changed)).startswith(said)
