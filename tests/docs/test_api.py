"""What a script sees: the public names, their examples, and a host that is left alone."""

import json
import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pages
import pytest
import pyvista
from csv_rows import rows
from one_line import refusal
from solved import solved

import railhead
import railhead as rh

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "api.md"


@pytest.mark.slow
def test_the_examples_of_the_page_run(here) -> None:
    found, _ = pages.run(PAGE)
    result = found["result"]
    assert result.pressure.max == pytest.approx(result.hertz.pressure.max, rel=0.005)
    assert (here / "out" / "summary.json").exists()
    assert float(abs(result.displacement.x.array).max()) > 0.3 * result.approach
    assert "largest pressure" in re.sub(r"\s+", " ", result._repr_html_()).replace("│", "")
    assert len(rows(here / "sweep.csv")) == len(found["table"]) == 4


def test_the_reference_has_every_name() -> None:
    page = (DOCS / "python-reference.md").read_text(encoding="utf-8")
    assert set(re.findall(r":: railhead\.(\w+)(?:\(\))?$", page, re.MULTILINE)) == set(rh.__all__)


def test_a_budget_and_an_accuracy_are_keys_of_the_scene() -> None:
    planned = rh.plan(rh.find("hertz_ellipse"), accuracy="0.1%", quiet=True)
    assert planned.plan.scene.accuracy == 0.001
    assert planned.as_dict()["unknowns"] > 1.5 * rh.plan(rh.find("hertz_ellipse")).plan.unknowns
    assert "budget" in refusal(
        lambda: rh.solve(rh.find("hertz_ellipse"), budget="soon", quiet=True)
    )


def test_keys_that_are_left_to_the_program_have_rows_too(in_this_process) -> None:
    table = rh.sweep(rh.find("sphere_on_plane"), {"solver.theta": [None, 1]}, quiet=True)
    assert [row["solver.theta"] for row in table.rows()] == [None, 1]


@pytest.mark.parametrize(
    "over, values, said",
    [("load", {}, "no mapping|not a mapping"), ({5: [1]}, {}, "no key"),
     ({"load": []}, {}, "load: has no values; give one or more"),
     ({}, {"load": "3 kN"}, "load: .* is not a list of values"),
     ({}, {"load": 3000}, "load: .* is not a list of values"),
     ({"load": ["1 N"]}, {"load": ["2 N"]}, "given twice")],
)  # fmt: skip
def test_a_wrong_sweep_is_one_line(over, values, said) -> None:
    with pytest.raises(rh.SceneError, match=said):
        rh.sweep(rh.find("sphere_on_plane"), over, **values, quiet=True)


def test_every_public_name_has_an_example() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert dir(railhead) == sorted([*railhead.__all__, "__version__"])
    for name in railhead.__all__:
        assert (f"rh.{name}" in page or name in ("Result", "Sweep")) and getattr(railhead, name)


