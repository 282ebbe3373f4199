"""Boundary elements on the real profiles beside the finite elements."""

from __future__ import annotations

from typing import Any

from railhead.meshing.bodies import RAIL
from railhead.planning.references import boundary_elements, rail_twist
from railhead.planning.references.allowance import allowance
from railhead.postprocess import compare
from railhead.postprocess.patch import body_motion
from railhead.run.mesh_solution import MeshSolution
from railhead.theory.bem.boundary_element import Solution

CELLS = 128


def solve(solved: MeshSolution) -> Solution | str | None:
    """Contact of the real profiles as half-spaces under the load of the solution, or the reason why
    boundary elements failed. None where exact Hertz is the half-space solution (half-spaces and
    line contacts) or nothing touches.
    """
    contact = solved.plan.contact
    if contact.half_space or contact.line or solved.findings is None:
        return None
    try:
        return boundary_elements.solve(contact, solved.ellipse, solved.solution.load, CELLS)
    except ValueError as error:
        return f"boundary elements: {error}"


def half_space(solved: MeshSolution, solution: Solution | str | None) -> dict[str, Any] | None:
    """Entry "half_space" of summary.json: quantities of the half-space `solution`, and by quantity
    the "allowance" for what half-spaces leave out; or {"reason": ...}. None where the solution is
    None.
    """
    contact, found = solved.plan.contact, solved.findings
    if solution is None or found is None:
        return None
    if isinstance(solution, str):
        return {"reason": solution}
    points, plane = boundary_elements.develop(contact).points, contact.touch.angle
    quantities = compare.from_half_space(solution, points, plane)
    try:
        twist = twist_change(solved)
    except ValueError as error:
        return {**quantities, "allowance": {"reason": f"twist: {error}"}}
    allowed = allowance(contact, solved.plan.deformable, solution, twist)
    if found.hertzian:  # half lengths are those of ellipses
        allowed |= dict.fromkeys(("a_mm", "b_mm"), allowed["area_mm2"])
    return {**quantities, "allowance": allowed}


def twist_change(solved: MeshSolution) -> float:
    """Relative change of the pressure by the rotation and the movement of the bodies in the
    solution (rank 0); 0 for a contact that is symmetric about y = 0. Raises ValueError where it
    cannot be computed.
    """
    contact, moved = solved.plan.contact, motion(solved)
    if contact.why_asymmetric_in_y() is None:
        return 0.0
    return rail_twist.change(contact, solved.plan.context.boundary_elements, *moved)


def motion(solved: MeshSolution) -> tuple[float, float]:
    """Relative rotation of the rail (rad) and lateral movement of the wheel (mm) in the solution
    (rank 0); zeros in a section, which is symmetric.
    """
    found, fields = solved.findings, solved.fields
    assert found is not None and fields is not None
    if solved.plan.section:
        return 0.0, 0.0
    angle = aside = 0.0
    for tag in solved.plan.deformable:
        sign = 1.0 if tag == RAIL else -1.0
        turned, moved = body_motion.motion(fields, tag, found.patch.each, solved.solution.load)
        angle, aside = angle + sign * turned, aside - sign * moved
    return angle, aside - angle * found.patch.each[0].centre[2]
