"""Error against time for each method and element, and what an asked accuracy costs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from railhead.run.progress import Progress
from railhead.scene import catalogue
from railhead.scene.scene import Scene
from studies.tables import COLUMNS, columns, write_csv

CASES = ("hertz_ellipse", "sphere_on_plane", "uic54_thesis")
NO_FORMULA = ("uic54_thesis",)  # no half-space: held against its own converged run
REFERENCE = 16.0  # elements per smaller semi-axis of that run
METHODS = ("nitsche", "penalty")
ELEMENTS = {
    "tetrahedron 2": ("tetrahedron", 2, (2.0, 4.0, 7.0, 12.0)),
    "tetrahedron 1": ("tetrahedron", 1, (7.0, 12.0, 20.0, 30.0)),
    "hexahedron 1": ("hexahedron", 1, (4.0, 7.0, 12.0, 20.0)),
}
"""Name: cell, order, elements per smaller semi-axis of the patch."""
CUBIC, CUBIC_SIZES = "tetrahedron 3", (2.0, 3.0, 4.0, 6.0)
"""No scene can ask for them: they are here to show whether they would pay."""
ASKED = ("5%", "1%", "0.2%")
MAX_UNKNOWNS = 200_000  # predicted; finer meshes are left out
MAIN = ("a", "b", "p_max")


@dataclass(frozen=True)
class Run:
    """One run. Errors are relative (error: worst of a, b, p_max; error_all: of all quantities),
    None where there is no result; asked: the accuracy, for runs that choose their own meshes."""

    case: str
    method: str
    element: str
    asked: float | None
    elements_per_semi_axis: float | None
    patch_size_mm: float | None
    unknowns: int | None
    seconds: float | None = None
    seconds_solve: float | None = None
    newton_iterations: int | None = None
    linear_iterations: int | None = None
    converged: bool = False
    failure: str = ""
    reached: bool | None = None
    error: float | None = None
    error_all: float | None = None
    error_a: float | None = None
    error_b: float | None = None
    error_p_max: float | None = None
    error_area: float | None = None
    error_approach: float | None = None
    error_tau_max: float | None = None
    error_tau_max_depth: float | None = None
    error_von_mises_max: float | None = None


@dataclass(frozen=True)
class Case:
    """A case and the values that count as exact."""

    scene: Scene
    exact: dict[str, float]


def main(out: Path, *, quick: bool) -> None:
    """Run everything (quick: half-spaces, two sizes, one asked accuracy); CSV, picture, page."""
    from studies.accuracy import accuracy_cost_page as accuracy_page

    runs: list[Run] = []
    with Progress(quiet=False) as progress:
        for name in CASES[: 1 if quick else None]:
            progress.stage(f"{name}: reference")
            scene = catalogue.find(name).replace(["effects.axisymmetry=off"])  # solids alone
            case = Case(scene, reference(scene))
            runs += fixed_meshes(case, 2 if quick else None, progress)
            runs += cubic_meshes(case, 2 if quick else None, progress)
            runs += asked_accuracies(case, 1 if quick else None, progress)
    write_csv(out / "accuracy_cost.csv", runs)
    rows = [vars(run) for run in runs]
    accuracy_page.draw(rows, out / "accuracy_cost.png")
    (out / "page.md").write_text(accuracy_page.page(rows, MAX_UNKNOWNS), encoding="utf-8")


def reference(scene: Scene) -> dict[str, float]:
    """Exact Hertz; where there is none, this program's own result on a fine mesh."""
    from railhead.planning import plan as planning
    from railhead.results import pipeline

    if scene.name not in NO_FORMULA:
        return columns(pipeline.run(scene).summary["hertz"], COLUMNS)
    ellipse = planning.make(scene).estimate
    fine = scene.replace([f"mesh.patch_size={min(ellipse.a, ellipse.b) / REFERENCE!r}"])
    return columns(pipeline.run(fine).summary["result"], COLUMNS)


