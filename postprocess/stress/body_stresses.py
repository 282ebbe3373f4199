"""Stresses inside the bodies: on the axes below the patches, and the largest anywhere."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhead.meshing.bodies import BODY_NAMES
from railhead.postprocess.findings import (
    COLUMN,
    ROW,
    SYMMETRIC,
    Array,
    DepthAxis,
    Frame,
    Largest,
)
from railhead.postprocess.patch.separate_patches import SeparatePatch
from railhead.postprocess.stress.body_geometry import Solid
from railhead.postprocess.stress.peaks import Search
from railhead.postprocess.stress.recovery import Recovery
from railhead.solver.system.fields import Fields
from railhead.theory.elastic.subsurface import max_shear, von_mises

DEPTH_POINTS = 121  # on an axis
DEPTH_REACH = 3.0  # largest depth over the smaller semi-axis
INNER = 0.6  # of the way from the middle of a facet to its nodes: where it sticks or slips


@dataclass(frozen=True, kw_only=True)
class BodyStresses:
    """Stresses inside all meshed bodies.

    axes: by body name, the stresses along the normal into the body from the centre of the most
        loaded patch.
    other_axes: the same from the centres of the other patches, in the rail, or in the wheel if the
        rail is rigid.
    largest: by body name, the largest stresses anywhere, with those near sharp edges apart.
    edges (n, 3): points in space on the sharp edges of all bodies, mm.
    misfit: largest relative difference of mean smooth and mean element stress around the places of
        the largest stresses, all components together.
    """

    axes: dict[str, DepthAxis]
    other_axes: tuple[DepthAxis, ...]
    largest: dict[str, Largest]
    edges: Array
    misfit: float


def read(
    fields: Fields,
    frame: Frame,
    centre: tuple[float, float],
    size: float,
    others: list[SeparatePatch],
    *,
    wanted: bool = True,
) -> BodyStresses:
    """Smooth stresses in the bodies, below the patches and where they are largest; only the sharp
    edges where they are not `wanted`.

    centre: (x, s) of the most loaded patch in the frame, mm. size: its smaller semi-axis, mm.
        others: the other patches.
    """
    bodies = {}
    for tag, name in BODY_NAMES.items():
        cells = np.flatnonzero(fields.body == tag)
        if len(cells):
            bodies[name] = Solid(fields, cells), Recovery(fields, cells)
    edges = np.concatenate([solid.sharp_edges() for solid, _ in bodies.values()])
    if not wanted:
        return BodyStresses(axes={}, other_axes=(), largest={}, edges=edges, misfit=math.nan)
    axes = {
        name: _below(*body, frame, centre, name, size * DEPTH_REACH)
        for name, body in bodies.items()
    }
    shown = next(iter(bodies))
    also = tuple(
        _below(*bodies[shown], part.frame, (0.0, 0.0), shown, min(part.a, part.b) * DEPTH_REACH)
        for part in others
    )
    largest = {
        name: _largest(Search(fields, *body, edges, size), axes[name])
        for name, body in bodies.items()
    }
    misfit = max(
        bodies[name][1].misfit(np.array(peak.place))
        for name, each in largest.items()
        for peak in (each.tau, each.von_mises)
    )
    return BodyStresses(axes=axes, other_axes=also, largest=largest, edges=edges, misfit=misfit)


def _below(
    solid: Solid,
    recovery: Recovery,
    frame: Frame,
    centre: tuple[float, float],
    name: str,
    reach: float,
) -> DepthAxis:
    """Stresses on the axis below a point of the tangent plane, in the frame, as deep as the body
    goes, at most to `reach`, mm.

    solid: cells of the body. recovery: smooth stresses of the body. centre: (x, s) of the point in
        the frame, mm. name: of the body, 'rail' or 'wheel'.
    """
    start, into = frame.place(*centre), frame.axes[2] * (-1.0 if name == "rail" else 1.0)
    depth = np.linspace(
        0.0, solid.extent(np.array(start), into, reach), DEPTH_POINTS, dtype=np.float64
    )
    stress = recovery.at(start + depth[:, None] * into)
    stress = (frame.axes @ np.take(stress, SYMMETRIC, axis=1) @ frame.axes.T)[:, ROW, COLUMN]
    return DepthAxis(name, depth, stress, (start, (float(into[0]), float(into[1]), float(into[2]))))


def _largest(search: Search, axis: DepthAxis) -> Largest:
    """Largest shear and von Mises stress of one body, by a search in its cells. If all of the body
    is near sharp edges, they are the largest ones on its depth axis.
    """
    spare = axis.largest
    tau = search.highest(max_shear, np.array([spare.tau.place])) or spare.tau
    mises = search.highest(von_mises, np.array([spare.von_mises.place])) or spare.von_mises
    edges = search.at_edges(max_shear, tau.value), search.at_edges(von_mises, mises.value)
    return Largest(tau, mises, edges)
