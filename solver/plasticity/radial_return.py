"""von Mises plasticity at points: the state of steel after a load step, and the tangent.

Stress and strain at points are vectors in Mandel's notation (n, m): the normal components 11, 22,
33 first, shears times sqrt(2) after them, so that a : b is a sum of products. The stress is
s = C (eps - eps_p), the yield function |dev s - alpha| - sqrt(2/3) kappa(q), with the equivalent
plastic strain q, and backward Euler over a load step (Simo and Hughes, Computational Inelasticity,
1998, boxes 3.1 and 3.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from railhead.solver.material import Hardening
from railhead.theory.array_types import Array, Index

ROOT = np.sqrt(2.0 / 3.0)
NEWTON_STEPS = 100  # most of the return to the yield surface
RETURN_TOLERANCE = 1e-11  # of its equations, over the trial stress
ROUGH_TOLERANCE = 1e-7  # the same where no tangent is wanted
SKEW = 1e-9  # of the largest entry of tangents that count as symmetric
LEAST_SIZE = 1e-14  # of a back stress over its limit, in Newton's method


@dataclass(frozen=True)
class History:
    """Plastic state of n points after a load step, with m components in Mandel's notation.

    plastic: plastic strain (n, m).
    back: k back stresses (n, k, m), MPa, whose sum is the centre of the yield surface.
    equivalent: equivalent plastic strain (n,).
    ahead: plastic strain (n, m), and equivalent_ahead: equivalent plastic strain (n,), by which
        `plastic` and `equivalent` have run ahead of `back` (`extrapolated`).
    """

    plastic: Array
    back: Array
    equivalent: Array
    ahead: Array
    equivalent_ahead: Array

    @classmethod
    def virgin(cls, count: int, size: int, backs: int = 1) -> History:
        """State of `count` points without plastic strain or back stress; size: number m of
        components; backs: number k of back stresses.
        """
        strain, back = np.zeros((count, size)), np.zeros((count, backs, size))
        return cls(strain, back, np.zeros(count), strain.copy(), np.zeros(count))

    def at(self, points: Index) -> History:
        """State of the points with the given numbers (k,), a copy."""
        parts = self.plastic, self.back, self.equivalent, self.ahead, self.equivalent_ahead
        return History(*(each[points] for each in parts))

    def put(self, points: Index, state: History) -> None:
        """Replace the state of the points with the given numbers (k,); further back stresses of
        these points are zero.
        """
        backs = state.back.shape[1]
        for each in fields(self):
            own, given = getattr(self, each.name), getattr(state, each.name)
            own[(points, slice(backs)) if each.name == "back" else points] = given

    def excess(self, elastic: Array, hardening: Hardening) -> Array:
        """Yield function (n,), MPa, of deviatoric stresses (n, m): positive where they yield."""
        radius = ROOT * hardening.radius(self.equivalent)[0]
        return np.asarray(_norm(elastic - self.back.sum(axis=1)) - radius)

    def run_ahead(self, factor: Array, plastic: Array, equivalent: Array) -> None:
        """Add to the plastic strain of each point a multiple of its last change, as a start for the
        radial return of the next step (BDF2). Back stresses stay: the radial return moves them.

        factor: the multiple (n,). plastic, equivalent: last changes of plastic strain (n, m) and of
            equivalent plastic strain (n,).
        """
        self.ahead[:], self.equivalent_ahead[:] = factor[:, None] * plastic, factor * equivalent
        self.plastic[:] += self.ahead
        self.equivalent[:] += self.equivalent_ahead

    def extrapolated(self, earlier: History, factor: float, points: Index) -> History:
        """A copy of this state in which some points have run ahead, see `run_ahead`.

        earlier: state of the same points one load step before. factor: multiple of the change since
            then. points: numbers (k,) of the points that run ahead.
        """
        out, factors = self.at(np.arange(len(self.plastic))), np.zeros(len(self.plastic))
        factors[points] = factor
        changes = self.plastic - earlier.plastic, self.equivalent - earlier.equivalent
        out.run_ahead(factors, *changes)
        return out


@dataclass(frozen=True, kw_only=True)
class TangentReduction:
    """Difference between the elastic tangent C and the consistent tangent C_ep, at the k points
    that yield.

    points: numbers (k,) of these points among all.
    matrix: C - C_ep (k, m, m), MPa, in Mandel's notation.
    """

    points: Index
    matrix: Array

    @classmethod
    def none(cls, size: int) -> TangentReduction:
        """Reduction at no point; size: number m of components."""
        return cls(points=np.zeros(0, dtype=np.int64), matrix=np.zeros((0, size, size)))

    @classmethod
    def joined(cls, reductions: Sequence[TangentReduction]) -> TangentReduction:
        """One tangent reduction that holds the points of several reductions, in their order."""
        parts = {each.name: [getattr(one, each.name) for one in reductions] for each in fields(cls)}
        return cls(**{name: np.concatenate(values) for name, values in parts.items()})

    @cached_property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric; back stresses that are recalled turn its range, unless
        plastic strain goes along them.
        """
        skew = np.abs(self.matrix - self.matrix.swapaxes(1, 2)).max(initial=0.0)
        return bool(skew <= SKEW * np.abs(self.matrix).max(initial=0.0))

    def stress(self, strain: Array) -> Array:
        """Stress (C - C_ep) : strain (k, m), MPa, from strains (k, m) at the k points, in Mandel's
        notation.
        """
        return np.asarray((self.matrix @ strain[..., None])[..., 0])


