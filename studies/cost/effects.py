"""Every effect on and off: what it costs, what leaving it out changes, and that off is free."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.cli.study import PAGE
from railhead.run.progress import Progress
from railhead.scene import catalogue
from studies import tables
from studies.cost import bare_contact

if TYPE_CHECKING:
    from railhead.scene.scene import Scene

SCENES = {
    "uic54_thesis": ("uic54_thesis", []),
    "axle near the R300-R80 joint": (
        "uic54_22t5_axle",
        ["rail.inclination=1:40", "effects.plasticity=off"],
    ),
    "sphere_on_plane": ("sphere_on_plane", []),
    "long_roller": ("long_roller", []),
    "wheel 2000 times stiffer": ("hertz_ellipse", ["wheel.young_modulus=4.14e8"]),
}
REPEATS, BARE_REPEATS = 2, 7  # the fastest and the median of so many runs count
UNITS = {"p_max": "MPa", "area": "mm2", "tau_max": "MPa", "approach": "mm"}


QUANTITIES = ("p_max", "area", "tau_max", "approach")
Row = dict[str, Any]
"""One scene as planned (effect "") or with one effect in its other state `on`.

called_for: by the plan; seconds: of the processor; change_*: relative to the run as planned.
"""


def main(out: Path, *, quick: bool) -> None:
    """Run all scenes (quick: the last one), and write two CSV files and the page."""
    from studies.cost import effects_page as effects_page

    names = list(SCENES)[-1:] if quick else list(SCENES)
    with Progress(quiet=False) as progress:
        runs = [run for name in names for run in switch(name, progress, 1 if quick else REPEATS)]
        progress.stage("with and without a plan")
        bare = bare_contact.compare(1 if quick else BARE_REPEATS)
    tables.write_csv(out / "effects.csv", runs, UNITS)
    tables.write_csv(out / "effects_off.csv", bare, UNITS)
    page = effects_page.page(runs, [vars(each) for each in bare])
    (out / PAGE).write_text(page, encoding="utf-8")


def switch(name: str, progress: Progress, repeats: int) -> Iterator[Row]:
    """A scene as planned, then with each effect in its other state where that can be had."""
    from railhead.planning import plan as planning
    from railhead.results import pipeline

    case, assignments = SCENES[name]
    scene = catalogue.find(case).replace(assignments)
    plan = planning.make(scene)
    decided = dict(plan.effects)
    pipeline.run(scene)  # compiles
    planned: dict[str, float] = {}
    both = ["symmetry"] if decided["symmetry_x"].on and decided["symmetry_y"].on else []
    decided.pop("mean_dilatation")  # a treatment of the cells, no effect of the scene
    for effect in ("", *decided, *both):
        state = decided.get(effect) or decided["symmetry_x"]
        on = state.on if not effect else not state.on
        if effect and not _possible(scene, effect, on):
            continue
        progress.stage(f"{name}: {effect or 'as planned'} {'on' if on else 'off'}")
        chosen = scene.replace([f"effects.{effect}={'on' if on else 'off'}"] if effect else [])
        times = []
        for _ in range(repeats):
            start = time.process_time()
            result = pipeline.run(chosen).summary
            times.append(time.process_time() - start)
        values = tables.columns(result["result"], QUANTITIES)
        planned = planned or values
        yield {
            "scene": name,
            "effect": effect,
            "on": on,
            "called_for": state.called_for,
            "accuracy": plan.context.accuracy,
            "unknowns": result["cost"]["dofs"],
            "seconds": min(times),
            **values,
            **{f"change_{key}": values[key] / planned[key] - 1 for key in values},
        }


def _possible(scene: Scene, effect: str, on: bool) -> bool:
    from railhead.planning import plan as planning
    from railhead.scene.scene import SceneError

    try:
        planning.make(scene.replace([f"effects.{effect}={'on' if on else 'off'}"]))
    except SceneError:
        return False
    return True
