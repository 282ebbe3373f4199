"""What a script calls, and the command too: find a shipped scene, plan it, solve it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from railhead.planning import plan as planning
from railhead.planning.plan import Plan
from railhead.results.report import terminal
from railhead.scene.catalogue import find
from railhead.scene.scene import Scene, checked

if TYPE_CHECKING:
    from rich.console import Console

    from railhead.results.result import Result

__all__ = ["Planned", "find", "plan", "solve"]


@dataclass(frozen=True)
class Planned:
    """The decisions for a scene; prints as the table of `railhead plan`."""

    plan: Plan

    def __str__(self) -> str:
        return terminal.text(self.show)

    def _repr_html_(self) -> str:
        return terminal.html(self.show)

    def as_dict(self) -> dict[str, Any]:
        """ "plan" of summary.json."""
        return self.plan.summary()

    def show(self, console: Console) -> None:
        """Print the table."""
        from railhead.results.report import tables

        tables.show_plan(self.plan, console)


def plan(
    scene: Scene,
    *,
    accuracy: str | float | None = None,
    budget: str | float | None = None,
    quiet: bool = False,
) -> Planned:
    """What would be simulated and what it costs; solves no finite elements.

    accuracy, budget: as for `solve`. quiet: has no effect. Raises SceneError.
    """
    return Planned(planning.make(with_accuracy(scene, accuracy, budget)))


def solve(
    scene: Scene,
    *,
    accuracy: str | float | None = None,
    budget: str | float | None = None,
    quiet: bool = False,
) -> Result:
    """Solve a scene. accuracy: asked relative error, e.g. "1%"; budget: best accuracy for that
    time, e.g. "30 s". What it does goes to standard error (of rank 0) unless quiet. Raises
    SceneError for a scene that makes no contact problem, MeshError."""
    from railhead.results import pipeline
    from railhead.run import refinement

    scene = with_accuracy(scene, accuracy, budget)
    with refinement.telling(quiet=quiet) as progress:
        return pipeline.run(scene, progress)


def with_accuracy(scene: Scene, accuracy: str | float | None, budget: str | float | None) -> Scene:
    """The scene with an accuracy and a budget. Raises SceneError."""
    ways = {"accuracy": accuracy, "budget": budget}
    given = {key: value for key, value in ways.items() if value is not None}
    scene = checked(scene)
    return scene.replace(**given) if given else scene
