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
    """Half lengths (mm) along and across the rail of the patch that a mesh must resolve: the semi-
    axes (a, b) of an ellipse; for a line contact its half width twice, never half its length.
    """
    if isinstance(contact, LineContact):
        return contact.half_width, contact.half_width
    return contact.a, contact.b


def curvature(contact: Hertz) -> float:
    """Largest relative curvature of the gap between the bodies, 1/mm."""
    if isinstance(contact, LineContact):
        return contact.strip.curvature
    return max(contact.curvature_x, contact.curvature_y)


def axis_stress(contact: Hertz, poisson: float, depth: ArrayLike) -> Array:
    """Normal stresses (n, 3) along x (the rail), y (across it) and z, MPa, tension positive, at
    depths (n,), mm, below the centre of the patch; a single depth has one row. ValueError: a
    negative depth.
    """
    room = line if isinstance(contact, LineContact) else subsurface
    return room.axis_stress(contact, poisson, depth)


def axis_extrema(contact: Hertz, poisson: float) -> AxisExtrema:
    """Largest shear stress and largest von Mises stress on the normal below the centre of the
    patch, MPa, with their depths, mm, down to twice the smaller half length.
    """
    if isinstance(contact, LineContact):
        return line.axis_extrema(contact, poisson)
    return subsurface.axis_extrema(contact, poisson)


def displacement(contact: Hertz, points: Array, young: float, poisson: float) -> Array:
    """Displacement (n, 3), components x, y, z (z up), of the half-space z <= 0 under the contact
    pressure, which presses it in -z, mm, at points (n, 3), mm, from the centre of the patch.

    young: Young's modulus, MPa. Zero at infinity; of a line contact zero at its datum instead.
    """
    if isinstance(contact, LineContact):
        return line.hertz_displacement(contact, points, young, poisson)
    return halfspace.hertz_displacement(contact, points, young, poisson)
