"""The quantities of summary.json, a row each: what the terminal's tables and result.csv show."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from railhead.postprocess.findings import NO_DEPTH

Cell = float | str | None
Row = dict[str, Cell]
"""Cells by column: "quantity", "unit", "FE" and what stands beside it; None where there is none."""

FIRST = ("quantity", "unit")
RELATIVE = ("estimate", "FE - Hertz")
"""Columns of relative numbers."""
ROWS = (
    ("semi-axis a, along rail", "mm", ("patch", "a_mm")),
    ("semi-axis b, across", "mm", ("patch", "b_mm")),
    ("patch area", "mm2", ("patch", "area_mm2")),
    ("largest pressure", "MPa", ("pressure", "max_MPa")),
    ("mean pressure", "MPa", ("pressure", "mean_MPa")),
    ("approach", "mm", ("approach_mm",)),
    ("largest shear stress", "MPa", ("stress", "tau_max_MPa")),
    ("   its depth", "mm", ("stress", "tau_max_depth_mm")),
    ("   its body", "", ("stress", "tau_max_body")),
    ("largest von Mises stress", "MPa", ("stress", "von_mises_max_MPa")),
    ("   its depth", "mm", ("stress", "von_mises_max_depth_mm")),
    ("   its body", "", ("stress", "von_mises_max_body")),
)
FRICTION = (
    ("force along the rail", "N", "force_along_N"),
    ("force across", "N", "force_across_N"),
    ("moment about the normal", "N mm", "moment_Nmm"),
    ("creepage along", "", "creepage_along"),
    ("creepage across", "", "creepage_across"),
    ("spin", "1/mm", "spin_per_mm"),
    ("axle", "", "axle"),
    ("shift along", "mm", "shift_along_mm"),
    ("shift across", "mm", "shift_across_mm"),
    ("share of the patch that sticks", "", "stick_share"),
    ("largest traction", "MPa", "traction_max_MPa"),
    ("T-gamma: energy per rolled length", "N", "t_gamma_N"),
    ("power", "W", "power_W"),
    ("energy per cycle", "N mm", "energy_per_cycle_Nmm"),
)
STEEL = (
    ("T-gamma without spin, worst patch", "N", "wear_number_N"),
    ("T-gamma over the area", "N/mm2", "t_gamma_over_area_MPa"),
    ("   wear by it (R8T on 900A)", "", "wear_regime"),
    ("where von Mises stress is largest", "", "von_mises_max_at"),
    ("tangential over normal force", "", "traction_coefficient"),
    ("p0/k at first yield", "", "first_yield_p0_over_k"),
    ("p0/k at which a line shakes down", "", "shakedown_limit_p0_over_k"),
    ("yield stress in shear k", "MPa", "shear_yield_MPa"),
    ("p0/k", "", "p0_over_k"),
    ("surface fatigue index", "", "surface_fatigue_index"),
    ("   passing again and again", "", "shakedown"),
)


def plain(summary: Mapping[str, Any]) -> str:
    """What the answer without yield or friction is called; empty where there is no other."""
    return next((each for each in ("elastic", "frictionless") if each in summary), "")


def contact(summary: Mapping[str, Any]) -> list[Row]:
    """Finite elements, estimates, half-spaces and exact Hertz side by side; no rows where nothing
    touches."""
    if summary["result"] is None:
        return []
    return [_row(summary, *row) for row in ROWS]


def _row(summary: Mapping[str, Any], label: str, unit: str, path: tuple[str, ...]) -> Row:
    least = NO_DEPTH * summary["result"]["patch"]["a_mm"] if path[-1].endswith("depth_mm") else 0.0
    fe, exact, half = (_get(summary[key], path, least) for key in ("result", "hertz", "half_space"))
    row: Row = {
        "quantity": label,
        "unit": unit,
        "FE": fe,
        "estimate": summary["accuracy"]["bound"].get(path[-1]),
        "half-space": half,
        "Hertz": exact,
        "FE - Hertz": _relative(fe, exact),
    }
    if kind := plain(summary):
        row[f"{kind} FE"] = _get(summary[kind], path, least)
    return row


def friction(summary: Mapping[str, Any]) -> list[Row]:
    """Forces of the wheel on the rail, its motion and stick, beside other methods."""
    found = (summary["result"] or {}).get("friction") or {}
    others = (summary.get("half_space_friction") or {}).items()
    bound = summary["accuracy"]["bound"] | _unresolved(found)
    return [
        {
            "quantity": label,
            "unit": unit,
            "FE": _get(found, (key,)),
            "estimate": bound.get(key),
            "without creepage": _get(found, ("resolution", key)) if "resolution" in found else None,
            **{name: _get(each, (key,)) for name, each in others if "reason" not in each},
        }
        for label, unit, key in FRICTION
        if key in found
    ]


def steel(summary: Mapping[str, Any]) -> list[Row]:
    """What pressure and tractions do to the steel."""
    found = (summary["result"] or {}).get("friction") or {}
    return [
        {
            "quantity": label,
            "unit": unit,
            "FE": _get(found, (key,)),
            "estimate": _unresolved(found).get(key),
        }
        for label, unit, key in STEEL
        if key in found
    ]


def _unresolved(friction: Mapping[str, Any]) -> dict[str, Cell]:
    """The words in the place of an estimate, by the name of a quantity below its resolution."""
    return dict.fromkeys(friction.get("below_resolution", ()), "below resolution")


def everything(summary: Mapping[str, Any]) -> Iterator[Row]:
    """All of them, each with a name of its own, and "value" for "FE"."""
    load = (summary["result"] or {}).get("load_N")
    given: list[Row] = [] if load is None else [{"quantity": "load", "unit": "N", "FE": load}]
    of = ""
    for row in (*contact(summary), *given, *friction(summary), *steel(summary)):
        label = str(row["quantity"])
        name = f"{of}: {label.strip()}" if label.startswith(" ") else label
        of = of if label.startswith(" ") else label
        named: Row = {"value" if key == "FE" else key: value for key, value in row.items()}
        yield {**named, "quantity": name}


def _get(values: Mapping[str, Any] | None, path: tuple[str, ...], least: float = 0.0) -> Cell:
    """A number or word; 0 for a number below the least that is none of rounding."""
    inner: Any = values
    for key in path:
        inner = None if inner is None else inner.get(key)
    if inner is None or isinstance(inner, str):
        return inner
    return float(inner) if not 0 < inner < least else 0.0


def _relative(value: Cell, exact: Cell) -> float | None:
    if isinstance(value, str) or isinstance(exact, str) or value is None or not exact:
        return None
    return (value - exact) / exact
