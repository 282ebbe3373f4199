"""The mesh of a scene; solves that stall or give no number, whose summary.json stays valid."""

import ctypes
import json
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

from railhead.meshing import isolated_process, mesh
from railhead.planning import simulation_plan
from railhead.results import pipeline, result_folder
from railhead.results.report import terminal
from railhead.run import mesh_solution
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.solver import compat
from railhead.solver.algebra import linear
from railhead.solver.algebra.problem import ContactProblem

SPHERE = "sphere_on_plane"
LIBC = ctypes.CDLL(None)


def solved(*changes: str, case: str = SPHERE) -> dict:
    """summary.json, read back by a reader that knows no NaN."""

    def refuse(word: str) -> None:
        raise AssertionError(word)

    result = pipeline.run(catalogue.find(case).replace(changes))
    return json.loads(result_folder.to_json(result.summary), parse_constant=refuse)


def told(summary: dict) -> str:
    return terminal.recorded(partial(terminal.show_failure, summary)).export_text()


@pytest.mark.parametrize(
    ("case", "off", "name"),
    [
        ("uic54_thesis", 0.015, "bodies"),
        ("uic54_thesis", 0.025, "profiles"),
        ("cone20_uninclined_uic54", 0.005, "bodies"),
        ("cone20_uninclined_uic54", 0.015, "profiles"),
    ],
)
def test_laws_of_ellipses_hold_where_one_is_planned_or_read_alone(case, off, name) -> None:
    """By the shape error of the solved patch: from 1 % on a general reading is mixed in."""
    found = SimpleNamespace(hertzian=off < 0.02, shape_error=off)
    plan = simulation_plan.make(catalogue.find(case))
    family = mesh_solution.MeshSolution.family
    assert family.fget(SimpleNamespace(plan=plan, findings=found)).name == name


def test_a_rescued_solve_is_a_result(monkeypatch) -> None:
    reference = solved("solver.tolerance=1e-8")["result"]
    monkeypatch.setattr(linear, "KRYLOV_LIMIT", 3)
    summary = solved("solver.tolerance=1e-8", "solver.linear=multigrid")
    stalled, *_, last = summary["newton"]["history"]
    assert stalled["residual"] is None and stalled["problem"] == "the linear solver stalls"
    assert last["residual"] < 1e-8 and summary["checks"]["passed"]
    assert summary["result"]["approach_mm"] == pytest.approx(reference["approach_mm"], rel=1e-7)


def test_a_solve_that_stalls_for_good_is_status_1_with_its_history(monkeypatch) -> None:
    monkeypatch.setattr(linear, "KRYLOV_LIMIT", 0)
    summary = solved()
    assert not summary["checks"]["passed"] and summary["result"] is None
    assert [step["residual"] for step in summary["newton"]["history"]] == [None]
    assert "step  0  the linear solver stalls" in told(summary)


def test_an_error_of_petsc_is_no_convergence_but_one_of_memory_is(monkeypatch) -> None:
    """As of a preconditioner that PETSc cannot make: 77; 55 is missing memory."""

    def failing(*given: object) -> None:
        raise linear.PETSc.Error(codes[-1])

    monkeypatch.setattr(linear, "krylov", failing)
    codes = [77]
    summary = solved()
    assert summary["result"] is None and not summary["checks"]["passed"]
    assert summary["newton"]["reason"].startswith("PETSc's error 77: ")
    assert "NOT CONVERGED: PETSc's error 77" in told(summary)
    codes += [55]
    with pytest.raises(linear.PETSc.Error):
        solved()


def test_a_residual_that_is_no_number_is_no_result(monkeypatch) -> None:
    calls = []

    def force(self: ContactProblem, pressure: object) -> float:
        calls.append(pressure)
        return original(self, pressure) if len(calls) < 2 else float("nan")

    original = ContactProblem.contact_force
    monkeypatch.setattr(ContactProblem, "contact_force", force)
    summary = solved("mesh.patch_size=2", case="hertz_ellipse")  # a sphere takes one step
    assert not summary["checks"]["passed"] and summary["result"] is None
    assert summary["newton"]["reason"] == "the residual is not a number"
    assert summary["newton"]["history"][-1]["residual"] is None
    assert "the residual is not a number" in told(summary)


