"""What studies write: CSV files, pages of markdown from templates, and trends of series of runs."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from numpy.typing import NDArray
from tabulate import tabulate

if TYPE_CHECKING:
    from _typeshed import DataclassInstance
    from matplotlib.axis import Axis


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
"""Columns of studies, and the quantities of `railhead.run.quantities` that they hold."""


def columns(result: Mapping[str, Any], names: Iterable[str]) -> dict[str, float]:
    """The named columns of a "result" of a summary, of its "hertz" or of its "difference"."""
    from railhead.run.quantities import numeric_values

    values = numeric_values(result)
    return {name: values[COLUMNS[name]] for name in names}


def write_csv(
    path: Path,
    records: Sequence[DataclassInstance] | Sequence[Mapping[str, Any]],
    units: Mapping[str, str] | None = None,
) -> None:
    """One line for each record, one column for each field, named <field>_<unit> where `units` has
    it; None is an empty cell."""
    rows = [dict(each) if isinstance(each, Mapping) else asdict(each) for each in records]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow("_".join(filter(None, (key, (units or {}).get(key)))) for key in rows[0])
        writer.writerows(row.values() for row in rows)


def table(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A markdown table that reads well as plain text too."""
    written = [[str(cell) for cell in row] for row in rows]
    return tabulate(written, list(header), tablefmt="github", disable_numparse=True)


def percent(value: float | None) -> str:
    """A relative error with three digits; a dash where there is none."""
    return "-" if value is None else f"{100 * value:.3g} %"


def render(name: str, /, **values: Any) -> str:
    """The text of templates/<name>.md.j2 with the values in their places, all of them given."""
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
    """(c, n) of y = c x^n by least squares of log y over log x; x and y positive, two or more.

    ValueError: fewer than two different x, or a value that is not positive.
    """
    if len(set(x)) < 2 or min(*x, *y) <= 0:
        raise ValueError(f"no power law through x = {list(x)}, y = {list(y)}")
    exponent, intercept = np.polyfit(np.log(x), np.log(y), 1)
    return float(np.exp(intercept)), float(exponent)


def pareto(cost: Sequence[float], error: Sequence[float]) -> NDArray[np.intp]:
    """Indices, by growing cost, of the points that no other point beats in cost and in error."""
    order = np.lexsort((error, cost))
    best = np.minimum.accumulate(np.asarray(error, dtype=float)[order])
    falls = np.concatenate([[True], np.diff(best) < 0])
    return np.asarray(order[falls])


def plain_ticks(axis: Axis, multiples: Sequence[float]) -> None:
    """Ticks of a logarithmic axis at these multiples of powers of ten, as plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=multiples))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
