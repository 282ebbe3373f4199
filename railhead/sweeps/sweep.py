"""`railhead.sweep`: all combinations solved in this process, as a list of results and a table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.results import table_file
from railhead.results.result import Result
from railhead.run import quantities, refinement
from railhead.scene.scene import SceneError
from railhead.sweeps import runner
from railhead.sweeps.grid import ParameterGrid

if TYPE_CHECKING:
    from railhead.scene.scene import Scene


class Sweep(list[Result]):
    """List of the results of all combinations, the last key changing fastest.

    keys: dotted keys whose values change.
    """

    def __init__(self, results: Iterable[Result], keys: Sequence[str]) -> None:
        """results: in the order of combinations; keys: dotted keys whose values change."""
        super().__init__(results)
        self.keys = list(keys)

    def rows(self) -> list[dict[str, Any]]:
        """A table with a row for each result, cells by column name.

        Columns: the changed values by key; `passed`; `unknowns`; the quantities with an error
            estimate by their names in summary.json (None where nothing touches); `bound_<name>`,
            their relative error bounds (None where there is none).
        """
        return [self._row(result) for result in self]

    def _row(self, result: Result) -> dict[str, Any]:
        """The row of one result, cells by column name."""
        summary = result.as_dict()
        changed = {key: result.plan.scene.value(key) for key in self.keys}
        verdict = {"passed": result.passed, "unknowns": summary["cost"]["dofs"]}
        known = quantities.numeric_values(summary["result"])
        values = {name: known.get(name) for name in quantities.ESTIMATED}
        bounds = {f"bound_{name}": summary["accuracy"]["bound"].get(name) for name in values}
        return changed | verdict | values | bounds

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as comma-separated values, in UTF-8 with a byte order mark."""
        Path(path).write_bytes(table_file.encoded(self.rows()))

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
    """Solve a scene for every combination of values.

    over: lists of values by key, for keys with a dot: ``{"wheelset.shift": [0, 2]}``.
    quiet: whether no progress is shown on standard error.
    values: lists of values by key: ``load=["25 kN", "50 kN"]``.
    All scenes are planned before the first is solved; those that differ in their load alone share a
    mesh. Raises SceneError for a wrong scene, MeshError where gmsh fails.
    """
    grid = ParameterGrid.combine(scene, _lists(over, values))
    results: dict[int, Result] = {}
    with refinement.show_progress(quiet=quiet) as progress:
        for group in runner.group_by_mesh(runner.plan_all(grid, progress)):
            scenes = {number: grid.scenes[number] for number in group}
            for number, result in runner.solve_group(scenes, group, progress):
                if isinstance(result, Exception):
                    raise result
                results[number] = result
                progress.jobs(len(results), len(grid.scenes))
    return Sweep([results[number] for number in sorted(results)], grid.keys)


def _lists(
    over: Mapping[str, Sequence[object]] | None, values: Mapping[str, Sequence[object]]
) -> dict[str, Sequence[object]]:
    """Lists of values by key from a mapping and from keyword arguments. Raises SceneError for
    anything that is no mapping of keys to lists, and for a key in both.
    """
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
    return {key: list(chosen) for key, chosen in lists.items()}
