"""Functions that solve a scene as `railhead run` would and compare it with a reference.

A quantity may deviate by ESTIMATE_FACTOR times its own estimate, by `limit` where it has none, and
by what the reference itself does not know.
"""

import functools
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from mpi4py import MPI

from railhead.contact.solid import Contact
from railhead.half_spaces import pressing
from railhead.meshing.mesh import MeshError
from railhead.planning import simulation_plan as planning
from railhead.results import pipeline
from railhead.results.checks import ESTIMATE_FACTOR, deviation
from railhead.results.summary import summarise
from railhead.run.half_space_answer import frictionless
from railhead.run.mesh_solution import mesh_and_solve
from railhead.run.progress import Progress
from railhead.run.refinement import Ending
from railhead.scene.quantities import numeric_values
from railhead.scene.scene import Scene, SceneError
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.friction import partial_slip
from studies.hard.case import CaseErrors, Deviation
from studies.hard.fuzz_scenes import Source, plans, runnable, scene
from studies.mechanics.plasticity import yield_pressure

Summary = Mapping[str, Any]
PATCH = ("max_MPa", "area_mm2", "tau_max_MPa")
HALF_SPACE = (*PATCH, "approach_mm")
LIMIT = 0.01  # of a quantity without an estimate
SINGLE, SEVERAL = 0.015, 0.03  # of the largest pressure, by number of patches
FORCES = ("force_along_N", "force_across_N")
# Within these an independent program's spheres are met (tests/verification/test_plasticity.py).
PLASTIC = {"approach_mm": 0.012, "area_mm2": 0.03, "max_MPa": 0.04, "strain_max": 0.08}
REPEATED = 0.01  # the same yielding scene in other units
FINE = 1.6  # times the elements per semi-axis, and twice the load steps
# Shares of mu N within which closed forms are met (tests/verification/friction/test_friction.py).
FORCE, STICK, SOLID = 0.012, 0.03, 0.02
SOFT = -0.72  # mu P at creepage 0 with a rail 69 times softer: two other programs, -0.72 and -0.75
RANDOM_SEED = 54


def refusable(solve: Callable[..., CaseErrors]) -> Callable[..., CaseErrors]:
    """The function `solve`, which then returns a refusal of the scene or of its mesh as a failed
    check instead of raising it.
    """

    @functools.wraps(solve)
    def guarded(*args: Any, **options: Any) -> CaseErrors:
        try:
            return solve(*args, **options)
        except (SceneError, MeshError) as error:
            return CaseErrors(failed=(str(error),))

    return guarded


def resolved(scene: Scene, n: float) -> Scene:
    """The scene with n elements per smaller semi-axis of the predicted patch; unchanged for 0."""
    if not n:
        return scene
    return scene.replace([f"mesh.patch_size={planning.make(scene).forecast.minor / n!r}"])


def deviations(
    summary: Summary,
    reference: Mapping[str, float],
    names: Iterable[str],
    limit: float = LIMIT,
    unknown: Mapping[str, float] | None = None,
) -> dict[str, Deviation]:
    """Deviations of a summary from a reference, of the named quantities that the reference has.

    unknown: relative error of the reference, by quantity.
    """
    found, bound = numeric_values(summary["result"] or {}), summary["accuracy"]["bound"]
    return {
        name: Deviation(
            deviation(found.get(name, math.nan), reference[name]),
            (ESTIMATE_FACTOR * bound[name] if name in bound else limit)
            + (unknown or {}).get(name, 0.0),
        )
        for name in names
        if name in reference
    }


def against_boundary_elements(
    summary: Summary, other: Summary, limit: float = LIMIT
) -> dict[str, Deviation]:
    """Deviations of a summary from boundary elements; other: "half_space" of a summary, with its
    grid error and its allowance for the bodies."""
    unknown = {
        name: other["allowance"][name]["total"] + error
        for name, error in other["grid_error"].items()
        if name in other["allowance"]
    }
    return deviations(summary, numeric_values(other), unknown, limit, unknown)


def against_fine_mesh(result: pipeline.Result, finer: Summary, limit: float) -> CaseErrors:
    """Errors of the patch of a result against a summary of the same scene on a finer mesh."""
    fine, bound = numeric_values(finer["result"] or {}), finer["accuracy"]["bound"]
    return measure(result, deviations(result.summary, fine, PATCH, limit, bound))


def measure(
    result: pipeline.Result, found: Mapping[str, Deviation], remark: str = ""
) -> CaseErrors:
    """The deviations with the failed checks and the cost of a run."""
    summary, findings = result.summary, result.findings
    return CaseErrors(
        deviations=found,
        failed=tuple(summary["checks"]["failed"]),
        newton=summary["cost"]["newton_iterations"],
        krylov=summary["cost"]["linear_iterations"],
        noise=None if findings is None else findings.noise,
        remark=remark,
    )


