"""What the page of the study accuracy_cost says of its runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from studies.tables import percent, render
from studies.trends import pareto, power_law

Row = Mapping[str, Any]
"""One run with the fields of the study's CSV."""
Cells = tuple[Any, ...]
DEFAULT = ("nitsche", "tetrahedron 2")
ASYMPTOTIC = 0.02  # error below which a power law is expected
SOLID185 = ("penalty", "hexahedron 1")
CUBIC = ("nitsche", "tetrahedron 3")


def page(rows: Sequence[Row], max_unknowns: int) -> str:
    """The whole page; max_unknowns: above it, runs were left out."""
    worst, a = orders(rows), orders(rows, "error_a")
    return render(
        "accuracy_cost",
        max_unknowns=max_unknowns,
        asymptotic=ASYMPTOTIC,
        fronts={case: _factor_ten(own) for case, own in _by(rows, "case").items()},
        solid185=_rival(rows, SOLID185),
        cubic=_rival(rows, CUBIC, "error_all"),
        orders=[(*key, f"{a[key]:.2f}", f"{worst[key]:.2f}") for key in worst],
        asked=[_asked(row) for row in rows if row["asked"] is not None],
        failed=[(row, _size(row)) for row in rows if not row["converged"]],
        runs=[_run(row) for row in rows if row["seconds"] is not None],
    )


def orders(rows: Sequence[Row], quantity: str = "error") -> dict[tuple[str, str, str], float]:
    """Order of convergence of an error field by (case, method, element), from converged runs."""
    found = {}
    for key, own in _by(_fixed(rows), "case", "method", "element").items():
        sizes, errors = [row["patch_size_mm"] for row in own], [row[quantity] for row in own]
        if len(own) > 1:
            found[key] = power_law(sizes, errors)[1]
    return found


def _by(rows: Sequence[Row], *keys: str) -> dict[Any, list[Row]]:
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        key = tuple(row[k] for k in keys) if len(keys) > 1 else row[keys[0]]
        groups.setdefault(key, []).append(row)
    return groups


def _fixed(rows: Sequence[Row], *which: tuple[str, str]) -> list[Row]:
    """Converged runs on given meshes, of all or of some (method, element)."""
    return [
        row
        for row in rows
        if row["converged"] and row["asked"] is None
        if not which or (row["method"], row["element"]) in which
    ]


def _factor_ten(rows: Sequence[Row]) -> dict[str, Any] | None:
    """Ends of the default's front, and the factor in time for ten in accuracy; None: no front."""
    runs = _fixed(rows, DEFAULT)
    seconds, errors = [row["seconds"] for row in runs], [row["error"] for row in runs]
    front = [runs[i] for i in pareto(seconds, errors)] if runs else []
    fine = [row for row in front if row["error"] < ASYMPTOTIC]
    front = fine if len(fine) > 1 else front
    if len(front) < 2:
        return None
    slope = power_law([row["error"] for row in front], [row["seconds"] for row in front])[1]
    return {"first": front[0], "last": front[-1], "factor": 10**-slope}


def _rival(rows: Sequence[Row], which: tuple[str, str], quantity: str = "error") -> list[Cells]:
    lines = []
    for case, own in _by(rows, "case").items():
        rivals = _fixed(own, which)
        for run in _fixed(own, DEFAULT):
            quick = [row[quantity] for row in rivals if row["seconds"] <= run["seconds"]]
            best, error = min(quick, default=None), run[quantity]
            ratio = "none as quick" if best is None else f"{best / error:.1f}"
            lines.append((case, f"{run['seconds']:.2f}", percent(error), percent(best), ratio))
    return lines


def _asked(row: Row) -> Cells:
    return (
        row["case"], percent(row["asked"]), "yes" if row["reached"] else "no",
        percent(row["error"]), percent(row["error_all"]),
        "-" if row["seconds"] is None else f"{row['seconds']:.2f}",
    )  # fmt: skip


def _size(row: Row) -> str:
    n = row["elements_per_semi_axis"]
    return f"asked {percent(row['asked'])}" if n is None else f"b/{n:g}"


def _run(row: Row) -> Cells:
    return (
        row["case"], row["method"], row["element"], _size(row), row["unknowns"],
        f"{row['seconds']:.2f}", f"{row['seconds_solve']:.2f}",
        f"{row['newton_iterations']} / {row['linear_iterations']}", percent(row["error"]),
        percent(row["error_approach"]), percent(row["error_tau_max"]), percent(row["error_all"]),
    )  # fmt: skip