def fixed_meshes(case: Case, sizes: int | None, progress: Progress) -> Iterator[Run]:
    """Every element, method and size; before an element's first run, a warm-up that is not timed
    (imports, compilation of the forms)."""
    from railhead.planning import plan as planning

    for element, (cell, order, resolutions) in ELEMENTS.items():
        base = case.scene.replace([f"mesh.cell={cell}", f"mesh.order={order}"])
        ellipse = planning.make(base).estimate
        minor = min(ellipse.a, ellipse.b)
        progress.stage(f"{base.name}: {element}, warm-up")
        _solve(base.replace([f"mesh.patch_size={minor / resolutions[0]!r}"]))
        for method in METHODS:
            for n in resolutions[:sizes]:
                size = minor / n
                scene = base.replace([f"solver.method={method}", f"mesh.patch_size={size!r}"])
                predicted = planning.make(scene).unknowns
                progress.stage(f"{base.name}: {method}, {element}, b/{n:g}, about {predicted}")
                run = Run(base.name, method, element, None, n, size, predicted)
                if predicted > MAX_UNKNOWNS:
                    yield replace(run, failure=f"left out: {predicted} unknowns predicted")
                else:
                    yield _recorded(run, _solve(scene), case.exact)


def cubic_meshes(case: Case, sizes: int | None, progress: Progress) -> Iterator[Run]:
    """Cubic tetrahedra with Nitsche's method, after a warm-up."""
    from mpi4py import MPI

    from railhead.planning import plan as planning
    from railhead.run.mesh_solution import mesh_and_solve

    plan = replace(planning.make(case.scene), order=3)
    silent, comm = Progress(quiet=True), MPI.COMM_WORLD
    progress.stage(f"{case.scene.name}: {CUBIC}, warm-up")
    mesh_and_solve(plan.at_resolution(CUBIC_SIZES[0]), None, silent, comm)
    for n in CUBIC_SIZES[:sizes]:
        progress.stage(f"{case.scene.name}: nitsche, {CUBIC}, b/{n:g}")
        solved = mesh_and_solve(plan.at_resolution(n), None, silent, comm)
        history = solved.solution.newton.history
        yield Run(
            case.scene.name,
            "nitsche",
            CUBIC,
            None,
            n,
            solved.grading.size,
            solved.unknowns,
            seconds=sum(solved.seconds.values()),
            seconds_solve=solved.seconds["solve"],
            newton_iterations=len(history),
            linear_iterations=sum(step.linear_iterations for step in history),
            converged=solved.solution.newton.converged,
            failure="" if solved.solution.newton.converged else solved.solution.newton.reason,
            **_errors(solved.result, case.exact),
        )


def asked_accuracies(case: Case, count: int | None, progress: Progress) -> Iterator[Run]:
    """Runs that choose their meshes for an asked accuracy; their seconds are of all meshes."""
    for asked in ASKED[:count]:
        progress.stage(f"{case.scene.name}: asked accuracy {asked}")
        scene = case.scene.replace([f"accuracy={asked}"])
        done = _solve(scene)
        if isinstance(done, str) or done["accuracy"]["bound"]:
            run = Run(scene.name, "nitsche", "tetrahedron 2", scene.accuracy, None, None, None)
            yield _recorded(run, done, case.exact)


def _solve(scene: Scene) -> dict[str, Any] | str:
    """The summary, or why there is none."""
    import numpy as np

    from railhead.meshing.mesh import MeshError
    from railhead.results import pipeline

    try:
        return pipeline.run(scene).summary
    except (MeshError, RuntimeError, ArithmeticError, np.linalg.LinAlgError) as error:
        return " ".join(f"{type(error).__name__}: {error}".split())


def _recorded(run: Run, done: dict[str, Any] | str, exact: dict[str, float]) -> Run:
    """The run with its price and its errors, or with the reason of its failure."""
    if isinstance(done, str):
        return replace(run, failure=done)
    cost, converged = done["cost"], done["checks"]["converged"]
    return replace(
        run,
        patch_size_mm=done["plan"]["patch_size_mm"],
        unknowns=cost["dofs"],
        seconds=cost["seconds"]["total"],
        seconds_solve=cost["seconds"]["solve"],
        newton_iterations=cost["newton_iterations"],
        linear_iterations=cost["linear_iterations"],
        converged=converged,
        failure="" if converged else done["newton"]["reason"],
        reached=done["accuracy"]["reached"],
        **_errors(done["result"], exact),
    )


def _errors(result: dict[str, Any] | None, exact: dict[str, float]) -> dict[str, Any]:
    if result is None:
        return {}
    found = columns(result, COLUMNS)
    errors = {f"error_{key}": abs(found[key] / exact[key] - 1) for key in COLUMNS}
    errors["error_all"] = max(errors.values())
    errors["error"] = max(errors[f"error_{key}"] for key in MAIN)
    return errors
