"""Numbers of the bodies and faces in every mesh."""

RAIL, WHEEL = 1, 2
BODY_NAMES = {RAIL: "rail", WHEEL: "wheel"}
CONTACT, SUPPORT = 10, 20  # facet tag of a body's face: CONTACT + RAIL and so on
SYMMETRY_X, SYMMETRY_Y = 31, 32


def other(tag: int) -> int:
    """Tag of the other body: RAIL for WHEEL, and WHEEL for RAIL."""
    return RAIL if tag == WHEEL else WHEEL
