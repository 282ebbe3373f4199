"""Each check fails where it should, names itself, and has a section of the page about checks."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI
from solved import solved

from railhead.meshing.bodies import BODY_NAMES
from railhead.planning import simulation_plan as planning
from railhead.postprocess.stress.recovery import Recovery
from railhead.results import checks
from railhead.results.report.html import CHECKS
from railhead.results.summary import exact_quantities
from railhead.run import estimates
from railhead.run.mesh_solution import MeshSolution, mesh_and_solve
from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.solver.system.solution import PlasticSolution
from railhead.theory.elastic import hertz


@pytest.fixture(scope="module")
def mesh_solution() -> MeshSolution:
    return solved("sphere_on_plane").mesh_solution


UNKNOWN = {"reason": "nobody knows"}


def failed(mesh_solution: MeshSolution, second=UNKNOWN) -> list[str]:
    known = estimates.totals(estimates.estimate([mesh_solution])[0])
    judged = checks.run(mesh_solution, known, second)
    return [check.name for check in judged if not check.passed]


def test_a_good_result_passes(mesh_solution) -> None:
    assert failed(mesh_solution, {**exact_quantities(mesh_solution), "allowance": {}}) == []


def found(solution: MeshSolution, **changes: object) -> MeshSolution:
    """With other findings."""
    return replace(solution, findings=replace(solution.findings, **changes))


def reached(solution: MeshSolution, **changes: object) -> MeshSolution:
    """With another state of the bodies."""
    return replace(solution, solution=replace(solution.solution, **changes))


def asked(solution: MeshSolution, *assignments: str) -> MeshSolution:
    """Of another scene."""
    context = replace(solution.plan.context, scene=solution.plan.scene.replace(assignments))
    return replace(solution, plan=replace(solution.plan, context=context))


def unloaded(solution: MeshSolution, reason: str) -> MeshSolution:
    """Yielded and unloaded, which ended for that reason."""
    newton = solution.solution.newton
    plasticity = PlasticSolution(
        load_over_first_yield=2.0,
        newton_results=(newton, replace(newton, reason=reason)),
        loading_steps=1,
        residual_state=solution.solution,
        indentation_depth={},
    )
    return reached(solution, plasticity=plasticity)


def loaded_beyond_yield(solution: MeshSolution, times: float) -> MeshSolution:
    return replace(solution, residual_state=SimpleNamespace(load_over_first_yield=times))


#: What is changed of a good solution, and the checks that fail then.
WRONG = {
    "noise": (lambda one: found(one, noise=0.55), ["pressure_noise"]),
    "noise that is no number": (lambda one: found(one, noise=np.nan), ["pressure_noise"]),
    "a pressure that does not carry the load": (
        lambda one: found(one, patch=replace(one.findings.patch, unbalance=0.021)),
        ["pressure_force"],
    ),
    "few elements": (lambda one: found(one, elements_across=(5.0, 5.0)), ["elements_across"]),
    "a patch at an edge": (lambda one: found(one, edge_distance=0.01), ["edge_distance"]),
    "stresses off the elements'": (lambda one: found(one, misfit=0.06), ["stress_misfit"]),
    "another load": (lambda one: reached(one, load=188.6), ["force_balance"]),
    "another reaction": (lambda one: reached(one, reaction=150.0), ["force_balance"]),
    "bodies in each other": (lambda one: reached(one, penetration=1.0), ["penetration"]),
    "another approach": (
        lambda one: asked(one, f"approach={1.01 * one.solution.approach!r}"), ["approach_reached"]
    ),
    "unloaded": (lambda one: unloaded(one, "residual below tolerance"), []),
    "not unloaded": (lambda one: unloaded(one, "too many steps"), ["unloaded"]),
    "109 times first yield": (lambda one: loaded_beyond_yield(one, 109.0), []),
    "111 times first yield": (
        lambda one: loaded_beyond_yield(one, 111.0), ["load_over_first_yield"]
    ),
    "a mesh of another patch": (
        lambda one: replace(one, mesh_fits_patch=False), ["patch_settled"]
    ),
    "stresses that do not carry the load": (
        lambda one: replace(one, fields=replace(one.fields, lame=0.9 * one.fields.lame)),
        ["flux_wheel"],
    ),
}  # fmt: skip


@pytest.mark.parametrize(("change", "names"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_with_a_solution_fails_its_check(mesh_solution, change, names) -> None:
    assert failed(change(mesh_solution)) == names


@pytest.mark.parametrize(
    ("factor", "name"), [(0.5, "shear_over_pressure_least"), (2.0, "shear_over_pressure")]
)
def test_implausible_stresses_fail(mesh_solution, factor, name) -> None:
    largest = {
        body: replace(each, tau=replace(each.tau, value=factor * each.tau.value))
        for body, each in mesh_solution.findings.largest.items()
    }
    assert failed(found(mesh_solution, largest=largest)) == [name]


def test_smooth_stresses_that_are_not_the_elements_fail(monkeypatch) -> None:
    """As those of a fit that is a tenth too high, which no flux through a plane shows."""
    fit = Recovery._fit
    monkeypatch.setattr(
        Recovery, "_fit", lambda self, points: (1.1 * fit(self, points)[0], fit(self, points)[1])
    )
    solved = mesh_and_solve(
        planning.make(catalogue.find("roller_on_block")), Progress(quiet=True), MPI.COMM_SELF
    )
    assert failed(solved) == ["stress_misfit"]


@pytest.mark.parametrize(
    "quantity", ["a_mm", "b_mm", "max_MPa", "area_mm2", "tau_max_MPa", "von_mises_max_MPa"]
)
def test_another_second_opinion_fails(mesh_solution, quantity) -> None:
    second = {**exact_quantities(mesh_solution), "allowance": {}}
    tables = {"max_MPa": "pressure"} | dict.fromkeys(("a_mm", "b_mm", "area_mm2"), "patch")
    table = tables.get(quantity, "stress")
    bound = estimates.totals(estimates.estimate([mesh_solution])[0])[quantity]
    for factor, names in ((1 + 0.9 * bound, []), (1 + 3 * bound, [f"second_opinion_{quantity}"])):
        other = {**second, table: {**second[table]}}
        other[table][quantity] = mesh_solution.result[table][quantity] * factor
        assert failed(mesh_solution, other) == names
    assert failed(mesh_solution, {**other, "allowance": {quantity: {"total": 0.05}}}) == []


def test_without_an_estimate_a_number_may_be_off_by_one_in_twenty(mesh_solution) -> None:
    second = {**exact_quantities(mesh_solution), "allowance": {}}
    for factor, names in ((1.04, []), (1.06, ["second_opinion_approach_mm"])):
        other = {**second, "approach_mm": mesh_solution.result["approach_mm"] * factor}
        judged = checks.run(mesh_solution, {}, other)
        assert [check.name for check in judged if not check.passed] == names


def test_what_a_second_opinion_leaves_out_unknown_is_not_compared(mesh_solution) -> None:
    """Half-spaces know no approach of bodies that are held."""
    second = {**exact_quantities(mesh_solution), "allowance": {"max_MPa": {"total": 0.01}}}
    second["approach_mm"] = 2 * mesh_solution.result["approach_mm"]
    known = estimates.totals(estimates.estimate([mesh_solution])[0])
    judged = checks.run(mesh_solution, known, second)
    assert all(check.passed for check in judged)
    missing = checks.not_made(mesh_solution, judged, second, None)
    assert missing["second_opinion_approach_mm"] == "what half-spaces leave out of it is not known"
    assert "second_opinion_max_MPa" not in missing


def test_a_missing_second_opinion_has_its_reason(mesh_solution) -> None:
    judged = checks.run(mesh_solution, {}, UNKNOWN)
    assert not any("second_opinion" in each.name for each in judged)
    missing = checks.not_made(mesh_solution, judged, UNKNOWN, None)
    assert missing == {"second_opinion": "nobody knows"}
    assert checks.summary(judged, missing)["not_made"] == missing


@pytest.mark.parametrize(
    ("given", "checked"),
    [("symmetry_x=off", True), ("symmetry_y=on", True), ("far_field=off", False)],
)
def test_the_second_opinion_is_about_the_problem_of_the_scene(given, checked) -> None:
    summary = solved("hertz_ellipse", f"effects.{given}", "mesh.patch_size=3").summary
    assert ("second_opinion_max_MPa" in summary["checks"]) == checked
    assert bool(summary["plan"]["chosen"]) != checked
    assert ("second_opinion" in summary["checks"]["not_made"]) != checked
    assert ("of the problem that was chosen" in summary["accuracy"]["source"]) != checked


def test_the_range_of_shear_over_pressure_is_that_of_hertz() -> None:
    ratios = [
        contact.axis_extrema(nu).tau_max / contact.p0
        for ratio in np.geomspace(1, 100, 9)
        for nu in (0.0, 0.2, 0.3, 0.4, 0.4999)
        for contact in [hertz.point_contact(1 / 300, 1 / 300 / ratio, 1e5, 1e4)]
    ]
    low, high = checks.SHEAR_OVER_PRESSURE
    assert low < min(ratios) and max(ratios) < high


@pytest.mark.parametrize(
    ("modulus", "load", "names"),
    [
        (1e3, 2e3, set()),
        (1e3, 3e3, {"small_strain"}),
        (2e5, 450.0, set()),
        (2e5, 550.0, {"pressure_of_steel"}),
        (1.7e5, 800.0, {"pressure_of_steel"}),
    ],
)
def test_loads_beyond_small_strain_or_any_steel_are_not_signed(modulus, load, names) -> None:
    """A sphere of 8 mm on a rigid plane: p0/E* 0.177 and 0.202; 4.0 and 4.3 GPa in steel;
    4.4 GPa in a body that is no steel, and no harder."""
    scene = catalogue.find("sphere_on_plane").replace(load=load, wheel={"young_modulus": modulus})
    found = mesh_and_solve(planning.make(scene), Progress(quiet=True), MPI.COMM_SELF)
    assert {"small_strain", "pressure_of_steel"} & set(failed(found)) == names


DOCS = Path(__file__).parents[4] / "docs"
PAGE = DOCS / "howto-failed-checks.md"


def names() -> set[str]:
    """Names of all checks in the source; those of compared quantities are one."""
    source = Path(checks.__file__).read_text(encoding="utf-8")
    found = set()
    for name in re.findall(r'name=f?"(?!{name})(.+?)"', source):
        name = name.replace("_{key}", "").replace("{SECOND}", checks.SECOND)
        found |= {name.replace("{BODY_NAMES[body]}", body) for body in BODY_NAMES.values()}
    return found


def test_every_check_has_a_section() -> None:
    sections = re.findall(r"^## (\w+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(sections) == sorted(names()) and len(sections) > 25


def test_the_list_of_checks_has_every_check() -> None:
    page = (DOCS / "checks.md").read_text(encoding="utf-8")
    assert [name for name in names() if name not in page] == []


def test_sections_begin_with_the_words_of_the_report() -> None:
    sections = dict(re.findall(r"^## (\w+)\n\n\*(.+?)\.\*", PAGE.read_text(), re.MULTILINE))
    assert CHECKS.keys() == {name for name in sections if not name.startswith(checks.SECOND)}
    for name in CHECKS:
        assert sections[name].casefold() == CHECKS[name].casefold(), name


def test_what_a_person_overruled_is_named_by_the_check_that_holds() -> None:
    summary = solved("uic54_22t5_axle", "effects.finite_bodies=off", "effects.plasticity=off")
    limit, reason = summary.summary["checks"]["limits"]["effects_left_out"]
    assert limit == 0 and reason == "none but what a person overruled: plasticity"


@pytest.mark.parametrize("profile_error", [0.2, 0.4, np.inf])
def test_where_a_measured_profile_is_uncertain_the_advice_is_to_measure(profile_error) -> None:
    """No mesh and no finite bodies tell more of it; below half of the estimate they do."""
    file = Path(__file__).parents[4] / "examples" / "worn_60e1.csv"
    scene = catalogue.find("s1002_60e1").replace([f"rail.profile={file}", "rail.inclination=0"])
    plan = SimpleNamespace(scene=scene, profile_error=profile_error)
    (found,) = checks.useful(plan, {"max_MPa": profile_error + 0.1, "area_mm2": 0.1}, checks.BODIES)
    assert not found.passed and "rail.smoothing" in found.advice and "--fast" not in found.advice
    (found,) = checks.useful(plan, {"max_MPa": 3 * min(profile_error, 1)}, checks.BODIES)
    assert ("--fast" in found.advice) == (profile_error < 1)
