"""Where a wheel touches a rail that is given by sections, against closed forms."""

import json
from pathlib import Path
from typing import Any

import drawn_sections as drawn
import numpy as np
import pytest

import railhead as rh
from railhead.contact import crossing, head_loads, placed_bodies
from railhead.geometry import profiles
from railhead.half_spaces.allowance import added_stress
from railhead.meshing.bodies import RAIL
from railhead.scene import catalogue
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps import sweep_table

OFF = {"finite_bodies": "off"}


def scene(position: float, rail: str, wing: str | None = None, **wheel: Any) -> Scene:
    """A wheel of radius 460 mm at a position over heads in tables of sections."""
    tables: dict[str, Any] = {"rail": {"sections": rail, "position": position}}
    if wing:
        tables["wing"] = {"sections": wing}
    wheel = {"profile": "cone40", "rolling_radius": 460.0} | wheel
    return Scene.from_mapping({"load": 80000.0, "wheel": wheel, **tables})


@pytest.fixture(scope="module")
def nose(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Table of the nose of case 6."""
    places = [*range(80, 230, 10), *range(230, 400, 5)]
    return drawn.write(
        tmp_path_factory.mktemp("nose"), places, lambda x: drawn.moved(drawn.nose(x), -20.0)
    )


@pytest.fixture(scope="module")
def wing(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Table of the wing of case 6."""
    return drawn.write(tmp_path_factory.mktemp("wing"), range(40, 400, 10), drawn.wing)


# Case 6 of the reference: place of the axle; x, y and height alone on nose and wing, mm; the axes
# of the gap on the wing are turned by 15.3 deg.
TOUCHES = [
    (192.0, (210.4073, -22.0010, -3.42671), (186.2616, 36.1279, -3.29540)),
    (194.5, (212.9073, -22.0010, -3.32671), (188.7617, 36.3779, -3.32665)),
    (300.0, (307.7772, -21.9997, 0.10277), (294.2650, 46.9283, -4.64542)),
]


@pytest.mark.parametrize(("position", "on_nose", "on_wing"), TOUCHES)
def test_a_wheel_touches_ahead_on_a_rising_nose_and_behind_on_a_falling_wing(
    nose: str, wing: str, position: float, on_nose: Any, on_wing: Any
) -> None:
    """Places to 0.5 um of case 6, heights to 0.01 um."""
    found = crossing.touch(scene(position, nose, wing))
    for name, truth in (("rail", on_nose), ("wing", on_wing)):
        touch = found.heads[name].touches[0]
        assert (position + touch.x, touch.y) == pytest.approx(truth[:2], abs=5e-4)
        assert found.alone(name) == pytest.approx(truth[2], abs=1e-5)
    assert found.height(found.lift) == pytest.approx(max(on_nose[2], on_wing[2]), abs=1e-5)
    turned = np.degrees(found.heads["wing"].touches[0].orientation)
    assert turned == pytest.approx(15.36, abs=0.02)


def test_both_heads_touch_where_the_load_goes_over(nose: str, wing: str) -> None:
    """Both of case 6 touch at 194.5012 mm."""
    before, after = (crossing.touch(scene(at, nose, wing)) for at in (194.50, 194.51))
    gaps = [each.alone("rail") - each.alone("wing") for each in (before, after)]
    assert np.interp(0.0, gaps, [194.50, 194.51]) == pytest.approx(194.5012, abs=3e-4)
    assert before.touching(0.05) == ["rail", "wing"]
    assert crossing.touch(scene(190.0, nose, wing)).touching(0.05) == ["wing"]


def test_a_ramp_lifts_the_wheel_by_more_than_its_height_below_the_axle(tmp_path: Path) -> None:
    """Case 3, slope 0.05: first contact at x = 22.9713 mm, height 0.57464 mm (pitfall 6)."""
    table = drawn.write(tmp_path, range(-80, 101, 20), lambda x: drawn.arcs(0.0) + [0.0, 0.05 * x])
    found = crossing.touch(scene(0.0, table, profile="cylinder"))
    touch = found.heads["rail"].touches[0]
    assert (touch.x, touch.y) == pytest.approx((22.9713, 0.0), abs=1e-4)
    assert found.height(found.lift) == pytest.approx(0.57464, abs=1e-5)
    assert touch.upright == pytest.approx(1 / np.hypot(1, 0.05))
    assert touch.curvature_x == pytest.approx(1 / 460, rel=1e-5)


def test_roll_lowers_the_field_side_by_its_angle(nose: str, wing: str) -> None:
    """1 mrad changes the heights of two heads 58 mm apart against each other by 0.058 mm (pitfall
    10).
    """
    plain = scene(194.5, nose, wing)
    rolled = plain.replace(wheelset={"roll": 1e-3})
    here, there = (crossing.touch(each) for each in (plain, rolled))
    apart = here.heads["wing"].touches[0].y - here.heads["rail"].touches[0].y
    moved = [each.alone("rail") - each.alone("wing") for each in (here, there)]
    assert moved[1] - moved[0] == pytest.approx(1e-3 * apart, rel=0.02)


def test_a_bar_that_goes_aside_is_a_straight_rail_under_a_yawed_wheel(tmp_path: Path) -> None:
    """Sections y cos t that go aside by tan t, and a wheelset turned by t, are a straight rail."""
    turn = 0.02
    straight = drawn.wing(0.0)

    def aside(x: float) -> Any:
        """Section across x of the straight bar turned about z."""
        return straight * [1 / np.cos(turn), 1.0] + [np.tan(turn) * x, 0.0]

    tables = [
        drawn.write(tmp_path / name, range(-60, 61, 10), points)
        for name, points in (("straight", lambda x: straight), ("aside", aside))
    ]
    plain = crossing.touch(scene(0.0, tables[0])).heads["rail"].touches[0]
    yawed = scene(0.0, tables[1]).replace(wheelset={"yaw": turn})
    turned = crossing.touch(yawed).heads["rail"].touches[0]
    assert turned.gap == pytest.approx(plain.gap, abs=1e-6)
    assert (turned.curvature_x, turned.curvature_y) == pytest.approx(
        (plain.curvature_x, plain.curvature_y), rel=0.0001
    )


def test_what_a_crossing_does_not_have_is_refused_in_a_line(nose: str, wing: str) -> None:
    """Positions beyond the sections and at their ends (pitfall 13), keys of a straight rail, wings
    without a rail of sections, finite elements, friction, heights on the rail and unlike steels."""
    fast, two = scene(194.5, nose, wing).replace(effects=OFF), scene(194.5, nose, wing)
    hard = scene(120.0, nose, wing).replace(rail={"yield_stress": 400.0})

    def read(**tables: Any) -> Scene:
        return Scene.from_mapping({"load": 1000.0, **tables})

    for call, said in (
        (lambda: crossing.touch(scene(500.0, nose, wing)),
         "500 is beyond the sections; give 40 to 395 mm"),
        (lambda: crossing.touch(scene(42.0, wing)), "42 lets the wheel touch at an end"),
        (lambda: read(rail={"sections": nose, "profile": "60E1"}),
         "profile: is not allowed beside"),
        (lambda: read(rail={"position": 3.0}), "position: 3 is not allowed without sections"),
        (lambda: crossing.touch(scene(300.0, nose, nose)), "rail.sections: lies where the wing is"),
        (lambda: read(wing={"sections": nose}), "not given; a wing needs sections of both heads"),
        (lambda: rh.plan(two.replace(friction={"coefficient": 0.3, "force_along": 1e3})),
         "friction: is not simulated on two heads by finite elements; leave it out, or --fast"),
        (lambda: rh.plan(two.replace(wing={"yield_stress": 400.0})),
         "wing.yield_stress: is not that of the rail, and finite elements know one"),
        (lambda: rh.plan(scene(390.0, nose)), "position: 390 is .* mm from the end of the head"),
        (lambda: rh.plan(hard),
         "wing.yield_stress: is not that of the rail, and finite elements know one"),
        (lambda: fast.replace(wing={"friction_coefficient": 0.2}),
         "wing.friction_coefficient: needs a friction.coefficient, and friction.law coulomb"),
        (lambda: fast.replace(rail={"friction_coefficient": 0.2}),
         "rail.friction_coefficient: is not allowed; give friction.coefficient"),
        (lambda: rh.plan(scene(180.0, nose).replace(**ROLLS)),
         "rolling: is not simulated yet on a rail of sections; leave it out, or --fast"),
        (lambda: rh.plan(scene(120.0, nose).replace(
            effects=OFF, rail={"yield_stress": 300.0}, rolling={"passes": 2})),
         "rolling.passes: 2 is not allowed: the rail has sections, so nothing is steady"),
        (lambda: rh.plan(fast.replace(wing={"young_modulus": 1e5})),
         "wing.young_modulus: is not simulated yet"),
    ):  # fmt: skip
        with pytest.raises(SceneError, match=said):
            call()


def solved(given: Scene) -> dict[str, Any]:
    """summary.json of a scene between half-spaces, its patches alone."""
    return rh.solve(given.replace(effects=OFF, quantities="patch"), quiet=True).summary


# Case 6 with each body one half-space (c = 1): place of the axle; share of the nose, largest
# pressures on nose and wing, MPa, height of the loaded wheel, mm.
SHARES = [
    (193.75, 0.19616, 1105.3, 1060.0, -3.39631),
    (194.5, 0.42838, 1434.0, 946.2, -3.39058),
    (195.25, 0.67284, 1666.9, 785.6, -3.38144),
]


@pytest.mark.parametrize(("position", "share", "on_nose", "on_wing", "height"), SHARES)
def test_two_heads_share_the_load_under_one_sink(
    nose: str, wing: str, position: float, share: float, on_nose: float, on_wing: float, height: Any
) -> None:
    """Shares, pressures and heights are those of boundary elements of the reference."""
    result = solved(scene(position, nose, wing))["result"]
    heads = result["heads"]
    assert heads["rail"]["share"] == pytest.approx(share, abs=3e-4)
    assert sum(each["force_N"] for each in heads.values()) == pytest.approx(80000, rel=1e-5)
    assert heads["rail"]["max_MPa"] == pytest.approx(on_nose, rel=1e-3)
    assert heads["wing"]["max_MPa"] == pytest.approx(on_wing, rel=5e-4)
    assert result["wheel_height_mm"]["loaded"] == pytest.approx(height, abs=2e-5)
    places = {each["head"]: each["centre_mm"] for each in result["patches"]}
    alone = np.array([[18.407, -22.001], [-5.7383, 36.3778 + (position - 194.5) / 10]])
    apart = alone[0] - alone[1]
    tilt = apart / (np.pi * 113736 * np.linalg.norm(apart) ** 3)  # by 1 N on the other head
    for name, other, place, radius in zip(heads, [*heads][::-1], alone, (80, 300), strict=True):
        away = tilt * heads[other]["force_N"] * (1 if name == "rail" else -1)
        assert places[name][:2] == pytest.approx(place + away * [460, radius], abs=5e-3)


@pytest.mark.parametrize(
    ("position", "one", "other"), [(193.0, 1131.4, -2.0), (196.0, 1830.5, -4.8)]
)
def test_the_estimate_holds_what_rails_that_are_apart_change(
    nose: str, wing: str, position: float, one: float, other: float
) -> None:
    """The largest pressure where the wheel is one half-space, and rails two (c = 0.5 of case 6)."""
    found = solved(scene(position, nose, wing))
    parts, p = found["accuracy"]["parts"]["max_MPa"], found["result"]["pressure"]["max_MPa"]
    change = one / p - 1
    assert change * p == pytest.approx(other, abs=1.0)  # boundary elements in planes
    assert abs(change) < parts["share"] < 0.05


def test_a_head_ends_where_its_section_does(nose: str) -> None:
    """The stress that the free sides of a nose add is that of their distance from the patch,
    F/(4 pi d^2), whatever the profile of a plain rail."""
    plan = rh.plan(scene(180.0, nose).replace(effects={"finite_bodies": "off"})).plan
    pair, pressed = plan.context.half_spaces, plan.context.half_spaces.boundary_elements
    (span,) = pair.developed.sections
    apart = min(abs(end - pressed.patches[0].centroid[1]) for end in span.ends)
    own = pressed.patches[0].force / (4 * np.pi * apart**2)
    assert added_stress(pair, [RAIL], pressed) == pytest.approx(own, rel=1e-9)


def test_a_slope_along_the_rail_makes_a_force_along_it(tmp_path: Path) -> None:
    """Case 3, slope 0.05: 1137.85 MPa, 105.59 mm2, sink 0.09076 mm; N = F/nz has the part F s."""
    table = drawn.write(tmp_path, range(-80, 101, 20), lambda x: drawn.arcs(0.0) + [0.0, 0.05 * x])
    result = solved(scene(0.0, table, profile="cylinder"))["result"]
    assert result["pressure"]["max_MPa"] == pytest.approx(1137.85, rel=3e-4)
    assert result["patch"]["area_mm2"] == pytest.approx(105.59, rel=3e-3)
    assert result["approach_mm"] == pytest.approx(0.09076, abs=1e-5)
    assert result["contact_point_mm"][0] == pytest.approx(22.971, abs=2e-3)
    assert result["force_along_N"] == pytest.approx(0.05 * 80000, rel=1e-3)


ROLLS = {
    "friction": {"coefficient": 0.3},
    "rolling": {"creepage_along": 0.0015, "creepage_across": 0.0007, "spin": 0.0002},
}


FORCES = ("force_along_N", "force_across_N")


def rolled(given: Scene) -> list[float]:
    """Largest pressure, MPa, and tractions' forces, N, of a scene that rolls."""
    result = rh.solve(given.replace(effects=OFF, quantities="forces", **ROLLS), quiet=True).summary
    found = result["result"]
    return [found["pressure"]["max_MPa"], *map(found["friction"].get, FORCES)]


# Case 6 at 194.5 mm: x from the axle and y of the contacts, mm, and slope of the height alone; that
# of the loaded height, by a spline through those of c = 1 at 193 to 196 mm.
AT = {"rail": (18.4073, -22.0010, 0.04), "wing": (-5.7383, 36.3779, -0.0125)}
CLIMBS = 0.00998


def creepages(x: float, y: float, rise: float) -> list[float]:
    """Creepages along and across of a cone of 1:40, R 460, at a place x, y (mm) of a head with a
    rise, where its axle moves along the slope CLIMBS and turns once in 2 pi R.
    """
    radius = 460 - y / 40
    down = np.sqrt(radius**2 - x**2)
    goes = np.array([1, 0, CLIMBS]) / np.hypot(1, CLIMBS)
    slip = goes + np.cross([0, 1 / 460, 0], [x, y, -down])
    along = np.array([1, 0, rise]) / np.hypot(1, rise)
    across = np.cross(np.cross([1, 0, rise], [0, 1, radius / down / 40]), along)
    return [float(slip @ along), float(slip @ across / np.linalg.norm(across))]


def test_each_of_two_heads_rubs_with_its_own_creepages_and_coefficient(
    nose: str, wing: str
) -> None:
    """One rigid motion at two places, whose axle climbs with the load that goes over. The vertical
    parts of pressure and tractions of both heads, each with its own mu N, are the load.
    """
    given = scene(194.5, nose, wing).replace(effects=OFF, quantities="forces")
    rolling = {"from_wheelset": True, "axle": "nominal"}
    given = given.replace(friction={"coefficient": 0.3}, rolling=rolling)
    result = rh.solve(given.replace(wing={"friction_coefficient": 0.1}), quiet=True).summary[
        "result"
    ]
    down = []
    for (name, place), mu in zip(AT.items(), (0.3, 0.1), strict=True):
        head = result["heads"][name]
        found = head["friction"]
        known = [found["creepage_along"], found["creepage_across"]]
        assert known == pytest.approx(creepages(*place), abs=2e-5)
        rise, cone = place[2], 1 / 40
        upright = 1 / np.sqrt(1 + rise**2 + cone**2)
        lifted = [rise, cone * np.cos(np.arctan(rise))] @ np.array([found[key] for key in FORCES])
        down.append(found["limit_N"] / mu * upright - lifted)
        assert head["force_N"] == pytest.approx(down[-1], rel=2e-3)
    assert sum(down) == pytest.approx(80000.0, rel=2e-4)
    sizes = [
        np.hypot(*(head["friction"][key] for key in FORCES)) for head in result["heads"].values()
    ]
    assert result["heads"]["wing"]["friction"]["share"] == pytest.approx(sizes[1] / sum(sizes))


def test_sections_of_a_standard_rail_answer_as_it_does_on_the_gauge_corner(tmp_path: Path) -> None:
    """S1002 on 60E1, conformal between R 80 and R 13, where half-spaces in a plane are 5 % off;
    the sections' wheel hangs where the wheelset puts it. Rolling, too."""
    head = profiles.rail_head("60E1", 1 / 40)
    y = np.union1d(np.arange(*head.domain, 0.1), head.joints)
    table = drawn.write(tmp_path, [-100, 0, 100], lambda x: np.column_stack([y, head.height(y)]))
    plain = Scene.from_mapping(
        {
            "load": 80000.0,
            "rail": {"profile": "60E1", "inclination": 1 / 40},
            "wheel": {"profile": "S1002", "rolling_radius": 460.0},
            "wheelset": {"shift": 3.0},
        }
    )
    placed = rh.plan(plain.replace(effects=OFF)).plan.contact
    hanging = {"shift": placed.pose.origin[1], "roll": placed.placed.roll}
    of = scene(0.0, table, profile="S1002").replace(wheelset=hanging)
    assert rolled(of) == pytest.approx(rolled(plain), rel=2e-3)


def test_a_roller_is_a_hump_and_discs_roll_as_a_wheel_of_half_the_radius() -> None:
    """Case 2: R 300 across on R 5000 along, 1169.58 MPa and 102.60 mm2. Discs of 150 mm have the
    pressure and the tractions of a wheel of 75 mm on a rail."""

    def on(crown: float, roller: float | None, radius: float, load: float) -> Scene:
        """A cylinder of a radius on an arc."""
        rail = {"profile": "arc", "crown_radius": crown, "roller_radius": roller}
        wheel = {"profile": "cylinder", "rolling_radius": radius}
        steel = {"young_modulus": 207000.0, "poisson_ratio": 0.3}
        return Scene.from_mapping({"load": load, "rail": rail | steel, "wheel": wheel | steel})

    hump = solved(on(300.0, 5000.0, 460.0, 80000.0))["result"]
    assert hump["pressure"]["max_MPa"] == pytest.approx(1169.58, rel=3e-4)
    assert hump["patch"]["area_mm2"] == pytest.approx(102.60, rel=2e-3)
    discs, wheel = rolled(on(100.0, 150.0, 150.0, 5e3)), rolled(on(100.0, None, 75.0, 5e3))
    assert discs == pytest.approx(wheel, rel=6e-3)
    with pytest.raises(SceneError, match="gauge: is not allowed beside roller_radius"):
        on(300.0, 5000.0, 460.0, 8e4).replace(rail={"gauge": 1435.0})


def test_a_prism_that_rises_rolls_as_a_level_one(tmp_path: Path) -> None:
    """Sections z / cos t that rise by tan t are a straight rail under N cos t - T sin t."""
    t, found = 0.05, []
    for turn in (0.0, t):
        table = drawn.write(
            tmp_path / f"{turn}",
            [-100, 0, 100],
            lambda x, turn=turn: drawn.arcs(0.0) * [1, 1 / np.cos(turn)] + [0, np.tan(turn) * x],
        )
        load = 80000 * np.cos(turn) - (found[0][1] * np.sin(turn) if turn else 0.0)
        found.append(rolled(scene(0.0, table).replace(load=load)))
    assert found[1] == pytest.approx(found[0], rel=1e-3)


def test_a_result_of_a_crossing_keeps_its_sections(nose: str, tmp_path: Path) -> None:
    """The scene in a result folder names a table whose sections lie beside it."""
    given = scene(200.0, nose)
    catalogue.copy_files(given.files, tmp_path)
    copied = scene(200.0, str(tmp_path / catalogue.portable(given)["rail"]["sections"]))
    assert crossing.touch(copied).lift == crossing.touch(given).lift


def test_the_estimate_knows_the_distance_of_the_sections(tmp_path: Path) -> None:
    """Of waves 240 mm long sections 30 mm apart leave more open than those 15 mm apart, and the
    estimate holds the difference.
    """
    found = []
    for apart in (7.5, 15.0, 30.0):
        places = np.arange(-120.0, 121.0, apart)
        table = drawn.write(
            tmp_path / f"{apart:g}",
            places,
            lambda x: drawn.arcs(0.0) + [0.0, 3.0 * np.cos(np.pi * x / 120)],
        )
        summary = solved(scene(11.0, table, profile="cylinder"))
        found.append(
            (
                summary["result"]["pressure"]["max_MPa"],
                summary["accuracy"]["parts"]["max_MPa"]["profile"],
            )
        )
    (fine, least), (middle, more), (coarse, most) = found
    assert least < more < most and abs(coarse / fine - 1) < most and abs(middle / fine - 1) < more


def test_a_blade_in_the_root_of_a_flange_takes_its_share(tmp_path: Path) -> None:
    """Case 7 at 209.25 mm: 43669 N and 2512.0 MPa on the blade, R 13 in R 25, 874.8 MPa on the
    stock rail, in planes; developed along R 13 the force differs by 0.25 %. The estimate holds
    finite elements of 910 000 unknowns at 205.25 mm, whose rim gives way aside.
    """
    places = range(160, 261, 20)
    given = scene(
        209.25,
        drawn.write(tmp_path / "blade", places, drawn.blade),
        drawn.write(tmp_path / "stock", places, drawn.stock),
        profile=drawn.root_wheel(tmp_path / "wheel.csv"),
        profile_origin="file",
        profile_flip="off",
        profile_mirror="off",
    )
    summary = solved(given)
    heads = summary["result"]["heads"]
    assert (heads["rail"]["force_N"], heads["rail"]["max_MPa"]) == pytest.approx(
        (43669, 2512.0), rel=0.004
    )
    assert heads["wing"]["max_MPa"] == pytest.approx(874.8, rel=2e-3)
    summary = solved(given.replace(rail={"position": 205.25}))
    pressure, by_elements = summary["result"]["pressure"]["max_MPa"], 2084.9
    change = abs(by_elements / pressure - 1)
    assert change < summary["accuracy"]["bound"]["max_MPa"] < 3 * change


@pytest.mark.parametrize("case", ["hump", "nose"])
def test_finite_elements_have_the_closed_forms_of_one_head(
    nose: str, tmp_path: Path, case: str
) -> None:
    """Largest pressure and area of cases 2 and 5 of the reference, within the estimates; place of
    the first contact, ahead of the axle, and height of the wheel without load. Half-spaces of
    the same scene agree within both estimates."""
    if case == "hump":
        rail = drawn.write(tmp_path, range(-70, 71, 10), drawn.arcs)
        of, truth = scene(30.0, rail, profile="cylinder"), (1169.58, 102.60, -2.5275, -0.08242)
    else:
        of, truth = scene(180.0, nose), (1902.80, 63.14, 18.4073, -3.90671)
    steel = {"young_modulus": 207000.0, "poisson_ratio": 0.3}
    of = of.replace(rail=steel, wheel=steel)
    found = rh.solve(of, quiet=True).summary
    result, bound = found["result"], found["accuracy"]["bound"]
    assert result["pressure"]["max_MPa"] == pytest.approx(truth[0], rel=bound["max_MPa"])
    assert result["patch"]["area_mm2"] == pytest.approx(truth[1], rel=bound["area_mm2"])
    assert bound["max_MPa"] < 0.01 and bound["area_mm2"] < 0.01
    assert result["contact_point_mm"][0] == pytest.approx(truth[2], abs=0.02)
    assert result["wheel_height_mm"]["rigid"] == pytest.approx(truth[3], abs=1e-4)
    assert found["checks"]["passed"] and "second_opinion_max_MPa" not in found["checks"]["not_made"]


def test_two_heads_are_meshed_on_one_foot(nose: str, wing: str) -> None:
    """Each is its section at its contact; the foot is as deep as both sections are drawn."""
    plan = rh.plan(scene(194.5, nose, wing)).plan
    rail = plan.contact.pair.rail
    for place, of in (
        (18.407, drawn.moved(drawn.nose(212.907), -20)),
        (-5.738, drawn.wing(188.762)),
    ):
        y = of[np.abs(of[:, 0] - of[:, 0].mean()) < 7, 0]
        assert rail.height(y) == pytest.approx(np.interp(y, *of.T), abs=1e-3), place
    feet = drawn.nose(212.907)[-1] + [-20, 0], drawn.wing(188.762)[0]
    for y, z in feet:
        assert rail.height(y) == pytest.approx(z, abs=0.3)
    places = np.array([zone.centre for zone in plan.forecast.zones])
    assert places[:, :2] == pytest.approx(np.array([[-5.738, 36.378], [18.407, -22.001]]), abs=0.1)
    assert (
        plan.effects["surface_shape"].on and "swept straight" in plan.effects["surface_shape"].why
    )


def test_the_foot_is_thicker_than_a_groove_between_heads_is_deep(wing: str, tmp_path: Path) -> None:
    """A nose that is drawn 60 mm deep: its section does not cross the lower side of the block."""
    y = np.arange(-24.0, 24.1, 0.25)
    points = np.column_stack([y - 20, drawn.head(y, 80, 9.0, -3.88, 0.0)])
    deep = drawn.write(tmp_path, range(140, 261, 20), lambda x: points)
    plan = rh.plan(scene(194.5, deep, wing)).plan
    bodies = placed_bodies.bodies(plan.contact, 50.0, [RAIL], whole_section=False, half=False)
    of = bodies[0].section
    groove, base = (
        min(curve.points[:, 1].min() for curve in of if curve.role == role)
        for role in ("contact", "support")
    )
    assert groove < -60 and base == pytest.approx(groove - 25)


@pytest.mark.slow
def test_finite_elements_share_the_load_of_two_heads(nose: str, wing: str) -> None:
    """Case 6 with each body one half-space, which stand on one foot here."""
    steel = {"young_modulus": 207000.0, "poisson_ratio": 0.3}
    given = scene(194.5, nose, wing).replace(
        rail=steel, wing=steel, wheel=steel, quantities="patch"
    )
    found = rh.solve(given, quiet=True).summary
    heads, (_, share, on_nose, on_wing, _) = found["result"]["heads"], SHARES[1]
    assert heads["rail"]["share"] == pytest.approx(share, abs=2e-3)
    assert heads["rail"]["max_MPa"] == pytest.approx(on_nose, rel=5e-3)
    assert heads["wing"]["max_MPa"] == pytest.approx(on_wing, rel=5e-3)
    assert found["checks"]["passed"] and found["accuracy"]["bound"]["max_MPa"] < 0.02


# Sweeps over the position: close positions, and one sentence where the load goes over.

# Position of the axle, share of the nose (c = 1), largest pressure, MPa.
GOES_OVER = {
    192.0: (0.0, 1140.1),
    193.0: (0.01743, 1133.4),
    **{at: (share, max(pressures)) for at, share, *pressures, _ in SHARES},
    196.0: (0.89794, 1835.3),
    300.0: (1.0, 1985.5),
}


@pytest.fixture(scope="module")
def passage(nose: str, wing: str) -> Scene:
    """Nose and wing of case 6 between half-spaces."""
    return scene(194.0, nose, wing).replace(effects=OFF, quantities="patch")


@pytest.mark.parametrize("position", [193.0, 194.5, 196.0, 300.0])
def test_springs_of_hertz_share_the_load_as_boundary_elements_do(
    passage: Scene, position: float
) -> None:
    """The reference has them in planes, with each body one half-space."""
    assert head_loads.share(passage, position) == pytest.approx(GOES_OVER[position][0], abs=1e-3)


def test_positions_are_close_where_the_load_goes_over(passage: Scene) -> None:
    """From one to the next no share changes by more than 0.1; far away none is added."""
    found = head_loads.refined(passage, {"rail.position": [180.0, "200 mm", 220.0]})[
        "rail.position"
    ]
    assert np.abs(np.diff([head_loads.share(passage, at) for at in found])).max() <= 0.1
    assert {180.0, 200.0, 220.0} <= {*found} and 13 <= len(found) <= 25
    assert not [at for at in found if 200 < at < 220]
    plain = {"load": [1e4, 2e4]}
    assert head_loads.refined(passage, plain) == plain


def rows(upward: bool) -> list[dict[str, Any]]:
    """Rows of a sweep with the shares of the reference; not upward: nose and wing exchanged."""
    return [
        {
            "rail.position [mm]": at,
            "share rail": share if upward else 1 - share,
            "share wing": 1 - share if upward else share,
            "p_max [MPa]": pressure,
        }
        for at, (share, pressure) in GOES_OVER.items()
    ]


@pytest.mark.parametrize("upward", [True, False])
def test_half_of_the_load_has_gone_over_within_a_short_travel(upward: bool) -> None:
    """Half from 194.720 mm; both heads carry more than 1 % from 192.57 mm on, linear to 300 mm."""
    found = sweep_table.transfer(rows(upward))
    assert found["half_mm"] == pytest.approx(194.720, abs=0.02)
    assert found["from_mm"] == pytest.approx(192.574, abs=1e-3) and 196.0 < found["to_mm"] < 300.0
    assert found["largest_MPa"] == 1985.5 and sweep_table.transfer(rows(upward)[:3]) == {}
    assert sweep_table.transfer([{"rail.position [mm]": 1.0, "share rail": 1.0}]) == {}


@pytest.mark.slow
def test_a_passage_tells_where_the_load_goes_over(passage: Scene, tmp_path: Path) -> None:
    """Rows of a sweep, its picture, and sweep.json; the same command goes on with the folder."""
    over = {"rail.position": [193.0, 194.5, 197.0]}
    found = rh.sweep(passage, over, out=tmp_path / "out", quiet=True)
    said = json.loads((tmp_path / "out" / "sweep.json").read_text())["transfer"]
    assert said["half_mm"] == pytest.approx(194.720, abs=0.02)
    table = {row["rail.position [mm]"]: row for row in found.rows()}
    assert table[194.5]["share rail"] == pytest.approx(0.42838, abs=3e-4)
    assert table[194.5]["p_max wing [MPa]"] == pytest.approx(946.2, rel=1e-3)
    assert np.abs(np.diff([row["share rail"] for row in found.rows()])).max() <= 0.11
    assert rh.sweep(passage, over, out=tmp_path / "out", quiet=True).rows() == found.rows()
