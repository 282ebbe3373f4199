"""Bodies of finite size instead of half-spaces, and what half-spaces would miss of them."""

from __future__ import annotations

import math

from railhead.meshing.tags import BODY_NAMES
from railhead.planning.context import Context, Effect
from railhead.planning.references.allowance import Allowance, allowance
from railhead.theory.elastic.line import LineContact

SECTION = "half-spaces know no section of bodies that end"
APPROACH = "the approach of bodies that end depends on where they are held; with a load they answer"
BUDGET = "half-spaces are solved once, whatever the budget"


def decide(context: Context) -> Effect:
    """Finite bodies are always called for and on; a person may switch them off. The reason says by
    how much half-spaces would be off.

    'off' is refused for sections of bodies that end, for a given approach of bodies that end, and
    with a budget.
    """
    scene, contact = context.scene, context.contact
    refused = {} if scene.budget is None else {"off": BUDGET}
    if contact.half_space:
        why = "the bodies are half-spaces: by their shape, half-spaces would miss nothing"
        return Effect(True, True, why, refused)
    if contact.plane:
        return Effect(True, True, SECTION, {"off": SECTION})
    if scene.load is None:
        refused = {"off": APPROACH}
    try:
        pressure, area = (100 * each["total"] for each in expected(context).values())
        why = f"half-spaces would be {pressure:.2g} % off in pressure, {area:.2g} % in area"
    except ValueError as error:
        why = f"by how much half-spaces would be off is not known ({error})"
    return Effect(True, True, why, refused)


def expected(context: Context) -> dict[str, Allowance]:
    """Differences between half-spaces and finite bodies by "max_MPa" and "area_mm2", relative,
    before anything is meshed: of exact Hertz where it gives the patch, else of boundary elements.
    Raises ValueError where the twist of the rail leaves no contact that can be computed.
    """
    tags = [tag for tag, name in BODY_NAMES.items() if context.decided[f"deformable_{name}"].on]
    solved = context.hertz if context.hertzian else context.boundary_elements
    assert not isinstance(solved, LineContact)
    return allowance(context.contact, tags, solved, _twist(context))


def _twist(context: Context) -> float:
    """Relative change of pressure or area by the twist of the rail; 0 for a block, a rigid rail, a
    contact in the plane of symmetry, and where both bodies have one radius.
    """
    rail = context.scene.rail
    still = rail.profile == "arc" or math.isinf(rail.young_modulus)
    still |= context.contact.why_asymmetric_in_y() is None
    still |= not context.decided["true_profile"].called_for
    return 0.0 if still else context.twist_change