def test_importing_and_planning_change_nothing() -> None:
    """Neither do the libraries below: PETSc catches signals, and ffcx logs, warnings too, if they
    may. (MPI does catch crashes, and where it uses UCX a hangup.) Nor is pkg_resources imported,
    which takes longer than ffcx and ufl, or what stands in for it left behind."""
    code = """
import logging, os, pathlib, signal, sys, warnings
from mpi4py import MPI
def host():
    status = pathlib.Path("/proc/self/status").read_text().splitlines()
    masks = [int(line.split()[1], 16) for line in status if line.startswith(("SigCgt", "SigIgn"))]
    ends = signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGPIPE, signal.SIGTERM
    caught = [mask >> (number - 1) & 1 for mask in masks for number in ends]
    logs = logging.root.manager.disable, logging.root.handlers[:], warnings.showwarning
    return dict(os.environ), logs, caught, sys.modules.get("pkg_resources")
before = host()
import railhead
railhead.plan(railhead.find("s1002_60e1"))
import railhead.solver.contact
after = host()
print(before == after)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"


@pytest.mark.parametrize("scene", ["hertz_ellipse", None, {"load": 1e4}])
def test_what_is_no_scene_is_one_line(scene: object) -> None:
    for call in (rh.plan, rh.solve, rh.locate, lambda each: rh.sweep(each, load=["1 kN"])):
        with pytest.raises(rh.SceneError, match="scene: .* is no Scene; give one"):
            call(scene)


ROLLS = "long_roller", "friction.coefficient=0.3", "rolling.force_along=10kN", "mesh.patch_size=0.6"
SHIFTED = (
    "hertz_ellipse", "friction.coefficient=0.3", "friction.force_along=1kN", "mesh.patch_size=0.9",
    "effects.finite_bodies=off",
)  # fmt: skip


@pytest.mark.parametrize("scene", [ROLLS, SHIFTED])
def test_a_pickled_result_has_the_same_numbers_and_arrays(scene) -> None:
    result = solved(*scene)
    copy = pickle.loads(pickle.dumps(result))
    assert copy.as_dict() == result.as_dict() and copy.pressure == result.pressure
    assert np.array_equal(copy.surface.pressure, result.surface.pressure)
    assert np.array_equal(copy.tractions.traction, result.tractions.traction)


def test_a_result_can_be_pickled_and_loaded(tmp_path) -> None:
    """What dolfinx holds is said to be gone in one line."""
    result = solved(*ROLLS)
    copy = pickle.loads(pickle.dumps(result))
    point = np.array([[0.0, 0.0, -1.0]])
    assert np.array_equal(copy.stress_at(point), result.stress_at(point))
    for name in ("displacement", "mesh"):
        with pytest.raises(ValueError, match="pickled result has no dolfinx mesh"):
            getattr(copy, name)
    copy.save(tmp_path / "out", pictures=False)
    (tmp_path / "out").rename(tmp_path / ".out.earlier")  # as a killed exchange leaves it
    loaded = rh.load(tmp_path / "out")
    assert loaded.pressure == result.pressure and loaded.friction == result.friction
    assert loaded.passed == result.passed and repr(loaded) == repr(result)
    assert "largest pressure" in loaded._repr_html_() and "<style>" not in loaded._repr_html_()
    assert "numbers only" in refusal(lambda: loaded.surface, ValueError)
    broken = json.loads((tmp_path / "out" / "summary.json").read_text())
    broken["result"]["patch"]["a_mm"] = {"a": 1}
    for text in ('{"checks": {}, "result": null, "hertz": {}}', 5000 * "[", json.dumps(broken)):
        (tmp_path / "out" / "summary.json").write_text(text)
        assert "holds no result of a run or a sweep" in refusal(lambda: rh.load(tmp_path / "out"))


def test_what_holds_no_result_and_what_is_no_path_is_one_line(tmp_path) -> None:
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    for folder in (tmp_path / "none", "n" * 5000, tmp_path / "loop"):
        with pytest.raises(rh.SceneError, match="holds no result of a run or a sweep"):
            rh.load(folder)
    case = rh.find("sphere_on_plane")
    for call in (rh.load, solved(case).save, rh.profile, lambda out: rh.sweep(case, out=out)):
        with pytest.raises(rh.SceneError, match="3 is no path; give text or a pathlib.Path"):
            call(3)


def test_a_folder_has_the_grids_of_the_bodies(tmp_path) -> None:
    solved("sphere_on_plane", "wheel.yield_stress=20", "mesh.patch_size=0.2").save(
        tmp_path / "out", pictures=False
    )
    assert {path.stem for path in (tmp_path / "out").glob("*.vtu")} == {
        "contact", "solution", "residual",
    }  # fmt: skip
    for path in (tmp_path / "out").glob("*.vtu"):
        assert pyvista.read(path).n_cells > 10


def test_progress_is_told_to_a_function(capfd, in_this_process) -> None:
    told: list[tuple[float, str]] = []
    case = rh.find("sphere_on_plane")
    rh.solve(case, progress=lambda *each: told.append(each))
    assert [text for _, text in told if "Newton step 1" in text] and told[-1][0] > told[0][0] >= 0
    assert told[-1][1] == "reading the result"

    def enough(seconds: float, text: str) -> None:
        raise TimeoutError(text)

    assert "meshing" in refusal(lambda: rh.solve(case, progress=enough), TimeoutError)
    for call in (rh.solve, lambda *_, **given: rh.sweep(case, load=[100], **given)):
        with pytest.raises(rh.SceneError, match="progress: 5 is no function; give one"):
            call(case, progress=5)
    fast = case.replace(effects={"finite_bodies": "off"})
    rh.sweep(fast, load=[100, 200], progress=lambda *each: told.append(each))
    assert told[-1][1] == "2 of 2 done" and capfd.readouterr().err == ""


def test_pictures_are_drawn_by_their_name() -> None:
    """A wrong name is one line with the right ones."""
    result = solved("sphere_on_plane")
    depth, _ = result.plot("depth").axes
    assert depth.get_ylim()[0] > depth.get_ylim()[1] == 0  # depth downwards
    assert "'patch' is none of this result; give pressure, depth" in refusal(
        lambda: result.plot("patch"), ValueError
    )
