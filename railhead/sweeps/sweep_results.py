"""A sweep as a list of results and a table: solved (`railhead.sweep`), or read from its folder."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpi4py import MPI
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from railhead.postprocess.findings import BASE_UNITS, Subject, Units
from railhead.results import result_folder
from railhead.results.report import terminal
from railhead.results.result import Result
from railhead.run.progress import Tell
from railhead.scene.catalogue import as_path
from railhead.scene.scene import Scene, SceneError, warn_of_units
from railhead.sweeps import parallel, store, sweep_table
from railhead.sweeps.grid import ParameterGrid, column

if TYPE_CHECKING:
    from railhead.postprocess.pictures.diagrams import Drawing

Row = dict[str, Any]


class Sweep(terminal.Drawn, list[Result]):
    """List of the results of all combinations that were solved, the last key changing fastest. A
    combination without a result is missing in the list, but has a row, so positions need not be
    numbers of combinations.

    keys: dotted keys that are set, in order.
    """

    def __init__(self, folder: Path, solved: Mapping[int, Result] | None = None) -> None:
        """folder: of the sweep. solved: results by number of the combination, in the place of those
        of the records, which have numbers only; None: none. Nothing is solved. Raises SceneError
        for a broken file, and for records of another sweep.
        """
        records = store.records(folder)
        found = {
            number: Result(None, record["summary"])
            for number, (record, _) in records.items()
            if not record["fault"]
        }
        super().__init__((found | dict(solved or {})).values())
        self._name, self.keys = store.request(folder)
        self._rows = [row for _, row in records.values()]
        if any(column(key) not in row for key in self.keys for row in self._rows):
            raise SceneError("load", f"{str(folder)!r} holds records of another sweep")
        self._outlines = [each.get("outlines", []) for each, _ in records.values()]

    def show(self, console: Console, units: Units | None = None) -> None:
        """Print a row for each combination, and what they say together, on a console. units: of the
        numbers; None: mm, N, MPa.
        """
        units = units or BASE_UNITS
        names = [*map(column, self.keys), *sweep_table.short(self._rows)]
        table = Table(box=box.SIMPLE)
        for name in names:
            table.add_column(Text(units.unit(name)), overflow="fold")
        for row in self._rows:
            table.add_row(*(Text(sweep_table.cell(row, name, units)) for name in names))
        console.print(table)
        for line in sweep_table.verdict(self._rows, units):
            console.print(line, markup=False, highlight=False)

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Functions that draw the pictures, by name of their PNG file. units: of their numbers."""
        from railhead.postprocess.pictures import sweep_plots as plots

        columns = [column(key) for key in self.keys]
        title = f"sweep of {self._name} over {' and '.join(self.keys)}"
        subject = Subject(title, units=units)
        return plots.drawings(columns, self._rows, self._outlines, "y, mm", subject)

    def as_dict(self) -> dict[str, Any]:
        """The rows as plain data."""
        return {"rows": self._rows}

    def rows(self) -> list[Row]:
        """The table of `railhead sweep`: a row for each combination that has a record, in their
        order, cells by column header (docs/sweeps.md). A combination that could not be solved has
        the reason in "checks".
        """
        return self._rows

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as comma-separated values, in UTF-8 with a byte order mark. Raises
        SceneError for what is no path, OSError where it cannot be written.
        """
        as_path(path, "path").write_bytes(result_folder.encoded(self.rows()))

    def to_dataframe(self) -> Any:
        """The rows as a pandas.DataFrame. Raises ImportError where pandas is not installed."""
        import pandas as pd  # type: ignore[import-untyped]

        return pd.DataFrame(self.rows())


def sweep(
    scene: Scene,
    over: Mapping[str, Sequence[object]] | None = None,
    /,
    *,
    out: str | Path | None = None,
    quiet: bool = False,
    progress: Tell | None = None,
    **values: Sequence[object],
) -> Sweep:
    """Solve a scene for every combination of values, a process a core, as `railhead sweep`.

    over: lists of values by key, for keys with a dot: ``{"wheelset.shift": [0, 2]}``.
    out: folder for the files of `railhead sweep`, which a repeated call goes on with; None: no
        files.
    quiet: whether no progress is shown on standard error.
    progress: as of `railhead.solve`, e.g. (8.1, "3 of 50 done, 0:02:10 left").
    values: lists of values by key: ``load=["25 kN", "50 kN"]``.
    Results that this call solved have arrays, but no dolfinx mesh; those that were in the folder
    have numbers. Under MPI, call this on all ranks. Raises SceneError for a wrong scene or folder,
    before any scene is solved, OSError where files cannot be written, after the others are. A
    combination that cannot be meshed or does not fit into the memory has the reason in its row.
    """
    grid = ParameterGrid.combine(scene, _lists(over, values))
    warn_of_units(*grid.scenes)
    comm = MPI.COMM_WORLD
    with tempfile.TemporaryDirectory() as temporary:
        folder = as_path(comm.bcast(temporary) if out is None else out, "out")
        result_folder.check_folder(folder)
        task = parallel.ParallelSweep(grid=grid, folder=folder, keep_results=True)
        outcome = parallel.run(task, pictures=out is not None, quiet=quiet, tell=progress)
        found = comm.bcast(outcome and Sweep(folder, outcome.results))
    if outcome and outcome.failures:
        raise OSError("\n".join(outcome.failures))
    return found


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
