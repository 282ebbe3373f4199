"""Stresses inside the bodies: on the axes below the patches, and the largest anywhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from railhead.meshing.tags import BODY_NAMES
from railhead.postprocess.findings import Array, DepthAxis, Frame, Largest, Peak
from railhead.postprocess.patch.separate_patches import SeparatePatch
from railhead.postprocess.stress import stick_border
from railhead.postprocess.stress.gauss_points import COLUMN, ROW
from railhead.postprocess.stress.peaks import Search
from railhead.postprocess.stress.recovery import Recovery
from railhead.postprocess.stress.solid import Solid
from railhead.solver.fields import Fields
from railhead.solver.solution import FrictionSolution
from railhead.theory.elastic.subsurface import max_shear, von_mises

SAMPLES = 121
REACH = 3.0  # over the smaller semi-axis
Found = tuple[dict[str, DepthAxis], tuple[DepthAxis, ...], dict[str, Largest], Array, float]


def read(
    fields: Fields,
    frame: Frame,
    centre: tuple[float, float],
    size: float,
    others: list[SeparatePatch],
    rubbing: FrictionSolution | None,
) -> Found:
    """By meshed body the stresses below (x, s) = centre and the largest ones; between them, in the
    body that is shown, those below the centres of the other patches; points (n, 3) on the sharp
    edges of all bodies; and how far the smooth stresses around the largest ones are from those of
    the elements (`Recovery.misfit`).

    size: smaller semi-axis of the (most loaded) patch, mm. rubbing: with friction, whose border of
    stick (`stick_border`) is read by itself.
    """
    bodies = {}
    for tag, name in BODY_NAMES.items():
        cells = np.flatnonzero(fields.body == tag)
        if len(cells):
            bodies[name] = Solid(fields, cells), Recovery(fields, cells)
    axes = {name: _below(*body, frame, centre, name, size * REACH) for name, body in bodies.items()}
    shown = next(iter(bodies))
    also = tuple(
        _below(*bodies[shown], part.frame, (0.0, 0.0), shown, min(part.a, part.b) * REACH)
        for part in others
    )
    edges = np.concatenate([solid.sharp_edges() for solid, _ in bodies.values()])
    largest = {
        name: _largest(Search(fields, *body, edges, size), axes[name])
        for name, body in bodies.items()
    }
    if rubbing is not None:
        largest = {
            name: _or_border(each, *stick_border.stresses(fields, *bodies[name], rubbing))
            for name, each in largest.items()
        }
    places = [
        (name, peak.place)
        for name, each in largest.items()
        for peak in (each.tau, each.von_mises)
        if peak.place
    ]
    misfit = max((bodies[name][1].misfit(np.array(at)) for name, at in places), default=0.0)
    return axes, also, largest, edges, misfit


def _below(
    solid: Solid, recovery: Recovery, frame: Frame, centre: tuple[float, float], name: str,
    reach: float,
) -> DepthAxis:  # fmt: skip
    """Stress on the axis below a point of the tangent plane, as deep as the body goes."""
    start, into = frame.place(*centre), frame.axes[2] * (-1.0 if name == "rail" else 1.0)
    depth = np.linspace(0.0, solid.extent(np.array(start), into, reach), SAMPLES, dtype=np.float64)
    stress = recovery.at(start + depth[:, None] * into)
    tensor = np.zeros((len(depth), 3, 3))
    tensor[:, ROW, COLUMN] = tensor[:, COLUMN, ROW] = stress
    stress = (frame.axes @ tensor @ frame.axes.T)[:, ROW, COLUMN]
    return DepthAxis(name, depth, stress, (start, (float(into[0]), float(into[1]), float(into[2]))))


def _largest(search: Search, axis: DepthAxis) -> Largest:
    """The largest of both stresses in one body, on its axis if the body is nothing but edges."""
    spare = axis.largest
    tau = search.highest(max_shear, _place(spare.tau)) or spare.tau
    mises = search.highest(von_mises, _place(spare.von_mises)) or spare.von_mises
    edges = search.at_edges(max_shear, tau.value), search.at_edges(von_mises, mises.value)
    return Largest(tau, mises, edges)


def _or_border(largest: Largest, places: Array, stress: Array) -> Largest:
    """The same, or the largest at the border of stick (places (n, 3), stress (n, 6)) if higher."""

    def higher(peak: Peak, values: Array) -> Peak:
        if values.max(initial=0.0) <= peak.value:
            return peak
        x, y, z = (float(each) for each in places[np.argmax(values)])
        return Peak(float(values.max()), 0.0, (x, y, z))

    tau, mises = max_shear(stress), von_mises(stress)
    return replace(largest, tau=higher(largest.tau, tau),
                   von_mises=higher(largest.von_mises, mises))  # fmt: skip


def _place(peak: Peak) -> Array:
    """(1, 3) or, where it is not known, (0, 3)."""
    return np.array([peak.place] if peak.place else []).reshape(-1, 3)
