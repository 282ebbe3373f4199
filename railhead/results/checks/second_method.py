"""Checks of a solution against a second method: Hertz, boundary elements, rolling half-spaces.

A quantity is compared where both methods have it and what the second one leaves out is known.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import Frame
from railhead.results.checks.solution import (
    DEFAULT_TOLERANCE,
    ESTIMATE_FACTOR,
    FINER,
    Check,
    allowed,
    deviation,
)
from railhead.run.estimates import Estimate, resolved_values
from railhead.run.mesh_solution import MeshSolution
from railhead.run.quantities import QUANTITIES, numeric_values

COMPARED = [each.key for each in QUANTITIES if each.compared]
"""Quantities held against a second method, as far as it has them and knows what it leaves out."""
SECOND = "second_opinion"  # begins the names of those checks
SHIFT_UNKNOWN = "the shift of bodies that end depends on where they are held"


def quantities(
    solved: MeshSolution, estimates: Mapping[str, Estimate], second: Mapping[str, Any]
) -> Iterator[Check]:
    """Checks of the compared quantities against another method, within the errors of both and the
    allowance. second: quantities of the other method, nested as
    "result" of summary.json, with "allowance" and "grid_error", or {"reason": ...} where there are
    none.
    """
    if _unknown(second):
        return  # `not_made` has the reason
    own, other = resolved_values(solved), numeric_values(second)
    for key in COMPARED:
        if key not in own or key not in other:
            continue
        if second["allowance"] and key not in second["allowance"]:
            continue  # nobody has computed what the method leaves out of it
        mine = allowed(estimates, key)
        allowance = second["allowance"].get(key, {}).get("total", 0.0)
        allowance += second.get("grid_error", {}).get(key, 0.0)
        yield Check(
            name=f"{SECOND}_{key}",
            value=deviation(own[key], other[key]),
            limit=mine + allowance,
            source=f"{mine:.2g} ({ESTIMATE_FACTOR:g} times the estimate, or without one "
            f"{DEFAULT_TOLERANCE:g}), and {allowance:.2g} for what it cannot know",
            advice="ask for an accuracy, and look at the profiles",
        )


def tangential_flux(solved: MeshSolution) -> Iterator[Check]:
    """Check for each body that its stresses around the patch carry the tangential forces, over mu
    N.
    """
    from railhead.postprocess.stress.flux import contact_force, pressure_force

    plan, found, fields = solved.plan, solved.solution.friction, solved.fields
    assert found is not None and fields is not None
    axes = Frame(plan.contact.origin, plan.contact.touch.angle).axes[:2]
    _, *given = plan.scene.tangential_forces
    wanted = [one or force for one, force in zip(given, found.force, strict=True)]
    pressed = pressure_force(fields)
    for body in plan.deformable:
        off = axes @ (contact_force(fields, body) - pressed) - wanted
        yield Check(
            name=f"tangential_flux_{BODY_NAMES[body]}",
            value=float(np.linalg.norm(off)) / found.friction_limit,
            limit=DEFAULT_TOLERANCE,
            source="the tangential force, over mu N; as for the load",
            advice=FINER,
        )


def forces(
    solved: MeshSolution, estimates: Mapping[str, Estimate], other: Mapping[str, Any]
) -> Iterator[Check]:
    """Check of the tangential forces in rolling against half-spaces, over mu N. other: quantities
    of one method, by the keys of "friction" in summary.json.
    """
    found = solved.solution.friction
    assert found is not None and solved.result is not None
    keys = [key for key in ("force_along_N", "force_across_N") if key in other]
    if not keys or not solved.plan.scene.rolling.prescribed:
        return
    force = dict(zip(("force_along_N", "force_across_N"), found.force, strict=True))
    tolerance = DEFAULT_TOLERANCE
    if still := solved.result.get("friction", {}).get("resolution"):
        estimated = [ESTIMATE_FACTOR * estimates[key].total for key in force if key in estimates]
        tolerance *= math.hypot(*found.force) / found.friction_limit
        tolerance = max(estimated, default=tolerance)
        unresolved = math.hypot(*(still[key] for key in force)) / found.friction_limit
        tolerance += ESTIMATE_FACTOR * unresolved
    yield Check(
        name=f"{SECOND}_friction",
        value=max(abs(force[key] - other[key]) / found.friction_limit for key in keys),
        limit=tolerance + other.get("grid_error", 0.0),
        source=f"half-spaces with friction, over mu N; {ESTIMATE_FACTOR:g} times the estimate, or "
        f"without one {DEFAULT_TOLERANCE:g} of the force (unlike bodies: of mu N); "
        f"{ESTIMATE_FACTOR:g} times what is found without creepage; the error of their grid",
        advice=FINER,
    )


def shift(solved: MeshSolution, other: Mapping[str, Any]) -> Iterator[Check]:
    """Check of the shift of half-spaces under tangential forces against another method, relative.
    other: quantities of that method, by the keys of "friction" in summary.json.
    """
    found = solved.solution.friction
    assert found is not None
    if "shift_along_mm" not in other:
        return
    pairs = [
        (shift, other[f"shift_{way}_mm"])
        for way, shift in zip(("along", "across"), found.rigid_motion, strict=False)
    ]
    whole = math.hypot(*(shift for _, shift in pairs))
    yield Check(
        name=f"{SECOND}_shift",
        value=max(abs(one - two) for one, two in pairs) / whole,
        limit=DEFAULT_TOLERANCE + other.get("grid_error", 0.0),
        source="half-spaces with friction, over their shift, and the error of their grid",
        advice=FINER,
    )


def not_made(
    solved: MeshSolution,
    made: Sequence[Check],
    second: Mapping[str, Any],
    second_friction: Mapping[str, Mapping[str, Any]] | None,
) -> dict[str, str]:
    """Reasons by name for the comparisons with a second method that were not made.

    made: the checks that were made.
    second: quantities of the second method, or {"reason": ...}.
    second_friction: quantities with friction by method; None without friction.
    """
    elastic = solved.elastic_reference or solved
    if elastic.result is None:
        return {}
    names, missing = {each.name for each in made}, {}
    if reason := _unknown(second):
        missing[SECOND] = reason
    else:
        other, own = numeric_values(second), resolved_values(elastic)
        missing = {
            f"{SECOND}_{key}": "what half-spaces leave out of it is not known"
            if key in other
            else "the second method does not give it"
            for key in COMPARED
            if key in own and f"{SECOND}_{key}" not in names
        }
    if solved.solution.friction is not None:
        name = f"{SECOND}_{'friction' if solved.plan.scene.rolling.prescribed else 'shift'}"
        reasons = [each["reason"] for each in (second_friction or {}).values() if "reason" in each]
        if name not in names:
            missing[name] = next(iter(reasons), SHIFT_UNKNOWN)
    return missing


def _unknown(second: Mapping[str, Any]) -> str:
    """Reason why a second method cannot be compared; empty where it can."""
    return str(second.get("reason") or second["allowance"].get("reason") or "")
