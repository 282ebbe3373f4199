"""Wear and damage of rolling surfaces: laws, and the worn height after a step in one contact solve.

A line of a surface along the rolling direction loses the depth

    dh = k dn int w dx,    w = tractions x slip per rolled length (MPa)

in dn passages; w is the density of the dissipated energy and k the worn volume over that energy,
mm3/(N mm). With w = p x (w/p) and w/p frozen in a step, the depth of the step is linear in the
pressure p of its end (backward Euler): the surfaces part by c int p dx, c = k dn int w dx / int p
dx. That is a compliance of each line beside that of the half-spaces (`bem.influence.Lines`). The
matrix stays symmetric and positive definite: any step is stable, and nothing is smoothed.
Lengths in mm, forces in N, stresses in MPa.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import PchipInterpolator, make_interp_spline

from railhead.theory.array_types import Array
from railhead.theory.friction_laws import DENSITY

Pairs = tuple[tuple[float, float], ...]
"""Pairs of numbers, the first ones positive and rising."""
VOLUME = 1e-3 / DENSITY  # mm3/(N mm) of 1 ug per m and mm2 at 1 N/mm2
#: Wheel R8T on rail UIC60 900A, twin discs, as of `WearLaw`: 5.3 x, then 55, and 55 + 61.9 (x -
#: 77.2) beyond 77.2. Lewis and Dwyer-Joyce, Proc. IMechE J 218 (2004); Braghin and others, Wear 261
#: (2006). The last line is taken to go on without a jump; constants that are in print make one.
USFD: Pairs = ((55.0 / 5.3, 55.0), (77.2, 55.0), (78.2, 116.9))
#: T-gamma of a patch, N, and damage of one passage: no cracks up to 15 N, and beyond 175 N wear
#: takes them off. Burstow's whole-life rail model, from memory; others begin at 20 N.
DAMAGE: Pairs = ((15.0, 0.0), (65.0, 1e-5), (175.0, 0.0))
FIRST, DEEPEST = 0.125, 0.02  # largest share, and depth in mm, of the first step
LEAST = 6  # lines of a patch
ENDS, SMOOTH = 0.75, 0.1  # spacings from the outermost line to the end; of the value beside it
SHORTEST, GROWTH = 1e-5, 3.0  # share of a step that is not made shorter; largest growth


@dataclass(frozen=True)
class WearLaw:
    """Wear as a function of the energy that a patch dissipates, per rolled length and area.

    pairs: T-gamma over the area of the patch, N/mm2, and worn mass, ug per m rolled and mm2 of the
        patch. Straight lines from (0, 0) through the pairs; the last one goes on.
    """

    pairs: Pairs

    @classmethod
    def of_energy(cls, rate: float) -> WearLaw:
        """The law of one rate, mm3/(N mm): the worn volume is `rate` times the energy."""
        return cls(((1.0, rate / VOLUME),))

    def rate(self, density: float) -> float:
        """Worn volume over dissipated energy, mm3/(N mm), at a T-gamma over area (N/mm2)."""
        x, mass = np.transpose([(0.0, 0.0), *self.pairs])
        density = max(density, 1e-9 * float(x[1]))
        beyond = max(density - float(x[-1]), 0.0) * (mass[-1] - mass[-2]) / (x[-1] - x[-2])
        return VOLUME * float(np.interp(density, x, mass) + beyond) / density


def damage(t_gamma: float) -> float:
    """Damage of one passage by T-gamma of a patch (N), as of DAMAGE; 1 is a crack that shows."""
    return float(np.interp(t_gamma, *np.transpose(DAMAGE)))


def onto(places: Array, s: Array, values: Array) -> Array:
    """Values (n,) at places (n,) of a curve through values (m,), none below 0, at s (m,), evenly
    spaced, mm, by cubic pieces that make no new extremes; zero beyond its ends, which follow from
    the outermost values above 0 (`_ended`).
    """
    (used,) = np.nonzero(values)
    if used.size < LEAST:
        return np.zeros_like(places)
    low, left = _ended(s[used[0] :], values[used[0] :])
    high, right = _ended(s[used[-1] :: -1], values[used[-1] :: -1])
    inner = slice(used[0] + left, used[-1] + 1 - right)
    x = np.concatenate([[low], s[inner], [high]])
    return np.nan_to_num(PchipInterpolator(x, np.pad(values[inner], 1), extrapolate=False)(places))


def _ended(s: Array, values: Array) -> tuple[float, int]:
    """Place at which values at s, mm, from the outermost one on, end, and how many of them do not
    count. The outermost line, which a smooth patch covers in part, does not where the parabola
    through the three next ones goes through it and is 0 close to it. Else the end is where the
    straight line through the last two is 0, or one spacing beyond.
    """
    edge, one, two, three = values[:4].tolist()
    bend, rise = (one - 2 * two + three) / 2, (one - three) / 2
    smooth = abs(two + 2 * rise + 4 * bend - edge) <= SMOOTH * one
    for root in np.roots([bend, rise, two]) if smooth else ():  # s[1] is at 1, the outermost at 2
        if root.imag == 0 and abs(root.real - 2) <= ENDS:
            return float(s[2] + root.real * (s[1] - s[2])), 1
    return float(s[0] + (s[0] - s[1]) * min(1.0, edge / max(one - edge, edge))), 0


def seen(values: Array, step: float, width: Array) -> Array:
    """Values (n,) that are `step` mm apart, as lines of the width (n,), mm, see them: averages with
    weights that fall linearly to zero at one width to each side. With values as of `onto` this
    keeps the influence of several grids on each other symmetric; what is shorter than a line cannot
    be taken for a longer wave.
    """
    s = step * np.arange(values.size)
    twice = make_interp_spline(s, values, k=1).antiderivative(2)
    ends = twice(s + width) + twice(s - width) - 2 * twice(s)
    return np.asarray(ends / width**2)


Advance = Callable[[Array, Sequence[float]], list[Array]]
"""Worn depth (n,), mm, and shares of the whole wear -> depth (n,) after one step of backward Euler
from there for each of the shares."""


@dataclass(frozen=True)
class Stage:
    """Worn depth after a step.

    done: share of the whole wear, 0 to 1.
    depth: (n,), mm.
    change: largest change of the depth by two half steps in the place of the step, mm.
    share: of the whole wear that the next step should take.
    """

    done: float
    depth: Array
    change: float
    share: float


def march(advance: Advance, start: Stage, ends: Sequence[float]) -> Iterator[Stage]:
    """Worn depth after each of some shares of the whole wear, ascending and after that of `start`.

    A step is made whole and in two halves; twice the second less the first has an error of second
    order. Depth never falls.
    """
    stage = start
    for end in ends:
        stage = _step(advance, stage, end - stage.done)
        yield stage


def march_freely(
    advance: Advance, start: Stage, accuracy: float, largest: float = math.inf
) -> Iterator[Stage]:
    """Worn depth as of `march` after steps that are chosen: halving a step changes the depth by no
    more than about the accuracy, a fraction of the largest depth that is expected at the end, and
    no more than about `largest`, mm. A step in which `advance` raises ValueError is made shorter;
    from SHORTEST on it is raised.
    """
    stage = start
    while stage.done < 1.0:
        count = math.ceil((1.0 - stage.done) / stage.share - 1e-9)
        share = (1.0 - stage.done) / count
        try:
            found = _step(advance, stage, share)
        except ValueError:
            if share <= SHORTEST:
                raise
            stage = replace(stage, share=share / GROWTH)
            continue
        most = min(accuracy * float(found.depth.max()) / found.done, largest)
        factor = 0.9 * math.sqrt(most / found.change) if found.change > 0 else GROWTH
        if found.change > 2 * most and share > SHORTEST:
            stage = replace(stage, share=share * max(factor, 1 / GROWTH))
            continue
        stage = replace(found, share=share * min(factor, GROWTH))
        yield stage


def _step(advance: Advance, stage: Stage, share: float) -> Stage:
    """The stage after a step from another one."""
    whole, half = advance(stage.depth, (share, share / 2))
    (halves,) = advance(half, (share / 2,))
    depth = np.maximum(2 * halves - whole, stage.depth)
    done = 1.0 if stage.done + share > 1.0 - 1e-9 else stage.done + share
    return Stage(done, depth, float(np.abs(halves - whole).max()), share)
