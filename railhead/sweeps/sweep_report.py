"""report.html of a sweep: one file with all of it, for a reader who has nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from railhead.postprocess.findings import Units
from railhead.postprocess.pictures.sweep_plots import PANELS
from railhead.results import result_folder
from railhead.results.report import html
from railhead.scene.scene import Scene
from railhead.sweeps import sweep_table

NAME = "report.html"
SHORT = (sweep_table.CHECKS, *PANELS)  # columns of short tables, behind those of the values


def write(
    title: str,
    scenes: Sequence[Scene],
    columns: Sequence[str],
    rows: Sequence[Mapping[str, Any]],
    folder: Path,
    pictures: Sequence[str],
    units: Units,
) -> None:
    """Write the report of a sweep into its folder. Raises OSError where it cannot be written.

    columns: names of the columns of the values that change. rows: of sweep.csv, one for each scene.
    pictures: names of PNG files in the folder; those that are missing are left out. units: of the
        numbers.
    """
    drawn = (folder / name for name in pictures)
    first, *others = [list(html.scene_rows(scene, units)) for scene in scenes]
    text = html.template("sweep.html.j2").render(
        title=title,
        units=units,
        verdict=sweep_table.verdict(rows, units),
        passed=all(row[sweep_table.CHECKS] == sweep_table.PASSED for row in rows),
        pictures=[html.picture(path.read_bytes()) for path in drawn if path.exists()],
        columns=[*columns, *SHORT, sweep_table.WARNINGS],
        every=list(dict.fromkeys(name for row in rows for name in row)),
        rows=rows,
        cell=cell,
        asked={
            name: list(dict.fromkeys(cell(row, name, units) for row in rows)) for name in columns
        },
        same=[pair for pair in first if all(pair in other for other in others)],
        date=result_folder.now(),
        versions=html.versions(),
    )
    (folder / NAME).write_text(text, encoding="utf-8")


def cell(row: Mapping[str, Any], name: str, units: Units) -> str:
    """A cell of a row as text: a number in the reader's unit, with its relative estimate where it
    has one; of a path its name. Empty where the row has no value.
    """
    value, bound = row.get(name), row.get(f"{name.partition(' [')[0]} estimate")
    if isinstance(value, float):
        value = units.value(value, name) + 0.0
        return f"{value:g}" if bound is None else f"{value:.5g}\u00a0\u00b1\u00a0{bound:.2%}"
    text = "" if value is None else str(value)
    return Path(text).name if name.endswith(("profile", "stress_strain")) else text
