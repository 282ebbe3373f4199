"""What is said of a plan, as plain data: the printed plan and `railhead plan --json` show it."""

from __future__ import annotations

import math
from typing import Any

from railhead.planning.cost.price import price
from railhead.planning.plan import Plan

PRICES = (0.05, 0.01, 0.002)


def told(plan: Plan) -> dict[str, Any]:
    """The scene, "plan" as in summary.json, and what it rests on; lengths mm, angles rad, MPa."""
    scene, touch, ellipse = plan.scene, plan.contact.touch, plan.estimate
    along, across = (
        1 / curvature if curvature else math.inf
        for curvature in (touch.curvature_x, touch.curvature_y)
    )
    return {
        "case": scene.name,
        "scene": scene.model_dump(exclude_none=True),
        "plan": plan.summary(),
        "contact": {
            "y_mm": touch.y,
            "z_mm": touch.z,
            "angle_rad": touch.angle,
            "relative_radius_along_mm": along,
            "relative_radius_across_mm": across,
        },
        "hertz": {"a_mm": ellipse.a, "b_mm": ellipse.b, "p0_MPa": ellipse.p0},
        "patches": [
            {"centre_mm": list(zone.centre), "a_mm": zone.a, "b_mm": zone.b}
            for zone in plan.forecast.zones
        ],
        "mesh": {"cell": scene.mesh.cell, "order": plan.order, "patch_size_mm": plan.patch_size},
        "solver": {"method": scene.solver.method, "linear": scene.solver.linear},
        "prices": prices(plan),
    }


def prices(plan: Plan) -> list[dict[str, Any]] | None:
    """What accuracies cost on this machine: patch size, unknowns, seconds and memory, None where
    one is out of reach; None where no family is calibrated."""
    asked, family = plan.scene.accuracy, plan.family
    if family is None:
        return None
    rows = []
    for value in sorted({*PRICES, *([asked] if asked else [])}, reverse=True):
        row = dict.fromkeys(("patch_size_mm", "unknowns", "seconds", "memory_MB"))
        if plan.hidden < value and family.reaches(value - plan.left_out):
            n = family.finest(value - plan.left_out)
            unknowns, seconds, memory = price(plan, n)
            row = {
                "patch_size_mm": plan.at_resolution(n).patch_size,
                "unknowns": unknowns,
                "seconds": seconds,
                "memory_MB": memory / 1e6,
            }
        rows.append({"accuracy": value, **row})
    return rows
