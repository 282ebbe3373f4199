"""What studies share: solving in silence, columns of runs and their trends, CSV files, and pages of
markdown from templates."""

import csv
import os
import re
import statistics
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from matplotlib.axes import Axes
from mpi4py import MPI
from tabulate import tabulate

from railhead.cli.study import PAGE
from railhead.planning.simulation_plan import Plan
from railhead.run.mesh_solution import MeshSolution, mesh_and_solve
from railhead.run.progress import Progress
from railhead.scene.quantities import QUANTITIES

T = TypeVar("T")
Row = dict[str, Any]
"""One run, scene or mesh of a study, by the columns of its CSV (without units)."""
COLUMNS = {
    "a": "a_mm",
    "b": "b_mm",
    "p_max": "max_MPa",
    "area": "area_mm2",
    "approach": "approach_mm",
    "tau_max": "tau_max_MPa",
    "tau_max_depth": "tau_max_depth_mm",
    "von_mises_max": "von_mises_max_MPa",
}
"""Columns of studies, and the quantities of `railhead.scene.quantities` that they hold."""

WIDTH = 120
"""Characters of a line of prose on a page."""


def columns(result: Mapping[str, Any], names: Iterable[str]) -> dict[str, float]:
    """Values by the names of columns (`COLUMNS`); result: "result", "hertz" or "difference" of a
    summary."""
    values = {
        each.key: float(each.value(result))
        for each in QUANTITIES
        if each.column and each.key in COLUMNS.values() and each.value(result) is not None
    }
    return {name: values[COLUMNS[name]] for name in names}


