"""Do the estimates hold? Random scenes of every family whose answer is known, other seeds."""

import math
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from railhead.planning import simulation_plan as planning
from railhead.results import pipeline
from railhead.scene import quantities
from railhead.scene.quantities import ESTIMATED
from railhead.scene.scene import Scene
from studies.accuracy import families
from studies.processes import attempts
from studies.tables import Row, cells, groups, publish, render, timed

SEEDS = (20261201, 20261202)
SCENES = 8  # of a family and a seed, but those in OTHERS
CHEAP = ("plane strain", "meridian", "incompressible lines", "incompressible circles")
OTHERS = {
    **dict.fromkeys(CHEAP, 12),
    "linear": 6,
    "bodies": 3,
    "yield": 3,
    "yielding profiles": 1,
    "profiles": 3,
    "hexahedra": 2,
    "outside": 1,
}
"""Scenes of a family and a seed, where cells cost little or much."""
ASKED = (None, 0.05, None, 0.02, None, 0.01)  # by scene in turn; None: default settings
ROUGH_ASKED = (None, 0.1, None, 0.05)  # of linear cells
YIELD_ASKED = (0.05, 0.02, None)
OTHERS_ASKED: dict[str, Sequence[float | None]] = {
    "outside": (0.05,),
    **dict.fromkeys(("hexahedra", "linear"), ROUGH_ASKED),
    **dict.fromkeys(("yield", "yielding profiles"), YIELD_ASKED),
}
LIMIT = 600.0  # s, of one scene and its truth
ROUNDING = 1e-7  # relative; errors below it say nothing of an estimate
MAIN = ("max_MPa", "area_mm2", "tau_max_MPa")  # quantities that must have an estimate


def signed(row: Row) -> bool:
    """Whether the program stands for the number: no check failed but that of the asked accuracy,
    which the program then says is missed."""
    return row["failed"] in ("", "accuracy")


def asked(name: str, index: int) -> float | None:
    """Relative accuracy that is asked of the scene number `index` of a family and a seed; None:
    default settings."""
    choice = OTHERS_ASKED.get(name, ASKED)
    return choice[index % len(choice)]


def measure(name: str, scene: Scene, accuracy: float | None) -> list[Row]:
    """Solve a scene and compare each estimate with the true error; no rows if not converged.

    A row is one quantity of the scene; estimate None where there is none; passed: status 0;
    seconds: of the processor; price: these over the predicted ones; failed: names of checks.
    accuracy: as from `asked`.
    """
    if accuracy is not None:
        scene = scene.replace([f"accuracy={accuracy!r}"])
    predicted = planning.make(scene).price.solving_seconds
    result, seconds = timed(pipeline.run, scene)
    checks, cost, reached = (result.summary[key] for key in ("checks", "cost", "accuracy"))
    if not checks["converged"]:
        return []
    found = quantities.numeric_values(result.summary["result"])
    run: dict[str, Any] = {
        "family": name,
        "scene": scene.name,
        "asked": accuracy,
        "passed": checks["passed"],
        "failed": " ".join(checks["failed"]),
        "reached": reached["reached"],
        "unknowns": cost["dofs"],
        "meshes": len(reached["levels"]),
        "seconds": seconds,
        "price": seconds / predicted,
    }
    return [
        run
        | {
            "quantity": key,
            "estimate": reached["bound"].get(key),
            "error": abs(found[key] / value - 1),
        }
        for key, value in families.truth(name, scene, result.mesh_solution).items()
        if key in found and value
    ]


def main(out: Path, *, quick: bool) -> None:
    """Write error_bounds.csv and page.md, anew after each family; quick: four scenes of two."""
    records, lost = [], []
    for name in CHEAP[:2] if quick else families.RECIPES:
        count = 2 if quick else OTHERS.get(name, SCENES)
        jobs = [
            (name, scene, asked(name, index))
            for seed in SEEDS
            for index, scene in enumerate(islice(families.scenes(name, seed), count))
        ]
        for job, attempt in zip(jobs, attempts(measure, jobs, [LIMIT] * len(jobs)), strict=True):
            records += attempt.value or []
            lost += [f"{job[1].name}: {attempt.fault}"] if attempt.fault else []
        publish(out, page(records, lost), error_bounds=records)


def verdict(records: Sequence[Row]) -> dict[str, float]:
    """holds: share of the signed estimates that hold; worst: largest error over estimate;
    effectivity: median of estimate over error; estimated: share of the main quantities that have an
    estimate; passed: share of the runs with status 0."""
    known = [r for r in records if signed(r) and r["estimate"] and r["error"] > ROUNDING]
    ratios = np.array([r["error"] / r["estimate"] for r in known] or [math.nan])
    wanted = [r for r in records if r["quantity"] in MAIN]
    return {
        "holds": float(np.mean(ratios <= 1)),
        "worst": float(ratios.max()),
        "effectivity": float(np.median(1 / ratios)),
        "estimated": float(np.mean([r["estimate"] is not None for r in wanted])),
        "passed": float(np.mean([r["passed"] for r in wanted])),
    }


def page(records: Sequence[Row], lost: Sequence[str]) -> str:
    """Tables by family and by quantity; lost: scenes that gave nothing, with the reason."""

    def lines(own: dict[str, list[Row]], *more: str) -> list[list[str]]:
        rows = [
            {"of": name, "scenes": len(groups(each, "family", "scene")), **verdict(each)}
            for name, each in own.items()
        ]
        head = ("{of}", "{scenes}", "{holds:.1%}", "{worst:.2f}", "{effectivity:.1f}")
        return cells(rows, *head, *more)

    quantities = groups(records, "quantity")
    price = [r["price"] for r in quantities["max_MPa"]]
    return render(
        "error_bounds",
        seeds=SEEDS,
        fine=families.FINE,
        by_family=lines(groups(records, "family"), "{estimated:.0%}", "{passed:.0%}"),
        by_quantity=lines({key: quantities[key] for key in ESTIMATED if key in quantities}),
        price=price,
        median=np.median(price),
        lost=lost,
        refused={r["scene"]: r for r in records if not signed(r)}.values(),
    )
