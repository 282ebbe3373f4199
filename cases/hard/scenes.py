"""Hard cases that a scene can say: solved as `railhead run` would, held against a reference."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI

from cases.hard.case import Measured
from railhead import estimates
from railhead import plan as planning
from railhead import run as running
from railhead.level import solve_level
from railhead.progress import Progress
from railhead.scene import Scene
from railhead.summary import Ending, summarise

PATCH = ("a_mm", "b_mm", "max_MPa")
HALF_SPACE = (*PATCH, "approach_mm")
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
    ellipse = planning.make(scene).estimate
    return scene.replace([f"mesh.patch_size={min(ellipse.a, ellipse.b) / n!r}"])


def quantities(summary: Mapping[str, Any]) -> dict[str, float]:
    """Result by name, NaN where there is none."""
    found = summary["result"]
    return dict.fromkeys(estimates.QUANTITIES, math.nan) if found is None else estimates.flat(found)


def worst(found: Mapping[str, float], exact: Mapping[str, float], names: tuple[str, ...]) -> float:
    """Largest relative deviation of the named quantities; inf where one is not a number."""
    each = [abs(found[name] / exact[name] - 1) for name in names]
    return max(each) if np.isfinite(each).all() else math.inf


def measure(result: running.Result, deviation: float) -> Measured:
    """The deviation with the checks and costs of a run."""
    summary, findings = result.summary, result.findings
    checks, cost = summary["checks"], summary["cost"]
    return Measured(
        deviation,
        checks["force_balance"],
        checks["converged"],
        cost["newton_iterations"],
        cost["linear_iterations"],
        None if findings is None else findings.noise,
        summary["newton"]["reason"] if not checks["converged"] else "",
    )


def against_hertz(
    scene: Scene, n: float = 4.0, names: tuple[str, ...] = HALF_SPACE
) -> Callable[[], Measured]:
    """Solve at n elements per semi-axis; exact Hertz is the reference."""

    def solve() -> Measured:
        result = running.run(resolved(scene, n))
        exact = estimates.flat(result.summary["hertz"])
        return measure(result, worst(quantities(result.summary), exact, names))

    return solve


def against_finer(
    scene: Scene, n: float = 3.0, fine: float = 6.0, names: tuple[str, ...] = HALF_SPACE
) -> Callable[[], Measured]:
    """Solve at n elements per semi-axis; the same scene at `fine` is the reference."""

    def solve() -> Measured:
        result = running.run(resolved(scene, n))
        exact = quantities(running.run(resolved(scene, fine)).summary)
        return measure(result, worst(quantities(result.summary), exact, names))

    return solve


def krylov_growth(scenes: Callable[[], list[Scene]], *, ordered: bool) -> Callable[[], Measured]:
    """Solve all; the deviation is how far the Krylov iterations per Newton step grow from the first
    scene to the last (ordered), or to the worst."""

    def solve() -> Measured:
        runs = [measure(running.run(scene), 0.0) for scene in scenes()]
        rates = [run.krylov / run.newton for run in runs]
        listed = ", ".join(f"{run.krylov}/{run.newton}" for run in runs)
        return Measured(
            (rates[-1] if ordered else max(rates)) / rates[0] - 1,
            max(run.balance for run in runs),
            all(run.converged for run in runs),
            max(run.newton for run in runs),
            max(run.krylov for run in runs),
            remark=f"Krylov/Newton {listed}",
        )

    return solve


def outgrown(
    scene: Scene, meshed: Scene, n: float = 4.0, fine: float = 0.0
) -> Callable[[], Measured]:
    """Solve a scene on a first mesh made for another one, as if it had been mispredicted: exact
    Hertz is the reference, or the scene itself at `fine` elements per semi-axis."""

    def solve() -> Measured:
        grading = planning.make(resolved(meshed, n)).grading()
        plan = replace(planning.make(scene), patch_size=grading.size)
        level = solve_level(plan, grading, Progress(quiet=True), MPI.COMM_WORLD)
        result = running.Result(level, summarise([level], Ending("one mesh")))
        if fine:
            exact = quantities(running.run(resolved(scene, fine)).summary)
        else:
            exact = estimates.flat(result.summary["hertz"])
        return measure(result, worst(quantities(result.summary), exact, PATCH))

    return solve
