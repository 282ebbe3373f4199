"""The same quantities of what was found, by finite elements or half-spaces, and of exact Hertz."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from railhead.postprocess.findings import (
    Array,
    DepthAxis,
    Findings,
    Frame,
    Largest,
    Peak,
    Place,
)
from railhead.theory.elastic.line import Hertz
from railhead.theory.elastic.subsurface import EllipsoidalPressure

PLACES = ("_point_mm", "_place_mm")  # ends of names of coordinates
NAMES = {"tau": "tau_max", "von_mises": "von_mises_max"}


Quantities = dict[str, Any]
"""Nested as under "result" in summary.json; None where a route has no answer."""


def from_findings(found: Findings, load: float, approach: float) -> Quantities:
    """Quantities of a result, nested and named as under "result" in summary.json: load, approach,
    contact point, extents, pressures and, where they were read, stresses.

    load: vertical load on the wheel, N, which at an inclined contact is not the normal force.
        approach: of the hub, or of half-spaces, along the load, mm.
    """
    patch, stress = found.patch, {}
    below: Sequence[DepthAxis | None] = [None] * len(patch.each)
    if found.largest:
        shown = found.axis
        below = [shown, *found.also][: len(patch.each)]
        stress["stress"] = {
            **_largest_stresses(
                found.largest, _largest_in(shown.body, shown.largest), shown.stress[0, :3]
            ),
            "at_edges": [
                {
                    "quantity": f"{name}_MPa",
                    "body": body,
                    "value_MPa": peak.value,
                    "place_mm": peak.place,
                }
                for body, each in found.largest.items()
                for name, peak in zip(NAMES.values(), each.edges, strict=True)
                if peak is not None
            ],
        }
    return {
        "load_N": load,
        "approach_mm": approach,
        "contact_point_mm": list(found.frame.place(*patch.centre)),
        "patch": {"a_mm": patch.a, "b_mm": patch.b, "area_mm2": patch.area},
        "patches": [
            {
                "centre_mm": list(one.centre),
                "contact_angle_rad": one.angle,
                "a_mm": one.a,
                "b_mm": one.b,
                "area_mm2": one.area,
                "max_MPa": one.max_pressure,
                "load_share": one.share,
                **({"stress": _largest_in(axis.body, axis.largest)} if axis else {}),
            }
            for one, axis in zip(patch.each, below, strict=True)
        ],
        "pressure": {"max_MPa": patch.max_pressure, "mean_MPa": patch.mean_pressure},
        **stress,
    }


def from_exact(
    contact: Hertz,
    poisson: Mapping[str, float],
    angle: float,
    origin: Place,
    approach: float | None,
) -> Quantities:
    """Quantities of Hertz's exact solution for a point or a line contact, nested and named as under
    "result" in summary.json.

    contact: under the normal force. poisson: Poisson's ratio by body name; the axis of the first
        body is shown. Empty: without stresses. angle: contact angle, rad; the load in the result is
        the vertical part of the normal force. origin: contact point, mm. approach: of the supports
        of the bodies along the load, mm, or None where it is not known.
    """
    return {
        "load_N": contact.load * math.cos(angle),
        "approach_mm": approach,
        "contact_point_mm": list(origin),
        "patch": {"a_mm": contact.a, "b_mm": contact.b, "area_mm2": contact.area},
        "pressure": {"max_MPa": contact.p0, "mean_MPa": contact.p_mean},
        **({"stress": _exact_stresses(contact, poisson, Frame(origin, angle))} if poisson else {}),
    }


def difference(result: Any, exact: Any) -> Any:
    """Relative difference (result - exact) / exact of each number, nested like `result`.

    A difference is None for words and for coordinates (keys that end in _point_mm or _place_mm),
    and where a number is missing or the exact one is zero. Keys that `exact` lacks are left out.
    ValueError: lists of different lengths.
    """
    if isinstance(result, dict):
        return {
            key: None if key.endswith(PLACES) else difference(value, exact[key])
            for key, value in result.items()
            if key in exact
        }
    if isinstance(result, list):
        return [difference(a, b) for a, b in zip(result, exact, strict=True)]
    if result is None or exact is None or isinstance(result, str) or exact == 0:
        return None
    return (result - exact) / exact


def _largest_stresses(
    bodies: Mapping[str, Largest], axis: dict[str, Any], centre: Array
) -> dict[str, Any]:
    """Entries of "stress" in summary.json: for each kind of stress the larger value of both bodies,
    with its depth, body and place.

    bodies: largest stresses by body name. axis: the entry for the axis below the patch. centre
        (3,): normal stresses xx, ss, nn at the centre of the patch, MPa.
    """
    values: dict[str, Any] = {}
    for attribute, name in NAMES.items():
        peaks: dict[str, Peak] = {body: getattr(each, attribute) for body, each in bodies.items()}
        body = max(peaks, key=lambda body: peaks[body].value)
        values[f"{name}_MPa"] = peaks[body].value
        values[f"{name}_depth_mm"] = peaks[body].depth
        values[f"{name}_body"] = body
        values[f"{name}_place_mm"] = list(peaks[body].place)
    return {**values, "axis": axis, "surface_centre_MPa": [float(v) for v in centre]}


def _largest_in(body: str, largest: Largest) -> dict[str, Any]:
    """Entry of summary.json for largest stresses: body, values in MPa, and depths in mm."""
    values: dict[str, Any] = {"body": body}
    for attribute, name in NAMES.items():
        peak: Peak = getattr(largest, attribute)
        values[f"{name}_MPa"], values[f"{name}_depth_mm"] = peak.value, peak.depth
    return values


def _exact_stresses(contact: Hertz, poisson: Mapping[str, float], frame: Frame) -> dict[str, Any]:
    """Entries of "stress" in summary.json for an exact Hertz contact: for each kind of stress the
    larger of both bodies with its depth, body and place; "axis" and the centre of the surface are
    those of the first body.

    poisson: Poisson's ratio by body name. frame: contact frame. Largest stresses lie on the axis:
        for no axis ratio from 1 to 1/30, nor a strip, and no Poisson's ratio from 0 to 0.4999, does
        a fine grid beside the axis have more.
    """
    bodies = {body: exact_largest(contact, body, nu, frame) for body, nu in poisson.items()}
    shown, nu = next(iter(poisson.items()))
    surface = contact.axis_stress(nu, 0.0)[0]
    return _largest_stresses(bodies, _largest_in(shown, bodies[shown]), surface)


def exact_largest(
    contact: Hertz | EllipsoidalPressure, body: str, poisson: float, frame: Frame
) -> Largest:
    """Largest shear and von Mises stress of an exact Hertz contact, on the axis in the body with
    this name and Poisson's ratio. frame: axes at the centre of the patch, for places in space.
    """
    found, up = contact.axis_extrema(poisson), -1.0 if body == "rail" else 1.0
    tau, mises = (
        Peak(value, depth, frame.place(0.0, 0.0, up * depth))
        for value, depth in (
            (found.tau_max, found.tau_max_depth),
            (found.von_mises_max, found.von_mises_max_depth),
        )
    )
    return Largest(tau, mises)
