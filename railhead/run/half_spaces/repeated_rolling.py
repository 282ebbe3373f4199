"""A wheel that rolls again and again over a rail that yields: passes on a half-space of rail steel.

Below the patch the rail is a block of quadratic cells, whose far faces are held (`solver.passes`);
what rolls is in `run.half_spaces.pass_contact`. Lengths in mm, forces in N, stresses in MPa; z
points out of the rail.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from railhead.postprocess.pass_rows import Passes, rail_state, row, verdict, words
from railhead.run.half_spaces import pass_contact
from railhead.run.half_spaces.pass_contact import RollingContact

if TYPE_CHECKING:
    from railhead.solver.material.elasticity import Material
    from railhead.solver.passes.rolling_block import RollingBlock

# By whether the contact is a line:
PER_LENGTH = {True: 8.0, False: 4.0}  # elements on a half length
GROWTH = {True: 1.35, False: 1.6}  # of the elements beside the patch
REACH = {True: 50.0, False: 12.0}  # of the block over the half length of the patch
DEEP, ASIDE = {True: 3.4, False: 2.6}, 2.2  # plastic strain is followed, over half lengths
INNER, BELOW = 1.5, {True: 2.2, False: 1.4}  # where the elements are small
TOLD = 5e-4  # strain of the first pass from which its energy is compared
SETTLED = 2e-3  # of the first plastic work: less is no longer compared with the resistance
COARSER = 0.75  # size of the block by which errors are estimated: elements and reach, relative


def block(
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
    coarser: factor on both.
    """
    from railhead.solver.passes.block import Block, graded, mirrored
    from railhead.solver.passes.rolling_block import RollingBlock

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
    before: Passes | None = None,
    stage: Callable[[str], None] = lambda name: None,
) -> Passes:
    """Roll `count` times over a block, on from the passes `before`, which come first in what is
    returned; None: the rail is new. stage: called with words before each pass. Raises ValueError
    where boundary elements find no balance.
    """
    pressing = pass_contact.Pressing(rolling, contact)
    rows, sections = ([*before.rows], [*before.sections]) if before else ([], [])
    state, last = (before and before.state) or rolling.start, len(rows) + count
    stiff = 2 * rolling.block.material.lame[1]
    whole = contact.width * (2 if rolling.block.half else 1)
    while len(rows) < last:
        stage(f"pass {len(rows) + 1} of {last}")
        if not contact.keeps:
            pressing.patch = None  # else a run in two parts would differ in the last digits
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
    increments = [each["strain_increment_max"] for each in rows]
    found = verdict(
        increments,
        [each["forward_mm"] for each in rows],
        half_lengths[0],
        rolling.tolerance * rolling.shear_yield / stiff,
        hardens=rolling.hardening.final_hardening_modulus > 0,
    )
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
        sections=sections,
        state=state,
        axes=np.concatenate(rolling.block.axes),
        half_lengths=half_lengths,
        converged=all(each["change"] < rolling.tolerance for each in rows),
        energy_error=max(errors, default=None),
        rim=max(each["strain_increment_rim"] for each in rows) / (max(increments) or 1.0),
        unknowns=rolling.block.nodes.size,
    )
