"""What the page of the study load_sweep says of its loads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from studies.tables import render
from studies.trends import power_law

Row = Mapping[str, Any]
"""One load with the fields of the study's CSV, without units."""
LAWS = {
    ("a", "load"): 1 / 3,
    ("b", "load"): 1 / 3,
    ("p_max", "load"): 1 / 3,
    ("approach", "load"): 2 / 3,
    ("tau_max", "load"): 1 / 3,
    ("p_max", "a"): 1.0,
}
"""Hertz's exponents of one quantity in another."""
QUANTITIES = ("a", "b", "p_max", "approach", "tau_max")


def page(rows: Sequence[Row], cases: Mapping[str, str]) -> str:
    """The whole page; cases: name and description."""
    own = {name: [row for row in rows if row["case"] == name] for name in cases}
    return render("load_sweep", cases=[_case(cases[name], own[name]) for name in own if own[name]])


def exponents(rows: Sequence[Row]) -> dict[tuple[str, str], float]:
    """Fitted exponents of one case, with the keys of LAWS."""
    return {
        (y, x): power_law([row[x] for row in rows], [row[y] for row in rows])[1] for y, x in LAWS
    }


def _case(text: str, rows: Sequence[Row]) -> dict[str, Any]:
    fitted, further = exponents(rows), rows[1:]
    return {
        "name": rows[0]["case"],
        "text": text,
        "loads": [_load(row) for row in rows],
        "exponents": [
            (y, x, f"{fitted[y, x]:.4f}", f"{exact:.4f}") for (y, x), exact in LAWS.items()
        ],
        "worst": max(abs(row[f"difference_{key}"]) for row in rows for key in ("a", "b", "p_max")),
        "unknowns": rows[0]["unknowns"],
        "first": rows[0]["seconds"],
        "further": median(row["seconds"] for row in further),
        "krylov": median(row["linear_iterations"] for row in further),
    }


def _load(row: Row) -> list[str]:
    load = f"{row['load'] / 1000:.4g}" + ("" if row["converged"] else " (not converged)")
    return [load, *(f"{row[key]:.4g} ({row[f'difference_{key}']:+.2%})" for key in QUANTITIES)]
