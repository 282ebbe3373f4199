"""Effects of traction on the steel: largest stress, wear regime, point in the shakedown map."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from railhead.theory.friction import shakedown, wear

AT_SURFACE = 0.1  # of the smaller half length of the patch: what lies less deep is at the surface


def answers(
    result: Mapping[str, Any],
    coefficient: float,
    shear_yield: float | None,
    *,
    poisson: float,
    rolling: bool,
    line: bool,
) -> dict[str, Any]:
    """Wear regime and state in the shakedown map, as entries of "friction" in summary.json.

    result: the summary's "result", with its "friction". coefficient: of friction. shear_yield:
        yield stress in shear k, MPa, or None. poisson: Poisson's ratio. rolling: whether the wheel
        rolls. line: whether the contact is a line.

    Always: the largest von Mises stress, its depth, and whether its place is at the 'surface' or
        'below', that is deeper than AT_SURFACE of the smaller half length.
    Rolling: T-gamma, the energy dissipated per rolled length, over the area, with its wear regime;
        traction_coefficient, tangential over normal force; first_yield_p0_over_k, the largest
        pressure p0 over k at which this patch begins to yield; shakedown_limit_p0_over_k. The limit
        is the smaller of two: that of a line that rolls with this share of the friction
        coefficient, and that of a surface that slips everywhere at the largest traction over p0;
        for a line, that at which the largest traction is k.
    With k: p0_over_k; surface_fatigue_index, (largest traction - k) / p0; and the state 'elastic',
        'shakes down', 'ratchets', or 'open' where a patch that is no line is above this limit only.
    """
    forces, patch, stress = result["friction"], result["patch"], result["stress"]
    pressure, hardest = result["pressure"]["max_MPa"], stress["von_mises_max_MPa"]
    depth = abs(stress["von_mises_max_depth_mm"])
    near = depth < AT_SURFACE * min(patch["a_mm"], patch["b_mm"])
    out = {
        "von_mises_max_MPa": hardest,
        "von_mises_max_depth_mm": depth,
        "von_mises_max_at": "surface" if near else "below",
    }
    if not rolling:
        return out
    normal = forces["limit_N"] / coefficient
    used = math.hypot(forces["force_along_N"], forces["force_across_N"]) / normal
    first, local = math.sqrt(3) * pressure / hardest, forces["traction_max_MPa"] / pressure
    surface = 1 / local if line else shakedown.surface_limit(local, poisson)
    limit = min(shakedown.shakedown_limit(coefficient, poisson, used), surface)
    density = forces["t_gamma_N"] / patch["area_mm2"]
    out |= {
        "t_gamma_over_area_MPa": density,
        "wear_regime": wear.regime(density, wear.TWIN_DISC),
        "traction_coefficient": used,
        "first_yield_p0_over_k": first,
        "shakedown_limit_p0_over_k": limit,
    }
    if shear_yield is None:
        return out
    ratio = pressure / shear_yield
    index = shakedown.surface_fatigue_index(forces["traction_max_MPa"], pressure, shear_yield)
    if ratio <= first:
        state = "elastic"
    elif ratio <= limit:
        state = "shakes down"
    else:
        state = "ratchets" if line or index > 0 or ratio > shakedown.CIRCLE else "open"
    return out | {
        "shear_yield_MPa": shear_yield,
        "p0_over_k": ratio,
        "surface_fatigue_index": index,
        "shakedown": state,
    }
