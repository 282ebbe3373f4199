"""summary.json: the contract with everyone who reads results."""

from __future__ import annotations

import math
import resource
from typing import Any

import numpy as np

from meshing.surfaces import ExactGap
from postprocess import compare
from railhead import forecast
from railhead.flat import FlatContact
from railhead.level import Level
from theory.hertz import Ellipse

BOUNDARY_CELLS = 128
FORCE_BALANCE = 1e-6  # largest relative force imbalance that passes


def summarise(
    levels: list[Level],
    bound: dict[str, float],
    reason: str,
    would_cost: tuple[int, float] | None,
) -> dict[str, Any]:
    """The summary of the last level (rank 0), with the bounds that the sequence gave."""
    level = levels[-1]
    plan, solution, found = level.plan, level.solution, level.findings
    scene, angle, poisson = plan.scene, plan.contact.touch.angle, plan.poisson_ratios
    ellipse, contact = level.ellipse, plan.contact
    thesis = None
    if isinstance(ellipse, Ellipse):
        hertz = compare.from_hertz(ellipse, poisson, angle, contact.origin)
        thesis = compare.from_thesis(ellipse, poisson)
    else:
        approach = contact.approach(ellipse) if isinstance(contact, FlatContact) else None
        hertz = compare.from_line(ellipse, poisson, angle, contact.origin, approach)
    target = scene.load if scene.load is not None else solution.reaction
    balance = max(
        abs(solution.load - target) / target if target else math.inf,
        abs(solution.reaction - solution.load) / solution.load if solution.load else math.inf,
    )
    newton = solution.newton
    converged = newton.converged and found is not None
    reached = None
    if scene.accuracy is not None:
        reached = bool(bound) and max(bound.values()) <= scene.accuracy
    return {
        "case": scene.name,
        "scene": scene.model_dump(exclude_none=True),
        "plan": plan.summary(),
        "result": level.result,
        "hertz": hertz,
        "thesis": thesis,
        "half_space": _half_space(level),
        "difference": None if level.result is None else compare.difference(level.result, hertz),
        "effects_after": {name: vars(each) for name, each in level.after.items()},
        "accuracy": {
            "asked": scene.accuracy,
            "bound": bound,
            "reached": reached,
            "reason": reason,
            "would_cost": would_cost and {"unknowns": would_cost[0], "seconds": would_cost[1]},
            "parts": _parts(level, bound),
            "levels": [_trace(each) for each in levels],
        },
        "checks": {
            "force_balance": balance,
            "max_penetration_mm": solution.penetration,
            "converged": converged,
            "hertzian": None if found is None else found.hertzian,
            "shape_error": None if found is None else found.shape_error,
            "passed": converged and balance < FORCE_BALANCE and reached is not False,
        },
        "newton": {"reason": newton.reason, "history": [vars(step) for step in newton.history]},
        "cost": {
            "dofs": level.unknowns,
            "cells": level.mesh.cells,
            "mesh_quality": level.mesh.quality,
            "ranks": level.ranks,
            "newton_iterations": len(newton.history),
            "linear_iterations": sum(step.linear_iterations for step in newton.history),
            "peak_rss_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
            "seconds": _seconds(levels),
        },
    }


def _parts(level: Level, bound: dict[str, float]) -> dict[str, float]:
    """Where the error comes from, relative: the mesh (the bound), the contact law (overlap over
    approach; Nitsche's method is consistent, so it is part of the mesh's), Newton's residual,
    the geometry (contact points off the exact surface, over the smaller semi-axis), and what the
    plan left out (part of the bound)."""
    solution, law = level.solution, level.plan.scene.solver.method
    size = min(level.plan.zone)
    left_out = level.plan.left_out
    return {
        "discretisation": max(bound.values(), default=0.0) - (left_out if bound else 0.0),
        "left_out": left_out,
        "contact_law": abs(solution.penetration / solution.approach) if law == "penalty" else 0.0,
        "newton": solution.newton.history[-1].residual,
        "geometry": _off_surface(level) / size,
    }


def _half_space(level: Level) -> dict[str, Any] | None:
    """Boundary elements on the real profiles; None for half-spaces, where Hertz is exact."""
    contact, ellipse = level.plan.contact, level.ellipse
    if contact.half_space or level.findings is None or not isinstance(ellipse, Ellipse):
        return None
    try:
        found = forecast.solve(contact, ellipse, level.solution.load, BOUNDARY_CELLS)
    except ValueError:  # no closed patch within the profiles
        return None
    planes = [(touch.angle, patch) for touch, patch in found]
    return compare.from_half_space(planes, level.findings.hertzian)


def _off_surface(level: Level) -> float:
    """Largest distance in z of touching contact points from the exact surface, mm."""
    gap = level.plan.surfaces.gap(level.plan.slave)
    if level.fields is None or not isinstance(gap, ExactGap):
        return 0.0
    contact = level.fields.contact
    touching = contact.points[contact.pressure > 0]
    return float(np.max(gap.off_surface(touching), initial=0.0))


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
