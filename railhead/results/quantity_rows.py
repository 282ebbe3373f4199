"""Rows of the quantities of summary.json, as the terminal, report.html and result.csv show them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from railhead.postprocess.findings import NO_DEPTH
from railhead.run import quantities
from railhead.run.quantities import Quantity

Cell = float | str | None
Row = dict[str, Cell]
"""Cells by column: "quantity", "unit", "FE" and what stands beside it; None where there is none.
Where half-spaces are the answer, "FE" is "half-spaces"."""

ROUNDING = 1e-9  # of friction times load: a force below it is 0
FIRST = ("quantity", "unit")
ANSWERS = ("FE", "half-spaces")
RELATIVE = ("estimate", *(f"{name} - Hertz" for name in ANSWERS))
"""Columns of relative numbers."""


def reference_name(summary: Mapping[str, Any]) -> str:
    """Key in summary.json of the solution without yield or friction: "elastic", "frictionless", or
    empty where the result has neither effect.
    """
    return next((each for each in ("elastic", "frictionless") if each in summary), "")


def contact(summary: Mapping[str, Any]) -> list[Row]:
    """Rows of finite elements, error estimates, half-spaces and exact Hertz side by side; empty
    where nothing touches.
    """
    if summary["result"] is None:
        return []
    return [_named(summary, _compared(summary, each)) for each in quantities.rows("contact")]


def _named(summary: Mapping[str, Any], row: Row) -> Row:
    """A row in whose columns "FE" is the name of the method of the answer."""
    if summary.get("method", ANSWERS[0]) != ANSWERS[1]:
        return row
    beside = {key: value for key, value in row.items() if key != "half-space"}
    return {key.replace(*ANSWERS): value for key, value in beside.items()}


def _compared(summary: Mapping[str, Any], quantity: Quantity) -> Row:
    """Row of one quantity: cells of finite elements, estimate, half-spaces and Hertz by column."""
    depth = quantity.key.endswith("depth_mm")
    least = NO_DEPTH * summary["result"]["patch"]["a_mm"] if depth else 0.0
    fe, exact, half = (
        _cell(quantity.value(summary[key]), least) for key in ("result", "hertz", "half_space")
    )
    row: Row = {
        "quantity": quantity.label,
        "unit": quantity.unit,
        "FE": fe,
        "estimate": summary["accuracy"]["bound"].get(quantity.key),
        "half-space": half,
        "Hertz": exact,
        "FE - Hertz": _relative(fe, exact),
    }
    if name := reference_name(summary):
        row[f"{name} FE"] = _cell(quantity.value(summary[name]), least)
    return row


def friction(summary: Mapping[str, Any]) -> list[Row]:
    """Rows of forces of the wheel on the rail, motion and stick share, with columns of other
    methods.
    """
    found = (summary["result"] or {}).get("friction") or {}
    others = (summary.get("half_space_friction") or {}).items()
    bound = summary["accuracy"]["bound"] | _unresolved(found)
    still, limit = found.get("resolution", {}), ROUNDING * found.get("limit_N", 0.0)
    least = {"N": limit, "N mm": limit}  # of a moment over an arm of 1 mm
    rows: list[Row] = [
        {
            "quantity": each.label,
            "unit": each.unit,
            "FE": _cell(found[each.key], least.get(each.unit, 0.0)),
            "estimate": bound.get(each.key),
            "without creepage": _cell(still.get(each.key), least.get(each.unit, 0.0)),
            **{
                name: _cell(of.get(each.key), least.get(each.unit, 0.0))
                for name, of in others
                if "reason" not in of
            },
        }
        for each in quantities.rows("friction")
        if each.key in found
    ]
    return [_named(summary, row) for row in rows]


def steel(summary: Mapping[str, Any]) -> list[Row]:
    """Rows of the effects of pressure and tractions on the steel."""
    found = (summary["result"] or {}).get("friction") or {}
    unresolved = _unresolved(found)
    rows: list[Row] = [
        {
            "quantity": each.label,
            "unit": each.unit,
            "FE": _cell(found[each.key]),
            "estimate": unresolved.get(each.key),
        }
        for each in quantities.rows("steel")
        if each.key in found
    ]
    return [_named(summary, row) for row in rows]


def _unresolved(friction: Mapping[str, Any]) -> dict[str, Cell]:
    """The words "below resolution" by key of the quantities that are smaller than the resolution of
    the mesh.
    """
    return dict.fromkeys(friction.get("below_resolution", ()), "below resolution")


def everything(summary: Mapping[str, Any]) -> Iterator[Row]:
    """Rows of all tables, each with a unique name in "quantity", and the column "value" in the
    place of "FE"; then program and date.
    """
    load: list[Row] = [
        {"quantity": each.label, "unit": each.unit, "FE": _cell(each.value(summary["result"]))}
        for each in quantities.rows("load")
        if summary["result"] is not None
    ]
    above = ""
    for row in (*contact(summary), *load, *friction(summary), *steel(summary)):
        label = str(row["quantity"])
        name = f"{above}: {label.strip()}" if label.startswith(" ") else label
        above = above if label.startswith(" ") else label
        named: Row = {"value" if key in ANSWERS else key: value for key, value in row.items()}
        yield {**named, "quantity": name}
    yield {"quantity": "program", "value": f"railhead {summary['railhead']}"}
    yield {"quantity": "date", "value": summary["date"]}


def _cell(value: Any, least: float = 0.0) -> Cell:
    """A number or a word of a table; a number whose size is below `least` (rounding) becomes 0."""
    if value is None or isinstance(value, str):
        return value
    return float(value) if abs(value) > least else 0.0


def _relative(value: Cell, exact: Cell) -> float | None:
    """Relative deviation of two numbers; None for words, missing numbers and an exact 0."""
    if isinstance(value, str) or isinstance(exact, str) or value is None or not exact:
        return None
    return (value - exact) / exact
