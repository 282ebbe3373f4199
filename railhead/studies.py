"""Studies: modules of `cases` with a line STUDY and a function `main(out, *, quick)`.

A study writes a CSV, a picture and a page into a folder that appears complete or not at all.
"""

from __future__ import annotations

import csv
import difflib
import importlib
import pkgutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

import cases
from railhead.scene import SceneError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

PAGE = "page.md"


class Study(Protocol):
    """What a study module provides; `quick` asks for a small part of it, `out` exists."""

    STUDY: str

    def main(self, out: Path, *, quick: bool) -> None:
        """Compute, and write <name>.csv, pictures and page.md into `out`."""


def shipped() -> dict[str, Study]:
    """The studies by the name of their module."""
    modules = {
        info.name: importlib.import_module(f"cases.{info.name}")
        for info in pkgutil.iter_modules(cases.__path__)
    }
    return {
        name: cast(Study, module) for name, module in modules.items() if hasattr(module, "STUDY")
    }


def canonical(name: str) -> str:
    """The name of a study's module from the name as typed; SceneError if there is none."""
    known, wanted = shipped(), name.replace("-", "_")
    if wanted in known:
        return wanted
    close = difflib.get_close_matches(wanted, known, n=1)
    hint = f"did you mean {close[0]}? " if close else ""
    raise SceneError("study", f"{name!r} is unknown; {hint}give one of {', '.join(known)}")


def run(name: str, folder: Path | None, *, quick: bool) -> tuple[Path, str]:
    """Run a study; returns its folder [results/<study>] and the text of its page.

    Raises SceneError for an unknown name, a folder that holds something else, or several ranks.
    """
    name = canonical(name)
    folder = folder if folder is not None else Path("results") / name

    from railhead import results

    results.check_folder(folder)

    from mpi4py import MPI

    if MPI.COMM_WORLD.size > 1:
        raise SceneError("study", f"{name} measures one process; start it without mpirun")
    with results.replacing(folder) as work:
        shipped()[name].main(work, quick=quick)
    return folder, (folder / PAGE).read_text(encoding="utf-8")


def write_csv(
    path: Path, records: Sequence[DataclassInstance], units: Mapping[str, str] | None = None
) -> None:
    """One line for each record, one column for each field, named <field>_<unit> where `units` has
    it; None is an empty cell."""
    rows = [asdict(record) for record in records]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow("_".join(filter(None, (key, (units or {}).get(key)))) for key in rows[0])
        writer.writerows(row.values() for row in rows)


def table(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A markdown table; the columns are padded, so that it reads well as plain text too."""
    lines = [list(header), *([str(cell) for cell in row] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    lines.insert(1, ["-" * width for width in widths])
    return "\n".join(
        "| " + " | ".join(map(str.ljust, line, widths)) + " |" for line in lines
    )  # fmt: skip


def percent(value: float | None) -> str:
    """A relative error with three digits; a dash where there is none."""
    return "-" if value is None else f"{100 * value:.3g} %"
