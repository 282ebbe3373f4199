"""Each check fails where it should, and names itself."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from railhead import catalogue, checks, estimates, refine
from railhead.level import Level, solve_level
from railhead.planning import plan as planning
from railhead.progress import Progress
from railhead.summary import exact_quantities


@pytest.fixture(scope="module")
def level() -> Level:
    plan = planning.make(catalogue.find("sphere_on_plane"))
    return solve_level(plan, None, Progress(quiet=True), MPI.COMM_SELF)


def failed(level: Level, second=None, reached=None) -> list[str]:
    known, _ = estimates.estimate([level])
    judged = checks.run(level, known, second, reached=reached)
    return [check.name for check in judged if not check.passed]


def test_a_good_result_passes(level) -> None:
    assert failed(level, {**exact_quantities(level), "allowance": {}}) == []


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"noise": 0.55}, "pressure_noise"),
        ({"elements_across": (5.0, 5.0)}, "elements_across"),
        ({"edge_distance": 0.01}, "edge_distance"),
        ({"reported_force": 100.0}, "reported_force"),
        ({"noise": float("nan")}, "pressure_noise"),
    ],
)
def test_findings_out_of_bounds(level, change, name) -> None:
    assert failed(replace(level, findings=replace(level.findings, **change))) == [name]


@pytest.mark.parametrize(
    ("change", "names"),
    [
        ({"load": 189.0}, ["force_balance"]),
        ({"reaction": 150.0}, ["force_balance"]),
        ({"penetration": 1.0}, ["penetration"]),
    ],
)
def test_solutions_out_of_bounds(level, change, names) -> None:
    assert failed(replace(level, solution=replace(level.solution, **change))) == names


def test_an_unsettled_mesh_fails(level) -> None:
    assert failed(replace(level, settled=False)) == ["patch_settled"]


def test_a_missed_approach_fails(level) -> None:
    scene = level.plan.scene.replace([f"approach={1.01 * level.solution.approach!r}"])
    missed = replace(
        level, plan=replace(level.plan, context=replace(level.plan.context, scene=scene))
    )
    assert "approach_reached" in failed(missed)


def test_stresses_that_do_not_carry_the_load_fail(level) -> None:
    weak = replace(level.fields, lame=0.9 * level.fields.lame)
    assert failed(replace(level, fields=weak)) == ["flux_wheel"]


@pytest.mark.parametrize(("factor", "name"), [(0.5, "_least"), (2.0, "")])
def test_implausible_shear_fails(level, factor, name) -> None:
    stress = {**level.result["stress"]}
    stress["tau_max_MPa"] *= factor
    result = {**level.result, "stress": stress}
    assert failed(replace(level, result=result)) == [f"shear_over_pressure{name}"]


@pytest.mark.parametrize("quantity", ["max_MPa", "area_mm2", "tau_max_MPa"])
def test_another_second_opinion_fails(level, quantity) -> None:
    second = {**exact_quantities(level), "allowance": {}}
    table = {"max_MPa": "pressure", "area_mm2": "patch", "tau_max_MPa": "stress"}[quantity]
    bound = estimates.estimate([level])[0][quantity].total
    for factor, names in ((1 + 0.9 * bound, []), (1 + 3 * bound, [f"second_opinion_{quantity}"])):
        other = {**second, table: {**second[table]}}
        other[table][quantity] = level.result[table][quantity] * factor
        assert failed(level, other) == names
    wide = {**other, "allowance": {quantity: {"total": 0.05}}}
    assert failed(level, wide) == []


def test_a_missed_accuracy_fails(level) -> None:
    asked = level.plan.scene.replace(["accuracy=5%"])
    level = replace(
        level, plan=replace(level.plan, context=replace(level.plan.context, scene=asked))
    )
    assert failed(level, reached=True) == []
    assert failed(level, reached=False) == ["accuracy"]


def test_the_range_of_shear_over_pressure_is_that_of_hertz() -> None:
    from railhead.theory import hertz, subsurface

    ratios = [
        subsurface.axis_extrema(contact, nu).tau_max / contact.p0
        for ratio in np.geomspace(1, 100, 9)
        for nu in (0.0, 0.2, 0.3, 0.4, 0.4999)
        for contact in [hertz.point_contact(1 / 300, 1 / 300 / ratio, 1e5, 1e4)]
    ]
    assert checks.SHEAR[0] < min(ratios) and max(ratios) < checks.SHEAR[1]


@pytest.mark.parametrize(
    ("case", "assignments", "name"),
    [
        ("hertz_ellipse", ["mesh.patch_size=5"], "elements_across"),
        ("hertz_ellipse", ["mesh.patch_size=1e6"], "elements_across"),
        ("sphere_on_plane", ["mesh.patch_size=0.8"], "elements_across"),
    ],
)
def test_coarse_meshes_are_not_signed(case, assignments, name) -> None:
    result = refine.run(catalogue.find(case).replace(assignments))
    assert not result.passed
    assert name in result.summary["checks"]["failed"]
    limit, source = result.summary["checks"]["limits"][name]
    assert limit > 0 and source
