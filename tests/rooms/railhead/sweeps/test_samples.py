"""Samples of a scene by the command: files, errors, failed ones, more of them later."""

import json

import command
import pytest

import railhead as rh
from railhead.postprocess.findings import Subject
from railhead.postprocess.pictures.sweep_plots import fatigue_map
from railhead.sweeps import sampling

OVER = (
    "--over", "wheelset.shift=uniform(-20mm, 20mm)",
    "--over", "friction.coefficient=choice(0.2, 0.3*2)",
)  # fmt: skip
S1002 = "sweep", "s1002_60e1", "--fast", "--only", "patch", "--without", "plasticity", "--quiet"


@pytest.fixture(scope="module")
def shifts(tmp_path_factory):
    """Eight samples, some of which derail, and then twelve."""
    folder, said = tmp_path_factory.mktemp("samples") / "out", []
    for count in ("8", "12"):
        said.append(command.status(*S1002, *OVER, "--sample", count, "--out", str(folder)))
        if count == "8":
            first = {path.name: path.read_text() for path in (folder / "records").glob("*.json")}
    return folder, said, first


def test_more_samples_keep_those_that_are_solved(shifts) -> None:
    folder, said, first = shifts
    assert said == [1, 1] and len(first) == 8
    solved = {name: text for name, text in first.items() if not json.loads(text)["fault"]}
    assert 0 < len(solved) < 8
    assert all((folder / "records" / name).read_text() == text for name, text in solved.items())
    assert len([*(folder / "records").glob("*.json")]) == 12


def test_those_that_fail_are_counted_and_named(shifts) -> None:
    folder, _, _ = shifts
    sample = json.loads((folder / "sample.json").read_text())
    rows = rh.load(folder).rows()
    failed = {str(n): row["checks"] for n, row in enumerate(rows) if row["checks"] != "passed"}
    assert sample["samples"] == 12 and sample["failed"]["names"] == failed
    assert sample["failed"]["count"] == len(failed) > 0
    assert all("flange" in why for why in failed.values())
    known = [row["p_max [MPa]"] for row in rows if row.get("p_max [MPa]")]
    own = sample["quantiles"]["p_max [MPa]"]["0.5"]
    assert min(known) < own["value"] < max(known) and 0 < own["estimate"] < 0.02 * own["value"]


def test_the_worst_sample_runs_again_by_one_command(shifts, tmp_path) -> None:
    folder, _, _ = shifts
    largest = max(row.get("p_max [MPa]") or 0.0 for row in rh.load(folder).rows())
    out = str(tmp_path / "again")
    assert command.status("run", str(folder / "worst_1.toml"), "--out", out, "--quiet") == 0
    assert rh.load(out).pressure.max == pytest.approx(largest, rel=1e-9)


def test_fewer_samples_than_are_there_are_refused(shifts, capsys) -> None:
    folder, _, _ = shifts
    assert command.status(*S1002, *OVER, "--sample", "4", "--out", str(folder)) == 2
    assert "has more samples" in capsys.readouterr().err


def test_rows_of_a_file_are_samples_whose_keys_depend_on_each_other(tmp_path) -> None:
    rows = [(1.0, 20.0), (2.0, 25.0), (3.0, 30.0)]
    file, out = tmp_path / "rows.csv", tmp_path / "out"
    file.write_text(
        "load [kN],rolling.creepage_along[%]\n" + "".join(f"{b},{a}\n" for a, b in rows)
    )
    given = "--samples-file", str(file), "--over", "friction.coefficient=normal(0.3, 0.01)"
    fast = "sweep", "hertz_ellipse", "--fast", "--only", "pictures", "--quiet"
    assert command.status(*fast, *given, "--out", str(out)) == 0
    found = rh.load(out).rows()
    assert [row["load [N]"] for row in found] == [20e3, 25e3, 30e3]
    law = sampling.law("friction.coefficient", "normal(0.3, 0.01)")
    drawn = sampling.draw({"friction.coefficient": law}, 3, sobol=False)
    assert [row["friction.coefficient"] for row in found] == [
        row["friction.coefficient"] for row in drawn
    ]
    assert (out / "sweep.png").exists() and "half below" in (out / "report.html").read_text()


