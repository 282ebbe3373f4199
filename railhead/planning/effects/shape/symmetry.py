"""Planes of symmetry: only x >= 0 or y >= 0 is modelled."""

from __future__ import annotations

from railhead.planning.context import Context, Effect


def along(context: Context) -> Effect:
    """Only x >= 0 is modelled where x = 0 is a plane of symmetry of the bodies and of the load;
    friction along the rail prevents this.
    """
    why, slips = context.contact.why_asymmetric_in_x(), context.scene.asymmetric_friction[0]
    straight = "the wheel stands straight: x = 0 mirrors bodies, materials and load"
    return _decide(why or ("friction along the rail" if slips else ""), straight)


def across(context: Context) -> Effect:
    """Only y >= 0 is modelled where both profiles are symmetric, the wheel stands in the middle,
    and no friction acts across the rail.
    """
    why, slips = context.contact.why_asymmetric_in_y(), context.scene.asymmetric_friction[1]
    mirrored = "profiles, materials and load mirror at y = 0"
    return _decide(why or ("friction across the rail" if slips else ""), mirrored)


def _decide(asymmetric: str, symmetric: str) -> Effect:
    """Symmetry is used where the reason against it (`asymmetric`) is empty. symmetric: the reason
    for it.
    """
    if asymmetric:
        return Effect(False, False, asymmetric, {"on": asymmetric})
    return Effect(True, True, symmetric)
