"""Passes from a scene to its result: summary.json, table, checks and files."""

import csv
import io
import json

import matplotlib.image
import pytest
from rich.console import Console
from solved import scene_of

import railhead as rh
from railhead.postprocess.pictures.views import gallery
from railhead.results import pipeline

KEYS = [
    "load=1150kN",
    "rail.extent=half-space",
    "rail.yield_stress=480",
    "rail.hardening_modulus=6210",
    "rail.kinematic_fraction=1",
    "mesh.patch_size=2.2",
]


@pytest.fixture(scope="module")
def result() -> rh.Result:
    """A line contact that rolls twice, four elements on the half width."""
    return pipeline.run(scene_of("long_roller", *KEYS, "rolling.passes=2"))


def test_summary_has_a_row_for_each_pass(result):
    found = json.loads(json.dumps(result.summary))["result"]
    assert len(found["passes"]) == 2
    first, second = found["passes"]
    assert first["strain_increment_max"] > second["strain_increment_max"] >= 0
    assert first["residual_along_MPa"] < -50
    assert first["place_mm"][0] == 0.0 and -15 < first["place_mm"][1] < -1
    assert found["passes_verdict"] == "undecided" and "more passes tell" in found["passes_words"]
    after = found["passes_after"]
    assert len(after["depth_mm"]) == len(after["strain"]) == len(after["residual_along_MPa"])
    assert max(after["strain"]) == pytest.approx(second["strain_max"])
    assert "plastic" not in found
    checks = result.summary["checks"]
    assert checks["effects_left_out"] == checks["passes_converged"] == checks["passes_rim"] == 0
    assert result.summary["effects_after"]["plasticity"]["why"] == "simulated in the passes"


def test_passes_carry_no_estimate(result):
    assert not any("pass" in key for key in result.summary["accuracy"]["bound"])


def test_the_files_hold_the_passes(result, tmp_path, monkeypatch):
    monkeypatch.setattr(gallery, "drawings", lambda *_: {})  # others than passes.png
    result.save(tmp_path / "out", report=False)
    with open(tmp_path / "out" / "passes.csv", encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["pass"] for row in rows] == ["1", "2"]
    written = float(rows[1]["residual_along_MPa"])
    assert written == pytest.approx(result.summary["result"]["passes"][1]["residual_along_MPa"])
    assert float(rows[0]["place_depth_mm"]) > 1
    assert all(row["program"].startswith("railhead ") and row["date"] for row in rows)
    assert matplotlib.image.imread(tmp_path / "out" / "passes.png").std() > 0.02


def test_the_table_shows_passes_and_verdict(result):
    console = Console(file=io.StringIO(), width=100)
    result.show(console)
    text = console.file.getvalue()
    assert "residual along" in " ".join(text.split()) and "Passes: undecided" in text


def test_half_spaces_in_the_place_of_bodies_have_the_same_passes(result):
    fast = pipeline.run(
        scene_of("long_roller", *KEYS[:-1], "rolling.passes=1", "effects.finite_bodies=off")
    )
    one = fast.summary["result"]["passes"][0]
    other = result.summary["result"]["passes"][0]
    assert one["strain_increment_max"] == pytest.approx(other["strain_increment_max"], rel=0.1)


def test_without_the_key_nothing_of_it_is_there():
    plain = pipeline.run(scene_of("long_roller", "mesh.patch_size=1.2"))
    assert not any("passes" in key for key in plain.summary["result"])
    assert not any("passes" in key for key in plain.summary["checks"])
    assert plain.solved.passes is None
