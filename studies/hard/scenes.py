"""Hard cases that a scene can say: solved as `railhead run` would, held against a reference.

A quantity may deviate by MISS times its own estimate, by the case's limit where it has none, and by
what the reference itself does not know.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from mpi4py import MPI

from railhead.contact.solid import Contact
from railhead.meshing.mesh import MeshError
from railhead.planning import plan as planning
from railhead.planning.references import boundary_elements
from railhead.postprocess import compare
from railhead.results import pipeline
from railhead.results.checks import MISS
from railhead.results.summary import summarise
from railhead.run import estimates
from railhead.run.mesh_solution import MeshSolution, mesh_and_solve
from railhead.run.progress import Progress
from railhead.run.references.allowance import allowance
from railhead.run.references.half_space_reference import CELLS, motion
from railhead.run.refinement import Ending
from railhead.scene.scene import Scene, SceneError
from railhead.theory.elastic.hertz import Ellipse
from studies.hard.case import Deviation, Measured

Summary = Mapping[str, Any]
Solve = Callable[[], Measured]
PATCH = ("max_MPa", "area_mm2", "tau_max_MPa")
HALF_SPACE = (*PATCH, "approach_mm")
LIMIT = 0.01  # of a quantity without an estimate
ELLIPSE = Scene.from_mapping(
    {
        "name": "ellipse",
        "load": 25e3,
        "rail": {"profile": "arc", "crown_radius": 300, "extent": "half-space"},
    }
)
HEAD = Scene(name="head", load=25e3)


def resolved(scene: Scene, n: float) -> Scene:
    """The scene with n elements per smaller semi-axis of the predicted patch."""
    zone = planning.make(scene).forecast
    return scene.replace([f"mesh.patch_size={zone.minor / n!r}"])


def quantities(summary: Summary) -> dict[str, float]:
    """Result by name; empty where there is none."""
    return estimates.flat(summary["result"] or {})


def off(value: float, reference: float) -> float:
    """Relative deviation."""
    return abs(value / reference - 1)


def deviations(
    summary: Summary,
    reference: Mapping[str, float],
    names: Iterable[str],
    limit: float = LIMIT,
    unknown: Mapping[str, float] | None = None,
) -> dict[str, Deviation]:
    """Of the named quantities that the reference has; unknown: the reference's own error."""
    found, bound = quantities(summary), summary["accuracy"]["bound"]
    return {
        name: Deviation(
            off(found.get(name, math.nan), reference[name]),
            (MISS * bound[name] if name in bound else limit) + (unknown or {}).get(name, 0.0),
        )
        for name in names
        if name in reference
    }


def against_boundary_elements(
    summary: Summary, other: Summary, limit: float = LIMIT
) -> dict[str, Deviation]:
    """other: "half_space" of a summary, with its grid error and its allowance for the bodies."""
    unknown = {
        name: other["allowance"][name]["total"] + error
        for name, error in other["grid_error"].items()
        if name in other["allowance"]
    }
    return deviations(summary, estimates.flat(other), unknown, limit, unknown)


def measure(result: pipeline.Result, found: Mapping[str, Deviation], remark: str = "") -> Measured:
    """The deviations with the failed checks and the cost of a run."""
    summary, findings = result.summary, result.findings
    return Measured(
        found,
        tuple(summary["checks"]["failed"]),
        summary["cost"]["newton_iterations"],
        summary["cost"]["linear_iterations"],
        None if findings is None else findings.noise,
        remark,
    )


def refusals(solve: Solve) -> Solve:
    """The same, with a refusal of the scene or of its mesh as what failed."""

    def guarded() -> Measured:
        try:
            return solve()
        except (SceneError, MeshError) as error:
            return Measured(failed=(str(error),))

    return guarded


def against_hertz(scene: Scene, n: float | None = 4.0, limit: float = LIMIT) -> Solve:
    """Half-spaces at n elements per semi-axis (None: as planned) against exact Hertz."""

    def solve() -> Measured:
        result = pipeline.run(scene if n is None else resolved(scene, n))
        exact = estimates.flat(result.summary["hertz"])
        return measure(result, deviations(result.summary, exact, HALF_SPACE, limit))

    return refusals(solve)


