"""Bodies that yield: an independent program's spheres, first yield, and what unloading leaves."""

import json
import math
from dataclasses import replace
from pathlib import Path

import matplotlib.image
import meshio
import numpy as np
import pytest
from mpi4py import MPI
from solved import assembled, draw_only, solved

import railhead as rh
from railhead.meshing.bodies import RAIL
from railhead.planning import error_envelopes
from railhead.planning import simulation_plan as planning
from railhead.planning.context import Effect
from railhead.planning.effects import EFFECTS
from railhead.postprocess.stress.flux import contact_force
from railhead.postprocess.stress.plastic import largest_von_mises
from railhead.run import estimates, mesh_solution
from railhead.run.progress import Progress
from railhead.scene import quantities
from railhead.solver.algebra import linear
from railhead.solver.system import load_stepping

REFERENCE = json.loads(
    (Path(__file__).parents[1] / "rooms" / "theory" / "data" / "plasticity.json").read_text()
)["calculix_axisymmetric"]
E, NU, Y, R = 207e3, 0.3, 480.0, 100.0
MODULUS = E / (1 - NU**2)
FIRST = math.pi**3 * R**2 * (1.6128 * Y) ** 3 / (6 * MODULUS**2)  # N; Johnson 1985, (6.5)
RADIUS = math.pi * 1.6128 * Y * R / (2 * MODULUS)  # of the patch at first yield, mm
CLOSER = RADIUS**2 / R  # approach there, mm


def pressed(multiple: float, hardening: float = 0.0, **changes: object) -> rh.Scene:
    """A rigid paraboloid on a half-space that yields, at a multiple of its first-yield load."""
    rail = rh.Rail(
        profile="arc", crown_radius=R, extent="half-space", yield_stress=Y,
        hardening_modulus=hardening,
    )  # fmt: skip
    wheel = rh.Wheel(rolling_radius=R, young_modulus=math.inf)
    return rh.Scene(load=multiple * FIRST, rail=rail, wheel=wheel).replace(**changes)


def coarse(multiple: float, **changes: object) -> rh.Scene:
    """The same on five elements across the patch of first yield."""
    return pressed(multiple, mesh={"patch_size": 0.4 * RADIUS}, **changes)


@pytest.fixture(scope="module")
def five() -> rh.Result:
    return solved(pressed(5.0))


@pytest.mark.parametrize(
    "multiple, hardening, key",
    [
        (5, 0.0, "d_L5_H0_n20_i10_nounload"),
        pytest.param(20, 1e4, "d_L20_H10000_n20_i10_nounload", marks=pytest.mark.slow),
    ],
)
def test_spheres_of_an_independent_program(multiple, hardening, key) -> None:
    """Its own errors, up to 4 %, are part of the limits."""
    found, other = solved(pressed(multiple, hardening)), REFERENCE[key]
    plastic = found.as_dict()["result"]["plastic"]
    assert found.passed, found.failed
    assert found.approach / CLOSER == pytest.approx(other["approach_over_omega_y"], rel=0.012)
    area = math.pi * (other["contact_radius_over_a_y"] * RADIUS) ** 2
    assert found.patch.area == pytest.approx(area, rel=0.03)
    centre = other["largest_pressure_over_yield_element_row_mean"]
    assert found.pressure.max / Y == pytest.approx(centre, rel=0.04)
    assert plastic["strain_max"] == pytest.approx(other["max_equivalent_plastic_strain"], rel=0.08)
    depth = other["residual_depth_over_omega_y"]
    assert plastic["residual_depth_rail_mm"] / CLOSER == pytest.approx(depth, rel=0.06)


def test_a_load_step_whose_start_stalls_begins_from_the_last_one(monkeypatch) -> None:
    """The linear problem that is solved for a start may be singular; the state is not its own."""
    usual = rh.solve(coarse(5.0, unload=False), quiet=True)
    stalls, solve = [], linear.solve

    def stalling(*given, **named) -> int:
        if given[5:] == (load_stepping.PREDICTOR_TOLERANCE,):
            stalls.append(1)
            raise linear.StalledError(1, "the linear solver stalls")
        return solve(*given, **named)

    monkeypatch.setattr(linear, "solve", stalling)
    found = rh.solve(coarse(5.0, unload=False), quiet=True)
    assert stalls and found.failed == usual.failed
    assert found.approach == pytest.approx(usual.approach, rel=1e-5)
    assert found.pressure.max == pytest.approx(usual.pressure.max, rel=1e-4)


