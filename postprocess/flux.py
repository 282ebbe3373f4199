"""The load that the elements' own stresses carry through a body, averaged over a slab of it."""

from __future__ import annotations

import basix
import numpy as np
from numpy.typing import NDArray

from railhead.meshing.tags import RAIL
from railhead.postprocess.solid import Solid
from railhead.postprocess.stress import at_reference
from railhead.solver.gather import Fields

BENT, EVEN = (
    4,
    2,
)  # degree of the rule in a cell where the weight over the slab bends, and elsewhere


def through_slab(fields: Fields, body: int, distance: float, thickness: float) -> float:
    """-int w sigma_zz over one body, N, of the whole model; w rises and falls linearly over a
    horizontal slab, with the integral 1 over its height.

    That is the mean of the load through the planes of the slab, which for a body with free sides is
    the load through each of them (the divergence of the stress is 0). Its middle lies `distance`
    (mm) below the lowest point with pressure in the rail, above the highest one in the wheel, or
    half way through a body that is thinner there than twice that; it is so many times as thick as
    its middle lies deep, 2 at most.
    """
    pressure, points = fields.contact.pressure, fields.contact.points
    touching, cells = points[pressure > 0, 2], np.flatnonzero(fields.body == body)
    height = float(np.ptp(fields.points[np.unique(fields.cells[cells]), 2]))
    into = np.array([0.0, 0.0, -1.0 if body == RAIL else 1.0])
    deepest = Solid(fields, cells).extent(points[np.argmax(pressure)], into, height)
    depth = min(distance, 0.5 * deepest)
    start = touching.min() if body == RAIL else touching.max()
    middle, half = start + depth * into[2], 0.5 * thickness * depth
    z = fields.points[fields.cells[cells], 2]
    low, high = z.min(axis=1), z.max(axis=1)
    bends = middle + half * np.array([[-1.0], [0.0], [1.0]])
    bent = np.any((low < bends) & (high > bends), axis=0)
    even = ~bent & (low < middle + half) & (high > middle - half)
    total = _weighted(fields, cells[bent], BENT, middle, half)
    total += _weighted(fields, cells[even], EVEN, middle, half)
    return -total * (1 if fields.kinematics.revolved else 2 ** len(fields.mirrors))


def _weighted(
    fields: Fields, cells: NDArray[np.int64], degree: int, middle: float, half: float
) -> float:
    """int w sigma_zz over some cells, with a rule of that degree."""
    kinematics, total = fields.kinematics, 0.0
    rule = basix.make_quadrature(getattr(basix.CellType, fields.cell), degree)
    for reference, weight in zip(*rule, strict=True):
        x, stress, size = at_reference(fields, cells, reference)
        size = size * kinematics.measure(kinematics.flatten(x))
        away = np.abs(x[:, 2] - middle) / half
        total += float((weight * size * np.maximum(1.0 - away, 0.0) / half) @ stress[:, 2])
    return total
