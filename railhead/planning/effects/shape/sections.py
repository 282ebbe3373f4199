"""Two dimensions instead of three: a plane-strain or a meridian section."""

from __future__ import annotations

from railhead.contact import dimension
from railhead.planning.context import Context, Effect


def plane_strain(context: Context) -> Effect:
    """Called for where the contact is a line (`dimension.choose`)."""
    kind = context.dimension
    refused = {} if kind.line else {"on": kind.plane_strain}
    return Effect(kind.line, kind.line, kind.plane_strain, refused)


def axisymmetry(context: Context) -> Effect:
    """Called for where both bodies, and what loads them, are of revolution about the contact's
    normal (`dimension.circular`)."""
    called, why = dimension.circular(context.scene)
    return Effect(called, context.contact.revolved, why)