@refusable
def against_hertz(scene: Scene, n: float = 4.0, limit: float = LIMIT) -> CaseErrors:
    """Half-spaces at n elements per smaller semi-axis (0: as planned) against exact Hertz."""
    result = pipeline.run(resolved(scene, n))
    exact = numeric_values(result.summary["hertz"])
    return measure(result, deviations(result.summary, exact, HALF_SPACE, limit))


def half_space(scene: Scene) -> Summary:
    """Boundary elements on the profiles of a scene with a load, twice as fine as beside a result,
    nested as "half_space" of a summary. Raises ValueError where boundary elements have no
    answer."""
    plan = planning.make(scene)
    contact = plan.contact
    assert isinstance(contact, Contact) and isinstance(plan.hertz, Ellipse)
    pair = plan.context.half_spaces
    found = pair.pressed(scene.load, 2 * pressing.FINE)
    return {
        **frictionless(pair, found),
        "allowance": plan.context.half_space_errors,
    }


@refusable
def against_half_space(scene: Scene, n: float = 4.0) -> CaseErrors:
    """Real bodies at n elements per smaller semi-axis (0: as planned) against boundary elements."""
    result = pipeline.run(resolved(scene, n))
    other = half_space(scene)
    return measure(result, against_boundary_elements(result.summary, other))


@refusable
def against_finer(
    scene: Scene, n: float = 3.5, fine: float = 6.0, limit: float = 0.02
) -> CaseErrors:
    """Solve at n elements per smaller semi-axis; the same scene at `fine` is the reference, which
    must be signed itself unless the coarse mesh is refused."""
    result = pipeline.run(resolved(scene, n))
    finer = pipeline.run(resolved(scene, fine)).summary
    measured = against_fine_mesh(result, finer, limit)
    if not measured.failed and finer["checks"]["failed"]:
        failed = ", ".join(finer["checks"]["failed"])
        return replace(measured, deviations={}, remark=f"the finer mesh fails: {failed}")
    return measured


@refusable
def positioned(scene: Scene) -> CaseErrors:
    """The largest pressure at default settings against boundary elements, within the limits for
    one patch and for several."""
    result = pipeline.run(scene)
    second = half_space(scene)
    pressure = deviation(result.pressure.max, second["pressure"]["max_MPa"])
    patches = len(second["patches"])
    allowed = Deviation(pressure, SINGLE if patches == 1 else SEVERAL)
    remark = f"{patches} patches, {result.mesh_solution.unknowns} unknowns"
    return measure(result, {"max_MPa": allowed}, remark)


def outgrown(scene: Scene, meshed: str, fine: float = 0.0) -> CaseErrors:
    """Solve a scene on a first mesh made for another one (`meshed`: an assignment to it), as if it
    had been mispredicted; boundary elements are the reference, or the scene itself at `fine`
    elements per smaller semi-axis."""
    wrong = planning.make(resolved(scene.replace([meshed]), 4.0))
    plan = replace(planning.make(scene), forecast=wrong.forecast, patch_size=wrong.patch_size)
    solution = mesh_and_solve(plan, Progress(quiet=True), MPI.COMM_WORLD)
    result = pipeline.Result(solution, summarise([solution], Ending("one mesh")))
    if fine:
        return against_fine_mesh(result, pipeline.run(resolved(scene, fine)).summary, 0.02)
    other = half_space(scene)
    return measure(result, against_boundary_elements(result.summary, other))


def first_yield(scene: Scene) -> float:
    """Load in N at which a rigid sphere first yields a half-space (Johnson, Contact Mechanics,
    6.8)."""
    rail, radius = scene.rail, scene.wheel.rolling_radius
    pressure = yield_pressure(rail.poisson_ratio) * float(rail.yield_stress or 0.0)
    modulus = rail.young_modulus / (1 - rail.poisson_ratio**2)
    return math.pi**3 * radius**2 * pressure**3 / (6 * modulus**2)


def plastic(summary: Summary) -> dict[str, float]:
    """The judged quantities of a body that yields, by name; empty where none does."""
    found = summary["result"] or {}
    values = numeric_values(found) | found["plastic"] if "plastic" in found else {}
    return {name: values[name] for name in PLASTIC if values}


def plastic_measured(
    scene: Scene, reference: Callable[[], Mapping[str, float]], limits: Mapping[str, float]
) -> CaseErrors:
    """Errors of a scene that yields against reference values, with relative limits; a failed check
    where the result has no yield."""
    result = pipeline.run(scene)
    if not (found := plastic(result.summary)):
        return CaseErrors(failed=("no plastic answer", *result.summary["checks"]["failed"]))
    return measure(
        result,
        {k: Deviation(deviation(found[k], value), limits[k]) for k, value in reference().items()},
    )


