"""summary.json: the contract with everyone who reads results."""

from __future__ import annotations

import math
import resource
from typing import Any

from railhead.contact.plane_section import FlatContact
from railhead.planning import effects
from railhead.planning.effects.material import plasticity
from railhead.postprocess import compare
from railhead.postprocess.friction import damage
from railhead.results import checks
from railhead.run import estimates
from railhead.run.mesh_solution import Level
from railhead.run.references import half_space_reference, rolling_reference
from railhead.run.refinement import Ending
from railhead.theory.elastic.hertz import Ellipse

NO_SECTION = {"reason": "boundary elements know no section of bodies that end"}


def summarise(levels: list[Level], ending: Ending) -> dict[str, Any]:
    """The summary of the last level (rank 0), with estimates from all of them."""
    level = levels[-1]
    plan, solution, found = level.plan, level.solution, level.findings
    scene = plan.scene
    hertz = exact_quantities(level)
    newton, cost, plain = solution.newton, ending.would_cost, level.plain
    known, source = estimates.estimate(levels)
    bound = {name: each.total for name, each in known.items()}
    reached = None
    if scene.accuracy is not None and level.result is not None:
        reached = bool(estimates.worst(known, level) <= scene.accuracy)
    solved = half_space_reference.solve(level)
    profiles, rubbed = (
        half_space_reference.half_space(level, solved),
        rolling_reference.opinions(level, solved),
    )
    second = {**hertz, "allowance": {}} if plan.contact.half_space else profiles or NO_SECTION
    other = effects.chosen(plan.effects)
    beyond = all(effects.EFFECTS[name].beyond for name in other)
    if not beyond:
        second = {"reason": f"another problem than the scene's was chosen: {', '.join(other)}"}
    if other:
        source = f"{source}; of the problem that was chosen ({', '.join(other)})"
    judged = checks.run(level, known, second, reached=reached)
    beside = rubbed if beyond or rubbed is None else {"scene": second}
    judged += checks.friction(level, known, beside)
    missing = checks.not_made(level, judged, second, beside)
    return {
        "case": scene.name,
        "scene": scene.model_dump(exclude_none=True),
        "plan": plan.summary(),
        "result": level.result and {**level.result, **_more(level)},
        **({} if plain is None else {_kind(level): plain.result}),
        "hertz": hertz,
        "half_space": profiles,
        **({} if rubbed is None else {"half_space_friction": rubbed}),
        "difference": None if level.result is None else compare.difference(level.result, hertz),
        "effects_after": {name: vars(each) for name, each in level.after.items()},
        "accuracy": {
            "asked": scene.accuracy,
            "bound": bound,
            "reached": reached,
            "reason": ending.reason,
            "would_cost": cost and {"unknowns": cost[0], "seconds": cost[1]},
            "source": source,
            "parts": {name: each.parts for name, each in known.items()},
            "levels": [_trace(each) for each in levels],
        },
        "checks": {
            **checks.summary(judged, missing),
            "converged": newton.converged and found is not None,
            "max_penetration_mm": solution.penetration,
            "hertzian": None if found is None else found.hertzian,
            "shape_error": None if found is None else found.shape_error,
        },
        "newton": {"reason": newton.reason, "history": [vars(step) for step in newton.history]},
        "cost": {
            "dofs": level.unknowns,
            "cells": level.mesh.cells,
            "mesh_quality": level.mesh.quality,
            "ranks": level.ranks,
            "newton_iterations": len(newton.history),
            "linear_iterations": sum(step.linear_iterations for step in newton.history),
            "peak_rss_MB": 1024e-6 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
            "seconds": _seconds(levels),
        },
    }


def _kind(level: Level) -> str:
    """What the plain solution is called: it is both where both effects are on."""
    return "elastic" if level.left is not None else "frictionless"


def _more(level: Level) -> dict[str, Any]:
    """What yield leaves and what tractions do to the steel."""
    out: dict[str, Any] = {} if level.left is None else {"plastic": _plastic(level)}
    if level.result is not None and (found := level.result.get("friction")):
        plan = level.plan
        rolling = plan.scene.rolling
        axle = {"axle": rolling.axle} if rolling.from_wheelset else {}
        stresses = damage.answers(
            level.result,
            plan.scene.friction.coefficient,
            plasticity.shear_yield(plan.context),
            poisson=min(plan.poisson_ratios.values()),
            rolling=rolling.given,
            line=plan.contact.line,
        )
        out["friction"] = found | axle | stresses
    return out


def _plastic(level: Level) -> dict[str, Any]:
    scene, left, elastic = level.plan.scene, level.left, level.plain
    assert left is not None and elastic is not None and elastic.result is not None
    part = scene.rail if left.zone.body == "rail" else scene.wheel
    shear = plasticity.hardening(part).first / math.sqrt(3)
    return left.summary(elastic.result["pressure"]["max_MPa"], shear)


def exact_quantities(level: Level) -> dict[str, Any]:
    """Exact Hertz under the load that was found, nested as "result"."""
    plan, ellipse, contact = level.plan, level.ellipse, level.plan.contact
    given = plan.poisson_ratios, contact.touch.angle, contact.origin
    if isinstance(ellipse, Ellipse):
        return compare.from_hertz(ellipse, *given)
    approach = contact.approach(ellipse) if isinstance(contact, FlatContact) else None
    return compare.from_line(ellipse, *given, approach)


def _trace(level: Level) -> dict[str, Any]:
    return {
        "elements_per_semi_axis": level.resolution,
        "patch_size_mm": level.grading.size,
        "unknowns": level.unknowns,
        "seconds": sum(level.seconds.values()),
        "result": level.result,
    }


def _seconds(levels: list[Level]) -> dict[str, float]:
    stages = {key: sum(level.seconds[key] for level in levels) for key in levels[-1].seconds}
    return {**stages, "total": sum(stages.values())}
