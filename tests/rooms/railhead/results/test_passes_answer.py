"""Passes from a scene to its result: summary.json, table, checks and files."""

import json
from dataclasses import replace

import matplotlib.image
import meshio
import numpy as np
import pytest
from csv_rows import rows
from solved import draw_only, scene_of, solved

import railhead as rh
from railhead.postprocess import vtu
from railhead.postprocess.pass_rows import PASS_ERRORS, RailState
from railhead.postprocess.pictures import pass_plots
from railhead.results import checks, pipeline, quantity_rows
from railhead.results.report import terminal

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
    assert first["residual_along_MPa"] < -50 and 0 <= first["ridge_mm"] < first["groove_mm"]
    assert first["place_mm"][0] == 0.0 and -15 < first["place_mm"][1] < -1
    assert found["passes_verdict"] == "undecided" and "more passes tell" in found["passes_words"]
    after = found["passes_after"]
    assert len(after["depth_mm"]) == len(after["strain"]) == len(after["residual_along_MPa"])
    assert max(after["strain"]) == pytest.approx(second["strain_max"])
    assert "plastic" not in found and after["estimate"] == {}
    assert not any("pass" in key for key in result.summary["accuracy"]["bound"])
    assert "Passes: undecided" in terminal.recorded(result.show).export_text()
    checks = result.summary["checks"]
    assert checks["effects_left_out"] == checks["passes_converged"] == checks["passes_rim"] == 0
    assert result.summary["effects_after"]["plasticity"]["why"] == "simulated"


def test_the_files_hold_the_passes(result, tmp_path, monkeypatch):
    draw_only(monkeypatch, "passes")
    result.save(tmp_path / "out", report=False)
    table = rows(tmp_path / "out" / "passes.csv")
    assert [row["pass"] for row in table] == ["1", "2"]
    written = float(table[1]["residual_along_MPa"])
    assert written == pytest.approx(result.summary["result"]["passes"][1]["residual_along_MPa"])
    assert float(table[0]["place_depth_mm"]) > 1
    assert all(row["program"].startswith("railhead ") and row["date"] for row in table)
    assert matplotlib.image.imread(tmp_path / "out" / "passes.png").std() > 0.02
    section = meshio.read(tmp_path / "out" / "passes_section.vtu")
    after = result.summary["result"]["passes_after"]
    assert section.points[:, 2] == pytest.approx(-np.array(after["depth_mm"]))
    assert section.point_data["residual_stress"][:, 0] == pytest.approx(after["residual_along_MPa"])
    assert section.point_data["equivalent_plastic_strain"].max() == pytest.approx(
        after["strain"][int(np.argmax(after["strain"]))]
    )
    assert not (tmp_path / "out" / "rail_profile.csv").exists()  # half-spaces have none


def test_the_section_of_a_solid_is_drawn(result, tmp_path):
    """Random stress at random places; a grid of quadrilaterals, and four panels."""
    rng, shape = np.random.default_rng(1), (6, 5)
    left = RailState(
        y=np.sort(rng.normal(size=6)),
        depth=np.sort(rng.uniform(size=5)),
        stress=rng.normal(size=(*shape, 6)),
        strain=rng.uniform(size=shape),
        across=np.zeros(1),
        up=np.zeros(1),
    )
    grid = vtu.section_grid(left)
    corners = grid.points[grid.cells[0].data]
    first, second = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    area = np.abs(first[:, 1] * second[:, 2] - first[:, 2] * second[:, 1]).sum() / 2
    assert area == pytest.approx(np.ptp(left.y) * np.ptp(left.depth))
    tensor = grid.point_data["residual_stress"][7].reshape(3, 3)
    assert tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] == pytest.approx(left.stress[1, 2])
    assert (tensor == tensor.T).all()
    passes = replace(result.solved.passes, sections=[left])
    pass_plots.draw_passes_section(passes, result.solved.findings, tmp_path / "section.png")
    assert matplotlib.image.imread(tmp_path / "section.png").std() > 0.02


