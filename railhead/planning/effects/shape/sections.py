"""Two dimensions instead of three: a plane-strain or a meridian section."""

from __future__ import annotations

from railhead.contact import dimension
from railhead.planning.context import Context, Effect


def plane_strain(context: Context) -> Effect:
    """Plane strain is called for, and simulated, where the contact is a line."""
    kind = context.dimension
    refused = {} if kind.line else {"on": kind.plane_strain}
    return Effect(kind.line, kind.line, kind.plane_strain, refused)


def axisymmetry(context: Context) -> Effect:
    """A meridian section is called for where both bodies, and their loads, are of revolution about
    the contact normal; it is on where such a section was located.
    """
    called, why = dimension.circular(context.scene)
    return Effect(called, context.contact.revolved, why)