@pytest.mark.parametrize("share, yields", [(0.97, False), (1.03, True)])
def test_it_yields_from_the_exact_load_on(share: float, yields: bool) -> None:
    scene = pressed(share, unload=False)
    assert planning.make(scene).effects["plasticity"].on == yields
    summary = rh.solve(scene.replace(effects={"plasticity": "on"}), quiet=True).as_dict()
    assert ("plastic" in summary["result"]) == yields


def test_yield_that_was_not_foreseen_is_simulated_all_the_same(monkeypatch) -> None:
    """Unless a person wants the elastic answer."""
    blind = replace(EFFECTS["plasticity"], decide=lambda _: Effect(False, False, "none is seen"))
    monkeypatch.setitem(EFFECTS, "plasticity", blind)
    assert not planning.make(coarse(2.0)).effects["plasticity"].on
    summary = rh.solve(coarse(2.0), quiet=True).as_dict()
    assert "plastic" in summary["result"] and summary["plan"]["effects"]["plasticity"]["on"]
    elastic = solved(coarse(2.0, effects={"plasticity": "off"})).as_dict()
    assert "plastic" not in elastic["result"] and elastic["effects_after"]["plasticity"]["needed"]


def test_below_first_yield_the_elastic_numbers_are_the_same_bits() -> None:
    elastic, followed = (
        rh.solve(coarse(0.9, effects={"plasticity": state}), quiet=True).as_dict()
        for state in ("off", "on")
    )
    assert followed["result"] == elastic["result"] and followed["newton"] == elastic["newton"]


def test_perfect_plasticity_bounds_the_stress(five: rh.Result) -> None:
    assert largest_von_mises(five.fields) == pytest.approx(Y, rel=1e-6)
    largest = five.as_dict()["result"]["stress"]
    assert largest["von_mises_max_MPa"] == pytest.approx(Y, rel=1e-6)
    assert largest["tau_max_MPa"] < (1 + 1e-6) * Y / math.sqrt(3)


def test_elastic_and_hertz_stand_beside_it(five: rh.Result) -> None:
    summary = five.as_dict()
    elastic = summary["elastic"]["pressure"]["max_MPa"]
    assert 0.5 * five.patch.a < summary["result"]["plastic"]["depth_mm"] < 2 * five.patch.a
    assert elastic == pytest.approx(summary["hertz"]["pressure"]["max_MPa"], rel=0.005)
    assert summary["result"]["pressure"]["max_MPa"] < 0.8 * elastic
    plastic = summary["result"]["plastic"]
    assert plastic["load_over_first_yield"] == pytest.approx(5, rel=1e-4)  # by exact Hertz
    assert 1e-4 < summary["accuracy"]["bound"]["load_over_first_yield"] < 0.05
    assert plastic["elastic_p0_over_k"] == pytest.approx(elastic * math.sqrt(3) / Y)
    assert plastic["body"] == "rail"


@pytest.mark.parametrize("multiple", [pytest.param(1.15, marks=pytest.mark.slow), 1.5])
def test_the_largest_pressure_is_that_of_the_middle(multiple: float) -> None:
    """That of the contact point nearest to it: an ellipsoid by moments is 0.4 and 1 % above it."""
    found = solved(pressed(multiple))
    contact = found.fields.contact
    middle = np.argmin(np.linalg.norm(found.findings.frame.local(contact.points)[:, :2], axis=1))
    assert found.findings.patch.max_pressure == pytest.approx(contact.pressure[middle], rel=1e-3)


def test_what_is_left_carries_no_force(five: rh.Result) -> None:
    """The residual stresses are in balance, and not zero."""
    state = five.mesh_solution.residual_state
    assert state.largest_von_mises > 0.2 * Y
    residual = replace(state.unloaded, contact=five.fields.contact)  # where the wheel had touched
    assert np.abs(contact_force(residual, RAIL)).max() < 0.02 * five.load


