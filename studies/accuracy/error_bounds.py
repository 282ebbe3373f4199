"""Do the estimates hold? Random scenes of every family whose answer is known, other seeds."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from railhead.cli import study
from railhead.results import pipeline
from railhead.run import quantities
from railhead.run.quantities import ESTIMATED
from railhead.scene.scene import Scene
from railhead.sweeps.worker_pool import attempts
from studies import tables
from studies.accuracy import families

SEED = 2028
SCENES = 20
ASKED = (None, 0.05, None, 0.02, None, 0.01)  # by scene in turn; None: default settings
ROUGH_ASKED = (None, 0.1, None, 0.05)  # of linear cells
LIMIT = 600.0  # s, of one scene and its truth
ROUNDING = 1e-7  # relative; errors below it say nothing of an estimate
MAIN = ("max_MPa", "area_mm2", "tau_max_MPa")  # quantities that must have an estimate


@dataclass(frozen=True)
class Record:
    """One quantity of one scene; estimate None where there is none; passed: status 0; seconds of
    the run over the predicted ones; failed: names of checks."""

    family: str
    scene: str
    asked: float | None
    passed: bool
    failed: str
    reached: bool | None
    unknowns: int
    meshes: int
    seconds: float
    price: float
    quantity: str
    estimate: float | None
    error: float

    @property
    def signed(self) -> bool:
        """Whether the number is one that the program stands for: no check failed but that of the
        asked accuracy, where numbers and estimates stand and the accuracy is said to be missed."""
        return self.failed in ("", "accuracy")

    @property
    def ratio(self) -> float:
        """True error over estimate; at most 1 where it holds."""
        return self.error / self.estimate if self.estimate else math.nan


def asked(name: str, index: int) -> float | None:
    """The accuracy that is asked of a scene."""
    if name == "outside":
        return 0.05
    choice = ROUGH_ASKED if name in ("hexahedra", "linear") else ASKED
    return choice[index % len(choice)]


def measure(name: str, scene: Scene, accuracy: float | None) -> list[Record]:
    """Solve a scene and hold each estimate against the true error; nothing if not converged."""
    from railhead.planning import plan as planning

    if accuracy is not None:
        scene = scene.replace([f"accuracy={accuracy!r}"])
    plan = planning.make(scene)
    predicted = plan.seconds if accuracy is None else plan.price_at(plan.sizing.resolution).seconds
    result = pipeline.run(scene)
    summary = result.summary
    if not summary["checks"]["converged"]:
        return []
    found, cost = quantities.numeric_values(summary["result"]), summary["cost"]
    return [
        Record(
            name,
            scene.name,
            accuracy,
            summary["checks"]["passed"],
            " ".join(summary["checks"]["failed"]),
            summary["accuracy"]["reached"],
            cost["dofs"],
            len(summary["accuracy"]["levels"]),
            cost["seconds"]["total"],
            cost["seconds"]["total"] / predicted,
            key,
            summary["accuracy"]["bound"].get(key),
            abs(found[key] / value - 1),
        )
        for key, value in families.truth(name, scene, result.mesh_solution).items()
        if key in found and value
    ]


def main(out: Path, *, quick: bool) -> None:
    """Write error_bounds.csv and page.md, anew after each family; quick: four scenes of two."""
    records: list[Record] = []
    lost: list[str] = []
    for name in ["plane strain", "meridian"] if quick else families.RECIPES:
        scenes = islice(families.scenes(name, SEED), 4 if quick else SCENES)
        jobs = [(name, scene, asked(name, index)) for index, scene in enumerate(scenes)]
        done = attempts(measure, jobs, [LIMIT] * len(jobs))
        for number, (job, attempt) in enumerate(zip(jobs, done, strict=True), 1):
            records += attempt.value or []
            lost += [f"{job[1].name}: {attempt.fault}"] if attempt.fault else []
            print(f"{name}: {number} of {len(jobs)}", file=sys.stderr)
        tables.write_csv(out / "error_bounds.csv", records)
        (out / study.PAGE).write_text(page(records, lost), encoding="utf-8")


def verdict(records: Sequence[Record]) -> dict[str, float]:
    """Share of the signed estimates that hold, worst ratio, median effectivity, share of the main
    quantities that have an estimate, share of runs with status 0."""
    known = [r for r in records if r.signed and r.estimate is not None and r.error > ROUNDING]
    ratios = np.array([r.ratio for r in known]) if known else np.array([math.nan])
    wanted = [r for r in records if r.quantity in MAIN]
    return {
        "holds": float(np.mean(ratios <= 1)),
        "worst": float(ratios.max()),
        "effectivity": float(np.median(1 / ratios)),
        "estimated": float(np.mean([r.estimate is not None for r in wanted])),
        "passed": float(np.mean([r.passed for r in wanted])),
    }


def page(records: Sequence[Record], lost: Sequence[str]) -> str:
    """Tables by family and by quantity; lost: scenes that gave nothing, with the reason."""

    def row(title: str, mine: Sequence[Record]) -> list[str]:
        v = verdict(mine)
        return [
            title,
            str(len({(r.family, r.scene) for r in mine})),
            f"{v['holds']:.1%}",
            f"{v['worst']:.2f}",
            f"{v['effectivity']:.1f}",
        ]

    def family(name: str) -> list[str]:
        mine = [r for r in records if r.family == name]
        v = verdict(mine)
        return [*row(name, mine), f"{v['estimated']:.0%}", f"{v['passed']:.0%}"]

    refused = {r.scene: r for r in records if not r.signed}
    price = [r.price for r in records if r.quantity == "max_MPa"]
    quantities = {key: [r for r in records if r.quantity == key] for key in ESTIMATED}
    return tables.render(
        "error_bounds",
        seed=SEED,
        fine=families.FINE,
        by_family=[family(name) for name in dict.fromkeys(r.family for r in records)],
        by_quantity=[row(key, mine) for key, mine in quantities.items() if mine],
        price=price,
        median=np.median(price),
        lost=lost,
        refused=refused.values(),
    )
