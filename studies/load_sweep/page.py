"""The page of the study load_sweep: what its loads say, in words and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from railhead.studies.tables import percent, table
from railhead.studies.trends import power_law

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


def page(rows: Sequence[Row], cases: Mapping[str, str]) -> str:
    """The whole page; cases: name and description."""
    parts = [
        "# Load sweep",
        "One mesh, stiffness and set of contact operators for each case; only the load changes. "
        "The mesh has five elements across the smaller semi-axis of the smallest patch and grows "
        "by 0.2 per distance outside of it. In brackets: difference from exact Hertz. On the rail "
        "head, approach and largest shear stress leave Hertz's power laws as the patch grows: a "
        "head 70 mm wide is no half-space, and its approach depends on where it is held.",
        "![Load sweep](load_sweep.png)",
    ]
    for name, text in cases.items():
        own = [row for row in rows if row["case"] == name]
        if own:
            parts += [f"## {name}: {text}", _loads(own), _exponents(own), _seconds(own)]
    return "\n\n".join(parts) + "\n"


def exponents(rows: Sequence[Row]) -> dict[tuple[str, str], float]:
    """Fitted exponents of one case, with the keys of LAWS."""
    return {
        (y, x): power_law([row[x] for row in rows], [row[y] for row in rows])[1] for y, x in LAWS
    }


def _loads(rows: Sequence[Row]) -> str:
    header = ("load, kN", "a, mm", "b, mm", "p_max, MPa", "approach, mm", "tau_max, MPa")
    keys = [name.split(",")[0] for name in header[1:]]
    lines = []
    for row in rows:
        load = f"{row['load'] / 1000:.4g}" + ("" if row["converged"] else " (not converged)")
        values = [f"{row[key]:.4g} ({row[f'difference_{key}']:+.2%})" for key in keys]
        lines.append([load, *values])
    return table(header, lines)


def _exponents(rows: Sequence[Row]) -> str:
    fitted = exponents(rows)
    lines = [(y, x, f"{fitted[y, x]:.4f}", f"{exact:.4f}") for (y, x), exact in LAWS.items()]
    return table(("quantity", "in", "fitted exponent", "Hertz"), lines)


def _seconds(rows: Sequence[Row]) -> str:
    first, further = rows[0]["seconds"], rows[1:]
    seconds = median(row["seconds"] for row in further)
    krylov = median(row["linear_iterations"] for row in further)
    worst = max(abs(row[f"difference_{key}"]) for row in rows for key in ("a", "b", "p_max"))
    return (
        f"Largest difference of a, b and p_max: {percent(worst)}. {rows[0]['unknowns']} unknowns. "
        f"The first load took {first:.2f} s with mesh, assembly, preconditioner and solve; a "
        f"further one (median) {seconds:.2f} s, {seconds / first:.2f} of the first "
        f"({krylov:.0f} Krylov iterations)."
    )
