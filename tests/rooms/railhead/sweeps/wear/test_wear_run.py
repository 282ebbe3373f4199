"""Wear over a route: files, errors, checks, going on, and what is refused."""

import json
import math
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from csv_rows import rows
from one_line import refusal

from railhead.cli.commands import main
from railhead.contact import solid
from railhead.half_spaces import worn_contact
from railhead.scene.scene import Effects, Friction, Rail, Rolling, Scene, SceneError, Wear, Wheel
from railhead.sweeps.wear import wear as sweep
from railhead.sweeps.wear import wear_result, wear_run

AXLES = 2200.6  # worn area 0.3565 mm2 at a creepage of 1 %
COARSE = {"coarse": (32, 7.5), "main": (64, 15.0)}


def crown(**wear: object) -> Scene:
    """A cylinder on a crown, which slips everywhere."""
    return Scene(
        load=80e3,
        rail=Rail(profile="arc", crown_radius=300),
        wheel=Wheel(profile="cylinder", rolling_radius=460),
        friction=Friction(coefficient=0.3),
        rolling=Rolling(creepage_along=0.01),
        wear=Wear(**({"axles": AXLES} | wear)),
        effects=Effects(finite_bodies="off"),
    )


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Grids that take a tenth of the time, and no processes."""
    monkeypatch.setattr(wear_run, "RUNS", COARSE)
    monkeypatch.setattr(sweep.worker_pool, "workers", lambda ranks: 1)


@pytest.fixture(scope="module")
def worn(tmp_path_factory: pytest.TempPathFactory) -> tuple[sweep.WearResult, Path]:
    """The crown after its whole wear with steps that are chosen, and the folder."""
    folder = tmp_path_factory.mktemp("wear") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(wear_run, "RUNS", COARSE)
        found = sweep.wear(crown(depth_limit=0.02), folder)
    return found, folder


def test_own_steps_give_pressure_and_depth_of_the_prototype_within_their_errors(worn):
    found, folder = worn
    summary = json.loads((folder / "wear.json").read_text())
    assert found.passed and summary["checks"]["passed"] and not summary["checks"]["failed"]
    first, last = (summary["pressure_max_MPa"][key] for key in ("first", "last"))
    bound = summary["accuracy"]["bound"]
    assert first == pytest.approx(1137.9, abs=2)
    assert abs(last - 840.0) < bound["pressure_max_MPa"]["last"] * last + 0.5 < 0.015 * 840
    depth = summary["depth_max_mm"]
    assert depth["rail"] == pytest.approx(0.0416, abs=3e-4) and depth["wheel"] == 0.0
    assert summary["worn_mm2"]["rail"] == pytest.approx(0.3565, rel=5e-3)
    assert summary["worn_mm2_by_part"]["rail"]["crown"] == summary["worn_mm2"]["rail"]
    per_million = 0.3565e6 / AXLES
    assert summary["worn_mm2_per"]["rail_1e6_axles"] == pytest.approx(per_million, rel=5e-3)


def test_tables_hold_the_worn_depth_over_y_with_its_error(worn):
    _, folder = worn
    rail = [row for row in rows(folder / "wear.csv") if row["body"] == "rail"]
    y, depth, off = (
        np.array([float(row[name]) for row in rail])
        for name in ("y [mm]", "depth [mm]", "depth [mm] estimate")
    )
    assert abs(y[np.argmax(depth)]) < 1 and depth.max() == pytest.approx(0.0416, abs=3e-4)
    half = np.ptp(y[depth > 5e-4]) / 2
    assert half == pytest.approx(6.75, abs=0.2) and 0 < off.max() < 0.1 * depth.max()
    damage = [row for row in rows(folder / "damage.csv") if row["body"] == "rail"]
    assert len(damage) == len(rail) and max(float(row["p_max [MPa]"]) for row in damage) > 830
    history = rows(folder / "history.csv")
    assert float(history[0]["done"]) == 0.0 and float(history[-1]["axles"]) == AXLES
    pressures = [float(row["pressure_max_MPa"]) for row in history]
    assert pressures == sorted(pressures, reverse=True)
    middle = max(damage, key=lambda row: float(row["sum of T-gamma [N/mm]"]))
    # 240 N over 10 to 13.5 mm of width, 2200 times
    assert float(middle["sum of T-gamma [N/mm]"]) == pytest.approx(AXLES * 240 / 8.6, rel=0.1)
    assert float(middle["damage"]) == 0.0  # wear takes the cracks off at 240 N
    assert float(middle["p_max [MPa]"]) == pytest.approx(1138, rel=0.01) and middle["p0/k"] == ""


def test_another_limit_goes_on_from_the_records(worn, tmp_path):
    folder = tmp_path / "again"
    shutil.copytree(worn[1], folder)
    found = sweep.wear(crown(depth_limit=0.03), folder)
    assert found.summary["limits_reached"]["depth_limit"]["limit"] == 0.03
    assert np.array_equal(found.rows[-1]["depth_rail_mm"], worn[0].rows[-1]["depth_rail_mm"])


def test_a_run_that_stops_keeps_what_it_has_with_its_error_and_says_why(tmp_path, monkeypatch):
    solve, calls = worn_contact.solve, []

    def fails(*job):
        calls.append(job)
        if len(calls) > 11:
            raise ValueError("no patch")
        return solve(*job)

    monkeypatch.setattr(worn_contact, "solve", fails)
    monkeypatch.setattr(sweep.wear_run, "refuse_amount", lambda route: None)
    found = sweep.wear(crown(step=3, accuracy=0.1), tmp_path / "out", pictures=False)
    summary = found.summary
    assert summary["reason"] == "main run, after 66.7%: no patch"
    assert f"stopped: {summary['reason']}" in found.words()
    assert found.words()[0].endswith("after 1467.07 wheels")
    assert summary["done"] == pytest.approx(2 / 3) and summary["checks"]["failed"] == ["converged"]
    assert 0 < summary["accuracy"]["bound"]["depth_max_mm"]["rail"] < 0.1
    assert summary["rows"][-1]["axles"] == pytest.approx(2 / 3 * AXLES)


def test_the_pressure_of_a_position_is_as_uncertain_as_those_of_all_and_its_edge():
    """Errors of 1 % of 600 MPa and 0.5 % of 300 MPa (the least one), edges of 8 and 0 MPa."""

    def run(*pressures: float) -> SimpleNamespace:
        """A run with two positions."""
        rows = zip(pressures, (8.0, 0.0), strict=True)
        values = [{"pressure_max_MPa": p, "pressure_edge_MPa": edge} for p, edge in rows]
        return SimpleNamespace(seen=[SimpleNamespace(values=values)])

    runs = {"main": run(600.0, 300.0), "coarse": run(597.0, 300.0)}
    first, second = wear_result.WearResult(None, runs)._contacts(0)
    own = np.hypot(0.01, 0.005)
    assert first["pressure_max_MPa estimate"] == pytest.approx(np.hypot(600 * own, 8))
    assert second["pressure_max_MPa estimate"] == pytest.approx(
        300 * np.sqrt((own**2 + 0.005**2) / 2)
    )


@pytest.mark.slow
def test_a_crown_worn_to_two_square_millimetres_has_its_pressure_and_depth(tmp_path):
    """600 MPa and 0.15 mm by steps of lines that stay in place."""
    found = sweep.wear(crown(axles=12343, accuracy=0.02), tmp_path / "out", pictures=False)
    bound, last = found.summary["accuracy"]["bound"], found.summary["pressure_max_MPa"]["last"]
    assert found.passed and abs(last - 600) < bound["pressure_max_MPa"]["last"] * last < 0.05 * last
    assert found.summary["depth_max_mm"]["rail"] == pytest.approx(0.15, rel=5e-3)


def test_limits_are_reached_where_the_depth_passes_them(worn):
    found, _ = worn
    limit = found.summary["limits_reached"]["depth_limit"]
    before, after = (
        next(row for row in each if (row["depth_rail_mm"] >= 0.02) is way)
        for way, each in ((False, found.rows[::-1]), (True, found.rows))
    )
    assert before["axles"] < limit["axles"] < after["axles"] and limit["limit"] == 0.02
    assert 0 < limit["axles estimate"] < 0.03 * limit["axles"]


def test_worn_profiles_are_read_back_to_a_micrometre(worn):
    found, folder = worn
    run = found.runs["main"]
    for body in ("rail", "wheel"):
        points = run.places[body].worn(run.depths[body])
        table = {"profile": str(folder / f"{body}_profile.csv"), "profile_mirror": "off"}
        again = Scene(load=1e4, **{body: table})
        profile = solid.rail_profile(again) if body == "rail" else solid.wheel_profile(again)
        assert np.abs(profile.height(points[1:-1, 0]) - points[1:-1, 1]).max() < 1e-3


def test_the_last_pressure_is_that_of_the_profile_that_is_written(tmp_path):
    """On a profile that another position wore, which lines of a grid do not see as it is."""
    table = tmp_path / "positions.csv"
    table.write_text("share,load [kN],rolling.creepage_along\n1,40,0.01\n0.02,120,0.001\n")
    found = sweep.wear(crown(step=2, positions=str(table), accuracy=0.2), tmp_path / "out")
    run, last = found.runs["main"], found.summary["positions"][1]["last"]
    worn = {"rail.profile": str(tmp_path / "out" / "rail_profile.csv"), "rail.crown_radius": "none"}
    again = found.route.positions[1].scene.replace(**worn, **{"rail.profile_mirror": "off"})
    begin = np.zeros((2, worn_contact.PLACES))
    (position,) = (replace(each, scene=again) for each in found.route.positions[1:])
    read = worn_contact.solve(position, run.fineness, begin, 0.0, 0.0, begin)[0]
    off = abs(read.values["pressure_max_MPa"] - last["pressure_max_MPa"])
    assert off < min(5.0, last["pressure_max_MPa estimate"])


@pytest.mark.parametrize(("alone", "named"), [(0.9, True), (0.5, False)])
def test_a_route_of_a_few_grooves_is_named(worn, alone, named, monkeypatch):
    """One position on purpose is not."""
    found = worn[0]
    assert "positions" not in found.summary["left_out"]
    monkeypatch.setattr(wear_result, "THIN", 0.2)  # the depth is 0.3 of the approach
    route = replace(found.route, positions=found.route.positions * 2, shares=(0.5, 0.5))
    twice = {
        name: replace(
            run, seen=[replace(each, values=each.values * 2, alone=alone) for each in run.seen]
        )
        for name, run in found.runs.items()
    }
    thin = wear_result.WearResult(route, twice)
    assert ("positions" in thin.summary["left_out"]) is named
    assert any("a groove of its own" in line for line in thin.words()) is named


def test_the_largest_of_pressures_is_as_uncertain_as_those_that_may_be_the_largest(worn):
    contacts = [
        {"pressure_max_MPa": value, "pressure_max_MPa estimate": off}
        for value, off in ((900.0, 10.0), (890.0, 50.0), (300.0, 200.0))
    ]
    assert worn[0]._together(contacts, " estimate")["pressure_max_MPa estimate"] == 40.0


def test_under_mpirun_it_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep, "MPI", SimpleNamespace(COMM_WORLD=SimpleNamespace(size=2)))
    assert "without mpirun" in refusal(lambda: sweep.wear(crown(), tmp_path / "out"))


def test_a_rail_that_leans_is_written_as_it_stood_before(tmp_path):
    scene = Scene(load=1e4, rail=Rail(profile="60E1", inclination=0.05))
    places = worn_contact.places(scene)["rail"]
    depth = 0.1 * np.exp(-((places.points[:, 0] / 5) ** 2))
    file = tmp_path / "rail.csv"
    file.write_text(sweep._profile(places, depth, 0.05))
    again = solid.rail_profile(scene.replace(**{"rail.profile": str(file)}))
    inner = places.worn(depth)[20:-20]
    assert np.abs(again.height(inner[:, 0]) - inner[:, 1]).max() < 1e-3


def test_a_run_goes_on_after_its_last_record(worn, tmp_path, monkeypatch):
    found, _ = worn
    folder, solve, calls = tmp_path / "killed", worn_contact.solve, []

    def some(*job):
        calls.append(job)
        if len(calls) == 10:
            raise KeyboardInterrupt
        return solve(*job)

    monkeypatch.setattr(worn_contact, "solve", some)
    with pytest.raises(KeyboardInterrupt):
        sweep.wear(crown(depth_limit=0.02), folder)
    assert len(list((folder / "records").glob("*.json"))) >= 2
    again = sweep.wear(crown(depth_limit=0.02), folder)
    for one, other in zip(again.runs["main"].stages, found.runs["main"].stages, strict=True):
        assert one.done == other.done and np.array_equal(one.depth, other.depth)
    assert again.summary["pressure_max_MPa"] == found.summary["pressure_max_MPa"]
    assert "another" in refusal(lambda: sweep.wear(crown(axles=AXLES + 1), folder))
    record = folder / "records" / "00001.json"
    text = record.read_text()
    for name, other in (("deepest", '"deepest": {}, "was'), ("rail_mm2", '"rail')):
        record.write_text(text.replace(f'"{name}"', f'{other}"'))
        assert "broken" in refusal(lambda: sweep.wear(crown(depth_limit=0.02), folder))


def test_rail_and_wheel_share_the_wear(worn, tmp_path):
    found, _ = worn
    amounts = {"axles": AXLES / 2, "distance": AXLES / 2 * 2 * math.pi * 460}
    both = sweep.wear(crown(on="both", step=5, accuracy=0.03, **amounts), tmp_path / "both")
    assert both.passed
    depth = both.summary["depth_max_mm"]
    assert depth["rail"] == pytest.approx(depth["wheel"], rel=1e-3)
    assert depth["rail"] == pytest.approx(found.summary["depth_max_mm"]["rail"] / 2, rel=0.01)


@pytest.mark.parametrize("limit", [None, 24.0])
def test_a_wheel_is_drawn_with_the_thickness_of_its_flange(limit: float | None, tmp_path) -> None:
    wear = {"on": "wheel", "axles": None, "distance": 1e7, "step": 1, "flange_limit": limit}
    bodies = {"rail": Rail(profile="60E1"), "wheel": Wheel(profile="S1002")}
    found = sweep.wear(crown(**wear).model_copy(update=bodies), tmp_path / "out")
    assert found.rows[-1]["flange_thickness_mm"] == pytest.approx(32.5, abs=0.1)
    assert (tmp_path / "out" / "depth.png").exists()


def test_positions_that_are_alike_wear_as_one(tmp_path):
    scene = crown(axles=AXLES / 4, step=2)
    (one,) = wear_run.read(scene).positions
    half = replace(one, axles=one.axles / 2)
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
    alone, shared = (
        wear_run.solve(
            wear_run.Route(
                scene=scene, positions=given, shares=(1 / len(given),) * len(given), left_out={}
            ),
            folder,
            None,
            wear_run.Progress(quiet=True),
        )
        for given, folder in (((one,), tmp_path / "one"), ((half, half), tmp_path / "two"))
    )
    depths = [runs["main"].depths["rail"] for runs in (alone, shared)]
    assert np.abs(depths[1] - depths[0]).max() < 0.02 * depths[0].max()


def test_what_fails_beside_an_answer_is_said_in_words(monkeypatch, tmp_path) -> None:
    """Once as the name of an error of Python."""
    known = SimpleNamespace(scene=Scene(load=1e4))
    route = SimpleNamespace(shares=[1.0], positions=[known], worn=())
    for result, other, said in (
        (None, None, "finite elements: no patch"),
        ({"pressure": {}}, {"reason": "boundary elements: none"}, "half spaces: boundary"),
    ):
        solved = SimpleNamespace(summary={"result": result, "half_space": other, "accuracy": {}})
        monkeypatch.setattr(sweep.pipeline, "run", lambda *_, solved=solved: solved)
        assert sweep._beside(route, tmp_path, None)["reason"].startswith(said)


def test_yield_and_fatigue_of_positions_stand_beside_the_wear(worn, monkeypatch, tmp_path) -> None:
    """Passes over the position that is loaded most; stresses of fatigue where they are asked for,
    on new and on worn profiles. What cannot be solved is a failed check."""
    table = tmp_path / "positions.csv"
    table.write_text("share,load [kN]\n3,80\n1,130\n1,10\n")
    steel, asked = {"rail.steel": "R260", "quantities": "fatigue"}, []
    one = crown().replace(**steel)
    route = wear_run.read(one.replace(**{"wear.positions": str(table)}))

    def run(given: Scene, *_) -> SimpleNamespace:
        asked.append(given)
        if given.rolling.passes and given.load == 130e3:
            raise SceneError("rolling.passes", "has no steady answer")
        if given.rolling.passes:
            passes = [{"groove_mm": 0.01}, {"groove_mm": 0.012}]
            result = {"passes": passes, "yield": {"load_over_first_yield": 4.0}}
        elif given.load == 10e3:
            raise SceneError("load", "is too small")
        else:
            profile = {key: [1.0, 2.0] for key in ("depth_mm", "dang_van_MPa", "findley_MPa")}
            result = {"contact_point_mm": [0, 1.5, 0], "fatigue": {"profile": profile}}
        return SimpleNamespace(summary={"result": result, "checks": {"failed": []}})

    monkeypatch.setattr(sweep.pipeline, "run", run)
    grooves = sweep._grooves(route, None)
    assert grooves["positions"] == [1, 2] and grooves["position"] == 1
    assert [*grooves["unknown"]] == ["2"] and "no steady" in grooves["unknown"]["2"]
    tired = sweep._fatigue(route, worn[1], None)
    assert [each.load for each in asked] == [130e3, 80e3, *(80e3, 130e3, 10e3) * 2]
    assert asked[-1].rail.profile.endswith("rail_profile.csv") and asked[2].rail.profile == "arc"
    assert "load" in tired[2]["reason"]

    found = replace(worn[0], route=wear_run.read(one), grooves=grooves, fatigue=tired)
    assert found.summary["checks"]["failed"] == ["yield", "fatigue"]
    said = "\n".join(found.words())
    assert "steel would yield at 2 of" in said and "a groove of 0.01 mm, two leave 0.012" in said
    assert "position 2: groove not known (SceneError: rolling.passes: has no steady" in said
    sweep._save(found, tmp_path, pictures=True)
    below = rows(tmp_path / "fatigue.csv")
    assert [row["profiles"] for row in below] == ["first"] * 4 + ["last"] * 4
    assert (tmp_path / "fatigue_map.png").exists()

    nothing = SimpleNamespace(summary={"result": None})
    monkeypatch.setattr(sweep.pipeline, "run", lambda *_: nothing)
    lost = replace(found, grooves=sweep._grooves(found.route, None))
    assert "yield" in lost.summary["checks"]["failed"]
    off = wear_run.read(crown().replace(**steel | {"effects.plasticity": "off"}))
    assert not off.yields and off.tires and not worn[0].route.tires


@pytest.mark.slow
def test_steel_that_yields_under_a_route_passes_its_checks(tmp_path) -> None:
    scene = crown(axles=AXLES / 100, step=1).replace(**{"rail.steel": "R260", "load": 110e3})
    found = sweep.wear(scene, tmp_path / "out")
    first, second = found.grooves["groove_mm"]
    assert found.passed and 0.005 < first < second < 0.05


@pytest.mark.slow
def test_finite_elements_stand_beside_the_half_spaces(tmp_path):
    scene = crown(axles=AXLES / 2, step=2).replace(**{"effects.finite_bodies": "auto"})
    found = sweep.wear(scene, tmp_path / "out")
    assert found.beside is not None and not found.beside["checks"]
    bodies, flat = (found.beside[name] for name in ("finite_elements", "half_spaces"))
    last = found.summary["pressure_max_MPa"]["last"]
    assert flat["pressure_max_MPa"] == pytest.approx(last, rel=0.015)  # its 48 cells
    assert bodies["pressure_max_MPa"] == pytest.approx(flat["pressure_max_MPa"], rel=0.02)
    assert bodies["area_mm2"] == pytest.approx(flat["area_mm2"], rel=0.03)


def test_wear_that_leaves_the_profile_fails_a_check(tmp_path):
    narrow = crown(axles=AXLES / 100, step=2)
    rail = narrow.rail.model_copy(update={"width": 8.0})
    found = sweep.wear(narrow.model_copy(update={"rail": rail}), tmp_path / "narrow")
    assert not found.passed
    assert "patch_on_profile" in found.summary["checks"]["failed"] or found.summary["reason"]


@pytest.mark.parametrize(
    ("changes", "table", "key"),
    [
        ({"wear.axles": "none"}, "", "wear.axles"),
        ({"wear.axles": 1e9}, "", "wear.axles"),  # deeper than profiles are
        ({"wear.distance": "1 km"}, "", "wear.distance"),
        ({"effects.friction": "off"}, "", "effects.friction"),
        ({"rolling.creepage_along": "none"}, "", "rolling"),
        ({"approach": 0.05}, "", "load"),
        ({"rail.extent": "half-space"}, "", "rail.extent"),
        ({"quantities": "patch,forces"}, "", "quantities"),
        ({"wear.flange_limit": 24}, "", "wear.flange_limit"),
        ({"rolling.creepage_along": 0.0}, "", "rolling"),
        ({}, "share,load [kN]\n0,80\n", "wear.positions"),
        ({}, "share,load [kN]\n1e308,80\n1e308,80\n", "wear.positions"),
        ({}, "share,load [kN]\nx,80\n", "wear.positions"),
        ({}, "share,load\n1\n", "wear.positions"),
        ({}, "share,wear.rate\n1,1e-4\n", "wear.positions"),
        ({}, "share,rail.crown_radius\n1,200\n", "rail.crown_radius"),
        ({}, "share,rail.crown\n1,200\n", "rail.crown"),
    ],
)
def test_scenes_and_positions_without_wear_are_one_line(changes, table, key, tmp_path):
    if table:
        (tmp_path / "positions.csv").write_text(table)
        changes = {"wear.positions": str(tmp_path / "positions.csv")}
    with pytest.raises(SceneError) as caught:
        sweep.wear(crown().replace(**changes), tmp_path / "out")
    assert caught.value.key == key and "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_pairs_are_a_law(tmp_path):
    file = tmp_path / "law.csv"
    file.write_text("T-gamma/A,rate\n10,53\n")
    (position,) = wear_run.read(crown(law=str(file))).positions
    assert position.law.rate(3.0) == pytest.approx(6.75e-7, rel=1e-3)
    file.write_text("10,53\n5,60\n")
    assert "line 2" in refusal(lambda: crown(law=str(file)))


def test_the_command_prints_what_was_worn(tmp_path, capsys):
    scene = tmp_path / "crown.toml"
    scene.write_text(
        'load = 80e3\n[rail]\nprofile = "arc"\ncrown_radius = 300\n[wheel]\nrolling_radius = 460\n'
        "[friction]\ncoefficient = 0.3\n[rolling]\ncreepage_along = 0.01\n[wear]\naxles = 20\n"
        "step = 2\n"
    )
    with pytest.raises(SystemExit) as ended:
        main(["wear", str(scene), "--out", str(tmp_path / "out"), "--fast", "--quiet"])
    assert ended.value.code == 0 and capsys.readouterr().out == ""
    with pytest.raises(SystemExit):
        main(["wear", str(scene), "--out", str(tmp_path / "out"), "--fast"])
    said = capsys.readouterr().out
    report = (tmp_path / "out" / "report.html").read_text()
    assert said.splitlines()[1] in report and report.count("data:image/png") == 1
    assert "steps: 2" in said and "rail: at most" in said and "all passed" in said
