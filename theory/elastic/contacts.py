"""Hertz's point contact and line contact by the same names."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhead.theory.elastic import halfspace, line, subsurface
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import LineContact
from railhead.theory.elastic.subsurface import AxisExtrema

Array = NDArray[np.float64]
Hertz = Ellipse | LineContact


def half_lengths(contact: Hertz) -> tuple[float, float]:
    """a along and b across the rail, mm, of what a mesh must resolve: of a line its half width."""
    if isinstance(contact, LineContact):
        return contact.half_width, contact.half_width
    return contact.a, contact.b


def curvature(contact: Hertz) -> float:
    """The largest relative curvature, 1/mm."""
    if isinstance(contact, LineContact):
        return contact.strip.curvature
    return max(contact.curvature_x, contact.curvature_y)


def axis_stress(contact: Hertz, poisson: float, depth: ArrayLike) -> Array:
    """Normal stresses (n, 3) along x, across and down, MPa, at depths (n,) mm below the centre."""
    room = line if isinstance(contact, LineContact) else subsurface
    return room.axis_stress(contact, poisson, depth)


def axis_extrema(contact: Hertz, poisson: float) -> AxisExtrema:
    """The largest shear and von Mises stresses below the centre."""
    if isinstance(contact, LineContact):
        return line.axis_extrema(contact, poisson)
    return subsurface.axis_extrema(contact, poisson)


def displacement(contact: Hertz, points: Array, young: float, poisson: float) -> Array:
    """Of the half-space (n, 3), mm, at points (n, 3), z <= 0, mm."""
    if isinstance(contact, LineContact):
        return line.hertz_displacement(contact, points, young, poisson)
    return halfspace.hertz_displacement(contact, points, young, poisson)
