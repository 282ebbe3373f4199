"""Wear and damage of rolling surfaces: laws, and the worn depth after a step in one contact solve.

A line of a surface along the rolling direction loses the depth

    dh = k dn int w dx,    w = tractions x slip per rolled length (MPa)

in dn passages; w is the density of the dissipated energy and k the worn volume over that energy,
mm3/(N mm). With w = p x (w/p) and w/p frozen in a step, the depth of the step is linear in the
pressure p of its end (backward Euler): dh = c int p dx, c = k dn int w dx / int p dx.

The depth is a cubic spline whose knots stay where they are on the profile: dh is projected onto
these splines by least squares (`Splines`). So the surfaces part by sqrt(c) P sqrt(c) int p dx, with
the projection P: a compliance of lines beside that of the half-spaces (`bem.influence.Lines`). The
matrix stays symmetric and positive definite: any step is stable.
Lengths in mm, forces in N, stresses in MPa.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline
from scipy.sparse.linalg import splu

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
FIRST, DEEPEST = 0.25, 0.02  # largest share, and depth in mm, of the first step
SHORT, SHORTEST = 0.1, 1e-3  # least steps: of what is done before, and of the whole
GROWTH = 3.0  # largest, from one step to the next
WILD = 0.5  # change of the rate in a shortest step, at which steps follow it no longer


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


@dataclass(frozen=True)
class Splines:
    """Cubic splines over evenly spaced places, with evenly spaced knots.

    places: number of places, n.
    knots: number of intervals between knots.
    """

    places: int
    knots: int

    @cached_property
    def _basis(self) -> tuple[Any, Any]:
        """Values (n, knots + 3) of the B-splines at the places, and the factors of their normal
        equations.
        """
        inner = np.linspace(0.0, 1.0, self.knots + 1)
        x = np.linspace(0.0, 1.0, self.places).clip(max=1 - 1e-12)
        basis = BSpline.design_matrix(x, np.pad(inner, 3, mode="edge"), 3)
        return basis.tocsr(), splu((basis.T @ basis).tocsc())

    def projected(self, values: Array) -> Array:
        """The spline (n,) that is nearest to values (n,) by least squares: P values."""
        basis, factors = self._basis
        return np.asarray(basis @ factors.solve(np.asarray(basis.T @ values)))

    def between(self, weights: Array) -> Array:
        """weights^T P weights (m, m) of weights (n, m): symmetric, none of its eigenvalues below
        0.
        """
        basis, factors = self._basis
        moments = np.asarray(basis.T @ weights)
        return np.asarray(moments.T @ factors.solve(moments))


def averaged(values: Array, step: float, width: float) -> Array:
    """Values (n, ...) that are `step` mm apart, and zero beyond, averaged with weights that fall
    linearly to zero at a width, mm, to each side.
    """
    more = math.ceil(width / step) + 1
    padded = np.pad(values, [(more, more)] + [(0, 0)] * (values.ndim - 1))
    s = step * np.arange(-more, len(values) + more)
    twice, s = make_interp_spline(s, padded, k=1).antiderivative(2), s[more:-more]
    return np.asarray((twice(s + width) + twice(s - width) - 2 * twice(s)) / width**2)


Advance = Callable[[Array, float], tuple[Array, float]]
"""Worn depth (n,), mm, and a share of the whole wear -> depth (n,) after a step of backward Euler
from there, and its change: how far the rate of wear at the start of the step is from that at its
end, over the latter."""


@dataclass(frozen=True)
class Stage:
    """Worn depth after a step.

    done: share of the whole wear, 0 to 1.
    depth: (n,), mm.
    change: of the step, as of `Advance`.
    share: of the whole wear that the next step should take.
    """

    done: float
    depth: Array
    change: float
    share: float


def march(advance: Advance, start: Stage, ends: Sequence[float]) -> Iterator[Stage]:
    """Worn depth after each of some shares of the whole wear, ascending and after that of `start`,
    by backward Euler.
    """
    stage = start
    for end in ends:
        depth, change = advance(stage.depth, end - stage.done)
        stage = Stage(end, depth, change, end - stage.done)
        yield stage


def march_freely(advance: Advance, start: Stage, largest: float) -> Iterator[Stage]:
    """Worn depth as of `march` after steps that are chosen: the change of each is about `largest`,
    and no more than twice that, but a step is at least SHORT of what is done before, and SHORTEST.
    A step in which `advance` raises ValueError is made shorter; from SHORTEST on it is raised, and
    where the rate changes by more than WILD in a step that cannot be shorter.
    """
    stage = start
    while stage.done < 1.0:
        count = math.ceil((1.0 - stage.done) / stage.share - 1e-9)
        share = (1.0 - stage.done) / count
        try:
            depth, change = advance(stage.depth, share)
        except ValueError:
            if share <= SHORTEST:
                raise
            stage = replace(stage, share=share / GROWTH)
            continue
        factor = min(max(largest / max(change, 1e-9), 1 / GROWTH), GROWTH)
        following = max(share * factor, SHORT * stage.done, SHORTEST)
        if change > 2 * largest and following < share:
            stage = replace(stage, share=following)
            continue
        if change > max(WILD, 2 * largest):
            raise ValueError(f"the rate of wear changes by {change:.0%} in a step of {share:.1%}")
        done = 1.0 if count == 1 else stage.done + share
        stage = Stage(done, depth, change, following)
        yield stage
