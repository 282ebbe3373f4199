"""What is not asked for is not computed, is absent, and is named."""

import json

import command
import numpy as np
import pytest
from csv_rows import rows

import railhead as rh
from railhead.half_spaces import shearing
from railhead.postprocess import read
from railhead.postprocess.patch import half_space
from railhead.run import half_space_answer
from railhead.theory.bem import grid_stress

ROLLS = [
    "effects.finite_bodies=off", "friction.coefficient=0.3", "rolling.creepage_along=0.1%",
    "rolling.spin=2e-4",
]  # fmt: skip
SLIPS = [
    ROLLS[0], "rail.steel=R260", "friction.coefficient=0.5", "rolling.creepage_along=1%",
]  # fmt: skip
SOLID = ["mesh.patch_size=1.2"]


def forbid(monkeypatch, *names: tuple[object, str]) -> None:
    """Let functions raise where they are called."""

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("it was not asked for")

    for module, name in names:
        monkeypatch.setattr(module, name, refuse)


def answer(case: str, *assignments: str, **keys: object) -> dict:
    """summary.json of a scene, which passes its checks."""
    result = rh.solve(rh.find(case).replace(assignments, **keys), quiet=True)
    assert result.passed
    return result.as_dict()


def test_forces_alone_are_the_same_forces(monkeypatch) -> None:
    every = answer("hertz_ellipse", *ROLLS)
    searches = (half_space, "largest"), (grid_stress, "below")
    forbid(monkeypatch, *searches)
    some = answer("hertz_ellipse", *ROLLS, quantities="patch,forces")
    missing = {"von_mises_max_MPa", "von_mises_max_depth_mm", "von_mises_max_at",
               "first_yield_p0_over_k", "shakedown_limit_p0_over_k"}  # fmt: skip
    rubbed = every["result"]["friction"]
    assert some["result"]["friction"] == {key: rubbed[key] for key in rubbed.keys() - missing}
    assert "stress" in every["result"] and "stress" not in some["result"]
    names = {"tau_max_MPa", "von_mises_max_MPa", "dang_van_MPa", "findley_MPa"}
    assert every["accuracy"]["bound"].keys() - some["accuracy"]["bound"].keys() == names
    left_out = some["checks"]["not_made"].keys() - every["checks"]["not_made"].keys()
    assert left_out == {"stresses", "friction_stresses", "second_method", "pictures", "fatigue"}


def test_stresses_alone_are_frictionless(monkeypatch) -> None:
    forbid(monkeypatch, (shearing, "shear"))
    some = answer("hertz_ellipse", *ROLLS, quantities=["stresses"])
    assert "friction" not in some["result"] and "frictionless" not in some
    assert some["result"]["stress"] == answer("hertz_ellipse", *ROLLS[:1])["result"]["stress"]
    assert {"forces", "friction_stresses"} <= some["checks"]["not_made"].keys()


def test_a_shift_from_rest_has_no_fatigue() -> None:
    some = answer("hertz_ellipse", *ROLLS[:2], "friction.force_along=2kN", quantities="fatigue")
    assert "stress" in some["result"] and "fatigue" not in some["result"]


def test_stresses_under_tractions_need_the_forces() -> None:
    every = answer("hertz_ellipse", *ROLLS)
    some = answer("hertz_ellipse", *ROLLS, quantities=["friction_stresses"])
    fatigue = every["result"].pop("fatigue")
    assert some["result"] == every["result"] and fatigue["findley_MPa"] > 0
    assert "stress" not in some["frictionless"] and "stress" in every["frictionless"]


