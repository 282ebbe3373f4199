"""Passes of the wheel of a solved scene over its rail, which yields.

Below the patch the rail is a block of quadratic cells, whose far faces are held
(`solver.plasticity.block`); what rolls is in `half_spaces.pass_contact`. Lengths in mm, forces
in N, stresses in MPa; z points out of the rail.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, LinearNDInterpolator

from railhead.half_spaces import pass_contact
from railhead.half_spaces.pass_contact import RollingContact
from railhead.half_spaces.surface import Developed
from railhead.planning.context import Context
from railhead.planning.effects import interface
from railhead.planning.effects.passes import line_limit, moves
from railhead.postprocess.pass_rows import (
    PASS_ERRORS,
    RATCHETS,
    RATES,
    SHAKES_DOWN,
    UNDECIDED,
    Passes,
    RailState,
    rail_state,
    rate,
    row,
    verdict,
    words,
)
from railhead.run.half_space_answer import Solved
from railhead.run.mesh_solution import MeshSolution
from railhead.run.model_setup import hardening
from railhead.run.progress import Progress
from railhead.solver.material import Material
from railhead.solver.plasticity.block import Block, graded, mirrored
from railhead.solver.plasticity.rolling_block import RollingBlock
from railhead.theory.array_types import Array
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction.solution import FrictionSolution

BEYOND = 1.03  # p0/k over Melan's limit, from which a line does not shake down
SPACING = 0.2  # mm, of the points of the profile with its groove
Laid = Callable[[RailState], Array]
"""Lays the groove of a state on the rail: state -> profile (n, 2), see `groove_on_profile`."""
ELEMENTS = {True: (3.0, 16.0), False: (2.0, 5.0)}
"""Fewest and most elements of the block on a half length of a line contact, and of a solid."""
# By whether the contact is a line:
PER_LENGTH = {True: 8.0, False: 4.0}  # elements on a half length
GROWTH = {True: 1.35, False: 1.6}  # of the elements beside the patch
REACH = {True: 50.0, False: 12.0}  # of the block over the half length of the patch
DEEP, ASIDE = {True: 3.4, False: 2.6}, 2.2  # plastic strain is followed, over half lengths
INNER, BELOW = 1.5, {True: 2.2, False: 1.4}  # where the elements are small
TOLD = 5e-4  # strain of the first pass from which its energy is compared
SETTLED = 2e-3  # of the first plastic work: less is no longer compared with the resistance
RATE_ERROR = 0.03  # least of a rate: lines on 8 elements are up to 1.7 % off those on 14
COARSER = 0.75  # size of the block by which errors are estimated: elements and reach, relative


def solve_passes(solved: Solved, progress: Progress) -> Passes:
    """Passes of the wheel of a solved scene over its rail; on this process alone. There are no rows
    but a `reason` where half-spaces find no balance or several patches.
    progress: shows the stages.
    """
    start, scene = time.perf_counter(), solved.plan.scene
    material = Material(scene.rail.young_modulus, scene.rail.poisson_ratio, hardening(scene.rail))
    try:
        contact, half_lengths, half, laid = _of_scene(solved)
        size, (fewest, most) = scene.mesh.patch_size, ELEMENTS[contact.line]
        per_length = None if size is None else min(max(min(half_lengths) / size, fewest), most)
        below = partial(
            rolling_block,
            material,
            half_lengths,
            line=contact.line,
            half=half,
            per_length=per_length,
        )
        count, errors = scene.rolling.passes or 1, {}
        found = roll(below(), contact, half_lengths, count, stage=progress.stage)
        if scene.accuracy is not None or found.rate is not None:
            progress.stage("passes on a coarser block")
            other = roll(below(coarser=COARSER), contact, half_lengths, count)
            pairs = {key: (found.rows[-1][key], other.rows[-1][key]) for key in PASS_ERRORS}
            factor = COARSER / (1 - COARSER)  # Richardson: errors fall with the size at least
            errors = {key: factor * abs(1 - two / one) for key, (one, two) in pairs.items() if one}
            if found.rate is not None and found.rate["estimate"] is not None:
                coarse = [abs(1 - other.rows[-1][key] / found.rows[-1][key]) for key in RATES]
                estimate = found.rate["estimate"] + max(factor * max(coarse), RATE_ERROR)
                found = replace(found, rate=found.rate | {"estimate": estimate})
    except ValueError as error:
        return Passes(rows=[], verdict="", reason=" ".join(str(error).split()))
    found = within_melan_s_limit(found, solved.plan.context)
    profile = None if laid is None else laid(found.sections[-1])
    seconds = time.perf_counter() - start
    return replace(found, profile=profile, errors=errors, seconds=seconds)


def rolling_block(
    material: Material,
    half_lengths: tuple[float, float],
    *,
    line: bool,
    half: bool,
    per_length: float | None = None,
    reach: float | None = None,
    coarser: float = 1.0,
) -> RollingBlock:
    """Block of a rail below a patch.

    material: elastic constants and flow curve.
    half_lengths: of the elastic patch, along and across, mm; of a line contact both are its half
        width.
    half: whether y = 0 is a symmetry plane.
    per_length: elements on each half length; None: 8 of a line, 4 of a solid (PER_LENGTH).
    reach: of the block to each side, over the larger half length; None: 50 of a line, 12 of a solid
        (REACH).
    coarser: factor on the number of elements and on the reach.
    """
    count, growth = coarser * (per_length or PER_LENGTH[line]), GROWTH[line]
    a, b = half_lengths
    least, far = min(a, b), coarser * (reach or REACH[line]) * max(a, b)
    x = mirrored(graded(INNER * a, a / count, far, growth))
    z = -graded(BELOW[line] * least, least / count, far, growth)[::-1]
    depth = DEEP[line] * least
    if line:
        return RollingBlock(Block((x, z), material, depth=depth))
    y = graded(INNER * b, b / count, far, growth)
    across = y if half else mirrored(y)
    return RollingBlock(Block((x, across, z), material, half, depth=depth, aside=ASIDE * b))


def roll(
    rolling: RollingBlock,
    contact: RollingContact,
    half_lengths: tuple[float, float],
    count: int,
    *,
    stage: Callable[[str], None] = lambda name: None,
) -> Passes:
    """Roll `count` times over a block. half_lengths: as of `rolling_block`. stage: called with
    words before each pass. A pass that does not converge ends nothing; `Passes.converged` is then
    False. Raises ValueError where boundary elements find no balance.
    """
    pressing = pass_contact.Pressing(rolling, contact)
    rows: list[dict[str, Any]] = []
    sections: list[RailState] = []
    state = rolling.start
    stiff = 2 * rolling.block.material.lame[1]
    whole = contact.width * (2 if rolling.block.half else 1)
    for number in range(1, count + 1):
        stage(f"pass {number} of {count}")
        if not contact.keeps:
            pressing.patch = None  # the iterations of every pass start alike
        each = rolling.roll(state, pressing)
        assert pressing.patch is not None
        state = each.state
        sections.append(rail_state(rolling, state))
        rows.append(
            row(rolling, each, sections[-1], pressing.patch)
            | {
                "work_N": whole * each.work,
                "stored_N": whole * each.stored,
                "resistance_N": None if contact.keeps else contact.resistance(pressing.patch),
                "traction_work_N": pressing.traction_work,
            }
        )
    increments, law = [each["strain_increment_max"] for each in rows], rolling.hardening
    noise = rolling.tolerance * rolling.shear_yield / stiff
    hardens = law.final_hardening_modulus > 0 or any(not each.recall for each in law.backstresses)
    recalls = not hardens and bool(law.backstresses or law.isotropic[0])
    forward = [each["forward_mm"] for each in rows]
    found = verdict(increments, forward, half_lengths[0], noise, hardens=hardens, recalls=recalls)
    least = SETTLED * rows[0]["work_N"] if increments[0] > TOLD else math.inf
    spent = [
        (each["work_N"] + each["stored_N"], each["resistance_N"] + each["traction_work_N"])
        for each in rows
        if each["resistance_N"] is not None
    ]
    errors = [abs(force - total) / total for total, force in spent if total > least]
    return Passes(
        rows=rows,
        verdict=found,
        words=words(found, rows, rolling, tractions=contact.traction is not None),
        rate=rate(rows, noise, half_lengths[0], law) if found == RATCHETS else None,
        sections=sections,
        half_lengths=half_lengths,
        converged=all(each["change"] < rolling.tolerance for each in rows),
        energy_error=max(errors, default=None),
        rim=max(each["strain_increment_rim"] for each in rows) / (max(increments) or 1.0),
        unknowns=rolling.block.nodes.size,
    )


def within_melan_s_limit(found: Passes, context: Context) -> Passes:
    """The passes; those of a line that are said to shake down beyond the limit are undecided.

    Where the surface sets the limit, the Gauss points, which lie deeper, may miss that it goes on
    to yield. A rail that hardens isotropically shakes down in the end, so its passes are not
    compared with the limit.
    """
    rail = context.scene.rail
    held = isinstance(context.hertz, LineContact) and (not rail.hardens or moves(rail))
    if found.verdict != SHAKES_DOWN or not held:
        return found
    limit = line_limit(context)
    reached = found.rows[-1]["pressure_max_MPa"] / rail.first_yield * math.sqrt(3)
    if reached <= BEYOND * limit:
        return found
    why = f"{UNDECIDED}: strain hardly grows, yet p0/k = {reached:.3g} is above Melan's limit "
    return replace(found, verdict=UNDECIDED, words=f"{why}{limit:.3g} (give a finer mesh)")


def groove_on_profile(surface: Developed, centre: float, inclination: float) -> Laid:
    """Function that lays the groove of passes on a rail's profile: from the state of the section to
    y and z (n, 2), mm, in the axes of the profile's file, before the rail is inclined.

    surface: of the rail as it stands. centre: arc length of the middle of the patch on it, mm.
    inclination: slope by which the rail leans. Points lie along the surface's normals, 0.2 mm
    (SPACING) apart or less.
    """
    s = np.linspace(surface.s[0], surface.s[-1], int(np.ptp(surface.s) / SPACING) + 2)
    normal, lean = surface.angle(s), math.atan(inclination)
    _, y, z = surface.points(np.zeros_like(s), s).T

    def laid(left: RailState) -> Array:
        """The profile (n, 2), mm."""
        up = CubicSpline(left.across, left.up)(np.clip(s - centre, *left.across[[0, -1]]))
        y_now, z_now = y - up * np.sin(normal), z + up * np.cos(normal)
        turned = (y_now + 1j * z_now) * np.exp(-1j * lean)
        return np.column_stack([turned.real, turned.imag])

    return laid


def _of_scene(
    solved: Solved,
) -> tuple[RollingContact, tuple[float, float], bool, Laid | None]:
    """What rolls in a solved scene, the half lengths of its elastic patch along and across, mm,
    whether it is symmetric about y = 0, and what lays the groove on its profile. The last is None
    for line contacts and half-spaces. Raises ValueError for several patches, and where boundary
    elements fail.
    """
    plan, load = solved.plan, solved.plan.scene.load
    coefficient = interface.friction_coefficient(plan.context)
    hertz = solved.ellipse if load is None else plan.hertz  # which is the same on any ranks
    keeps = plan.scene.rolling.pressure == "hertz"
    if isinstance(hertz, LineContact):
        width, share = hertz.half_width, _share_of_full_slip(solved)
        contact = pass_contact.line_contact(
            width,
            hertz.load_per_length,
            hertz.curvature,
            hertz.contact_modulus,
            keeps=keeps,
            slips=math.copysign(coefficient, share) if share else 0.0,
            sticks=math.sqrt(1 - abs(share)),
            width=hertz.length,
        )
        return contact, (width, width), False, None
    if plan.contact.half_space:
        contact = pass_contact.ellipse_contact(hertz, keeps=keeps)
        friction = _friction(solved)
        if friction is not None:
            x, y, _ = friction.points.T
            bound = coefficient * contact.pressure
            contact = _with_tractions(solved, contact, bound, x, y, friction.traction[:, :2])
        return contact, (hertz.a, hertz.b), not plan.scene.asymmetric_friction[1], None
    pair = plan.context.half_spaces
    surface, found = pair.developed, pair.pressed(load or solved.load)
    if len(found.patches) > 1:
        raise ValueError("there are several patches; passes know one")
    patch = found.patches[0]
    half_lengths, plane = patch.half_extents, patch.plane
    x, s = patch.centroid
    symmetric = plan.contact.why_asymmetric_in_y() is None
    symmetric &= not (plan.scene.asymmetric_friction[1] or plan.scene.friction.uneven)
    contact = pass_contact.solid_contact(
        half_lengths,
        patch.cell * float((patch.pressure @ np.cos(patch.angle - plane)).sum()),
        lambda along, across: surface.gap(x + along, s + across),
        hertz.contact_modulus,
        lambda across: surface.angle(s + across) - plane,
        keeps=keeps,
    )
    friction = _friction(solved)
    if friction is not None:
        along, y, _ = friction.points.T
        across = np.interp(y, surface.y, surface.s)
        tilt, sideways = surface.angle(across), friction.traction[:, 1:]
        tangent = np.cos(tilt) * sideways[:, 0] + np.sin(tilt) * sideways[:, 1]
        traction = np.column_stack([friction.traction[:, 0], tangent])
        bound = surface.friction_coefficient(s + contact.grid.s) * contact.pressure
        contact = _with_tractions(solved, contact, bound, along - x, across - s, traction)
    laid = groove_on_profile(surface, s, plan.scene.rail.inclination)
    return contact, half_lengths, symmetric, laid


def _friction(solved: Solved) -> FrictionSolution | None:
    """Tractions of a solved scene whose wheel rolls; None without them."""
    if not solved.plan.scene.rolling.prescribed:
        return None
    return solved.solution.friction if isinstance(solved, MeshSolution) else solved.friction


def _with_tractions(
    solved: Solved, contact: RollingContact, bound: Array, x: Array, s: Array, traction: Array
) -> RollingContact:
    """Contact of solids with tractions (n, 2), MPa, along and across, found at places x, s (n,),
    mm from the middle of the patch. Where they exceed the bound (nx, ns), MPa, they are reduced to
    that.
    """
    if solved.plan.half_y:
        x, s = np.concatenate([x, x]), np.concatenate([s, -s])
        traction = np.vstack([traction, traction * [1.0, -1.0]])
    places = np.stack(np.meshgrid(contact.grid.x, contact.grid.s, indexing="ij"), axis=-1)
    # Four points on a circle have two triangulations: that of sorted points is the same each time.
    points, order = np.unique(np.column_stack([x, s]).round(5), axis=0, return_index=True)
    found = LinearNDInterpolator(points, traction[order], fill_value=0.0)(places)
    size = np.hypot(found[..., 0], found[..., 1])
    found *= np.minimum(1.0, bound / np.maximum(size, 1e-300))[..., None]
    return replace(contact, traction=np.moveaxis(found, -1, 0))


def _share_of_full_slip(solved: Solved) -> float:
    """Tangential force of the wheel on the rail along it over that of full slip, -1 to 1; 0 without
    rolling with friction.
    """
    rolls = solved.plan.scene.rolling.prescribed
    found = (solved.result or {}).get("friction") if rolls else None
    coefficient = interface.friction_coefficient(solved.plan.context)
    if not found or not coefficient:
        return 0.0
    share = float(found["force_along_N"]) / (coefficient * solved.load)
    return min(max(share, -1.0), 1.0)
