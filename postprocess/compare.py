"""The same quantities from the finite elements, from exact Hertz and from the thesis's formulas."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from postprocess.findings import Array, DepthAxis, Findings, OnePatch
from postprocess.parts import SMALLEST
from theory import line, subsurface, thesis
from theory.boundary_element import Solution
from theory.half_space_patch import PatchSolution
from theory.hertz import Ellipse
from theory.line import LineContact

Quantities = dict[str, Any]
"""Nested as under "result" in summary.json; None where a route has no answer."""


def from_findings(found: Findings, load: float, approach: float) -> Quantities:
    """Finite-element result. load N, approach mm (of the hub, along the load)."""
    axis = found.axis
    patch = found.patch
    x, s = patch.centre
    point = np.array(found.frame.origin) + np.array([x, s, 0.0]) @ found.frame.axes
    tau_depth, tau = axis.peak(subsurface.max_shear(axis.stress))
    mises_depth, mises = axis.peak(subsurface.von_mises(axis.stress))
    return {
        "load_N": load,
        "approach_mm": approach,
        "contact_point_mm": [float(v) for v in point],
        "patch": {"a_mm": patch.a, "b_mm": patch.b, "area_mm2": patch.area},
        "patches": [_one(each) for each in patch.each],
        "pressure": {"max_MPa": patch.max_pressure, "mean_MPa": patch.mean_pressure},
        "stress": {
            "tau_max_MPa": tau,
            "tau_max_depth_mm": tau_depth,
            "von_mises_max_MPa": mises,
            "von_mises_max_depth_mm": mises_depth,
            "surface_centre_MPa": [float(v) for v in axis.stress[0, :3]],
        },
    }


def _one(patch: OnePatch) -> Quantities:
    """One of the separate patches."""
    return {
        "centre_mm": list(patch.centre),
        "contact_angle_rad": patch.angle,
        "a_mm": patch.a,
        "b_mm": patch.b,
        "area_mm2": patch.area,
        "max_MPa": patch.max_pressure,
        "load_share": patch.share,
    }


def from_hertz(
    ellipse: Ellipse, poisson: float, angle: float, origin: tuple[float, float, float]
) -> Quantities:
    """Exact Hertz. angle: contact angle in rad, which tilts load and approach from the normal."""
    extrema = subsurface.axis_extrema(ellipse, poisson)
    cosine = math.cos(angle)
    return {
        "load_N": ellipse.load * cosine,
        "approach_mm": ellipse.approach / cosine,
        "contact_point_mm": list(origin),
        "patch": {"a_mm": ellipse.a, "b_mm": ellipse.b, "area_mm2": ellipse.area},
        "pressure": {"max_MPa": ellipse.p0, "mean_MPa": ellipse.p_mean},
        "stress": {
            "tau_max_MPa": extrema.tau_max,
            "tau_max_depth_mm": extrema.tau_max_depth,
            "von_mises_max_MPa": extrema.von_mises_max,
            "von_mises_max_depth_mm": extrema.von_mises_max_depth,
            "surface_centre_MPa": [
                float(v) for v in subsurface.surface_centre_stress(ellipse, poisson)
            ],
        },
    }


def from_line(
    contact: LineContact,
    poisson: float,
    angle: float,
    origin: tuple[float, float, float],
    approach: float | None,
) -> Quantities:
    """Exact line contact; approach: mm, along the load, of the bodies' supports, if it is known."""
    extrema = line.axis_extrema(contact, poisson)
    return {
        "load_N": contact.load * math.cos(angle),
        "approach_mm": approach,
        "contact_point_mm": list(origin),
        "patch": {"a_mm": contact.a, "b_mm": contact.b, "area_mm2": contact.area},
        "pressure": {"max_MPa": contact.p0, "mean_MPa": contact.p_mean},
        "stress": {
            "tau_max_MPa": extrema.tau_max,
            "tau_max_depth_mm": extrema.tau_max_depth,
            "von_mises_max_MPa": extrema.von_mises_max,
            "von_mises_max_depth_mm": extrema.von_mises_max_depth,
            "surface_centre_MPa": [float(v) for v in line.axis_stress(contact, poisson, 0.0)[0]],
        },
    }


