"""Largest stresses as under "stress" in summary.json: of both bodies, and on the axis of one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from railhead.postprocess.findings import Array, DepthAxis, Frame, Largest, Peak
from railhead.theory.elastic import contacts
from railhead.theory.elastic.contacts import Hertz

NAMES = {"tau": "tau_max", "von_mises": "von_mises_max"}


def quantities(
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
        place = peaks[body].place
        values[f"{name}_place_mm"] = None if place is None else list(place)
    return {**values, "axis": axis, "surface_centre_MPa": [float(v) for v in centre]}


def below(axis: DepthAxis) -> dict[str, Any]:
    """Entry of summary.json with the largest shear and von Mises stress on the axis below a patch:
    body, values in MPa, depths in mm.
    """
    return _below(axis.body, axis.largest)


def _below(body: str, largest: Largest) -> dict[str, Any]:
    """Entry of summary.json for largest stresses: body, values in MPa, and depths in mm."""
    values: dict[str, Any] = {"body": body}
    for attribute, name in NAMES.items():
        peak: Peak = getattr(largest, attribute)
        values[f"{name}_MPa"], values[f"{name}_depth_mm"] = peak.value, peak.depth
    return values


def at_edges(bodies: Mapping[str, Largest]) -> list[dict[str, Any]]:
    """Entries of summary.json for stresses near sharp edges that exceed those elsewhere: quantity,
    body, value (MPa), place (mm).
    """
    return [
        {"quantity": f"{name}_MPa", "body": body, "value_MPa": peak.value, "place_mm": peak.place}
        for body, each in bodies.items()
        for name, peak in zip(NAMES.values(), each.edges, strict=True)
        if peak is not None
    ]


def exact(contact: Hertz, poisson: Mapping[str, float], frame: Frame) -> dict[str, Any]:
    """Entries of "stress" in summary.json for an exact Hertz contact.

    poisson: Poisson's ratio by body name; the axis of the first body is shown. frame: contact
        frame. Largest stresses lie on the axis: for no axis ratio from 1 to 1/30, nor a strip, and
        no Poisson's ratio from 0 to 0.4999, does a fine grid beside the axis have more.
    """
    bodies = {body: exact_largest(contact, body, nu, frame) for body, nu in poisson.items()}
    shown, nu = next(iter(poisson.items()))
    surface = contacts.axis_stress(contact, nu, 0.0)[0]
    return quantities(bodies, _below(shown, bodies[shown]), surface)


def exact_largest(contact: Hertz, body: str, poisson: float, frame: Frame) -> Largest:
    """Largest shear and von Mises stress of an exact Hertz contact, on the axis in the body with
    this name and Poisson's ratio.
    """
    found = contacts.axis_extrema(contact, poisson)
    tau, mises = (
        Peak(value, depth, frame.below(0.0, 0.0, body, depth))
        for value, depth in (
            (found.tau_max, found.tau_max_depth),
            (found.von_mises_max, found.von_mises_max_depth),
        )
    )
    return Largest(tau, mises)
