"""Checks that a result must pass, each with its value, its limit, the limit's source, and advice.

The limits follow from physics or from the wanted accuracy. Two were set anew after right results
had been refused: that of the noise, and that of the flux with linear cells. A new check is a
`Check` that the function of its group yields, and its name in words in `report.html`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from railhead.results.checks import second_method, solution
from railhead.results.checks.solution import Check
from railhead.run.estimates import Estimate, largest_error
from railhead.run.mesh_solution import MeshSolution


def run(
    solved: MeshSolution,
    estimates: Mapping[str, Estimate],
    second: Mapping[str, Any],
    *,
    reached: bool | None,
) -> list[Check]:
    """All checks of a solved mesh but those of friction (rank 0).

    estimates: error estimates by key.
    second: quantities of another method, nested as "result" of summary.json, with "allowance" and
        "grid_error", or {"reason": ...} where there are none.
    reached: whether the wanted accuracy was met; None without one.
    """
    checks = [*solution.equations(solved)]
    if solved.result is not None and solved.findings is not None:
        elastic = solved.elastic_reference or solved
        checks += solution.resolution(solved)
        checks += solution.physics(solved)
        checks += solution.pressure_over_mean(elastic, estimates)
        checks += second_method.quantities(elastic, estimates, second)
    if reached is not None:
        error, wanted = largest_error(estimates, solved), float(solved.plan.scene.accuracy or 0.0)
        checks.append(
            Check(
                name="accuracy",
                value=error if reached else max(error, math.nextafter(wanted, math.inf)),
                limit=wanted,
                source="asked",
                advice="ask for less, or give a larger budget; see accuracy.would_cost",
            )
        )
    return checks


def friction(
    solved: MeshSolution,
    estimates: Mapping[str, Estimate],
    second: Mapping[str, Mapping[str, Any]] | None,
) -> list[Check]:
    """Checks of a solution with friction; empty without friction.

    second: quantities of half-spaces by method, as "half_space_friction" of summary.json.
    """
    if solved.solution.friction is None or solved.result is None:
        return []
    other = (second or {}).get("boundary elements") or (second or {}).get("Carter") or {}
    return [
        *second_method.tangential_flux(solved),
        *second_method.forces(solved, estimates, other),
        *second_method.shift(solved, other),
    ]


def summary(checks: list[Check], missing: Mapping[str, str]) -> dict[str, Any]:
    """Entry "checks" of summary.json: value by name, "limits" with sources, "advice", "not_made"
    (missing), "failed" and "passed".
    """
    failed = [each.name for each in checks if not each.passed]
    return {
        **{each.name: each.value for each in checks if each.name != "converged"},
        "limits": {each.name: [each.limit, each.source] for each in checks},
        "advice": {each.name: each.advice for each in checks if not each.passed},
        "not_made": dict(missing),
        "failed": failed,
        "passed": not failed,
    }
