"""`railhead.sweep`: all combinations solved in this process, as a list of results and a table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhead.results import table_file
from railhead.results.result import Result
from railhead.run import refinement
from railhead.scene.scene import SceneError
from railhead.sweeps import runner, sweep_table
from railhead.sweeps.grid import ParameterGrid

if TYPE_CHECKING:
    from railhead.scene.scene import Scene

Outcome = Result | Exception


class Sweep(list[Result]):
    """List of the results of all combinations that were solved, the last key changing fastest.

    keys: dotted keys whose values change.
    """

    def __init__(self, outcomes: Sequence[Outcome], grid: ParameterGrid) -> None:
        """outcomes: result or error of each scene of the grid."""
        super().__init__(each for each in outcomes if isinstance(each, Result))
        self.keys = list(grid.keys)
        self._rows = [
            sweep_table.row(grid.values(number), sweep_table.record(outcome))
            for number, outcome in enumerate(outcomes)
        ]

    def rows(self) -> list[dict[str, Any]]:
        """The table of `railhead sweep`: a row for each combination, cells by column header
        (docs/sweeps.md). A combination that could not be solved has the reason in "checks".
        """
        return self._rows

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
    mesh. Raises SceneError for a wrong scene, before any is solved.
    """
    grid = ParameterGrid.combine(scene, _lists(over, values))
    outcomes: dict[int, Outcome] = {}
    with refinement.show_progress(quiet=quiet) as progress:
        for group in runner.group_by_mesh(runner.plan_all(grid, progress)):
            scenes = {number: grid.scenes[number] for number in group}
            for number, outcome in runner.solve_group(scenes, group, progress):
                outcomes[number] = outcome
                progress.jobs(len(outcomes), len(grid.scenes))
    return Sweep([outcomes[number] for number in sorted(outcomes)], grid)


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
