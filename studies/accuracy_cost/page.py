"""The page of the study accuracy_cost: what its runs say, in words and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from railhead.studies.tables import percent, table
from railhead.studies.trends import pareto, power_law

Row = Mapping[str, Any]
"""One run with the fields of the study's CSV."""
DEFAULT = ("nitsche", "tetrahedron 2")
ASYMPTOTIC = 0.02  # error below which a power law is expected
SOLID185 = ("penalty", "hexahedron 1")
CUBIC = ("nitsche", "tetrahedron 3")


def page(rows: Sequence[Row], max_unknowns: int) -> str:
    """The whole page; max_unknowns: above it, runs were left out."""
    parts = [
        "# What accuracy costs",
        "Seconds are of the whole run in one process (mesh, assembly, solve, reading; no imports, "
        "compilation, files or pictures), after a warm-up run for each case and element. The error "
        "is the worst of a, b and the largest pressure, relative to exact Hertz; for "
        "`uic54_thesis` relative to the program's own result with 16 quadratic tetrahedra per "
        "smaller semi-axis, whose own error limits what can be seen. b/n: n elements per smaller "
        f"semi-axis. Runs predicted above {max_unknowns} unknowns were left out.",
        "![Error against time](accuracy_cost.png)",
        "## A factor ten in accuracy",
        f"Fitted to runs with errors below {percent(ASYMPTOTIC)}, if there are two.",
        *(_factor_ten(case, own) for case, own in _by(rows, "case").items()),
        "## Linear hexahedra with a penalty, as in SOLID185",
        "The best such run that took no longer than each run of the default (quadratic tetrahedra, "
        "Nitsche's method):",
        _rival(rows, SOLID185, "SOLID185-like"),
        "## Cubic tetrahedra: do they pay?",
        "No scene can ask for them. The best run with cubic tetrahedra that took no longer than "
        "each run of the default, by the worst of all quantities:",
        _rival(rows, CUBIC, "cubic", "error_all"),
        "## Orders of convergence",
        "Exponent of the element size in a power law fitted to the error. Where the error is as "
        "small as those of the far field and of the reading, the order means little.",
        _orders(rows),
        "## Asked accuracies",
        _asked(rows),
        "## What failed or was left out",
        _failed(rows),
        "## All runs",
        _all(rows),
    ]
    return "\n\n".join(parts) + "\n"


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


def _factor_ten(case: str, rows: Sequence[Row]) -> str:
    runs = _fixed(rows, DEFAULT)
    seconds, errors = [row["seconds"] for row in runs], [row["error"] for row in runs]
    front = [int(i) for i in pareto(seconds, errors)] if runs else []
    fine = [i for i in front if errors[i] < ASYMPTOTIC]
    front = fine if len(fine) > 1 else front
    if len(front) < 2:
        return f"- `{case}`: fewer than two runs of the default improve on each other."
    first, last = front[0], front[-1]
    slope = power_law([errors[i] for i in front], [seconds[i] for i in front])[1]
    return (
        f"- `{case}`: the default goes from {percent(errors[first])} in {seconds[first]:.2g} s to "
        f"{percent(errors[last])} in {seconds[last]:.2g} s. A factor ten in accuracy costs a "
        f"factor {10**-slope:.1f} in time."
    )


def _rival(rows: Sequence[Row], which: tuple[str, str], name: str, quantity: str = "error") -> str:
    lines = []
    for case, own in _by(rows, "case").items():
        rivals = _fixed(own, which)
        for run in _fixed(own, DEFAULT):
            quick = [row[quantity] for row in rivals if row["seconds"] <= run["seconds"]]
            best, error = min(quick, default=None), run[quantity]
            ratio = "none as quick" if best is None else f"{best / error:.1f}"
            lines.append((case, f"{run['seconds']:.2f}", percent(error), percent(best), ratio))
    return table(("case", "seconds", "default", name, "times the error"), lines)


def _orders(rows: Sequence[Row]) -> str:
    worst, a = orders(rows), orders(rows, "error_a")
    lines = [(*key, f"{a[key]:.2f}", f"{worst[key]:.2f}") for key in worst]
    return table(("case", "method", "element", "a", "worst of a, b, p_max"), lines)


def _asked(rows: Sequence[Row]) -> str:
    runs = [row for row in rows if row["asked"] is not None]
    if not runs:
        return "No run with an asked accuracy gave a bound."
    lines = [
        (row["case"], percent(row["asked"]), "yes" if row["reached"] else "no",
         percent(row["error"]), percent(row["error_all"]),
         "-" if row["seconds"] is None else f"{row['seconds']:.2f}")
        for row in runs
    ]  # fmt: skip
    return table(("case", "asked", "reached", "error", "worst of all", "seconds"), lines)


def _failed(rows: Sequence[Row]) -> str:
    lines = [
        f"- `{row['case']}`, {row['method']}, {row['element']}, {_size(row)}: {row['failure']}"
        for row in rows
        if not row["converged"]
    ]
    return "\n".join(lines) or "Nothing: every run converged."


def _size(row: Row) -> str:
    n = row["elements_per_semi_axis"]
    return f"asked {percent(row['asked'])}" if n is None else f"b/{n:g}"


def _all(rows: Sequence[Row]) -> str:
    lines = [
        (row["case"], row["method"], row["element"], _size(row), row["unknowns"],
         f"{row['seconds']:.2f}", f"{row['seconds_solve']:.2f}",
         f"{row['newton_iterations']} / {row['linear_iterations']}", percent(row["error"]),
         percent(row["error_approach"]), percent(row["error_tau_max"]), percent(row["error_all"]))
        for row in rows
        if row["seconds"] is not None
    ]  # fmt: skip
    header = (
        "case", "method", "element", "size", "unknowns", "seconds", "solve", "Newton / Krylov",
        "error", "approach", "tau_max", "worst of all",
    )  # fmt: skip
    return table(header, lines)