def one(*changes: str, case: str = SPHERE) -> mesh_solution.MeshSolution:
    decided = simulation_plan.make(catalogue.find(case).replace(changes))
    return mesh_solution.mesh_and_solve(decided, Progress(quiet=True), MPI.COMM_WORLD)


def test_a_patch_that_no_mesh_fits_is_not_settled(monkeypatch) -> None:
    assert one().mesh_fits_patch
    monkeypatch.setattr(mesh_solution, "REMESH_RATIO", 1 + 1e-9)
    monkeypatch.setattr(mesh_solution, "MAX_MESHES", 2)
    assert not one().mesh_fits_patch


def test_an_approach_that_is_not_reached_is_told(monkeypatch) -> None:
    assert one().approach_error == 0.0
    monkeypatch.setattr(mesh_solution, "MAX_APPROACH_SOLVES", 1)
    found = one("rail.extent=half-space", "approach=0.03")
    off = abs(found.solution.approach / 0.03 - 1)
    assert found.approach_error == off > mesh_solution.APPROACH_TOLERANCE


@pytest.mark.parametrize(
    "case, more",
    [
        pytest.param("hertz_ellipse", ["mesh.patch_size=1.2"], marks=pytest.mark.slow),
        ("long_roller", []),
        ("sphere_on_plane", []),
    ],
)
def test_an_approach_between_half_spaces_takes_four_loads(case, more, monkeypatch) -> None:
    monkeypatch.setattr(mesh_solution, "MAX_APPROACH_SOLVES", 4)
    found = one("approach=0.02", "rail.extent=half-space", *more, case=case)
    assert found.approach_error < mesh_solution.APPROACH_TOLERANCE


def test_bodies_that_pass_each_other_fail_a_check() -> None:
    """No facet of the wheel lies opposite the rail's any more."""
    summary = solved("load=1GN", "mesh.patch_size=40", case="hertz_ellipse")
    assert "small_strain" in summary["checks"]["failed"] and summary["result"] is not None


@pytest.fixture
def unfilled():
    yield
    LIBC.mallopt(isolated_process.M_PERTURB, 0)


@pytest.mark.usefixtures("unfilled", "meshed_anew")
def test_the_mesh_does_not_depend_on_what_memory_held() -> None:
    """Of these bodies gmsh makes 3041 tetrahedra where it finds zeros, and 3038 where it finds the
    bytes 0xfe or 0xaa."""
    decided = simulation_plan.make(catalogue.find("uic54_thesis").replace(["mesh.patch_size=1.0"]))
    found = []
    for byte in (0xFF, 0x55):
        LIBC.mallopt(isolated_process.M_PERTURB, byte)
        made = mesh_solution.generate(decided, decided.grading, MPI.COMM_WORLD)
        found.append((made.cells, np.sort(compat.node_points(made.mesh), axis=0)))
    (cells, points), (others, their_points) = found
    assert cells == others
    np.testing.assert_array_equal(points, their_points)


def test_a_mesh_that_was_made_again_is_said(monkeypatch) -> None:
    """gmsh fails once: elements are smaller by a twentieth."""
    run, failed = isolated_process.run, []

    def once(*given, **keys):
        if not failed:
            failed.append(given)
            raise isolated_process.IsolatedProcessError("no")
        return run(*given, **keys)

    monkeypatch.setattr(isolated_process, "run", once)
    result = pipeline.run(catalogue.find("long_roller"))
    assert result.summary["cost"]["mesh_size_share"] == 0.95
    (level,) = result.summary["accuracy"]["levels"]
    assert level["patch_size_mm"] == pytest.approx(0.95 * result.plan.patch_size)
    shown = terminal.recorded(result.show).export_text()
    assert "gmsh failed at the planned size of elements: they have 0.95 of it" in shown


def test_flat_elements_on_a_flange_are_meshed_again_smaller_far_from_the_patch() -> None:
    """A whole S1002 on 60E1 under 110 kN: flat elements lie 70 mm beside a patch of 8 mm, and
    smaller ones in the patch alone leave them flat."""
    keys = ["load=110kN", "wheelset.shift=2mm", "effects.plasticity=off"]
    plan = simulation_plan.make(catalogue.find("s1002_60e1").replace(keys))
    found = mesh_solution.generate(plan, plan.grading, MPI.COMM_WORLD)
    assert found.quality > mesh.MIN_QUALITY and found.share > 0.9