def test_passes_of_two_results_are_compared(result):
    other = json.loads(json.dumps(result.summary))
    last = other["result"]["passes"].pop()
    other["result"]["passes"][0]["groove_mm"] = 2 * last["groove_mm"]
    other["result"]["passes_after"]["estimate"] = {"groove_mm": 0.07}
    found = quantity_rows.difference(result.summary, other)
    rows = {row["quantity"]: row for row in found["quantities"]}
    assert (rows["passes"]["A"], rows["passes"]["B"]) == (2, 1)
    assert rows["passes: verdict"]["B"] == "undecided"
    groove = rows["passes: groove of the last"]
    assert groove["A"] == last["groove_mm"] and groove["B - A"] == 1.0 and groove["unit"] == "mm"
    assert (groove["estimate A"], groove["estimate B"]) == (None, 0.07)


def test_half_spaces_in_the_place_of_bodies_have_the_same_passes(result):
    """With an accuracy groove and residual stress have estimates, which hold beside the coarser
    block of the other run.
    """
    keys = *KEYS[:-1], "rolling.passes=1", "effects.finite_bodies=off", "accuracy=0.01"
    fast = pipeline.run(scene_of("long_roller", *keys))
    estimate = fast.summary["result"]["passes_after"]["estimate"]
    row, coarse = (each.summary["result"]["passes"][0] for each in (fast, result))
    assert set(estimate) == {*PASS_ERRORS}
    for key, error in estimate.items():
        assert 0 < error < 0.09
        assert coarse[key] == pytest.approx(row[key], rel=2 * error)  # on half the elements
    assert (
        "passes (estimate after the last: largest strain"
        in terminal.recorded(fast.show).export_text()
    )
    assert row["strain_increment_max"] == pytest.approx(coarse["strain_increment_max"], rel=0.1)


def test_a_wheel_that_yields_has_passes_of_its_own(tmp_path):
    """Softer than the rail, on a coarse block: told, drawn and written beside the rail's."""
    keys = *KEYS[:2], "rail.yield_stress=480", "wheel.yield_stress=400", "mesh.patch_size=2.8"
    both = pipeline.run(
        scene_of("long_roller", *keys, "rolling.passes=1", "effects.finite_bodies=off")
    )
    found = both.summary["result"]
    assert both.summary["checks"]["effects_left_out"] == 0
    assert found["passes_name"] == "rail" and both.summary["checks"]["passes_energy"] < 0.03
    (wheel,) = found["passes_beside"]
    assert wheel["passes_name"] == "wheel"
    first, other = found["passes"][0], wheel["passes"][0]
    assert other["strain_increment_max"] > 1.2 * first["strain_increment_max"] > 1e-4
    assert first["resistance_N"] == other["resistance_N"]
    assert "Passes, wheel: undecided" in terminal.recorded(both.show).export_text()
    both.save(tmp_path / "out", report=False)
    told = {row["quantity"]: row.get("value") for row in quantity_rows.everything(both.summary)}
    assert told["passes, wheel: groove of the last"] == other["groove_mm"]
    far = replace(both.solved.passes.beside[0], rim=0.5)
    seen = replace(both.solved, passes=replace(both.solved.passes, beside=(far,)))
    rim = next(each for each in checks.passes(seen) if each.name == "passes_rim")
    assert not rim.passed  # of the wheel, too
    written = {each.name for each in (tmp_path / "out").iterdir()}
    assert {"passes_wheel.csv", "passes_wheel.png", "passes_section_wheel.vtu"} <= written


def test_without_the_key_nothing_of_it_is_there():
    plain = solved("long_roller", "mesh.patch_size=1.2")
    assert not any("passes" in key for key in plain.summary["result"])
    assert not any("passes" in key for key in plain.summary["checks"])
    assert plain.solved.passes is None


@pytest.mark.slow
def test_passes_that_ratchet_have_a_rate_with_an_estimate():
    """Without an accuracy too: the passes are rolled again on a coarser block."""
    keys = (*KEYS[1:3], "load=1080kN", "rail.backstress=[[40000, 100]]", "mesh.patch_size=2")
    fast = "rolling.passes=6", "effects.finite_bodies=off", "rail.yield_stress=400"
    result = pipeline.run(scene_of("long_roller", *keys, *fast)).summary["result"]
    rate = result["rate"]
    assert result["passes_verdict"] == "ratchets" and rate["rule"].startswith("Armstrong")
    assert rate["forward_mm_per_pass"] == result["passes"][-1]["forward_mm"]
    assert rate["forward_mm_per_pass"] == pytest.approx(-0.00276, rel=0.03)
    assert 0.03 < rate["estimate"] < 0.5