def _norm(tensors: Array) -> Array:
    """Norm (...,) of tensors (..., m)."""
    return np.asarray(np.sqrt(np.einsum("...m,...m->...", tensors, tensors)))


def deviator(tensors: Array) -> Array:
    """Deviatoric part (..., m) of tensors (..., m) in Mandel's notation, whose first three
    components are the normal ones.
    """
    out = tensors.copy()
    out[..., :3] -= tensors[..., :3].mean(axis=-1, keepdims=True)
    return out


@dataclass
class _Return:
    """Equations of the return of k points that yield, in Newton's method: unknown are the growth d
    of the equivalent plastic strain in the step, and the sizes y_i = |X_i| g_i / C_i at its end,
    these only where a recall exponent makes them count.

        n . (s* - sum X_i) - sqrt(6) mu d - sqrt(2/3) kappa(p) = 0,    y_i - |X_i| g_i / C_i = 0

    Over the step dp each back stress follows exactly from a constant direction of plastic strain
    and a constant recall phi, X = exp(-g phi dp) X_0 + 2/3 C psi deps_p with psi = (1 -
    exp(-z))/z, z = g phi dp. phi is a mean of its values at both ends, whose weight of the end
    grows from 1/2 to 1 with the step, so that it is of second order and does not swing.
    """

    hardening: Hardening
    mu: Array
    elastic: Array
    before: History

    def __post_init__(self) -> None:
        """Constants of the back stresses (b,), and the state without growth."""
        law = self.hardening
        self.bent = law.kinematic > 0 and len(law.strain) > 1  # else Prager's part has one modulus
        self.modulus, self.recall, self.scale = law.constants
        self.growth = np.zeros(len(self.mu))
        self.size = np.full(self.before.back.shape[:2], LEAST_SIZE)
        if law.recall_exponent:
            self.size = np.maximum(self.sizes(self.before.back), LEAST_SIZE)

    def sizes(self, back: Array) -> Array:
        """von Mises sizes (k, b) of back stresses (k, b, m) over their limits C/g."""
        return np.asarray(self.scale * _norm(back))

    def evaluate(self) -> None:
        """Back stresses, direction, residuals (k, u) of the u unknowns, and what `derivatives`
        needs.
        """
        law, before, chi = self.hardening, self.before, self.hardening.recall_exponent
        step = before.equivalent_ahead + self.growth
        self.step = np.maximum(step, 1e-300)[:, None]
        self.plastic = before.equivalent + self.growth
        self.phi, self.turn = np.ones(()), np.zeros(())
        if chi:
            start = self.sizes(before.back) ** chi
            now, late = self.size**chi, self.step * self.recall * (1 + chi)
            self.weight = (1 + late) / (2 + late)
            self.phi = self.weight * now + (1 - self.weight) * start
            self.turn = (now - start) * self.recall * (1 + chi) / (2 + late) ** 2
        self.z = np.maximum(self.recall * self.phi * self.step, 1e-300)
        self.kept = np.exp(-self.z)
        self.psi = -np.expm1(-self.z) / self.z
        self.gain = 2 / 3 * self.modulus * self.psi
        if self.bent:
            curve, self.slope = law.stress_and_slope(self.plastic)
            self.moved = law.kinematic * (curve - law.stress_and_slope(self.plastic - step)[0])
            self.gain = self.gain + 2 / 3 * self.moved[:, None] / self.step
        fixed = self.kept[..., None] * before.back + self.gain[..., None] * before.ahead[:, None]
        across = self.elastic - fixed.sum(axis=1)
        self.norm = np.maximum(_norm(across), 1e-300)
        self.normal = across / self.norm[:, None]
        self.strain = before.ahead + self.growth[:, None] * self.normal / ROOT
        self.back = self.kept[..., None] * before.back + self.gain[..., None] * self.strain[:, None]
        radius, self.radius_slope = law.radius(self.plastic)
        along = self.norm - self.growth * self.gain.sum(axis=1) / ROOT
        self.excess = along - 2 * self.mu * self.growth / ROOT - ROOT * radius
        self.residual = self.excess[:, None]
        if chi:
            wrong = self.size - self.sizes(self.back)
            self.residual = np.concatenate([self.residual, wrong], axis=1)

    def derivatives(self) -> tuple[Array, Array, Array]:
        """Derivatives of the residuals by the unknowns (k, u, u) and by s* (k, u, m), and of the
        sum of the back stresses by the unknowns, at a kept direction (k, u, m).
        """
        chi, before = self.hardening.recall_exponent, self.before
        bend = np.where(self.z < 1e-4, self.z / 3 - 0.5, (self.kept - self.psi) / self.z)
        by_z = 2 / 3 * self.modulus[:, None] * bend[..., None] * self.strain[:, None]
        by_z = by_z - self.kept[..., None] * before.back
        speed = self.recall * (self.phi + self.step * self.turn)
        by_growth = by_z * speed[..., None]
        if self.bent:
            prager = self.hardening.kinematic * self.slope - self.moved / self.step[:, 0]
            drift = 2 / 3 * (prager / self.step[:, 0])[:, None] * self.strain
            by_growth = by_growth + drift[:, None]
        by_growth = by_growth + self.gain[..., None] * self.normal[:, None] / ROOT
        total, by_stress = by_growth.sum(axis=1)[:, None], self.normal[:, None]
        if chi:
            power = self.weight * chi * self.size ** (chi - 1)
            by_size = by_z * (self.recall * self.step * power)[..., None]
            total = np.concatenate([total, by_size], axis=1)
        jacobian = -np.einsum("km,kum->ku", self.normal, total)[:, None]
        jacobian[:, 0, 0] -= 2 * self.mu / ROOT + ROOT * self.radius_slope
        if chi:
            unit = self.scale[:, None] * self.back
            unit = unit / np.maximum(_norm(self.back), 1e-300)[..., None]
            turned = (self.gain * self.growth[:, None] / ROOT / self.norm[:, None])[..., None]
            turned = turned * self.across(unit)
            rows = np.einsum("kbm,kum->kbu", turned, total)
            rows[..., 0] -= np.einsum("kbm,kbm->kb", unit, by_growth)
            every = np.arange(len(self.recall))
            rows[:, every, 1 + every] += 1 - np.einsum("kbm,kbm->kb", unit, by_size)
            jacobian = np.concatenate([jacobian, rows], axis=1)
            by_stress = np.concatenate([by_stress, -turned], axis=1)
        return jacobian, by_stress, total

    def across(self, tensors: Array) -> Array:
        """Part of tensors (k, u, m) across the direction of plastic strain."""
        along = np.einsum("kum,km->ku", tensors, self.normal)
        return np.asarray(tensors - along[..., None] * self.normal[:, None])

    def solve(self, excess: Array, tolerance: float) -> None:
        """Newton's method from no growth, where the first equation has the value `excess` (k,), to
        a tolerance over the trial stress; at points where a step would enlarge the residual it is
        shortened. Raises ValueError where it does not converge.
        """
        chi, before = self.hardening.recall_exponent, self.before
        units = np.ones((len(excess), 1 + (len(self.recall) if chi else 0)))
        units[:, 0] = excess + self.hardening.initial_yield_stress
        limit = np.maximum(2 ** (1 / (1 + chi)), self.size)  # as the end weighs a half
        slope = self.hardening.radius(before.equivalent)[1]
        back = before.back.sum(axis=1)
        way = self.elastic - back
        recalled = np.einsum("km,kbm,b->k", way, before.back, self.recall) / _norm(way)
        stiff = 2 * self.mu / ROOT + ROOT * (slope + self.modulus.sum())
        stiff = np.maximum(stiff - recalled, self.mu)
        now = np.column_stack([excess / stiff, self.size])[:, : units.shape[1]]
        least, most = np.full_like(now, LEAST_SIZE), np.full_like(now, np.inf)
        least[:, 0], most[:, 1:] = -before.equivalent_ahead, limit[:, : now.shape[1] - 1]
        start, change, share = now, np.zeros_like(now), np.ones((len(now), 1))
        smallest = np.full((len(now), 1), np.inf)
        for _ in range(NEWTON_STEPS):
            self.growth = now[:, 0]
            if chi:
                self.size = now[:, 1:]
            self.evaluate()
            wrong = np.abs(self.residual / units)
            done = (wrong < tolerance).all(axis=1, keepdims=True)
            if done.all():
                return
            left = _norm(wrong)[:, None]
            better = (left < smallest) | done
            share = np.where(better, 1.0, share / 4)
            start, smallest = np.where(better, now, start), np.minimum(left, smallest)
            jacobian = self.derivatives()[0]
            step = (
                np.linalg.solve(jacobian, self.residual[..., None])[..., 0]
                if chi
                else self.residual / jacobian[:, 0]
            )
            change = np.where(done, 0.0, np.where(better, step, change))
            now = np.minimum(np.maximum(start - share * change, least), most)
        raise ValueError("the return to the yield surface does not converge")

    def reduction(self) -> Array:
        """C - C_ep (k, m, m), MPa."""
        jacobian, by_stress, total = self.derivatives()
        unknowns = -np.linalg.solve(jacobian, by_stress)
        turned = np.eye(self.normal.shape[1]) - np.einsum("kum,kun->kmn", total, unknowns)
        turned = self.across(turned.swapaxes(1, 2)).swapaxes(1, 2)
        flow = self.normal[:, :, None] * unknowns[:, :1]
        flow = flow + (self.growth / self.norm)[:, None, None] * turned
        return np.asarray(deviator(flow) / ROOT * (2 * self.mu[:, None, None]) ** 2)