@pytest.mark.parametrize(
    ("case", "keys", "quantities", "needed", "said"),
    [
        ("hertz_ellipse", [*SLIPS, "load=30kN"], "patch,forces", True, "the yield 472"),
        ("hertz_ellipse", [*SLIPS, "load=20kN"], "patch,forces", True,
         "without friction; up to 687.8 MPa where all slips"),
        ("hertz_ellipse", [*SLIPS, "load=1kN"], "patch,forces", False, "stays below"),
        ("uic54_22t5_axle", [ROLLS[0], "effects.plasticity=off"], "patch", True,
         "806.5 MPa passes the yield 472 MPa"),
    ],
)  # fmt: skip
def test_without_stresses_those_of_the_plan_tell_of_yield(
    case, keys, quantities, needed, said
) -> None:
    summary = rh.solve(rh.find(case).replace(keys, quantities=quantities), quiet=True).summary
    found = summary["effects_after"]["plasticity"]
    assert found["needed"] == needed and said in found["why"]
    assert "those of the plan" in summary["checks"]["not_made"]["plasticity"]
    accepted = "plasticity" in summary["plan"]["chosen"]
    assert summary["checks"]["failed"] == ["effects_left_out"] * (needed and not accepted)


def test_the_patch_of_bodies_alone_has_no_stresses_and_no_second_method(
    monkeypatch, tmp_path
) -> None:
    searches = (read, "Search"), (read, "_below"), (half_space_answer, "beside")
    forbid(monkeypatch, *searches)
    result = rh.solve(rh.find("uic54_thesis").replace(SOLID, quantities="patch"), quiet=True)
    assert result.passed and result.stress is None and result.estimate.tau_max is None
    assert result.summary["half_space"] is None
    made = result.summary["checks"]
    assert {"second_opinion", "stresses", "pictures"} <= made["not_made"].keys()
    assert "stress_misfit" not in made and "shear_over_pressure" not in made
    assert {*result.drawings()} == {"pressure.png", "patch.png"}
    result.save(tmp_path / "out")
    files = {path.name for path in (tmp_path / "out").iterdir()}
    assert {name for name in files if name[0] != "."} == {
        "result.csv",
        "scene.toml",
        "summary.json",
    }
    assert rh.find(str(tmp_path / "out" / "scene.toml")).quantities == ("patch",)


def test_pictures_need_all_stresses() -> None:
    scene = rh.find("hertz_ellipse").replace(quantities="pictures")
    names = "patch", "stresses", "forces", "friction_stresses", "pictures"
    assert all(map(scene.asks, names)) and not scene.asks("second_method")


@pytest.mark.parametrize("names", ["", "patch,force", "[]", "3", "true"])
def test_what_is_no_quantity_is_refused(names: str, capsys) -> None:
    line = command.refused(capsys, "plan", "hertz_ellipse", "--only", names)
    assert "quantities: " in line and "give one or more of patch, stresses, forces" in line


def test_a_sweep_computes_what_is_asked(tmp_path, monkeypatch) -> None:
    out = tmp_path / "out"
    keys = [word for key in ROLLS[1:] for word in ("--set", key)]
    asked = ["--over", "load=20kN,30kN", "--only", "forces"]
    asked += ["--set", "rolling.speed=20", "--quiet", "--out", str(out)]
    assert command.status("sweep", "hertz_ellipse", "--fast", *keys, *asked) == 0
    assert all(float(row["force along [N]"]) > 0 for row in rows(out / "sweep.csv"))
    record = json.loads(next((out / "records").glob("*.json")).read_text())
    assert "stress" not in record["summary"]["result"] and not list(out.glob("*.png"))


def test_contact_points_carry_the_forces_and_dissipate_their_energy() -> None:
    scene = rh.find("hertz_ellipse").replace([*ROLLS[1:], "rolling.speed=20"])
    result = rh.solve(scene.replace(["effects.finite_bodies=off"]), quiet=True)
    own = result.contact_points
    names = "points area pressure traction slip sticks dissipation power rise_rail rise_wheel"
    assert own.keys() == {*names.split()} and len({len(each) for each in own.values()}) == 1
    assert own["area"] @ own["pressure"] == pytest.approx(result.load, rel=1e-9)
    force, energy = result.friction.force_along, result.friction.t_gamma
    assert own["area"] @ own["traction"][:, 0] == pytest.approx(force, rel=5e-3)
    assert own["area"] @ own["dissipation"] == pytest.approx(energy, rel=4e-3)
    assert np.allclose(own["power"], 20 * own["dissipation"])
