"""The command as a person meets it: exit status, one-line errors, the result folder."""

import contextlib
import functools
import io
import json
import operator
import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import command
import pytest
from solved import solved

import railhead as rh
from railhead.planning.effects import EFFECTS
from railhead.scene import catalogue

ROOT = Path(__file__).parents[4]


def files(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.rglob("*"))


def test_plan_solves_and_writes_nothing(here, capsys) -> None:
    assert command.status("plan", "uic54_22t5_axle") == 0
    printed = capsys.readouterr().out
    assert "symmetry_x" in printed and "wheel cone20 on rail" in printed and "unknowns" in printed
    assert files(here) == []


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> Path:
    """The thesis case on a coarse mesh, with pictures."""
    folder, told, errors = tmp_path_factory.mktemp("run"), io.StringIO(), io.StringIO()
    with contextlib.chdir(folder), redirect_stdout(told), redirect_stderr(errors):
        assert command.status("run", "uic54_thesis", "--set", "mesh.patch_size=1.2") == 0
    assert "FE - Hertz" in told.getvalue() and "Newton step" in errors.getvalue()
    return folder / "results" / "uic54_thesis"


def test_result_folder_is_complete(result) -> None:
    assert files(result) == sorted(
        [".railhead", "contact.vtu", "depth.png", "fatigue.png", "patch.png"]
        + [
            "pictures.npz",
            "pressure.png",
            "report.html",
            "result.csv",
            "scene.toml",
            "solution.vtu",
            "stress_cut.png",
            "summary.json",
            "wheel_rail.png",
        ]
    )
    assert os.listdir(result.parent) == [result.name]  # no temporary folder is left


THREE = "result", "hertz", "difference"
PART = {"load_N", "approach_mm", "contact_point_mm", "patch", "pressure", "stress"}
AXIS = {"tau_max_MPa", "tau_max_depth_mm", "von_mises_max_MPa", "von_mises_max_depth_mm"}
STRESS = AXIS | {"axis", "surface_centre_MPa"}
STRESS |= {f"{name}_max_{key}" for name in ("tau", "von_mises") for key in ("body", "place_mm")}
#: All keys of tables of summary.json, and some of others.
ALL_KEYS = {
    **dict.fromkeys(THREE, PART),
    "result": PART | {"fatigue", "patches", "side_force_N", "yield"},
    **{f"{part}.patch": {"a_mm", "b_mm", "area_mm2"} for part in THREE},
    **{f"{part}.pressure": {"max_MPa", "mean_MPa"} for part in THREE},
    **{f"{part}.stress": STRESS for part in THREE},
    "result.stress": STRESS | {"at_edges"},
    **{f"{part}.stress.axis": AXIS | {"body"} for part in THREE},
    "cost.seconds": {"mesh", "assemble", "solve", "postprocess", "total"},
}
SOME_KEYS = {
    "plan": {"unknowns", "predicted_seconds"},
    **{f"plan.effects.{name}": {"called_for", "on", "why"} for name in EFFECTS},
    "accuracy": {"asked", "bound", "reached"},
    "checks": {"force_balance", "max_penetration_mm", "converged"},
    "cost": {"dofs", "cells", "ranks", "newton_iterations", "linear_iterations", "peak_rss_MB"},
}


@pytest.fixture(scope="module")
def summary(result) -> dict:
    return json.loads((result / "summary.json").read_text())


@pytest.mark.parametrize("place", [*ALL_KEYS, *SOME_KEYS])
def test_summary_keeps_the_contract(summary, place: str) -> None:
    found = set(functools.reduce(operator.getitem, place.split("."), summary))
    assert ALL_KEYS.get(place, found) == found and SOME_KEYS.get(place, found) <= found


NO_HALF_SPACE = {"two_cylinders": 0.01}  # patch over radius 0.12
LONG = "cone20_uninclined_uic54", "s1002_60e1"
IN_README = "hertz_ellipse", "uic54_22t5_axle", "uic54_thesis"  # see test_readme


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, marks=[pytest.mark.slow] if case in LONG else [])
        for case in catalogue.shipped()
        if case not in IN_README
    ],
)
def test_every_case_meets_theory(case: str) -> None:
    """Exact Hertz, or boundary elements on the same profiles where the patch is no ellipse."""
    result = solved(case)
    summary = result.summary
    assert result.passed and summary["case"] == case
    hertzian = summary["checks"]["hertzian"] or summary["half_space"] is None
    reference = summary["hertz" if hertzian else "half_space"]["pressure"]["max_MPa"]
    within = NO_HALF_SPACE.get(case, 0.005) if hertzian else 0.02
    found = summary.get("elastic", summary["result"])  # of a rail that yields
    assert found["pressure"]["max_MPa"] == pytest.approx(reference, rel=within)


