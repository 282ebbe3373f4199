"""All scenes of a sweep: planned, and what they are predicted to take."""

from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import timedelta
from typing import Any

from railhead.planning import cost
from railhead.planning import simulation_plan as planning
from railhead.planning.simulation_plan import Plan
from railhead.run.progress import Progress
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps import worker_pool
from railhead.sweeps.grid import ParameterGrid

PLANNED = 5  # scenes that a process plans in one job


def plan_each(scenes: Sequence[Scene]) -> list[Plan | SceneError]:
    """Plan scenes one after the other in this process; an error in the place of a plan says why a
    scene makes no contact problem.
    """
    planned: list[Plan | SceneError] = []
    for scene in scenes:
        try:
            planned.append(planning.make(scene))
        except SceneError as error:
            planned.append(error)
    return planned


def plan_all(
    grid: ParameterGrid,
    progress: Progress,
    submit: worker_pool.Submit | None = None,
    refused: dict[int, SceneError] | None = None,
) -> dict[int, Plan]:
    """Plans of all scenes of a grid by number. Raises SceneError, with the values of the scene, for
    the first scene that makes no contact problem; where there is a table of the `refused`, it is
    put there instead. submit: as of `worker_pool.together`.

    The approach of a whole rail is to its foot, that of a head to its cut. So that one sweep has
    one datum, `effects.rail_section` is set to on in the grid's scenes that leave it to the plan,
    where the plan of another scene has it.
    """
    total = len(grid.scenes)
    progress.stage(f"planning {total} scenes")
    jobs = [(grid.scenes[first : first + PLANNED],) for first in range(0, total, PLANNED)]
    planned: list[Plan | SceneError] = []
    for part in worker_pool.together(submit, plan_each, jobs):
        planned += part
        progress.stage(f"planning: {len(planned)} of {total} scenes")
    plans = {}
    for number, (_, error) in grid.refused.items():
        planned[number] = error
    for number, plan in enumerate(planned):
        if not isinstance(plan, SceneError):
            plans[number] = plan
        elif refused is None:
            raise SceneError(plan.key, f"{plan.text} ({grid.label(number)})")
        else:
            refused[number] = plan
    sections = {number: plan.effects["rail_section"] for number, plan in plans.items()}
    if any(each.on for each in sections.values()) and "effects.rail_section" not in grid.keys:
        for number, each in sections.items():
            scene = grid.scenes[number]
            if not each.on and "on" not in each.refused and scene.effects.rail_section == "auto":
                grid.scenes[number] = scene.replace(["effects.rail_section=on"])
                plans[number] = planning.make(grid.scenes[number])
    return plans


def forecast(grid: ParameterGrid, workers: int, progress: Progress) -> dict[str, Any]:
    """What a sweep is predicted to take, as plain data: "combinations", "unknowns" (of each
    combination), "seconds" of the whole sweep, "processes" (workers), and "effects", the number of
    combinations by name of the effects that are on. Raises SceneError for a scene that makes no
    contact problem.
    """
    plans = [*plan_all(grid, progress).values()]
    seconds = [plan.price.solving_seconds - cost.START for plan in plans]
    on = Counter(name for plan in plans for name, effect in plan.effects.items() if effect.on)
    return {
        "combinations": len(plans),
        "unknowns": [plan.unknowns for plan in plans],
        "seconds": cost.START + max(sum(seconds) / workers, *seconds),
        "processes": workers,
        "effects": dict(on),
    }


def words(found: Mapping[str, Any]) -> list[str]:
    """Lines that say what `forecast` found."""
    count, sizes = found["combinations"], found["unknowns"]
    duration = timedelta(seconds=round(found["seconds"]))
    return [
        f"{count} combinations",
        f"predicted: {min(sizes)} to {max(sizes)} unknowns, {duration} on {found['processes']} "
        "cores",
        *(
            f"{name}: on in {'all' if number == count else number}"
            for name, number in found["effects"].items()
        ),
    ]