def publish(
    out: Path, page: str, units: Mapping[str, str] | None = None, **csvs: Sequence[Row]
) -> None:
    """Write the page of a study and its CSV files into its folder.

    csvs: rows by the name of the file, one column for each key of the first row; None is an empty
        cell. Without rows no file is written.
    units: unit by key; the column is named <key>_<unit>.
    """
    for name, rows in csvs.items():
        if rows:
            with (out / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
                header = ["_".join(filter(None, (k, (units or {}).get(k)))) for k in rows[0]]
                writer = csv.writer(file, lineterminator="\n")
                writer.writerows([header, *(row.values() for row in rows)])
    (out / PAGE).write_text(wrapped(page), encoding="utf-8")


def beside_errors(records: Sequence[Row], holds: Sequence[bool]) -> tuple[int | str, ...]:
    """Cells of a page for estimates beside errors (relative): how many, the share that holds, the
    largest error over its estimate, the median of estimates over their errors, the largest error.
    """
    over = [each["error"] / max(each["estimate"], 1e-12) for each in records]
    return (
        len(records),
        f"{sum(holds) / len(records):.1%}",
        f"{max(over):.2f}",
        f"{statistics.median(1 / max(each, 1e-9) for each in over):.1f}",
        f"{max(each['error'] for each in records):.2g}",
    )


def wrapped(page: str) -> str:
    """The page with its prose broken at `WIDTH` characters, the lines of an item of a list indented
    below its first one; code, tables, headings and paragraphs without a longer line stay as is.
    """
    parts = re.split(r"(^```.*?^```$)", page, flags=re.DOTALL | re.MULTILINE)
    for number, prose in [*enumerate(parts)][::2]:
        blocks = re.split(r"(\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) ))", prose)
        parts[number] = "".join(map(_broken, blocks))
    return "".join(parts)


def _broken(block: str) -> str:
    """One paragraph or item of a list, broken at `WIDTH` characters; no new line begins as an item
    or a heading does.
    """
    text = block.lstrip("\n")
    if max(map(len, text.split("\n"))) <= WIDTH or re.match(r"\||#|!\[|    |<", text):
        return block
    first = re.match(r"\s*(?:(?:[-*]|\d+\.) +)?", text)
    assert first is not None
    start, rest = first[0], text[first.end() :]
    ending = rest[len(rest.rstrip()) :]
    words = re.sub(r" (?=(?:[-*+#>|=]|\d+[.)])(?: |$))", "\0", " ".join(rest.split()))
    told = textwrap.fill(
        words,
        WIDTH,
        initial_indent=start,
        subsequent_indent=" " * len(start),
        break_long_words=False,
        break_on_hyphens=False,
    )
    return block[: len(block) - len(text)] + told.replace("\0", " ") + ending


def groups(rows: Iterable[Row], *keys: str) -> dict[Any, list[Row]]:
    """Rows by the value of a key, or by the tuple of the values of several."""
    found: dict[Any, list[Row]] = {}
    for row in rows:
        found.setdefault(tuple(row[k] for k in keys) if keys[1:] else row[keys[0]], []).append(row)
    return found


def cells(rows: Iterable[Row], *formats: str) -> list[list[str]]:
    """The cells of a table: for each row its values, put into each of the format strings."""
    return [[each.format_map(row) for each in formats] for row in rows]


def table(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A markdown table that reads well as plain text too."""
    written = [[str(cell) for cell in row] for row in rows]
    return tabulate(written, list(header), tablefmt="github", disable_numparse=True)


def percent(value: float | None) -> str:
    """A relative error with three digits; a dash where there is none."""
    return "-" if value is None else f"{100 * value:.3g} %"


def render(name: str, /, **values: Any) -> str:
    """The text of templates/<name>.md.j2 with the values in their places. Raises
    jinja2.UndefinedError where the template needs a value that is not given.
    """
    pages = Environment(
        loader=PackageLoader("studies"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    pages.filters |= {"table": table, "percent": percent}
    return pages.get_template(f"{name}.md.j2").render(values)


def power_law(x: Sequence[float], y: Sequence[float]) -> tuple[float, float]:
    """(c, n) of y = c x^n by least squares of log y over log x. Raises ValueError for fewer than
    two different x, or a value that is not positive.
    """
    if len(set(x)) < 2 or min(*x, *y) <= 0:
        raise ValueError(f"no power law through x = {list(x)}, y = {list(y)}")
    exponent, intercept = np.polyfit(np.log(x), np.log(y), 1)
    return float(np.exp(intercept)), float(exponent)


def front(rows: Sequence[Row]) -> list[Row]:
    """The rows that no other row beats in both seconds and error, by growing seconds."""
    found: list[Row] = []
    for row in sorted(rows, key=lambda each: (each["seconds"], each["error"])):
        if not found or row["error"] < found[-1]["error"]:
            found.append(row)
    return found


def factor_ten(rows: Sequence[Row]) -> float:
    """The factor in seconds for a tenth of the error, by the power law through the rows."""
    return float(10 ** -power_law([r["error"] for r in rows], [r["seconds"] for r in rows])[1])


def timed(work: Callable[..., T], *arguments: Any) -> tuple[T, float]:
    """Value of a function, and its processor seconds in this process and its children that end."""
    start = sum(os.times()[:4])
    return work(*arguments), sum(os.times()[:4]) - start


def told(items: Iterable[T], text: Callable[[T], str]) -> Iterator[T]:
    """The items, each with its text on standard error before its turn."""
    for item in items:
        print(text(item), file=sys.stderr)
        yield item


def solved(plan: Plan) -> MeshSolution:
    """Solution of a plan on its one mesh; no progress is shown. Raises MeshError where gmsh cannot
    mesh the bodies.
    """
    return mesh_and_solve(plan, Progress(quiet=True), MPI.COMM_WORLD)


def plain_ticks(axis: Any, multiples: Sequence[float]) -> None:
    """Set the ticks of a logarithmic axis to these multiples of powers of ten, as plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=multiples))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def log_axes(axes: Axes, *multiples: Sequence[float], **labels: str) -> None:
    """Make both axes logarithmic, with labels and plain ticks. multiples: of powers of ten, along x
    and along y; as many as fit where none are given."""
    axes.set(xscale="log", yscale="log", **labels)
    for axis, given in zip((axes.xaxis, axes.yaxis), multiples or ((), ()), strict=True):
        low, high = axis.get_view_interval()
        plain_ticks(axis, given or ((1, 2, 5) if high > 10 * low else (1, 1.5, 2, 3, 4, 6, 8)))
