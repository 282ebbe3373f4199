"""summary.json and checks of an answer by half-spaces."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from railhead.planning import effects
from railhead.postprocess import compare
from railhead.results import checks, summary
from railhead.results.checks import second_method, solution
from railhead.results.checks.check import DEFAULT_TOLERANCE, Check, deviation
from railhead.results.result_folder import origin
from railhead.run.half_spaces import CELLS, HalfSpaceSolution
from railhead.scene.catalogue import portable

METHOD = "half-spaces"
BODIES = "simulate finite bodies: leave out --fast, --without finite_bodies"
SOURCE = "half-spaces: what finite bodies would change, and the error of the grid"


def summarise(solved: HalfSpaceSolution) -> dict[str, Any]:
    """summary.json of a solution by half-spaces, with the keys of one by finite elements."""
    plan, scene, result = solved.plan, solved.plan.scene, solved.result
    hertz, reference = summary.exact_quantities(solved), solved.elastic_reference
    bound = {key: sum(parts.values()) for key, parts in solved.error_parts.items()}
    reached = None
    if scene.accuracy is not None and result is not None:
        reached = max(bound.values()) <= scene.accuracy
    source = SOURCE
    if other := effects.overruled(plan.effects):
        source = f"{source}; of the problem that was chosen ({', '.join(other)})"
    missing = {second_method.SECOND: "half-spaces are the answer itself"}
    return {
        "case": scene.name,
        "method": METHOD,
        **origin(),
        "scene": portable(scene),
        "plan": plan.summary(),
        "result": result and {**result, **summary.more(solved)},
        **({} if reference is None else {"frictionless": reference.result}),
        "hertz": hertz,
        "half_space": None,
        **({} if solved.friction is None else {"half_space_friction": solved.other_friction}),
        "difference": None if result is None else compare.difference(result, hertz),
        "effects_after": {name: vars(each) for name, each in solved.after.items()},
        "accuracy": {
            "asked": scene.accuracy,
            "bound": bound,
            "reached": reached,
            "reason": "half-spaces are solved once",
            "would_cost": None,
            "source": source,
            "parts": solved.error_parts,
            "levels": [],
        },
        "checks": {
            **checks.summary(list(_checks(solved, bound)), missing),
            "converged": result is not None,
            "max_penetration_mm": 0.0,
            "hertzian": None if solved.findings is None else solved.findings.hertzian,
            "shape_error": None if solved.findings is None else solved.findings.shape_error,
        },
        "newton": {"reason": solved.reason or "no finite elements", "history": []},
        "cost": {
            "dofs": 0,
            "cells": 0,
            "mesh_quality": None,
            "ranks": 1,
            "newton_iterations": 0,
            "linear_iterations": 0,
            "peak_rss_MB": summary.peak_memory(),
            "seconds": {
                **dict.fromkeys(("mesh", "assemble", "postprocess"), 0.0),
                "solve": solved.seconds,
                "total": solved.seconds,
            },
        },
    }


def _checks(solved: HalfSpaceSolution, bound: dict[str, float]) -> Iterator[Check]:
    """Checks of a solution by half-spaces. bound: error estimates by key."""
    yield solution.left_out(solved)
    yield Check(
        name="converged",
        value=math.inf if solved.result is None else 0.0,
        limit=0.0,
        source=solved.reason or "boundary elements to 1e-5 of the displacement",
        advice=BODIES,
    )
    if solved.result is None:
        return
    yield from solution.physics(solved)
    load = solved.plan.scene.load or solved.result["load_N"]
    yield Check(
        name="force_balance",
        value=deviation(solved.load, load),
        limit=solution.BALANCE_TOLERANCE,
        source="the load that the pressure carries",
        advice=BODIES,
    )
    wanted = solved.plan.scene.accuracy
    if wanted is not None:
        yield Check(
            name="accuracy",
            value=max(bound.values()),
            limit=wanted,
            source="asked",
            advice=BODIES,
        )
    if solved.findings is None or solved.plan.contact.half_space:
        return
    yield Check(
        name="edge_distance",
        value=solved.findings.edge_distance,
        limit=2 / CELLS,
        source="one cell, over the smaller half length: at an edge the pressure has no bound",
        advice="move the wheel",
        at_least=True,
    )
    yield Check(
        name="grid_error",
        value=max(parts.get("grid", 0.0) for parts in solved.error_parts.values()),
        limit=DEFAULT_TOLERANCE,
        source="the change from a grid of half as many cells each way",
        advice=BODIES,
    )