def test_an_accuracy_covers_mesh_and_load_steps() -> None:
    """Four times as many load steps on a finer mesh stay within the estimate."""
    scene = pressed(5.0)
    found = rh.solve(scene, accuracy="8%", quiet=True)
    accuracy = found.as_dict()["accuracy"]
    assert accuracy["reached"] and found.passed and len(accuracy["levels"]) == 3
    assert 0.001 < accuracy["parts"]["max_MPa"]["load_steps"] <= 0.02
    plan = replace(planning.make(scene).at_resolution(7.0), load_steps=16)
    fine = mesh_solution.mesh_and_solve(plan, Progress(quiet=True), MPI.COMM_WORLD).result
    for name, value in quantities.numeric_values(found.as_dict()["result"]).items():
        error = abs(value / quantities.numeric_values(fine)[name] - 1)
        assert error < accuracy["bound"][name], name


def test_yield_has_an_estimate_where_the_errors_of_load_steps_are_known(monkeypatch) -> None:
    """Twice as many steps divide them by 2^1.5. None are known at 30 times the usual loads."""
    solved = rh.solve(coarse(2.0, unload=False), quiet=True).mesh_solution
    n, law = solved.resolution, error_envelopes.ErrorEnvelope(0.01, 1.0)
    known = replace(error_envelopes.families()[0], resolution=(n / 2, 2 * n), laws={"a_mm": law})
    monkeypatch.setattr(mesh_solution.MeshSolution, "family", known)
    steps = solved.plan.load_step_errors
    assert estimates.estimate([solved])[0]["a_mm"]["load_steps"] == steps["a_mm"] > 0
    twice = replace(solved.plan, load_steps=2 * solved.plan.load_steps).load_step_errors
    assert twice["a_mm"] == pytest.approx(steps["a_mm"] / 2**1.5)
    assert not error_envelopes.load_steps(600.0, line=False)
    monkeypatch.setattr(error_envelopes, "load_steps", lambda overload, line: {})
    assert estimates.estimate([solved]) == ({}, "the error of the load steps is not known")


def test_load_steps_are_of_second_order() -> None:
    """Twice the steps divide the change by 3.9, on a coarse mesh; by backward Euler it is 1.8."""
    plan, pressure = planning.make(coarse(5.57, unload=False)), []
    for steps in (4, 8, 16):
        finer = replace(plan, load_steps=steps)
        found = mesh_solution.mesh_and_solve(finer, Progress(quiet=True), MPI.COMM_WORLD)
        pressure.append(quantities.numeric_values(found.result)["max_MPa"])
    assert pressure[0] - pressure[1] > 3 * (pressure[1] - pressure[2]) > 0


def test_files_and_picture_show_the_load_and_what_it_leaves(
    five: rh.Result, tmp_path, monkeypatch
) -> None:
    draw_only(monkeypatch, "plastic")
    five.save(tmp_path / "out", report=False)
    loaded, left = (
        meshio.read(tmp_path / "out" / f"{name}.vtu") for name in ("solution", "residual")
    )
    most = five.as_dict()["result"]["plastic"]["strain_max"]
    for grid in (loaded, left):
        assert 0.7 * most < grid.cell_data["equivalent_plastic_strain"][0].max() <= most
        tensor = grid.cell_data["plastic_strain"][0].reshape(-1, 3, 3)
        assert np.abs(np.trace(tensor, axis1=1, axis2=2)).max() < 1e-12
    assert left.point_data["von_mises"].max() < 0.5 * loaded.point_data["von_mises"].max()
    picture = matplotlib.image.imread(tmp_path / "out" / "plastic.png")
    assert picture.shape[0] > 300 and picture[..., :3].std() > 0.05


@pytest.fixture(scope="module")
def solid():
    """The coarse solid of the same scene."""
    plan = planning.make(pressed(4.0, 2e3, effects={"axisymmetry": "off"})).at_resolution(3.5)
    model = assembled(plan)
    return model, mesh_solution.solve(plan, model)


def test_newton_takes_few_steps(solid) -> None:
    _, solution = solid
    for result in solution.plasticity.newton_results:
        assert result.converged and len(result.history) <= 9  # the first one is the start
        assert max(step.linear_iterations for step in result.history) <= 35
