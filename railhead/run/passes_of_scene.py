"""Passes of the wheel of a solved scene over its rail, which yields.

Below each patch the rail is a block of quadratic cells, whose far faces are held
(`solver.plasticity.block`), and so is the wheel if it yields; what rolls is in
`half_spaces.pass_contact`. Lengths in mm, forces in N, stresses in MPa; z points out of the body.
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, LinearNDInterpolator

from railhead.half_spaces import pass_contact
from railhead.half_spaces.pass_contact import Below, RollingContact
from railhead.half_spaces.surface import Developed
from railhead.planning.context import Context
from railhead.planning.effects import interface
from railhead.planning.effects.passes import ASIDE, line_limit, moves
from railhead.postprocess.pass_rows import (
    PASS_ERRORS,
    RATCHETS,
    RATES,
    SHAKES_DOWN,
    UNDECIDED,
    Passes,
    RailState,
    extrapolated,
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
from railhead.scene.bodies import Rail, Wheel
from railhead.solver.material import Material
from railhead.solver.plasticity import rolling_block as blocks
from railhead.solver.plasticity.block import Block, graded, mirrored
from railhead.solver.plasticity.rolling_block import RollingBlock
from railhead.theory.array_types import Array
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction.solution import FrictionSolution

BEYOND = 1.03  # p0/k over Melan's limit, from which a line does not shake down
SPACING = 0.2  # mm, of the points of the profile with its groove
Laid = Callable[[Sequence[RailState]], Array]
"""Lays the grooves of states on the rail: states -> profile (n, 2), see `groove_on_profile`."""
ELEMENTS = {True: (3.0, 16.0), False: (2.0, 5.0)}
"""Fewest and most elements of the block on a half length of a line contact, and of a solid."""
# By whether the contact is a line:
PER_LENGTH = {True: 8.0, False: 4.0}  # elements on a half length
GROWTH = {True: 1.35, False: 1.6}  # of the elements beside the patch
REACH = {True: 50.0, False: 12.0}  # of the block over the half length of the patch
DEEP = {True: 3.4, False: 2.6}  # plastic strain is followed down to there, over half lengths
INNER, BELOW = 1.5, {True: 2.2, False: 1.4}  # where the elements are small
TOLD = 5e-4  # strain of the first pass from which its energy is compared
SETTLED = 2e-3  # of the first plastic work: less is no longer compared with the resistance
LEAST_ERROR = 0.03  # of all values: two blocks may agree by chance, some 2 % off
COARSER = 0.75  # size of the block by which errors are estimated: elements and reach, relative


def solve_passes(solved: Solved, progress: Progress) -> Passes:
    """Passes of the wheel of a solved scene over its rail; on this process alone. They are those of
    the rail below the patch of the largest pressure, and have those of other patches, and of the
    wheel if it yields, beside them. Where half-spaces find no balance there are no rows, but a
    `reason`. progress: shows the stages.
    """
    start, scene, context = time.perf_counter(), solved.plan.scene, solved.plan.context
    bodies: list[Rail | Wheel] = [scene.rail]
    if solved.plan.effects["plasticity_wheel"].on:
        bodies.append(scene.wheel)
    count = scene.rolling.passes or 1
    try:
        contact, half, laid = _of_scene(solved)
        every = range(len(contact.patches))
        order = sorted(every, key=lambda number: -contact.patches[number].pressure.max())
        places = [(number, body) for number in order for body in bodies]

        def rolled(coarser: float, stage: Callable[[str], None]) -> list[Passes]:
            """Passes of all places on blocks with this factor on their elements and reach."""

            @cache
            def block(number: int, young: float, poisson: float) -> RollingBlock:
                """Block of a patch and elastic constants, for all bodies that have these."""
                half_lengths = contact.patches[number].half_lengths
                size, (fewest, most) = scene.mesh.patch_size, ELEMENTS[contact.line]
                fine = None if size is None else min(max(min(half_lengths) / size, fewest), most)
                material = Material(young, poisson, hardening(scene.rail))
                return rolling_block(
                    material, half_lengths, line=contact.line, half=half, per_length=fine,
                    coarser=coarser,
                )  # fmt: skip

            below = []
            for number, body in places:
                own = block(number, body.young_modulus, body.poisson_ratio)
                own = replace(own, law=hardening(body))
                below.append(Below(own, contact, number, wheel=body is scene.wheel))
            return roll(below, contact, count, stage=stage)

        found = rolled(1.0, progress.stage)
        if scene.accuracy is not None or any(each.rate is not None for each in found):
            progress.stage("passes on a coarser block")
            pairs = zip(found, rolled(COARSER, lambda name: None), strict=True)
            found = [estimated(*pair, asked=scene.accuracy is not None) for pair in pairs]
    except ValueError as error:
        return Passes(rows=[], verdict="", reason=" ".join(str(error).split()))
    grooves = {}
    for k, (number, body) in enumerate(places):
        found[k] = within_melan_s_limit(found[k], context, body)
        if scene.rolling.wheels:
            found[k] = extrapolated(found[k], scene.rolling.wheels)
        if body is scene.rail:
            grooves[number] = found[k].sections[-1]
        if len(places) > 1:
            of = f", patch {number + 1}" if len(every) > 1 else ""
            found[k] = replace(found[k], name=f"{'rail' if body is scene.rail else 'wheel'}{of}")
    profile = None if laid is None else laid([grooves[number] for number in every])
    seconds = time.perf_counter() - start
    return replace(found[0], profile=profile, seconds=seconds, beside=tuple(found[1:]))


def estimated(found: Passes, coarse: Passes, *, asked: bool) -> Passes:
    """Passes with estimates from the same on a coarser block; asked: also of values other than the
    rate. By Richardson's extrapolation, as errors are taken to be proportional to the size of the
    elements.
    """
    factor, last, other = COARSER / (1 - COARSER), found.rows[-1], coarse.rows[-1]
    if asked:
        pairs = {key: (last[key], other[key]) for key in PASS_ERRORS if last[key]}
        changes = {key: abs(1 - two / one) for key, (one, two) in pairs.items()}
        errors = {key: max(factor * each, LEAST_ERROR) for key, each in changes.items()}
        found = replace(found, errors=errors)
    if found.rate is not None and found.rate["estimate"] is not None:
        change = max(abs(1 - other[key] / last[key]) for key in RATES)
        estimate = found.rate["estimate"] + max(factor * change, LEAST_ERROR)
        found = replace(found, rate=found.rate | {"estimate": estimate})
    return found


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
    below: Sequence[Below],
    contact: RollingContact,
    count: int,
    *,
    stage: Callable[[str], None] = lambda name: None,
) -> list[Passes]:
    """Roll `count` times over blocks; passes of each of them. stage: called with words before each
    pass. A pass that does not converge ends nothing; `Passes.converged` of all is then False.
    Raises ValueError where boundary elements find no balance.
    """
    pressing = pass_contact.Pressing(below, contact)
    rows: list[list[dict[str, Any]]] = [[] for _ in below]
    sections: list[list[RailState]] = [[] for _ in below]
    states = [each.rolling.start for each in below]
    spent: list[tuple[float, float]] = []  # by yield, and by the forces that act
    for number in range(1, count + 1):
        stage(f"pass {number} of {count}")
        if not contact.keeps:
            pressing.found = ()  # the iterations of every pass start alike
        found = blocks.roll([each.rolling for each in below], states, pressing)
        states = [each.state for each in found]
        forces = [contact.resistance(k, each) for k, each in enumerate(pressing.found)]
        for k, (own, each) in enumerate(zip(below, found, strict=True)):
            sections[k].append(rail_state(own.rolling, each.state))
            whole = contact.width * (2 if own.rolling.block.half else 1)
            rows[k].append(
                row(own.rolling, each, sections[k][-1], pressing.found[own.number])
                | {
                    "work_N": whole * each.work,
                    "stored_N": whole * each.stored,
                    "resistance_N": None if contact.keeps else forces[own.number],
                    "traction_work_N": pressing.traction_work[k],
                }
            )
        now = [each[-1] for each in rows]
        taken = sum(each["work_N"] + each["stored_N"] for each in now)
        spent.append((taken, sum(forces) + sum(each["traction_work_N"] for each in now)))
    errors = []
    if not contact.keeps and max(each[0]["strain_increment_max"] for each in rows) > TOLD:
        least = SETTLED * sum(each[0]["work_N"] for each in rows)
        errors = [abs(force - total) / total for total, force in spent if total > least]
    same = {
        "converged": all(
            row["change"] < own.rolling.tolerance
            for own, of in zip(below, rows, strict=True)
            for row in of
        ),
        "energy_error": max(errors, default=None),
    }
    return [_read(*each, contact, same) for each in zip(below, rows, sections, strict=True)]


def _read(
    below: Below,
    rows: list[dict[str, Any]],
    sections: list[RailState],
    contact: RollingContact,
    same: dict[str, Any],
) -> Passes:
    """Passes of a block. same: fields of `Passes` that all blocks share."""
    rolling, patch = below.rolling, contact.patches[below.number]
    increments, law = [each["strain_increment_max"] for each in rows], rolling.hardening
    length = patch.half_lengths[0]
    noise = rolling.tolerance * rolling.shear_yield / (2 * rolling.block.material.lame[1])
    hardens = law.final_hardening_modulus > 0 or any(not each.recall for each in law.backstresses)
    recalls = not hardens and bool(law.backstresses or law.isotropic[0])
    forward = [each["forward_mm"] for each in rows]
    found = verdict(increments, forward, length, noise, hardens=hardens, recalls=recalls)
    return Passes(
        rows=rows,
        verdict=found,
        words=words(found, rows, rolling, tractions=patch.traction is not None),
        rate=rate(rows, noise, length, law) if found == RATCHETS else None,
        sections=sections,
        half_lengths=patch.half_lengths,
        rim=max(each["strain_increment_rim"] for each in rows) / (max(increments) or 1.0),
        unknowns=rolling.block.nodes.size,
        **same,
    )


def within_melan_s_limit(found: Passes, context: Context, body: Rail | Wheel) -> Passes:
    """The passes of a body; those of a line that are said to shake down beyond the limit are
    undecided.

    Where the surface sets the limit, the Gauss points, which lie deeper, may miss that it goes on
    to yield. A body that hardens isotropically shakes down in the end, so its passes are not
    compared with the limit.
    """
    held = isinstance(context.hertz, LineContact) and (not body.hardens or moves(body))
    if found.verdict != SHAKES_DOWN or not held:
        return found
    limit = line_limit(context, body)
    reached = found.rows[-1]["pressure_max_MPa"] / body.first_yield * math.sqrt(3)
    if reached <= BEYOND * limit:
        return found
    why = f"{UNDECIDED}: strain hardly grows, yet p0/k = {reached:.3g} is above Melan's limit "
    return replace(found, verdict=UNDECIDED, words=f"{why}{limit:.3g} (give a finer mesh)")


def groove_on_profile(surface: Developed, centres: Sequence[float], inclination: float) -> Laid:
    """Function that lays the grooves of passes on a rail's profile: from the state of the section
    below each patch to y and z (n, 2), mm, in the axes of the profile's file, before the rail is
    inclined.

    surface: of the rail as it stands. centres: arc length of the middle of the patches on it, mm.
    inclination: slope by which the rail leans. Points lie along the surface's normals, 0.2 mm
    (SPACING) apart or less.
    """
    s = np.linspace(surface.s[0], surface.s[-1], int(np.ptp(surface.s) / SPACING) + 2)
    normal, lean = surface.angle(s), math.atan(inclination)
    _, y, z = surface.points(np.zeros_like(s), s).T

    def laid(left: Sequence[RailState]) -> Array:
        """The profile (n, 2), mm."""
        up = sum(
            CubicSpline(each.across, each.up)(np.clip(s - centre, *each.across[[0, -1]]))
            for each, centre in zip(left, centres, strict=True)
        )
        y_now, z_now = y - up * np.sin(normal), z + up * np.cos(normal)
        turned = (y_now + 1j * z_now) * np.exp(-1j * lean)
        return np.column_stack([turned.real, turned.imag])

    return laid


def _of_scene(solved: Solved) -> tuple[RollingContact, bool, Laid | None]:
    """What rolls in a solved scene, whether it is symmetric about y = 0, and what lays the grooves
    on its profile. The last is None for line contacts and half-spaces. Raises ValueError where
    boundary elements fail.
    """
    plan, load = solved.plan, solved.plan.scene.load
    coefficient = interface.friction_coefficient(plan.context)
    hertz = solved.ellipse if load is None else plan.hertz  # which is the same on any ranks
    keeps = plan.scene.rolling.pressure == "hertz"
    if isinstance(hertz, LineContact):
        share = _share_of_full_slip(solved)
        contact = pass_contact.line_contact(
            hertz.half_width,
            hertz.load_per_length,
            hertz.curvature,
            hertz.contact_modulus,
            keeps=keeps,
            slips=math.copysign(coefficient, share) if share else 0.0,
            sticks=math.sqrt(1 - abs(share)),
            width=hertz.length,
        )
        return contact, False, None
    friction = _friction(solved)
    if plan.contact.half_space:
        contact = pass_contact.ellipse_contact(hertz, keeps=keeps)
        if friction is not None:
            x, y, _ = friction.points.T
            bounds = [coefficient * contact.patches[0].pressure]
            contact = _with_tractions(solved, contact, bounds, x, y, friction.traction[:, :2])
        return contact, not plan.scene.asymmetric_friction[1], None
    pair = plan.context.half_spaces
    surface, found = pair.developed, pair.pressed(load or solved.load)
    halves = [patch.half_extents for patch in found.patches]
    centres = [patch.centroid for patch in found.patches]
    symmetric = plan.contact.why_asymmetric_in_y() is None and len(halves) == 1
    symmetric &= not (plan.scene.asymmetric_friction[1] or plan.scene.friction.uneven)
    grids = [
        pass_contact.patch_grid(centre, half, surface.angle)
        for centre, half in zip(centres, halves, strict=True)
    ]
    contact = pass_contact.solid_contact(
        grids, surface.gap, found.load, hertz.contact_modulus, halves, keeps
    )
    if friction is not None:
        x, y, _ = friction.points.T
        across = np.interp(y, surface.y, surface.s)
        tilt, sideways = surface.angle(across), friction.traction[:, 1:]
        tangent = np.cos(tilt) * sideways[:, 0] + np.sin(tilt) * sideways[:, 1]
        traction = np.column_stack([friction.traction[:, 0], tangent])
        bounds = [
            surface.friction_coefficient(each.grid.s) * each.pressure for each in contact.patches
        ]
        contact = _with_tractions(solved, contact, bounds, x, across, traction)
    along = [s for _, s in centres]
    laid = groove_on_profile(surface, along, plan.scene.rail.inclination)
    return contact, symmetric, laid


def _friction(solved: Solved) -> FrictionSolution | None:
    """Tractions of a solved scene whose wheel rolls; None without them."""
    if not solved.plan.scene.rolling.prescribed:
        return None
    return solved.solution.friction if isinstance(solved, MeshSolution) else solved.friction


def _with_tractions(
    solved: Solved,
    contact: RollingContact,
    bounds: Sequence[Array],
    x: Array,
    s: Array,
    traction: Array,
) -> RollingContact:
    """Contact of solids with tractions (n, 2), MPa, along and across, found at places x, s (n,),
    mm. Where they exceed the bound (nx, ns) of a patch, MPa, they are reduced to that.
    """
    if solved.plan.half_y:
        x, s = np.concatenate([x, x]), np.concatenate([s, -s])
        traction = np.vstack([traction, traction * [1.0, -1.0]])
    # Four points on a circle have two triangulations: that of sorted points is the same each time.
    points, order = np.unique(np.column_stack([x, s]).round(5), axis=0, return_index=True)
    at = LinearNDInterpolator(points, traction[order], fill_value=0.0)
    patches = []
    for patch, bound in zip(contact.patches, bounds, strict=True):
        found = at(np.stack(np.meshgrid(patch.grid.x, patch.grid.s, indexing="ij"), axis=-1))
        size = np.hypot(found[..., 0], found[..., 1])
        found *= np.minimum(1.0, bound / np.maximum(size, 1e-300))[..., None]
        patches.append(replace(patch, traction=np.moveaxis(found, -1, 0)))
    return replace(contact, patches=tuple(patches))


def _share_of_full_slip(solved: Solved) -> float:
    """Tangential force of the wheel on the rail along it over that of full slip, -1 to 1; 0 without
    rolling with friction.
    """
    coefficient = interface.friction_coefficient(solved.plan.context)
    if not (solved.plan.scene.rolling.prescribed and solved.forces and coefficient):
        return 0.0
    share = float(solved.forces["force_along_N"]) / (coefficient * solved.load)
    return min(max(share, -1.0), 1.0)