def from_half_space(
    solution: Solution,
    surface: Callable[[Array, Array], Array],
    plane: float,
    *,
    hertzian: bool,
) -> Quantities:
    """Boundary elements on the exact gap: the profiles' answer if the bodies were half-spaces.

    surface maps x, s (n,) to points (n, 3), mm; plane: contact angle of first contact, rad, on
    whose tangent plane a single patch is measured. Of several, the areas are those on their own
    tangent planes, a and b those of the most loaded one. Semi-axes are from moments where the
    patch is an ellipse, else half the extents. grid_error: relative change from 64 cells an axis.
    """
    area = _areas(solution, plane)
    patches = solution.patches
    several = len(patches) > 1
    main = patches[0]
    a, b = main.half_extents_on(main.plane if several else plane)
    if hertzian and not several:
        a, b = main.semi_axes
    quantities: Quantities = {
        "load_N": solution.load,
        "approach_mm": solution.approach,
        "patch": {"a_mm": a, "b_mm": b, "area_mm2": area},
        "patches": [
            _half_space_patch(patch, surface, solution.force)
            for patch in patches
            if patch.force > SMALLEST * solution.force
        ],
        "pressure": {"max_MPa": solution.max_pressure, "mean_MPa": solution.force / area},
    }
    if coarse := solution.coarse:
        quantities["grid_error"] = {
            "max_MPa": abs(coarse.max_pressure / solution.max_pressure - 1),
            "area_mm2": abs(_areas(coarse, plane) / area - 1),
        }
    return quantities


def _areas(solution: Solution, plane: float) -> float:
    """Area (mm2) of a single patch on a plane, of several each on its own."""
    patches = solution.patches
    return patches[0].area_on(plane) if len(patches) == 1 else solution.area


def _half_space_patch(
    patch: PatchSolution, surface: Callable[[Array, Array], Array], force: float
) -> Quantities:
    x, s = patch.centroid
    a, b = patch.half_extents_on(patch.plane)
    return {
        "centre_mm": [float(v) for v in surface(np.array([x]), np.array([s]))[0]],
        "contact_angle_rad": patch.plane,
        "a_mm": a,
        "b_mm": b,
        "area_mm2": patch.area,
        "max_MPa": patch.max_pressure,
        "load_share": patch.force / force,
    }


def from_thesis(ellipse: Ellipse, poisson: float) -> Quantities:
    """The thesis's route: interpolated m and n, then circular stress formulas with radius a."""
    route = thesis.thesis_contact(
        (ellipse.curvature_x, ellipse.curvature_y), (0.0, 0.0),
        ellipse.contact_modulus, ellipse.load,
    )  # fmt: skip
    depth = np.linspace(0.0, 3 * min(route.a, route.b), 301)
    normal = thesis.thesis_axis_stress(route.p0, route.a, poisson, depth)
    stress = np.column_stack([normal, np.zeros_like(normal)])
    axis = DepthAxis("half-space", depth, stress)
    tau_depth, tau = axis.peak(subsurface.max_shear(stress))
    mises_depth, mises = axis.peak(subsurface.von_mises(stress))
    area = math.pi * route.a * route.b
    return {
        "load_N": ellipse.load,
        "approach_mm": None,
        "contact_point_mm": None,
        "patch": {"a_mm": route.a, "b_mm": route.b, "area_mm2": area},
        "pressure": {"max_MPa": route.p0, "mean_MPa": ellipse.load / area},
        "stress": {
            "tau_max_MPa": tau,
            "tau_max_depth_mm": tau_depth,
            "von_mises_max_MPa": mises,
            "von_mises_max_depth_mm": mises_depth,
            "surface_centre_MPa": [float(v) for v in normal[0]],
        },
    }


def difference(result: Any, exact: Any) -> Any:
    """(result - exact) / exact, nested alike; None where it does not exist."""
    if isinstance(result, dict):
        return {key: difference(value, exact[key]) for key, value in result.items() if key in exact}
    if isinstance(result, list):
        return [difference(a, b) for a, b in zip(result, exact, strict=True)]
    if result is None or exact is None or exact == 0:
        return None
    return (result - exact) / exact
