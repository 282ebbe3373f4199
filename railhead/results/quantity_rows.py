"""Rows of the quantities of summary.json, as the terminal, report.html and result.csv show them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from railhead.postprocess.findings import NO_DEPTH
from railhead.run import quantities
from railhead.run.quantities import Quantity

Cell = float | str | None
Row = dict[str, Cell]
"""Cells by column: "quantity", "unit", "FE" and what stands beside it; None where there is none."""

FIRST = ("quantity", "unit")
RELATIVE = ("estimate", "FE - Hertz")
"""Columns of relative numbers."""


def reference_name(summary: Mapping[str, Any]) -> str:
    """Key of the solution without yield or friction: "elastic", "frictionless", or empty where the
    result itself has neither."""
    return next((each for each in ("elastic", "frictionless") if each in summary), "")


def contact(summary: Mapping[str, Any]) -> list[Row]:
    """Finite elements, estimates, half-spaces and exact Hertz side by side; no rows where nothing
    touches."""
    if summary["result"] is None:
        return []
    return [_compared(summary, each) for each in quantities.rows("contact")]


def _compared(summary: Mapping[str, Any], quantity: Quantity) -> Row:
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
    """Forces of the wheel on the rail, its motion and stick, beside other methods."""
    found = (summary["result"] or {}).get("friction") or {}
    others = (summary.get("half_space_friction") or {}).items()
    bound = summary["accuracy"]["bound"] | _unresolved(found)
    still = found.get("resolution", {})
    return [
        {
            "quantity": each.label,
            "unit": each.unit,
            "FE": _cell(found[each.key]),
            "estimate": bound.get(each.key),
            "without creepage": _cell(still.get(each.key)),
            **{name: _cell(of.get(each.key)) for name, of in others if "reason" not in of},
        }
        for each in quantities.rows("friction")
        if each.key in found
    ]


def steel(summary: Mapping[str, Any]) -> list[Row]:
    """What pressure and tractions do to the steel."""
    found = (summary["result"] or {}).get("friction") or {}
    unresolved = _unresolved(found)
    return [
        {
            "quantity": each.label,
            "unit": each.unit,
            "FE": _cell(found[each.key]),
            "estimate": unresolved.get(each.key),
        }
        for each in quantities.rows("steel")
        if each.key in found
    ]


def _unresolved(friction: Mapping[str, Any]) -> dict[str, Cell]:
    """The words in the place of an estimate, by the key of a quantity below its resolution."""
    return dict.fromkeys(friction.get("below_resolution", ()), "below resolution")


def everything(summary: Mapping[str, Any]) -> Iterator[Row]:
    """All rows, each with a name of its own, and "value" for "FE"."""
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
        named: Row = {"value" if key == "FE" else key: value for key, value in row.items()}
        yield {**named, "quantity": name}


def _cell(value: Any, least: float = 0.0) -> Cell:
    """A number or word; 0 for a positive number below the least that is none of rounding."""
    if value is None or isinstance(value, str):
        return value
    return float(value) if not 0 < value < least else 0.0


def _relative(value: Cell, exact: Cell) -> float | None:
    if isinstance(value, str) or isinstance(exact, str) or value is None or not exact:
        return None
    return (value - exact) / exact