@refusable
def finer_plastic(scene: Scene, multiple: float = 0.0) -> CaseErrors:
    """A scene that yields against a mesh FINE times as fine with twice the load steps; multiple:
    load over that of first yield of a sphere; 0: the scene's own load."""
    if multiple:
        scene = scene.replace(load=multiple * first_yield(scene))

    def finer() -> dict[str, float]:
        plan = planning.make(scene)
        plan = plan.at_resolution(FINE * plan.resolution)
        plan = replace(plan, load_steps=2 * plan.load_steps)
        solved = mesh_and_solve(plan, Progress(quiet=True), MPI.COMM_WORLD)
        return plastic(summarise([solved], Ending("one mesh")))

    return plastic_measured(scene, finer, PLASTIC)


@refusable
def same_plastic(scene: Scene, multiple: float, length: float) -> CaseErrors:
    """A sphere that yields, made `length` times smaller, against itself; multiple: load over that
    of first yield."""
    scene = scene.replace(load=multiple * first_yield(scene))
    other = scene.replace(
        load=float(scene.load or 0.0) / length**2,
        rail={"crown_radius": float(scene.rail.crown_radius or 0.0) / length},
        wheel={"rolling_radius": scene.wheel.rolling_radius / length},
    )
    scale = {"approach_mm": length, "area_mm2": length**2}

    def same() -> dict[str, float]:
        found = plastic(pipeline.run(scene).summary)
        return {name: value / scale.get(name, 1.0) for name, value in found.items()}

    return plastic_measured(other, same, dict.fromkeys(PLASTIC, REPEATED))


@refusable
def friction(scene: Scene, reference: str) -> CaseErrors:
    """Forces (over mu N) or the share of the patch that sticks against a reference: 'boundary
    elements', 'cattaneo', 'carter', 'the given force' or 'other programs'."""
    result = pipeline.run(scene)
    found = (result.summary["result"] or {}).get("friction")
    if found is None:
        return CaseErrors(failed=("no friction", *result.summary["checks"]["failed"]))
    limit, given = found["limit_N"], scene.friction
    if reference == "boundary elements":
        other, names = result.summary["half_space_friction"][reference], FORCES
        apart = {name: abs(found[name] - other[name]) / limit for name in names}
        return measure(result, {name: Deviation(each, SOLID) for name, each in apart.items()})
    share, line = found["force_along_N"] / limit, result.ellipse
    creepage = float(scene.rolling.creepage_along or 0.0)
    references = {
        "cattaneo": ("stick_share", lambda: partial_slip.strip_stick_ratio(0.5), STICK),
        "carter": (
            "force_along_N",
            lambda: partial_slip.carter_share(
                line,  # type: ignore[arg-type]
                float(given.at(0.0, scene.heat.bulk)),
                creepage,
            ),
            FORCE,
        ),
        "the given force": ("force_along_N", lambda: (given.force_along or 0.0) / limit, 1e-6),
        "other programs": ("force_along_N", lambda: SOFT, STICK),
    }
    name, exact, allowed = references[reference]
    value = share if name == "force_along_N" else found[name]
    return measure(result, {name: Deviation(abs(value - exact()), allowed)})


def random_plans(count: int) -> CaseErrors:
    """Share of `count` random valid scenes whose plan has numbers that are not finite, or whose
    refusal has more than one line; none may."""
    refused = broken = 0
    for seed in range(count):
        try:
            refused += plans(scene(Source(seed))) is None
        except ValueError:
            broken += 1
    remark = f"{refused} of {count} refused in one line"
    return CaseErrors({"broken plans": Deviation(broken / count, 0.0)}, remark=remark)


def random_scene(number: int) -> CaseErrors:
    """A random scene that the plan accepts, one for each `number`: half-spaces against Hertz for
    odd numbers, profiles against boundary elements for even ones."""
    flat = number % 2 == 1
    drawn = runnable(
        RANDOM_SEED + 1000 * (number - 1), lambda each: (each.rail.extent == "half-space") == flat
    )
    return (against_hertz if flat else against_half_space)(drawn, n=0.0)


METHODS: dict[str, Callable[..., CaseErrors]] = {
    "hertz": against_hertz,
    "half_space": against_half_space,
    "finer": against_finer,
    "positioned": positioned,
    "outgrown": outgrown,
    "finer_plastic": finer_plastic,
    "same_plastic": same_plastic,
    "friction": friction,
    "random_plans": random_plans,
    "random_scene": random_scene,
}
"""What `against` in cases.toml names; other names are functions of `blocks`."""
