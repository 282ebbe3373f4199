"""The same scene with other values: every combination is solved, and makes a row of a table."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from functools import reduce
from itertools import product
from operator import getitem
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead import estimates, refine
from railhead.result import Result
from railhead.scene.scene import SceneError, checked

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
        given = result.plan.scene.model_dump()
        scene = {key: reduce(getitem, key.split("."), given) for key in self.keys}
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
    with a dot as a mapping: ``{"wheelset.shift": [0, 2]}``. Every scene is checked before the first
    is solved. Raises SceneError, MeshError."""
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
    scenes = [
        checked(scene).replace(**dict(zip(lists, chosen, strict=True)))
        for chosen in product(*lists.values())
    ]
    results = Sweep([], list(lists))
    with refine.telling(quiet=quiet) as progress:
        for number, each in enumerate(scenes, 1):
            progress.stage(f"{number} of {len(scenes)}")
            results.append(refine.run(each, progress))
    return results