def test_a_refused_value_is_a_failed_sample_and_not_the_end(tmp_path, capsys) -> None:
    file, out = tmp_path / "rows.csv", tmp_path / "out"
    file.write_text("load [kN],rail.profile\nnan,60E1\n20,60E1\n-5,60E1\n20,missing.csv\n")
    given = *S1002, "--only", "pictures", "--samples-file", str(file), "--out", str(out)
    assert command.status(*given) == 1
    names = json.loads((out / "sample.json").read_text())["failed"]["names"]
    assert list(names) == ["0", "2", "3"]
    assert "nankN" in names["0"] and "-5kN" in names["2"] and "missing.csv" in names["3"]
    assert [row["rail.profile"] for row in rh.load(out).rows()][2:] == ["60E1", "missing.csv"]
    assert (out / "sweep.png").exists() and "NOT SOLVED" in capsys.readouterr().err
    assert command.status(*given) == 1  # goes on
    file.write_text("load [kN]\n-20\n-5\n")
    assert command.status(*S1002, "--samples-file", str(file), "--out", str(out)) == 2


def test_too_few_samples_tell_no_error_of_shares(tmp_path, capsys) -> None:
    asked = "sweep", "hertz_ellipse", "--fast", "--only", "patch", "--sobol", "--sample", "2"
    over = "--over", "load=choice(20kN, 30kN)", "--out", str(tmp_path / "out")
    assert command.status(*asked, *over) == 0
    assert "in all, within ?" in " ".join(capsys.readouterr().out.split())
    shares = json.loads((tmp_path / "out" / "sample.json").read_text())["sobol"]
    assert shares["p_max [MPa]"]["load"]["error"] is None
    scene = rh.find("hertz_ellipse").replace(effects={"finite_bodies": "off"}, quantities="patch")
    called = rh.sweep(scene, load="choice(20kN, 30kN)", sample=2, sobol=True, quiet=True)
    assert called.sample["sobol"] == shares


def test_the_map_of_fatigue_has_all_depths_of_all_patches_the_largest_on_top() -> None:
    depths = {"depth_mm": [0.1, 1.0], "dang_van_MPa": [10.0, 20.0], "findley_MPa": [40.0, 30.0]}
    most = {**depths, "findley_MPa": [90.0, 35.0]}
    left, right = fatigue_map([1.0, 5.0], [most, depths], Subject("")).axes[:2]
    shown = [axes.collections[0] for axes in (left, right)]
    assert shown[0].get_array().tolist() == [10.0, 10.0, 20.0, 20.0]
    assert shown[1].get_array().tolist() == [30.0, 35.0, 40.0, 90.0]
    assert shown[1].get_offsets()[-1].tolist() == [1.0, 0.1]


def test_more_rows_keep_the_first_ones_and_other_rows_are_refused(tmp_path, capsys) -> None:
    file, out = tmp_path / "rows.csv", tmp_path / "out"
    asked = "sweep", "hertz_ellipse", "--fast", "--only", "patch", "--quiet"
    asked = *asked, "--samples-file", str(file), "--out", str(out)
    file.write_text("load [kN]\n20\n")
    assert command.status(*asked) == 0
    first = (out / "records" / "00000.json").read_text()
    file.write_text("load [kN]\n20\n30\n")
    assert command.status(*asked) == 0 and len(rh.load(out).rows()) == 2
    assert (out / "records" / "00000.json").read_text() == first
    file.write_text("load [kN]\n20\n35\n")
    assert command.status(*asked) == 2 and "has another sample 1" in capsys.readouterr().err
    file.write_text("load [kN],load [N]\n25\n")
    assert command.status(*asked) == 2
    assert capsys.readouterr().err.startswith("railhead: --samples-file: ")