def radial_return(
    strain: Array, mu: Array, before: History, hardening: Hardening, *, tangent: bool = True
) -> tuple[History, TangentReduction]:
    """State at n points after a load step, and the reduction of the tangent at the points that
    yield.

    strain: total strain at the end of the step (n, m), in Mandel's notation.
    mu: shear modulus (n,), MPa.
    before: state at the start of the step.
    hardening: law of all points.
    tangent: whether the reduction is wanted; else it is that of no point.
    The trial stress returns along the radius that the back stresses of the end leave (Simo and
    Hughes 1998, box 3.2, with one scalar equation a point; `_Return`).
    """
    backs = max(len(hardening.backstresses), 1)
    before = replace(before, back=before.back[:, :backs])
    elastic = 2 * mu[:, None] * (deviator(strain) - before.plastic)
    if before.equivalent_ahead.any():
        start = _Return(hardening, mu, elastic, before)
        start.evaluate()
        back, excess = start.back, start.excess
    else:
        back, excess = before.back.copy(), before.excess(elastic, hardening)
    yielding = np.flatnonzero(excess > 1e-12 * ROOT * hardening.initial_yield_stress)
    nothing, no_strain = np.zeros(len(mu)), np.zeros_like(strain)
    after = History(before.plastic.copy(), back, before.equivalent.copy(), no_strain, nothing)
    if not len(yielding):
        return after, TangentReduction.none(strain.shape[1])
    at = before.at(yielding)
    found = _Return(hardening.at(yielding), mu[yielding], elastic[yielding], at)
    found.solve(excess[yielding], RETURN_TOLERANCE if tangent else ROUGH_TOLERANCE)
    after.plastic[yielding] += found.strain - at.ahead
    after.back[yielding], after.equivalent[yielding] = found.back, found.plastic
    if not tangent:
        return after, TangentReduction.none(strain.shape[1])
    return after, TangentReduction(points=yielding, matrix=found.reduction())
