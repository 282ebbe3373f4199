"""Planes of symmetry: only x >= 0 or y >= 0 is modelled."""

from __future__ import annotations

from railhead.planning.context import Context, Effect


def along(context: Context) -> Effect:
    """Only x >= 0 is modelled where x = 0 is a plane of symmetry of the bodies and of the load;
    friction along the rail prevents this.
    """
    why = context.contact.why_asymmetric_in_x()
    if why is None and context.scene.asymmetric_friction[0]:
        why = "friction along the rail"
    if why is None:
        straight = "the wheel stands straight: x = 0 mirrors bodies, materials and load"
        return Effect(True, True, straight)
    return Effect(False, False, why, {"on": why})


def across(context: Context) -> Effect:
    """Only y >= 0 is modelled where both profiles are symmetric, the wheel stands in the middle,
    and no friction acts across the rail.
    """
    why = context.contact.why_asymmetric_in_y()
    if why is None and context.scene.asymmetric_friction[1]:
        why = "friction across the rail"
    if why is None:
        return Effect(True, True, "profiles, materials and load mirror at y = 0")
    return Effect(False, False, why, {"on": why})
