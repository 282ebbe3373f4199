"""summary.json: the contract with everyone who reads results."""

from __future__ import annotations

import math
import resource
from typing import Any

from railhead.planning import effects
from railhead.planning.effects import material
from railhead.postprocess import compare
from railhead.postprocess.friction import damage
from railhead.results import checks
from railhead.results.checks import second_method
from railhead.results.result_folder import origin
from railhead.run import estimates
from railhead.run.half_spaces import Solved
from railhead.run.mesh_solution import MeshSolution
from railhead.run.references import half_space_reference, rolling_reference
from railhead.run.refinement import Ending
from railhead.scene.catalogue import portable
from railhead.theory.elastic.hertz import Ellipse

NO_SECTION = {"reason": "boundary elements know no section of bodies that end"}


def summarise(levels: list[MeshSolution], ending: Ending) -> dict[str, Any]:
    """summary.json of the last of a scene's meshes, with error estimates from all of them (rank 0).
    ending: why the sequence of meshes ended.
    """
    solved = levels[-1]
    plan, solution, found = solved.plan, solved.solution, solved.findings
    scene = plan.scene
    hertz = exact_quantities(solved)
    newton, cost, reference = solution.newton, ending.would_cost, solved.elastic_reference
    known, source = estimates.estimate(levels)
    found_friction = (solved.result or {}).get("friction", {})
    unresolved = found_friction.get("below_resolution", [])
    bound = {name: each.total for name, each in known.items() if name not in unresolved}
    reached = None
    if scene.accuracy is not None and solved.result is not None:
        reached = bool(estimates.largest_error(known, solved) <= scene.accuracy)
    half_spaces = half_space_reference.solve(solved)
    profiles, rubbed = (
        half_space_reference.half_space(solved, half_spaces),
        rolling_reference.half_space_friction(solved, half_spaces),
    )
    second = {**hertz, "allowance": {}} if plan.contact.half_space else profiles or NO_SECTION
    other = effects.overruled(plan.effects)
    beyond = all(effects.EFFECTS[name].beyond_half_spaces for name in other)
    if not beyond:
        second = {"reason": f"another problem than the scene's was chosen: {', '.join(other)}"}
    if other:
        source = f"{source}; of the problem that was chosen ({', '.join(other)})"
    judged = checks.run(solved, known, second, reached=reached)
    beside = rubbed if beyond or rubbed is None else {"scene": second}
    judged += checks.friction(solved, known, beside)
    missing = second_method.not_made(solved, judged, second, beside)
    return {
        "case": scene.name,
        "method": "finite elements",
        **origin(),
        "scene": portable(scene),
        "plan": plan.summary(),
        "result": solved.result and {**solved.result, **more(solved)},
        **({} if reference is None else {_reference_name(solved): reference.result}),
        "hertz": hertz,
        "half_space": profiles,
        **({} if rubbed is None else {"half_space_friction": rubbed}),
        "difference": None if solved.result is None else compare.difference(solved.result, hertz),
        "effects_after": {name: vars(each) for name, each in solved.after.items()},
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
            "dofs": solved.unknowns,
            "cells": solved.mesh.cells,
            "mesh_quality": solved.mesh.quality,
            "ranks": solved.mesh.mesh.comm.size,
            "newton_iterations": len(newton.history),
            "linear_iterations": sum(step.linear_iterations for step in newton.history),
            "peak_rss_MB": peak_memory(),
            "seconds": _seconds(levels),
        },
    }


def peak_memory() -> float:
    """Largest memory of this process so far, MB."""
    return 1024e-6 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _reference_name(solved: MeshSolution) -> str:
    """Key of the solution without yield and friction: "elastic" where bodies yield, else
    "frictionless".
    """
    return "elastic" if solved.residual_state is not None else "frictionless"


def more(solved: Solved) -> dict[str, Any]:
    """Entries "plastic" and "friction" (and effects on the steel) of "result" in summary.json."""
    out: dict[str, Any] = {} if solved.residual_state is None else {"plastic": _plastic(solved)}
    if solved.result is not None and (found := solved.result.get("friction")):
        plan = solved.plan
        rolling = plan.scene.rolling
        axle = {"axle": rolling.axle} if rolling.from_wheelset else {}
        stresses = damage.answers(
            solved.result,
            plan.scene.friction.coefficient,
            material.shear_yield(plan.context),
            poisson=min(plan.poisson_ratios.values()),
            rolling=rolling.prescribed,
            line=plan.contact.line,
        )
        out["friction"] = found | axle | stresses
    return out


def _plastic(solved: Solved) -> dict[str, Any]:
    """Entry "plastic" of "result" in summary.json: yield and the state after unloading."""
    scene, left, elastic = solved.plan.scene, solved.residual_state, solved.elastic_reference
    assert left is not None and elastic is not None and elastic.result is not None
    part = scene.rail if left.zone.body == "rail" else scene.wheel
    shear = material.first_yield(part) / math.sqrt(3)
    return left.summary(elastic.result["pressure"]["max_MPa"], shear)


def exact_quantities(solved: Solved) -> dict[str, Any]:
    """Quantities of exact Hertz under the load of the solution, as "result" of summary.json."""
    contact, hertz = solved.plan.contact, solved.ellipse
    angle = contact.touch.angle
    approach = (
        hertz.approach / math.cos(angle)
        if isinstance(hertz, Ellipse)
        else contact.exact_approach(hertz)
    )
    return compare.from_exact(hertz, solved.plan.poisson_ratios, angle, contact.origin, approach)


def _trace(solved: MeshSolution) -> dict[str, Any]:
    """Resolution, element size (mm), unknowns, seconds and result of one mesh."""
    return {
        "elements_per_semi_axis": solved.resolution,
        "patch_size_mm": solved.grading.size,
        "unknowns": solved.unknowns,
        "seconds": sum(solved.seconds.values()),
        "result": solved.result,
    }


def _seconds(levels: list[MeshSolution]) -> dict[str, float]:
    """Seconds of all meshes together by stage, and "total"."""
    stages = {key: sum(solved.seconds[key] for solved in levels) for key in levels[-1].seconds}
    return {**stages, "total": sum(stages.values())}
