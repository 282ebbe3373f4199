"""The same quantities from the finite elements, from exact Hertz and from the thesis's formulas."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from postprocess import extremes
from postprocess.findings import DepthAxis, Findings, Frame, OnePatch, Place
from theory import thesis
from theory.boundary_element import PatchSolution
from theory.hertz import Ellipse
from theory.line import LineContact

Quantities = dict[str, Any]
"""Nested as under "result" in summary.json; None where a route has no answer."""


def from_findings(found: Findings, load: float, approach: float) -> Quantities:
    """Finite-element result. load N, approach mm (of the hub, along the load)."""
    axis, patch = found.axis, found.patch
    below = [axis, *found.also][: len(patch.each)]
    return {
        "load_N": load,
        "approach_mm": approach,
        "contact_point_mm": list(found.frame.place(*patch.centre)),
        "patch": {"a_mm": patch.a, "b_mm": patch.b, "area_mm2": patch.area},
        "patches": [_one(*each) for each in zip(patch.each, below, strict=True)],
        "pressure": {"max_MPa": patch.max_pressure, "mean_MPa": patch.mean_pressure},
        "stress": {
            **extremes.quantities(found.largest, extremes.below(axis), axis.stress[0, :3]),
            "at_edges": extremes.at_edges(found.largest),
        },
    }


def _one(patch: OnePatch, axis: DepthAxis) -> Quantities:
    """One of the separate patches, with the stresses on the axis below it."""
    return {
        "centre_mm": list(patch.centre),
        "contact_angle_rad": patch.angle,
        "a_mm": patch.a,
        "b_mm": patch.b,
        "area_mm2": patch.area,
        "max_MPa": patch.max_pressure,
        "load_share": patch.share,
        "stress": extremes.below(axis),
    }


def from_hertz(
    ellipse: Ellipse, poisson: Mapping[str, float], angle: float, origin: Place
) -> Quantities:
    """Exact Hertz. poisson: by body, the one whose axis is shown first; angle: contact angle in
    rad, which tilts load and approach from the normal."""
    cosine = math.cos(angle)
    return {
        "load_N": ellipse.load * cosine,
        "approach_mm": ellipse.approach / cosine,
        "contact_point_mm": list(origin),
        "patch": {"a_mm": ellipse.a, "b_mm": ellipse.b, "area_mm2": ellipse.area},
        "pressure": {"max_MPa": ellipse.p0, "mean_MPa": ellipse.p_mean},
        "stress": extremes.exact(ellipse, poisson, Frame(origin, angle)),
    }


def from_line(
    contact: LineContact,
    poisson: Mapping[str, float],
    angle: float,
    origin: Place,
    approach: float | None,
) -> Quantities:
    """Exact line contact; approach: mm, along the load, of the bodies' supports, if it is known."""
    return {
        "load_N": contact.load * math.cos(angle),
        "approach_mm": approach,
        "contact_point_mm": list(origin),
        "patch": {"a_mm": contact.a, "b_mm": contact.b, "area_mm2": contact.area},
        "pressure": {"max_MPa": contact.p0, "mean_MPa": contact.p_mean},
        "stress": extremes.exact(contact, poisson, Frame(origin, angle)),
    }


def from_half_space(found: Sequence[tuple[float, PatchSolution]], hertzian: bool) -> Quantities:
    """Boundary elements on the exact gap: the profiles' answer if the bodies were half-spaces.

    found: contact angle (rad) and solution in each tangent plane, the first contact's first.
    Semi-axes from moments where the patch is an ellipse, else half the extents in the first plane.
    """
    angle, first = found[0]
    a, b = first.semi_axes if hertzian else first.half_extents
    area = sum(patch.area for _, patch in found)
    return {
        "load_N": sum(patch.load * math.cos(angle) for angle, patch in found),
        "approach_mm": first.approach / math.cos(angle),
        "patch": {"a_mm": a, "b_mm": b, "area_mm2": area},
        "pressure": {
            "max_MPa": max(patch.max_pressure for _, patch in found),
            "mean_MPa": sum(patch.load for _, patch in found) / area,
        },
    }


def from_thesis(ellipse: Ellipse, poisson: Mapping[str, float]) -> Quantities:
    """The thesis's route: interpolated m and n, then circular stress formulas with radius a."""
    route = thesis.thesis_contact(
        (ellipse.curvature_x, ellipse.curvature_y), (0.0, 0.0),
        ellipse.contact_modulus, ellipse.load,
    )  # fmt: skip
    area = math.pi * route.a * route.b
    return {
        "load_N": ellipse.load,
        "approach_mm": None,
        "contact_point_mm": None,
        "patch": {"a_mm": route.a, "b_mm": route.b, "area_mm2": area},
        "pressure": {"max_MPa": route.p0, "mean_MPa": ellipse.load / area},
        "stress": extremes.of_thesis(route, poisson),
    }


def difference(result: Any, exact: Any) -> Any:
    """(result - exact) / exact, nested alike; None where there is none, as of words."""
    if isinstance(result, dict):
        return {key: difference(value, exact[key]) for key, value in result.items() if key in exact}
    if isinstance(result, list):
        return [difference(a, b) for a, b in zip(result, exact, strict=True)]
    if result is None or exact is None or isinstance(result, str) or exact == 0:
        return None
    return (result - exact) / exact
