"""The same scene with other values: every combination is solved, and makes a row of a table."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.planning import plan as planning
from railhead.results.result import Result
from railhead.run import estimates, refinement
from railhead.scene.scene import SceneError
from railhead.sweeps import grid, shared_mesh

if TYPE_CHECKING:
    from railhead.scene.scene import Scene


class Sweep(list[Result]):
    """Results, the last key changing fastest; keys: dotted, those that change."""

    def __init__(self, results: Iterable[Result], keys: Sequence[str]) -> None:
        super().__init__(results)
        self.keys = list(keys)

    def rows(self) -> list[dict[str, Any]]:
        """One a result: what changed, passed, unknowns, the quantities that carry an estimate (None
        where nothing touches), and their bounds (None where there is none)."""
        return [self._row(result) for result in self]

    def _row(self, result: Result) -> dict[str, Any]:
        summary = result.as_dict()
        scene = {key: result.plan.scene.value(key) for key in self.keys}
        found = estimates.flat(summary["result"] or {})
        told = {"passed": result.passed, "unknowns": summary["cost"]["dofs"]}
        values = {name: found.get(name) for name in estimates.QUANTITIES}
        bounds = {f"bound_{name}": summary["accuracy"]["bound"].get(name) for name in values}
        return scene | told | values | bounds

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as comma-separated values."""
        rows = self.rows()
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, rows[0] if rows else [])
            writer.writeheader()
            writer.writerows(rows)

    def to_dataframe(self) -> Any:
        """The rows as a pandas.DataFrame. Raises ImportError where pandas is not installed."""
        import pandas as pd  # type: ignore[import-untyped]

        return pd.DataFrame(self.rows())


def sweep(
    scene: Scene,
    over: Mapping[str, Sequence[object]] | None = None,
    /,
    *,
    quiet: bool = False,
    **values: Sequence[object],
) -> Sweep:
    """Solve a scene for every combination of values, by key: ``load=["25 kN", "50 kN"]``, those
    with a dot as a mapping: ``{"wheelset.shift": [0, 2]}``. Every scene is planned before the first
    is solved; those that differ in their load alone share a mesh. Raises SceneError, MeshError."""
    if not isinstance(over or {}, Mapping):
        raise SceneError("over", f"{over!r} is not a mapping of keys to lists of values; give one")
    for key in (over or {}).keys() & values.keys():
        raise SceneError(key, "is given twice; give one list of values")
    lists = {**(over or {}), **values}
    for key, chosen in lists.items():
        if not isinstance(key, str):
            raise SceneError("over", f"{key!r} is no key; give a word")
        if isinstance(chosen, str) or not isinstance(chosen, Iterable):
            raise SceneError(key, f"{chosen!r} is not a list of values; give one")
    scenes = grid.scenes(scene, lists)
    found: dict[int, Result] = {}
    with refinement.telling(quiet=quiet) as progress:
        for group in shared_mesh.groups([planning.make(each) for each in scenes]):
            shared = [scenes[index] for index in group]
            for number, result in shared_mesh.run(shared, range(len(group)), progress):
                if isinstance(result, Exception):
                    raise result
                found[group[number]] = result
                progress.stage(f"{len(found)} of {len(scenes)}")
    return Sweep([found[index] for index in range(len(scenes))], list(lists))
