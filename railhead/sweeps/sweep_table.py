"""What a sweep tells of its combinations: a record of each, and the rows of sweep.csv."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from railhead.results.result import Result
from railhead.scene.scene import unit

BODY, ANGLE = "tau_max body", "contact angle [rad]"
COLUMNS = {
    "p_max [MPa]": ("result", "pressure", "max_MPa"),
    "p_mean [MPa]": ("result", "pressure", "mean_MPa"),
    "area [mm2]": ("result", "patch", "area_mm2"),
    "a [mm]": ("result", "patch", "a_mm"),
    "b [mm]": ("result", "patch", "b_mm"),
    "tau_max [MPa]": ("result", "stress", "tau_max_MPa"),
    "tau_max depth [mm]": ("result", "stress", "tau_max_depth_mm"),
    BODY: ("result", "stress", "tau_max_body"),
    "von_mises_max [MPa]": ("result", "stress", "von_mises_max_MPa"),
    "found approach [mm]": ("result", "approach_mm"),
    "found load [N]": ("result", "load_N"),
    ANGLE: ("plan", "contact_angle_rad"),
    "unknowns": ("cost", "dofs"),
}
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
BOUNDS = {
    "p_max estimate": "max_MPa",
    "area estimate": "area_mm2",
    "a estimate": "a_mm",
    "b estimate": "b_mm",
    "tau_max estimate": "tau_max_MPa",
    "approach estimate": "approach_mm",
}
CHECKS, PASSED = "checks", "passed"


def column(key: str) -> str:
    """Header of a parameter's values."""
    return f"{key} [{unit(key)}]" if unit(key) else key


def record(found: Result | Exception) -> dict[str, Any]:
    """What is kept of a combination: summary.json, the patches' outlines as seen from above (x, y;
    mm) and what refused it, if something did."""
    if isinstance(found, Exception):
        return {"fault": " ".join(str(found).split())}
    lines, findings = [], found.findings
    if findings is not None:
        for line in findings.patch.outlines:
            places = (findings.frame.place(float(x), float(s)) for x, s in line)
            lines.append([[round(x, 4), round(y, 4)] for x, y, _ in places])
    return {"fault": "", "summary": found.summary, "outlines": lines}


def row(values: Mapping[str, object], kept: Mapping[str, Any]) -> dict[str, Any]:
    """A line of sweep.csv. Where no result is signed by convergence there are no numbers."""
    line: dict[str, Any] = {column(key): value for key, value in values.items()}
    line[CHECKS] = status(kept)
    if kept["fault"] or not kept["summary"]["checks"]["converged"]:
        return line
    summary = kept["summary"]
    line |= {name: _at(summary, path) for name, path in COLUMNS.items()}
    place = summary["result"]["contact_point_mm"]
    line |= {f"patch {axis} [mm]": value for axis, value in zip("xyz", place, strict=True)}
    patches = summary["result"]["patches"]
    line["patches"] = max(1, len(patches))
    if patches:  # the most loaded one is the first, as for a, b and its place
        line[ANGLE] = patches[0]["contact_angle_rad"]
    rubbed = summary["result"].get("friction") or {}
    line |= {name: rubbed[key] for name, key in FRICTION.items() if key in rubbed}
    bound = summary["accuracy"]["bound"]
    return line | {name: bound.get(key) for name, key in BOUNDS.items()}


def check(kept: Mapping[str, Any]) -> None:
    """Raises LookupError, TypeError or ValueError where a record is none that `record` made."""
    for name, value in row({}, kept).items():
        if name in COLUMNS and name != BODY and not isinstance(value, int | float | None):
            raise TypeError(f"{name} is no number")
    for line in kept.get("outlines", []):
        np.asarray(line, dtype=float).reshape(-1, 2)


def status(kept: Mapping[str, Any]) -> str:
    """passed, or what is wrong."""
    if kept["fault"]:
        return f"NOT SOLVED: {kept['fault']}"
    checks = kept["summary"]["checks"]
    if not checks["converged"]:
        return f"NOT CONVERGED: {kept['summary']['newton']['reason']}"
    return PASSED if checks["passed"] else f"FAILED: {' '.join(checks['failed'])}"


def _at(summary: Mapping[str, Any], path: tuple[str, ...]) -> Any:
    inner: Any = summary
    for key in path:
        inner = inner[key]
    return inner
