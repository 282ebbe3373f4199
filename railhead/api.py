"""The functions of a script: find a shipped scene, plan it, solve it, load a result."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.planning import simulation_plan as planning
from railhead.planning.simulation_plan import Plan
from railhead.results.report import terminal
from railhead.scene.bodies import steels
from railhead.scene.catalogue import as_path, find
from railhead.scene.scene import Scene, SceneError, checked, warn_of_units

if TYPE_CHECKING:
    from rich.console import Console

    from railhead.results.result import Result
    from railhead.run.progress import Tell
    from railhead.sweeps.sweep_table import Sweep

__all__ = ["Planned", "find", "load", "plan", "solve", "steels"]


@dataclass(frozen=True)
class Planned(terminal.Printed):
    """The plan of a scene: effects, mesh and cost. Prints as the table of `railhead plan`.

    plan: the decisions with their reasons.
    """

    plan: Plan

    def __str__(self) -> str:
        """The table of the plan as text."""
        return terminal.recorded(self.show).export_text()

    def as_dict(self) -> dict[str, Any]:
        """The plan as plain data: the table "plan" of summary.json."""
        return self.plan.summary()

    def show(self, console: Console) -> None:
        """Print the plan as a table on a console of rich."""
        terminal.show_plan(self.plan, console)


def plan(
    scene: Scene,
    *,
    accuracy: str | float | None = None,
    budget: str | float | None = None,
    quiet: bool = False,
) -> Planned:
    """Plan a scene: what would be simulated and its cost. No mesh is made and no finite elements
    are solved; boundary elements may be.

    accuracy: largest relative error of the results, e.g. 0.01 or "1%"; None keeps the scene's.
    budget: computing time for the best accuracy, s or e.g. "30 s"; None keeps the scene's.
    quiet: no effect.
    Raises SceneError for what is no scene, a wrong accuracy or budget, and a scene that makes no
    contact problem. So it does for an effect that cannot be chosen, an accuracy out of reach, and
    bodies that cannot be built.
    """
    scene = with_accuracy(scene, accuracy, budget)
    warn_of_units(scene)
    return Planned(planning.make(scene))


def solve(
    scene: Scene,
    *,
    accuracy: str | float | None = None,
    budget: str | float | None = None,
    quiet: bool = False,
    progress: Tell | None = None,
) -> Result:
    """Solve a scene by finite elements, or by half-spaces where effects.finite_bodies is off, and
    return the result. Under MPI, call this on all ranks. Nothing is written.

    accuracy: largest relative error of the results, e.g. 0.01 or "1%", None keeps the scene's;
        meshes are refined until the error estimates meet it.
    budget: computing time for the best accuracy, s or e.g. "30 s", None keeps the scene's. With
        neither, one mesh is solved.
    quiet: whether no progress is shown on standard error.
    progress: function that is called in the place of showing progress, on rank 0, with the seconds
        since the start and what is done now, e.g. (1.3, "solving 9000 unknowns"). What it raises
        ends the call.
    Raises SceneError for all that `plan` refuses, and for a mesh too large for the memory or for
    friction. MeshError: gmsh fails. A result that fails a check is returned, too: see
    `Result.passed`.
    """
    from railhead.results import pipeline
    from railhead.run.progress import show_progress

    scene = with_accuracy(scene, accuracy, budget)
    warn_of_units(scene)
    with show_progress(quiet=quiet, tell=progress) as shown:
        return pipeline.run(scene, shown)


def load(folder: str | Path) -> Result | Sweep:
    """The result in a folder that `railhead run` or `Result.save` wrote: its numbers, checks and
    tables, without fields; infinite numbers in `summary` are the words "inf" and "-inf". In that of
    a sweep, finished or not, a `Sweep` of such results. An exchange of folders that was killed is
    finished first. Raises SceneError for a folder without one, and for what is no path.
    """
    from railhead.results import result_folder
    from railhead.results.result import Result
    from railhead.sweeps import store
    from railhead.sweeps.sweep_table import Sweep

    folder = as_path(folder, "folder")
    with suppress(OSError, ValueError, RuntimeError):  # a name too long, a loop of links
        result_folder.settle(folder.resolve())
    with reading(folder, "result of a run or a sweep"):
        if (folder / store.REQUEST).is_file():
            return Sweep(folder)
        found = Result(None, result_folder.from_json(folder / "summary.json"))
        terminal.recorded(found.show)  # reads every number once: what is broken shows here
        return found


@contextmanager
def reading(folder: Path, what: str) -> Iterator[None]:
    """A block that reads a folder. Raises SceneError where that fails. what: it should hold."""
    try:
        yield
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        if isinstance(error, SceneError):
            raise
        text = f"{str(folder)!r} holds no {what}, or a broken one; give its folder"
        raise SceneError("load", text) from None


def with_accuracy(scene: Scene, accuracy: str | float | None, budget: str | float | None) -> Scene:
    """The scene with the keys `accuracy` and `budget` set to those arguments that are not None.
    Raises SceneError for a wrong value and for an argument that is no Scene.
    """
    keys = {"accuracy": accuracy, "budget": budget}
    values = {key: value for key, value in keys.items() if value is not None}
    scene = checked(scene)
    return scene.replace(**values) if values else scene
