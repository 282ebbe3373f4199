"""The record of a solved scene, and its row of sweep.csv."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from operator import getitem
from typing import Any

import numpy as np

from railhead.results.result import Result
from railhead.sweeps.grid import column

TAU_MAX_BODY, CONTACT_ANGLE = "tau_max body", "contact angle [rad]"
PLACES = {
    "p_max [MPa]": ("result", "pressure", "max_MPa"),
    "p_mean [MPa]": ("result", "pressure", "mean_MPa"),
    "area [mm2]": ("result", "patch", "area_mm2"),
    "a [mm]": ("result", "patch", "a_mm"),
    "b [mm]": ("result", "patch", "b_mm"),
    "tau_max [MPa]": ("result", "stress", "tau_max_MPa"),
    "tau_max depth [mm]": ("result", "stress", "tau_max_depth_mm"),
    TAU_MAX_BODY: ("result", "stress", "tau_max_body"),
    "von_mises_max [MPa]": ("result", "stress", "von_mises_max_MPa"),
    "found approach [mm]": ("result", "approach_mm"),
    "found load [N]": ("result", "load_N"),
    CONTACT_ANGLE: ("plan", "contact_angle_rad"),
    "unknowns": ("cost", "dofs"),
}
"""Place in summary.json of the values of a column."""
FRICTION = {
    "force along [N]": "force_along_N",
    "force across [N]": "force_across_N",
    "moment [N mm]": "moment_Nmm",
    "mu N [N]": "limit_N",
    "creepage along": "creepage_along",
    "creepage across": "creepage_across",
    "spin [1/mm]": "spin_per_mm",
    "axle": "axle",
    "shift along [mm]": "shift_along_mm",
    "shift across [mm]": "shift_across_mm",
    "stick share": "stick_share",
    "T-gamma [N]": "t_gamma_N",
}
"""Keys of result.friction by column."""
BOUNDS = {
    "p_max estimate": "max_MPa",
    "area estimate": "area_mm2",
    "a estimate": "a_mm",
    "b estimate": "b_mm",
    "tau_max estimate": "tau_max_MPa",
    "approach estimate": "approach_mm",
}
"""Keys of accuracy.bound by column."""
CHECKS, PASSED = "checks", "passed"


def record(result: Result | Exception) -> dict[str, Any]:
    """The record of a scene, as plain data.

    fault: why there is no result, in one line; empty where there is one.
    summary: summary.json.
    outlines: of the patches seen from above, points x, y in mm.
    """
    if isinstance(result, Exception):
        return {"fault": " ".join(str(result).split())}
    outlines, findings = [], result.findings
    if findings is not None:
        for line in findings.patch.outlines:
            points = (findings.frame.place(float(x), float(s)) for x, s in line)
            outlines.append([[round(x, 4), round(y, 4)] for x, y, _ in points])
    return {"fault": "", "summary": result.summary, "outlines": outlines}


def row(values: Mapping[str, object], record: Mapping[str, Any]) -> dict[str, Any]:
    """A row of sweep.csv: cells by column.

    values: of the changing keys. Where Newton's method did not converge, or there is no result, the
    row ends after the column `checks`.
    """
    cells: dict[str, Any] = {column(key): value for key, value in values.items()}
    cells[CHECKS] = status(record)
    if record["fault"] or not record["summary"]["checks"]["converged"]:
        return cells
    summary = record["summary"]
    cells |= {name: reduce(getitem, place, summary) for name, place in PLACES.items()}
    point = summary["result"]["contact_point_mm"]
    cells |= {f"patch {axis} [mm]": value for axis, value in zip("xyz", point, strict=True)}
    patches = summary["result"]["patches"]
    cells["patches"] = max(1, len(patches))
    if patches:  # the most loaded one is the first, as for a, b and its place
        cells[CONTACT_ANGLE] = patches[0]["contact_angle_rad"]
    friction = summary["result"].get("friction") or {}
    cells |= {name: friction[key] for name, key in FRICTION.items() if key in friction}
    bound = summary["accuracy"]["bound"]
    return cells | {name: bound.get(key) for name, key in BOUNDS.items()}


def check(record: Mapping[str, Any]) -> None:
    """Raise LookupError, TypeError or ValueError for what is no record of `record`."""
    for name, value in row({}, record).items():
        if name in PLACES and name != TAU_MAX_BODY and not isinstance(value, int | float | None):
            raise TypeError(f"{name} is no number")
    for line in record.get("outlines", []):
        np.asarray(line, dtype=float).reshape(-1, 2)


def status(record: Mapping[str, Any]) -> str:
    """PASSED, or which checks failed, or why there is no result."""
    if record["fault"]:
        return f"NOT SOLVED: {record['fault']}"
    checks = record["summary"]["checks"]
    if not checks["converged"]:
        return f"NOT CONVERGED: {record['summary']['newton']['reason']}"
    return PASSED if checks["passed"] else f"FAILED: {' '.join(checks['failed'])}"
