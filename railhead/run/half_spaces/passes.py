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
from numpy.typing import NDArray

from railhead.postprocess.passes import Passes, rail_state, row, words
from railhead.run.half_spaces import pass_contact
from railhead.run.half_spaces.pass_contact import RollingContact

if TYPE_CHECKING:
    from railhead.solver.material.elasticity import Material
    from railhead.solver.passes.rolling import RollingBlock, SectionState

Array = NDArray[np.float64]
PER_LENGTH = {"line": 8.0, "solid": 3.0}  # elements on a half length
GROWTH = {"line": 1.35, "solid": 1.6}  # of the elements beside the patch
REACH = {"line": 50.0, "solid": 12.0}  # of the block over the half length of the patch
DEEP, ASIDE = {"line": 3.4, "solid": 2.6}, 2.2  # plastic strain is followed, over half lengths
INNER, BELOW = 1.5, {"line": 2.2, "solid": 1.4}  # where the elements are small
TOLD = 5e-4  # strain of the first pass from which its energy is compared
SETTLED = 2e-3  # of the first plastic work: less is no longer compared with the resistance


def block(
    material: Material,
    half_lengths: tuple[float, float],
    *,
    line: bool,
    half: bool,
    per_length: float | None = None,
    reach: float | None = None,
) -> RollingBlock:
    """Block of a rail below a patch.

    material: elastic constants and flow curve.
    half_lengths: of the elastic patch, along and across, mm; of a line contact both are its half
        width.
    half: whether y = 0 is a symmetry plane.
    per_length: elements on a half length; None: PER_LENGTH. reach: of the block over the half
        length; None: REACH.
    """
    from railhead.solver.passes.block import Block, graded, mirrored
    from railhead.solver.passes.rolling import RollingBlock

    kind = "line" if line else "solid"
    count, growth = per_length or PER_LENGTH[kind], GROWTH[kind]
    a, b = half_lengths
    least, far = min(a, b), (reach or REACH[kind]) * max(a, b)
    x = mirrored(graded(INNER * a, a / count, far, growth))
    z = -graded(BELOW[kind] * least, least / count, far, growth)[::-1]
    depth = DEEP[kind] * least
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
    state: SectionState | None = None,
    stage: Callable[[str], None] = lambda name: None,
) -> tuple[Passes, SectionState]:
    """Roll `count` times over a block, from a state or from the start; the passes, and the state
    after them. stage: called with words before each pass. Raises ValueError where boundary
    elements find no balance.
    """
    from railhead.solver.passes.verdict import verdict

    pressing, state = pass_contact.Pressing(rolling, contact), state or rolling.start
    made, rows, sections, works = [], [], [], []
    stiff = 2 * rolling.block.material.lame[1]
    noise = rolling.tolerance * rolling.shear_yield / stiff
    for number in range(count):
        stage(f"pass {number + 1} of {count}")
        each = rolling.roll(state, pressing)
        assert pressing.patch is not None
        state = each.state
        made.append(each)
        sections.append(rail_state(rolling, state))
        rows.append(row(rolling, each, sections[-1], pressing.patch))
        whole = contact.width * (2 if rolling.block.half else 1)
        work, stored = whole * each.work, whole * each.stored
        resistance = None if contact.keeps else contact.resistance(pressing.patch)
        rubbed = pressing.traction_work
        works.append((work, stored, None if resistance is None else resistance + rubbed))
        rows[-1] |= {
            "work_N": work,
            "stored_N": stored,
            "resistance_N": resistance,
            "traction_work_N": rubbed,
        }
    found = verdict(
        [each["strain_increment_max"] for each in rows],
        [each["forward_mm"] for each in rows],
        half_lengths[0],
        noise,
        hardens=rolling.hardening.final_hardening_modulus > 0,
    )
    least = SETTLED * works[0][0] if rows[0]["strain_increment_max"] > TOLD else math.inf
    spent = [(work + kept, force) for work, kept, force in works if force is not None]
    errors = [abs(force - total) / total for total, force in spent if total > least]
    largest = max((float(each.growth.max()) for each in made), default=0.0)
    passes = Passes(
        rows=rows,
        verdict=found,
        words=words(found, rows, rolling),
        sections=sections,
        half_lengths=half_lengths,
        converged=all(each.converged for each in made),
        energy_error=max(errors, default=None),
        rim=max(each.rim for each in made) / largest if largest else 0.0,
        unknowns=rolling.block.nodes.size,
    )
    return passes, state
