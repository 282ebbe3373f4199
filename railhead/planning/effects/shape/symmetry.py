"""Planes of symmetry: only x >= 0 or y >= 0 is modelled."""

from __future__ import annotations

from railhead.planning.context import Context, Effect


def along(context: Context) -> Effect:
    """x = 0 mirrors the bodies and a vertical load."""
    why = context.contact.why_asymmetric_in_x()
    if why is None and context.scene.asymmetric_friction[0]:
        why = "friction along the rail"
    if why is None:
        straight = "the wheel stands straight: x = 0 mirrors bodies, materials and load"
        return Effect(True, True, straight)
    return Effect(False, False, why, {"on": why})


def across(context: Context) -> Effect:
    """y = 0 mirrors them where both profiles do and the wheel stands in the middle."""
    why = context.contact.why_asymmetric_in_y()
    if why is None and context.scene.asymmetric_friction[1]:
        why = "friction across the rail"
    if why is None:
        return Effect(True, True, "profiles, materials and load mirror at y = 0")
    return Effect(False, False, why, {"on": why})
