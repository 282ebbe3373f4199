"""What a command computes from geometry alone, and its files."""

from abc import abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar

from rich.console import Console

from railhead.postprocess.findings import BASE_UNITS, Units
from railhead.results import result_folder
from railhead.results.report import terminal
from railhead.scene.catalogue import as_path
from railhead.scene.scene import Scene


class Examined(terminal.Drawn):
    """Base class of what a command computes from geometry alone.

    scene: whose geometry it is.
    command: its word, 'locate' or 'profile'.
    summary: returns the content of summary.json.
    tables: returns rows of tables, cells by column header, by name of their file.
    """

    scene: Scene
    command: ClassVar[str]
    summary: Callable[[], dict[str, Any]]
    tables: Callable[[], dict[str, list[dict[str, Any]]]]

    @staticmethod
    @abstractmethod
    def shown(summary: Mapping[str, Any], console: Console, units: Units) -> None:
        """Print the content of summary.json on a console. units: of the numbers."""

    def show(self, console: Console, units: Units = BASE_UNITS) -> None:
        """Print what was computed on a console. units: of the numbers."""
        self.shown(self.summary(), console, units)

    def save(
        self,
        folder: str | Path,
        *,
        pictures: bool = True,
        units: Units | None = None,
        force: bool | None = False,
    ) -> None:
        """Write the files of the command into a folder: summary, tables and pictures.

        pictures: whether PNG files are written.
        units: of pictures; None: mm.
        force: whether another result is replaced; None: it is renamed, as of `Result.save`.
        Raises SceneError for a folder with other files and, without `force`, with another result;
        OSError where it cannot be written.
        """
        folder, scene = as_path(folder, "folder"), self.scene
        result_folder.check_free(folder, self.command, scene, force=force is not False)
        summary, tables = self.summary(), self.tables()
        drawings = self.drawings(units or BASE_UNITS) if pictures else {}
        begun = result_folder.result(folder, self.command, scene, summary, aside=force is None)
        with begun as (work, keep):
            for name, rows in tables.items():
                (work / name).write_bytes(result_folder.encoded(result_folder.signed(rows)))
            result_folder.draw(drawings, work, keep)
