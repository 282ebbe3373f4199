"""Which part of the bodies is modelled: a section, one side of a plane of symmetry, or blocks cut
out of half-spaces.
"""

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


def symmetry_x(context: Context) -> Effect:
    """Only x >= 0 is modelled where x = 0 is a plane of symmetry of the bodies and of the load;
    friction along the rail prevents this.
    """
    why, slips = context.contact.why_asymmetric_in_x(), context.scene.asymmetric_friction[0]
    straight = "the wheel stands straight: x = 0 mirrors bodies, materials and load"
    return _symmetry(why or ("friction along the rail" if slips else ""), straight)


def symmetry_y(context: Context) -> Effect:
    """Only y >= 0 is modelled where both profiles are symmetric, the wheel stands in the middle,
    and no friction acts across the rail.
    """
    why, slips = context.contact.why_asymmetric_in_y(), context.scene.asymmetric_friction[1]
    mirrored = "profiles, materials and load mirror at y = 0"
    return _symmetry(why or ("friction across the rail" if slips else ""), mirrored)


def _symmetry(asymmetric: str, symmetric: str) -> Effect:
    """Symmetry is used where the reason against it (`asymmetric`) is empty. symmetric: the reason
    for it.
    """
    if asymmetric:
        return Effect(False, False, asymmetric, {"on": asymmetric})
    return Effect(True, True, symmetric)


def far_field(context: Context) -> Effect:
    """Half-spaces that continue beyond their meshed blocks are simulated where rail.extent is half-
    space; for real bodies the effect is refused.
    """
    if context.contact.half_space:
        return Effect(True, True, "rail.extent = half-space: what lies beyond the blocks deforms")
    why = "the bodies end where they really end"
    return Effect(False, False, why, {"on": f"rail.extent is {context.scene.rail.extent}"})