def half_space(scene: Scene, mesh_solution: MeshSolution) -> Summary:
    """Boundary elements on the profiles of a scene with a load, twice as fine as beside a result,
    nested as "half_space" of a summary; level: a solution of it. Raises ValueError where they know
    no answer."""
    plan = planning.make(scene)
    contact = plan.contact
    assert isinstance(contact, Contact) and isinstance(plan.estimate, Ellipse)
    found = boundary_elements.solve(contact, plan.estimate, scene.load, 2 * CELLS)
    points, plane = boundary_elements.develop(contact).points, contact.touch.angle
    other = compare.from_half_space(found, points, plane)
    allowed = {name: vars(each) | {"total": each.total}
               for name, each in allowance(plan, found, motion(mesh_solution)).items()}  # fmt: skip
    return {**other, "allowance": allowed}


def against_half_space(scene: Scene, n: float | None = 4.0, limit: float = LIMIT) -> Solve:
    """Real bodies at n elements per semi-axis against boundary elements."""

    def solve() -> Measured:
        result = pipeline.run(scene if n is None else resolved(scene, n))
        return measure(
            result,
            against_boundary_elements(
                result.summary, half_space(scene, result.mesh_solution), limit
            ),
        )

    return refusals(solve)


def against_finer(
    scene: Scene,
    n: float = 3.5,
    fine: float = 6.0,
    names: tuple[str, ...] = PATCH,
    limit: float = 0.02,
) -> Solve:
    """Solve at n elements per semi-axis; the same scene at `fine` is the reference, which must be
    signed itself unless the coarse mesh is refused."""

    def solve() -> Measured:
        result = pipeline.run(resolved(scene, n))
        finer = pipeline.run(resolved(scene, fine)).summary
        unknown = finer["accuracy"]["bound"]
        found = deviations(result.summary, quantities(finer), names, limit, unknown)
        measured = measure(result, found)
        if not measured.failed and finer["checks"]["failed"]:
            failed = ", ".join(finer["checks"]["failed"])
            return replace(measured, deviations={}, remark=f"the finer mesh fails: {failed}")
        return measured

    return refusals(solve)


def positioned(scene: Scene, single: float, several: float) -> Solve:
    """The largest pressure at default settings against boundary elements, within the limits for
    one patch and for several."""

    def solve() -> Measured:
        result = pipeline.run(scene)
        second = half_space(scene, result.mesh_solution)
        pressure = off(quantities(result.summary)["max_MPa"], second["pressure"]["max_MPa"])
        patches = len(second["patches"])
        allowed = single if patches == 1 else several
        return measure(result, {"max_MPa": Deviation(pressure, allowed)},
                       f"{patches} patches, {result.mesh_solution.unknowns} unknowns")  # fmt: skip

    return refusals(solve)


def outgrown(
    scene: Scene, meshed: Scene, n: float = 4.0, fine: float = 0.0, limit: float = 0.02
) -> Solve:
    """Solve a scene on a first mesh made for another one, as if it had been mispredicted; boundary
    elements are the reference, or the scene itself at `fine` elements per semi-axis."""

    def solve() -> Measured:
        wrong = planning.make(resolved(meshed, n))
        plan = replace(planning.make(scene), forecast=wrong.forecast, patch_size=wrong.patch_size)
        mesh_solution = mesh_and_solve(plan, None, Progress(quiet=True), MPI.COMM_WORLD)
        result = pipeline.Result(mesh_solution, summarise([mesh_solution], Ending("one mesh")))
        if not fine:
            found = against_boundary_elements(result.summary, half_space(scene, mesh_solution))
            return measure(result, found)
        finer = pipeline.run(resolved(scene, fine)).summary
        unknown = finer["accuracy"]["bound"]
        found = deviations(result.summary, quantities(finer), PATCH, limit, unknown)
        return measure(result, found)

    return solve
