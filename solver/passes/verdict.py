"""What passes of a load come to: elastic, shakedown, closed cycles, ratchetting, or in between."""

from __future__ import annotations

import math
from collections.abc import Sequence

FALLS = 0.9  # ratio of an increment to the one before, below which the increments fall
STEADY = 0.98  # ratio from which they are steady
SHARE = 0.1  # of the plastic strain that is there: what later passes may add after shakedown
NOTHING = 1e-2  # forward displacement over half length and strain increment, that counts as none

ELASTIC, SHAKES_DOWN, CYCLES = "elastic", "shakes down", "closed cycles"
RATCHETS, LIMIT, UNDECIDED = "ratchets", "at the limit", "undecided"


def verdict(
    increments: Sequence[float],
    forward: Sequence[float],
    length: float,
    noise: float,
    *,
    hardens: bool,
) -> str:
    """Verdict on n passes.

    increments: largest increase of the equivalent plastic strain in each pass (n,).
    forward: displacement of the surface along the rail in each pass (n,), mm.
    length: half length of the patch along the rail, mm.
    noise: increment that the tolerance of the solution may make.
    hardens: whether the flow curve rises without end; then nothing ratchets for ever, and no
        limit lies between shakedown and ratchetting: such passes are undecided.

    Elastic: nothing yields in the first pass. Shakedown: nothing yields in the last two; or the
    last two increments each fall below 0.9 of the one before, and all that a geometric series adds
    to them is below a tenth of their sum. Closed cycles: the increments are steady and the forward
    displacement is zero or, of a curve that rises without end, falls. Ratchetting: both are steady.
    In between, increments fall slowly, at the limit of shakedown. Fewer than three passes are
    undecided, before the fourth only shakedown is told, and a forward displacement that still grows
    or turns round is undecided.
    """
    small = [value <= noise for value in increments]
    if small and small[0] and all(small):
        return ELASTIC
    if len(small) > 2 and small[-1] and small[-2]:
        return SHAKES_DOWN
    if len(increments) < 3:
        return UNDECIDED
    falls = _ratio(increments)
    if falls < FALLS:
        rest = increments[-1] * falls / (1 - falls)
        return SHAKES_DOWN if rest < SHARE * sum(increments) else UNDECIDED
    if len(increments) < 4:
        return UNDECIDED
    still = abs(forward[-1]) <= NOTHING * length * increments[-1]
    steady = all(FALLS <= each <= 1 / FALLS for each in _ratios(forward))
    if falls < STEADY:
        return LIMIT if (still or steady) and not hardens else UNDECIDED
    if still or (hardens and _ratio(forward) < FALLS):
        return CYCLES
    return RATCHETS if steady and not hardens else UNDECIDED


def _ratios(values: Sequence[float]) -> list[float]:
    """The last two ratios of a value to the one before; infinite after zero."""
    return [b / a if a else math.inf for a, b in zip(values[-3:], values[-2:], strict=False)]


def _ratio(values: Sequence[float]) -> float:
    """Larger of the last two ratios of a value to the one before, in size."""
    return max(abs(each) for each in _ratios(values))
