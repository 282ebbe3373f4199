"""Do the error bounds hold? Random Hertz scenes, whose exact answer is known."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from railhead import accuracy, run, studies
from railhead.scene import Mesh, Rail, Scene, Wheel
from theory.hertz import point_contact

STUDY = "error bounds against true errors on 30 random Hertz scenes"
SEED = 20120
ASKED = (0.05, 0.02, 0.01, 0.005, 0.002)


@dataclass(frozen=True)
class Record:
    """One quantity of one scene; ratio: true error over bound (at most 1 if the bound holds)."""

    scene: int
    asked: float
    axis_ratio: float
    load: float
    modulus_ratio: float
    reached: bool
    unknowns: int
    seconds: float
    predicted_seconds: float
    quantity: str
    bound: float
    error: float
    ratio: float


def random_scenes(count: int, seed: int = SEED) -> list[tuple[Scene, float]]:
    """Scenes with their axis ratio: ratio 1-8 either way, load 1-200 kN, E ratio 0.3-3."""
    rng = np.random.default_rng(seed)
    scenes = []
    for index in range(count):
        ratio, radius = rng.uniform(1, 8), 10 ** rng.uniform(2, 2.8)

        def excess(log_ratio: float, ratio: float = ratio, radius: float = radius) -> float:
            found = point_contact(math.exp(-log_ratio) / radius, 1 / radius, 1e5, 1e3)
            return math.log(found.a / found.b / ratio)

        other = radius * math.exp(brentq(excess, -0.01, 9.0))
        rolling, crown = (other, radius) if rng.random() < 0.5 else (radius, other)
        scene = Scene(
            name=f"random_{index}",
            load=10 ** rng.uniform(3, math.log10(2e5)),
            accuracy=ASKED[index % len(ASKED)],
            rail=Rail(
                profile="arc",
                crown_radius=crown,
                extent="half-space",
                young_modulus=207000 * 10 ** rng.uniform(math.log10(0.3), math.log10(3)),
                poisson_ratio=rng.uniform(0.2, 0.4),
            ),
            wheel=Wheel(rolling_radius=rolling, poisson_ratio=rng.uniform(0.2, 0.4)),
            mesh=Mesh(),
        )
        scenes.append((scene, ratio))
    return scenes


def measure(index: int, scene: Scene, ratio: float) -> list[Record]:
    """Solve one scene to its asked accuracy and hold each bound against the true error."""
    from railhead import plan as planning
    from railhead.price import price

    plan = planning.make(scene)
    predicted = price(plan, plan.resolution)[1]
    summary = run.run(scene).summary
    error = accuracy.flat(summary["difference"])
    found = summary["accuracy"]
    return [
        Record(
            index,
            float(scene.accuracy or 0.0),
            ratio,
            float(scene.load or 0.0),
            scene.rail.young_modulus / scene.wheel.young_modulus,
            bool(found["reached"]),
            summary["cost"]["dofs"],
            summary["cost"]["seconds"]["total"],
            predicted,
            name,
            bound,
            abs(error[name]),
            abs(error[name]) / bound,
        )
        for name, bound in found["bound"].items()
    ]


def main(out: Path, *, quick: bool) -> None:
    """Write error_bounds.csv and page.md; quick: 3 scenes."""
    records: list[Record] = []
    for index, (scene, ratio) in enumerate(random_scenes(3 if quick else 30)):
        print(f"scene {index + 1}: accuracy {scene.accuracy:g}", file=sys.stderr)
        records += measure(index, scene, ratio)
    studies.write_csv(out / "error_bounds.csv", records)
    (out / studies.PAGE).write_text(page(records), encoding="utf-8")


def page(records: list[Record]) -> str:
    """The result in words and a table by quantity."""
    ratios = np.array([record.ratio for record in records])
    effectivity = 1 / np.maximum(ratios, 1e-6)
    scenes = len({record.scene for record in records})
    reached = len({record.scene for record in records if record.reached})
    price = {r.scene: r.seconds / r.predicted_seconds for r in records}
    off = np.array(list(price.values()))
    rows = []
    for name in accuracy.QUANTITIES:
        mine = [record for record in records if record.quantity == name]
        part = np.array([record.ratio for record in mine])
        rows.append(
            [
                name,
                f"{np.mean(part <= 1):.0%}",
                f"{part.max():.2f}",
                f"{np.median(1 / np.maximum(part, 1e-6)):.1f}",
                studies.percent(float(np.median([record.error for record in mine]))),
                studies.percent(float(np.median([record.bound for record in mine]))),
            ]
        )
    head = ("quantity", "bound holds", "error/bound, max", "effectivity, median", "error", "bound")
    return (
        "# Error bounds\n\n"
        f"{scenes} random Hertz half-space scenes (axis ratio 1-8, load 1-200 kN, E ratio 0.3-3), "
        f"accuracies asked: {', '.join(f'{value:g}' for value in ASKED)}. "
        "Made by `railhead study error-bounds`.\n\n"
        f"- asked accuracy reached in {reached} of {scenes} scenes;\n"
        f"- the bound holds in {np.mean(ratios <= 1):.1%} of {len(ratios)} numbers and is exceeded "
        f"by at most a factor {max(1.0, ratios.max()):.2f};\n"
        f"- effectivity (bound over true error): median {np.median(effectivity):.1f};\n"
        f"- time over predicted time: {off.min():.2f} to {off.max():.2f}, "
        f"median {np.median(off):.2f}.\n\n"
        "Error and bound are medians over the scenes.\n\n" + studies.table(head, rows) + "\n"
    )
