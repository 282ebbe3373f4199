"""The record of a solved scene, and its row of sweep.csv."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from railhead.results.result import Result
from railhead.run import quantities
from railhead.sweeps.grid import column

CONTACT_ANGLE = "contact angle [rad]"
OTHERS = {CONTACT_ANGLE: ("plan", "contact_angle_rad"), "unknowns": ("cost", "dofs")}
"""Place in summary.json of the values of columns that are no quantities of the result."""
COLUMNS = [each for each in quantities.QUANTITIES if each.column]
CHECKS, PASSED = "checks", "passed"


def record(result: Result | Exception) -> dict[str, Any]:
    """Record of a solved scene, or of the error that refused the scene, as plain data.

    fault: reason why there is no result, in one line; empty where there is one.
    summary: content of summary.json.
    outlines: outlines of the patches seen from above, lists of points x, y in mm.
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
    """A row of sweep.csv: cells by column header.

    values: values of the changing keys by dotted key. Where Newton's method did not converge, or
        there is no result, the row ends after the column `checks`. Raises LookupError, TypeError,
        ValueError or AttributeError for data that is no record of a scene.
    """
    cells: dict[str, Any] = {column(key): value for key, value in values.items()}
    cells[CHECKS] = status(record)
    if record["fault"] or not record["summary"]["checks"]["converged"]:
        return cells
    summary = record["summary"]
    every = [each for each in COLUMNS if each.table != "friction"]
    cells |= {each.header: each.value(summary["result"]) for each in every}
    cells |= {name: summary[part][key] for name, (part, key) in OTHERS.items()}
    point = summary["result"]["contact_point_mm"]
    cells |= {f"patch {axis} [mm]": value for axis, value in zip("xyz", point, strict=True)}
    patches = summary["result"]["patches"]
    cells["patches"] = max(1, len(patches))
    if patches:  # the most loaded one is the first, as for a, b and its place
        cells[CONTACT_ANGLE] = patches[0]["contact_angle_rad"]
    friction = summary["result"].get("friction") or {}
    cells |= {each.header: friction[each.key] for each in COLUMNS if each.key in friction}
    bound = summary["accuracy"]["bound"]
    cells |= {
        f"{each.column.removeprefix('found ')} estimate": bound.get(each.key)
        for each in COLUMNS
        if each.estimated
    }
    return cells | {"program": f"railhead {summary['railhead']}", "date": summary["date"]}


def status(record: Mapping[str, Any]) -> str:
    """State of a record in words: "passed", the names of the failed checks, or the reason why there
    is no result.
    """
    if record["fault"]:
        return f"NOT SOLVED: {record['fault']}"
    checks = record["summary"]["checks"]
    if not checks["converged"]:
        return f"NOT CONVERGED: {record['summary']['newton']['reason']}"
    return PASSED if checks["passed"] else f"FAILED: {' '.join(checks['failed'])}"
