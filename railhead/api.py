"""What a script calls: find a shipped scene, plan it, solve it."""

from __future__ import annotations

import io
from dataclasses import dataclass

from rich.console import Console

from railhead import refine
from railhead.catalogue import find
from railhead.planning import plan as planning
from railhead.planning.plan import Plan
from railhead.progress import Progress
from railhead.result import Result
from railhead.scene.scene import Scene, checked

__all__ = ["Planned", "Result", "find", "plan", "solve"]
WIDTH = 120  # characters of a printed plan


@dataclass(frozen=True)
class Planned:
    """The decisions for a scene; prints as the table of `railhead plan`."""

    plan: Plan

    def __str__(self) -> str:
        console = Console(file=io.StringIO(), width=WIDTH, record=True)
        self._show(console)
        return console.export_text()

    def _repr_html_(self) -> str:
        console = Console(file=io.StringIO(), width=WIDTH, record=True)
        self._show(console)
        return console.export_html(inline_styles=True)

    def _show(self, console: Console) -> None:
        from railhead import report

        report.show_plan(self.plan, console)


def plan(scene: Scene) -> Planned:
    """What would be simulated and what it costs; solves nothing. Raises SceneError."""
    return Planned(planning.make(checked(scene)))


def solve(scene: Scene, *, accuracy: str | float | None = None, quiet: bool = False) -> Result:
    """Solve a scene; accuracy: asked relative error, e.g. "1%". What it does goes to standard error
    unless quiet. Raises SceneError for a scene that makes no contact problem, MeshError."""
    scene = checked(scene)
    if accuracy is not None:
        scene = scene.replace(accuracy=accuracy)
    with Progress(quiet=quiet) as progress:
        return refine.run(scene, progress)
