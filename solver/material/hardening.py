"""Small-strain von Mises plasticity at points: yield, hardening, radial return, tangent.

Stress and strain are vectors in Mandel's notation (n, m): the normal components 11, 22, 33 first,
shears times sqrt(2) after them, so that a : b is a sum of products. The stress is
s = C (eps - eps_p), the yield function |dev s - alpha| - sqrt(2/3) kappa(q), with the equivalent
plastic strain q, and backward Euler over a load step (Simo and Hughes, Computational Inelasticity,
1998, boxes 3.1 and 3.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ROOT = np.sqrt(2.0 / 3.0)


@dataclass(frozen=True)
class Hardening:
    """Uniaxial true stress (k,) MPa at plastic strain (k,), the first at 0, straight between them;
    beyond: slope after the last, MPa; kinematic: share of the growth by which the surface moves
    instead of growing (Prager's rule), 0 to 1."""

    strain: tuple[float, ...]
    stress: tuple[float, ...]
    kinematic: float = 0.0
    beyond: float = 0.0

    @classmethod
    def linear(cls, stress: float, modulus: float = 0.0, kinematic: float = 0.0) -> Hardening:
        """Yield at a stress (MPa) and a constant modulus d stress / d plastic strain (MPa)."""
        return cls((0.0,), (stress,), kinematic, modulus)

    @property
    def first(self) -> float:
        """Stress at which it begins to yield, MPa."""
        return self.stress[0]

    @property
    def segments(self) -> tuple[Array, Array, Array]:
        """Plastic strain and stress (MPa) of the points (k,), and the slope behind each, MPa."""
        strain, stress = np.array(self.strain), np.array(self.stress)
        return strain, stress, np.append(np.diff(stress) / np.diff(strain), self.beyond)

    def at(self, plastic: Array) -> tuple[Array, Array]:
        """Stress of the curve and its slope, MPa, at equivalent plastic strains (n,)."""
        strain, stress, slopes = self.segments
        segment = np.searchsorted(strain, plastic, side="right") - 1
        return stress[segment] + slopes[segment] * (plastic - strain[segment]), slopes[segment]


@dataclass(frozen=True)
class History:
    """plastic (n, m) strain; back (n, m) stress, MPa; equivalent (n,) plastic strain."""

    plastic: Array
    back: Array
    equivalent: Array

    @classmethod
    def virgin(cls, count: int, size: int) -> History:
        """Nothing has yielded."""
        return cls(np.zeros((count, size)), np.zeros((count, size)), np.zeros(count))


@dataclass(frozen=True)
class Loss:
    """What the tangent loses, C - C_ep = 2 mu (shear (I - 1x1/3) + along n x n), at the yielding
    points (k,) of all."""

    points: NDArray[np.int64]
    shear: Array
    along: Array
    normal: Array
    mu: Array

    def among(self, members: NDArray[np.int64]) -> Loss:
        """The same with points numbered among all, of which these `members` were looked at."""
        return replace(self, points=members[self.points])

    @classmethod
    def joined(cls, losses: Sequence[Loss]) -> Loss:
        """Of several sets of points."""
        parts = {each.name: [getattr(loss, each.name) for loss in losses] for each in fields(cls)}
        return cls(**{name: np.concatenate(values) for name, values in parts.items()})

    def of(self, strain: Array) -> Array:
        """(C - C_ep) : strain (k, m), MPa, of strains (k, m) at these points."""
        along = np.einsum("km,km->k", self.normal, strain) * self.along
        sheared = self.shear[:, None] * deviator(strain)
        return 2 * self.mu[:, None] * (sheared + along[:, None] * self.normal)


def deviator(tensors: Array) -> Array:
    """Of (n, m) tensors."""
    out = tensors.copy()
    out[:, :3] -= tensors[:, :3].mean(axis=1, keepdims=True)
    return out


def returned(
    strain: Array, mu: Array, before: History, hardening: Hardening
) -> tuple[History, Loss]:
    """State of points after a step to strains (n, m), with shear moduli mu (n,) MPa."""
    trial = 2 * mu[:, None] * (deviator(strain) - before.plastic) - before.back
    size = np.sqrt(np.einsum("nm,nm->n", trial, trial))
    share = hardening.kinematic
    first = hardening.first
    curve, _ = hardening.at(before.equivalent)
    radius = first + (1 - share) * (curve - first)
    yielding = np.flatnonzero(size > ROOT * radius * (1 + 1e-12))
    mu, size = mu[yielding], size[yielding]
    normal = trial[yielding] / size[:, None]
    start, curve = before.equivalent[yielding], curve[yielding]
    # 2 mu q / ROOT + ROOT k(q) = reached, piecewise straight and growing with q: the segment by
    # bisection of the points of the curve, then a linear equation.
    strain_at, stress_at, slopes = hardening.segments
    reached = size + 2 * mu * start / ROOT + ROOT * share * (curve - first)
    low, high = np.zeros(len(yielding), dtype=int), np.full(len(yielding), len(strain_at))
    for _ in range(len(strain_at).bit_length()):
        middle = (low + high) // 2
        beyond = 2 * mu * strain_at[middle] / ROOT + ROOT * stress_at[middle] <= reached
        low, high = np.where(beyond, middle, low), np.where(beyond, high, middle)
    slope = slopes[low]
    excess = reached - 2 * mu * strain_at[low] / ROOT - ROOT * stress_at[low]
    growth = np.maximum(strain_at[low] + excess / (2 * mu / ROOT + ROOT * slope) - start, 0.0)
    step, now = growth / ROOT, hardening.at(start + growth)[0]
    plastic, back = before.plastic.copy(), before.back.copy()
    equivalent = before.equivalent.copy()
    plastic[yielding] += step[:, None] * normal
    back[yielding] += (ROOT * share * (now - curve))[:, None] * normal
    equivalent[yielding] += growth
    shear = 2 * mu * step / size
    along = 1 / (1 + slope / (3 * mu)) - shear
    return History(plastic, back, equivalent), Loss(yielding, shear, along, normal, mu)