def test_a_case_is_a_script_too(tmp_path) -> None:
    """One of them as a process; the others end with the same two lines."""
    for case in catalogue.shipped():
        script = ROOT / "cases" / f"{case}.py"
        assert script.read_text().endswith('\nif __name__ == "__main__":\n    run_case(SCENE)\n')
    script = ROOT / "cases" / "long_roller.py"
    done = subprocess.run(
        [sys.executable, script, "--json", "--no-pictures"],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert json.loads(done.stdout)["case"] == "long_roller" and done.stderr == ""


WRONG = [
    (["run", "nothing_here"], "case"),
    (["run", "uic54_thesi"], "did you mean uic54_thesis"),
    (["run", "missing.toml"], "missing.toml"),
    (["run", "uic54_thesis", "--set", "rail.crown_radius=-80"], "rail.crown_radius"),
    (["run", "uic54_thesis", "--set", "rail.poisson_ratio=0.5"], "rail.poisson_ratio"),
    (["run", "uic54_thesis", "--set", "rail.colour=red"], "rail.colour"),
    (["run", "uic54_thesis", "--set", "load=25 parsec"], "load"),
    (["run", "uic54_thesis", "--set", "load=nan"], "load"),
    (["run", "uic54_thesis", "--set", "load=0"], "load"),
    (["run", "uic54_thesis", "--set", "load=1", "--set", "approach=1"], "load"),
    (["plan", "uic54_thesis", "--set", "load=1kN", "--set", "load=2kN"], "load: given twice"),
    (
        [
            "plan",
            "hertz_ellipse",
            "--set",
            "friction.tangential_load=1",
            "--set",
            "friction.force_along=2",
        ],
        "friction.force_along: given twice",
    ),
    (["run", "uic54_thesis", "--set", "rail.profile=49E1"], "rail.profile"),
    (["run", "uic54_thesis", "--set", "wheel.profile=gone.csv"], "wheel.profile"),
    (["run", "uic54_thesis", "--set", "wheelset.shift=90"], "wheelset.shift"),
    (["run", "uic54_22t5_axle", "--set", "effects.symmetry=on"], "effects.symmetry"),
    (["run", "uic54_thesis", "--accuracy", "0"], "accuracy"),
    (["run", "uic54_thesis", "--nonsense"], "nonsense"),
    (["run", "hertz_ellipse", "--set", "mesh.patch_size=0.02"], "GB free"),
    (["run", "hertz_ellipse", "--set", "rail.crown_radius=0.001"], "GB free"),
    (["run", "long_roller", "--ranks", "1.5"], "'1.5' is not a valid number of processes; give"),
    (["run", "long_roller", "--ranks", "two"], "'two' is not a valid number of processes; give"),
    (["run", "long_roller", "--ranks", "0"], "'--ranks': 0 is not in the range x>=1"),
    (["plan"], "CASE"),
    (["plan", "uic54_22t5_axle", "--with", "symmetry_y"], "effects.symmetry_y"),
    (["plan", "uic54_22t5_axle", "--without", "colour"], "effects.colour"),
    (["plan", "long_roller", "--json", "--set", "load=3mm"], "load: '3mm'"),
    (["study", "hard-cses"], "hard_cases"),
    (["study", "hertz_ellipse"], "hard_cases"),
    (["study", "nothing"], "hard_cases"),
    (["study", "--quick"], "need the name of a study"),
    (["fly"], "fly"),
    (["run", "long_roller", "--out", "/"], "--out: '/' is a mount point"),
    (["run", "long_roller", "--out", ""], "--out: is empty; give the path of a folder"),
    (["table", "--out", "/etc/hostname"], "--out: '/etc/hostname' is a file; give another folder"),
    (["table", "--cells", "13"], "railhead: --cells: 13 is not allowed; give 12 to 96, even"),
    (["sweep", "s1002_60e1", "--over", "wear.axles=100,200"], "wear.axles: changes no scene"),
    (["plan", "s1002_60e1", "--set", "wheelset.other_radius=inf"], "wheelset.other_radius: inf"),
    # What cannot be computed.
    (["run", "uic54_thesis", "--set", "load=1e-300"], "give a force from 1e-40 to 1e15 N"),
    (["run", "uic54_thesis", "--set", "load=1e-39"], "give one with half lengths from 0.000"),
    (["run", "uic54_thesis", "--set", "load=1e-10"], "give one with half lengths from 0.000"),
    (["run", "long_roller", "--set", "load=1e-6"], "give one with half lengths from 0.000"),
    (["run", "sphere_on_plane", "--set", "load=1e-20"], "give one with half lengths from 1e-06 to"),
    (["run", "sphere_on_plane", "--set", "approach=1e-20"], "half lengths from 1e-06"),
    (["run", "sphere_on_plane", "--set", "approach=1e300"], "give a length from 1e-21"),
    (["run", "sphere_on_plane", "--set", "wheel.young_modulus=1e300"], "from 1e-12 to 1e15 MPa"),
    (["run", "sphere_on_plane", "--set", "wheel.young_modulus=1e-12"], "lengths from 1e-06"),
    (["run", "sphere_on_plane", "--set", "mesh.patch_size=1e-300"], "a length from 1e-9 to 1e6 mm"),
    (["run", "sphere_on_plane", "--set", "mesh.patch_size=1e200"], "a length from 1e-9 to 1e6 mm"),
    (["run", "two_cylinders", "--set", "wheel.width=1e-9"], "give a length from 0.001 to 1e6 mm"),
]


@pytest.mark.parametrize("arguments, words", WRONG, ids=[" ".join(a) for a, _ in WRONG])
def test_wrong_input_is_one_line_status_2_and_nothing_written(
    arguments, words, here, capsys
) -> None:
    assert words in command.refused(capsys, *arguments) and files(here) == []


def test_a_process_that_is_refused_says_so_alone(tmp_path) -> None:
    """No line of a library beside the one of the command."""
    done = command.process("run", "uic54_thesi", cwd=tmp_path)
    assert (done.returncode, done.stdout, files(tmp_path)) == (2, "", [])
    assert len(done.stderr.splitlines()) == 1 and "did you mean uic54_thesis" in done.stderr


def test_quiet_prints_nothing_and_an_earlier_result_is_replaced(here, capfd) -> None:
    folder = here / "results" / "long_roller"
    solved("long_roller").save(folder, pictures=False)
    before = (folder / "summary.json").stat().st_ino
    assert command.status("run", "long_roller", "--quiet", "--no-pictures") == 0
    assert capfd.readouterr() == ("", "") and (folder / "summary.json").stat().st_ino != before
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["railhead"] == rh.__version__ and summary["units"] == "N, mm, MPa, rad, s"
    assert os.listdir(here / "results") == ["long_roller"]


def test_non_convergence_is_status_1_with_its_history(here, capsys) -> None:
    one_step = ("--no-pictures", "--set", "solver.max_newton=1")
    assert command.status("run", "two_cylinders", "--quiet", *one_step) == 1
    told = capsys.readouterr().err
    assert "NOT CONVERGED" in told and "residual" in told and "try solver" in told
    summary = json.loads((here / "results/two_cylinders/summary.json").read_text())
    assert summary["checks"]["converged"] is False and len(summary["newton"]["history"]) == 1


def test_two_results_are_compared(tmp_path, capsys) -> None:
    """Numbers are those of both; Hertz's area grows as load^(2/3); what only one has is named."""
    light = solved("hertz_ellipse", "effects.finite_bodies=off")
    rubs = "friction.coefficient=0.3", "friction.force_along=1kN"
    heavy = solved("hertz_ellipse", "effects.finite_bodies=off", "load=200kN", *rubs)
    a, b = str(tmp_path / "a"), str(tmp_path / "b")
    light.save(a, pictures=False)
    heavy.save(b, pictures=False)
    found = command.told(capsys, "diff", a, b)
    assert found["scene"]["load"] == [light.load, 2e5]
    area = {row["quantity"]: row for row in found["quantities"]}["patch area"]
    assert (area["A"], area["B"]) == (light.patch.area, heavy.patch.area)
    assert area["B - A"] == pytest.approx((2e5 / light.load) ** (2 / 3) - 1, rel=1e-6)
    assert area["estimate A"] == light.estimate.area and "patch area" in found["beyond"]
    assert command.status("diff", a, b, "--units", "um,kN") == 0
    printed = capsys.readouterr().out
    assert f"{1e3 * light.patch.a:.5g}" in printed and "stick" in printed
    assert "friction.coefficient: 0.0 and 0.3" in printed
    assert "holds no result" in command.refused(capsys, "diff", a, str(tmp_path))


KEPT = {
    "locate": ("locate", "s1002_60e1", "--no-pictures", "--shift", "3mm"),
    "rows": ("locate", "s1002_60e1", "--no-pictures", "--over", "wheelset.shift=-2:2:2mm"),
    "profile": ("profile", "examples/worn_60e1.csv", "--no-pictures"),
    "steel": ("steel", "1070", "--no-pictures", "--cycles", "3"),
    "table": ("table", "--ratios", "1:1", "--cells", "12", "--accuracy", "20%"),
}


@pytest.mark.parametrize("kind", KEPT)
def test_what_a_command_printed_is_printed_again_and_compared(kind, tmp_path, capsys) -> None:
    out = str(tmp_path / "out")
    assert command.status(*KEPT[kind], "--out", out) == 0
    printed, _, _ = capsys.readouterr().out.partition("written to")
    assert command.status("show", out) == 0 and capsys.readouterr().out == printed
    numbers = command.told(capsys, "diff", out, out)["quantities"]
    assert numbers and all(row["A"] == row["B"] for row in numbers)
    summary = tmp_path / "out" / "summary.json"
    summary.write_text(summary.read_text()[:-20])
    assert "or a broken one" in command.refused(capsys, "show", out)


def test_show_says_which_checks_failed(tmp_path, capsys) -> None:
    """It said what was found, and nothing of its checks."""
    fast, out = ("--fast", "--no-pictures", "--set", "load=6MN"), str(tmp_path / "out")
    assert command.status("run", "hertz_ellipse", *fast, "--out", out) == 1
    assert "CHECK FAILED: pressure_of_steel" in capsys.readouterr().err
    assert command.status("show", out) == 0
    assert capsys.readouterr().err.startswith("CHECK FAILED: pressure_of_steel")


def test_two_conicities_are_in_one_picture(tmp_path, capsys) -> None:
    """Each wheel's own: of a cone 1:40 the numbers are its slope."""
    a, b, c = (str(tmp_path / name) for name in "abc")
    for out, wheel in ((a, "S1002"), (b, "cone40")):
        asked = "locate", "s1002_60e1", "--set", f"wheel.profile={wheel}", "--no-pictures"
        assert command.status(*asked, "--out", out) == 0
    capsys.readouterr()
    picture = tmp_path / "both.png"
    told = command.told(capsys, "diff", a, b, "--picture", str(picture))["quantities"]
    found = {row["quantity"]: row for row in told}
    assert found["conicity at 3 mm"]["B"] == pytest.approx(0.025, rel=1e-6)
    assert found["conicity at 3 mm"]["A"] > 0.1 and picture.stat().st_size > 10_000
    assert command.status("profile", "examples/worn_60e1.csv", "--no-pictures", "--out", c) == 0
    capsys.readouterr()
    for other, text in ((c, "a locate and a profile"), (a, "FILE.png")):
        asked = "diff", a, other, "--picture", str(tmp_path / "no.gif")
        assert text in command.refused(capsys, *asked)


def test_summary_differs_from_hertz_by_shares(summary) -> None:
    assert summary["case"] == "uic54_thesis" and summary["plan"]["effects"].keys() == EFFECTS.keys()
    a, exact = summary["result"]["patch"]["a_mm"], summary["hertz"]["patch"]["a_mm"]
    assert summary["difference"]["patch"]["a_mm"] == pytest.approx((a - exact) / exact)
    assert exact == pytest.approx(4.33609754384)
    assert summary["difference"]["contact_point_mm"] is None  # coordinates have none
