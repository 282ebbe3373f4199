"""Friction on a contact that is pressed: a shift from rest, and steady rolling at a creepage.

At every contact point the traction of the wheel on the rail is (Kalker 1990; Chouly and Hild's
method in the tangent plane)

    lambda = projection of q + tau s on the disc of radius mu p,   c = F^+ lambda

with q, p and F of `solver.condensed`, s the rigid slip (d times it when rolling) and F^+ the L2
projection on the nodes. Newton's method starts where all sticks, and no point crosses the disc in
one step: one that would slip the other way round sticks for a step. Without these two rules it does
not converge. Conventions are those of `theory.rolling`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from railhead.solver.interface.condensation import ContactCompliance
from railhead.solver.space.cells import Array

STEPS = 60  # of Newton's method
HELD = 1e-3  # of the stiffness of all that sticks: holds motions where nothing else converges
LENGTHS = 1.0, 0.5  # of every other step: the one that leaves less
TOLERANCE = 1e-8  # change of the tractions over the largest mu p; missing force over mu times load
LEAST = 1e-300  # below it a vector has no direction


@dataclass(frozen=True)
class TangentialState:
    """n points with k tangents. traction (n, k) MPa of the wheel on the rail; slip (n, k) of the
    wheel over the rail: mm since `settled`, or, rolling, of 1; sticks (n,) of those with pressure
    (n,) MPa; nodal (m,): tractions at the nodes; motion (j,): what the given modes of rigid slip
    were multiplied with; slips (n,) and direction (n, k): where Newton's method ended; history:
    change of the tractions in each of its steps, over the largest mu p, or what is missing of given
    forces, over mu times the load, if that is more."""

    traction: Array
    slip: Array
    sticks: NDArray[np.bool_]
    pressure: Array
    nodal: Array
    motion: Array
    slips: NDArray[np.bool_]
    direction: Array
    history: tuple[float, ...]

    @property
    def converged(self) -> bool:
        """Whether the last step changed nothing and the forces are those given."""
        return self.history[-1] <= TOLERANCE


class CoulombContact:
    """A condensed contact with a coefficient of friction. onto (m, n k): the nodes' shape functions
    times weights; mass (m, m): of the nodes."""

    def __init__(self, contact: ContactCompliance, coefficient: float) -> None:
        """ValueError: a coefficient that is not positive and finite."""
        if not 0 < coefficient < np.inf:
            raise ValueError(f"friction must be positive and finite, got {coefficient}")
        self.contact, self.coefficient = contact, coefficient
        n, k = contact.start.shape
        weights = sp.diags(np.repeat(contact.weights, k))
        self.onto = (contact.traces.T @ weights).tocsr()
        self.mass = (self.onto @ contact.traces).toarray()

    @property
    def top(self) -> float:
        """The largest mu p without traction, MPa."""
        return float(self.coefficient * self.contact.pressure[self.contact.touches].max())

    def solve(
        self,
        slip: Array,
        modes: Array,
        forces: Array,
        *,
        settled: Array | None = None,
        start: TangentialState | None = None,
    ) -> TangentialState:
        """slip (n, k): the rigid one that is known, of the wheel over the rail: mm, or, rolling,
        of 1. modes (j, n, k): further rigid slips, multiplied so that forces along (j, 3) axes in
        space are what is given, N: `forces` (j, 4) holds axes and forces. settled (n, k): of a
        shift, where the surfaces had come to rest, mm. start: of a similar problem."""
        contact, (n, k) = self.contact, slip.shape
        base = contact.start + contact.tau[:, None] * (contact.step * slip)
        if settled is not None:
            base -= contact.tau[:, None] * settled
        pull = contact.tau[:, None] * (contact.step * modes)
        problem = CoulombEquations(
            self,
            base,
            np.hstack([contact.answer, pull.reshape(-1, n * k).T]).reshape(n, k, -1),
            np.hstack([contact.closing, np.zeros((n, len(modes)))]),
            np.array([contact.force(axis) for axis in forces[:, :3]]).reshape(-1, len(self.mass)),
            forces[:, 3],
        )
        stiffness = contact.step * float(contact.area @ contact.tau)
        begun = [(start, 0.0)] if start is not None else []
        freed = [(None, HELD * stiffness)] if len(modes) else []
        for begin, held in (*begun, (None, 0.0), *freed):
            found = problem.solve(begin, held)
            if found.converged:
                break
        return found


@dataclass(frozen=True)
class CoulombEquations:
    """Unknowns x (m + j,): tractions at the nodes and motions. q = base + pull x, with pull
    (n, k, m + j); p = p0 + closing x; rows (j, m) of the tractions are the forces (j,), N."""

    friction: CoulombContact
    base: Array
    pull: Array
    closing: Array
    rows: Array
    forces: Array

    def solve(self, begin: TangentialState | None, held: float) -> TangentialState:
        """Newton's method from all that sticks, or from the solution of a similar problem; held:
        stiffness that its tangent adds to the motions, N/mm."""
        contact, coefficient = self.friction.contact, self.friction.coefficient
        n, k, unknowns = self.pull.shape
        m, active, top = len(self.friction.mass), contact.touches, self.friction.top
        limit = coefficient * float(contact.area[active] @ contact.pressure[active])
        x: Array = np.zeros(unknowns)
        slips: NDArray[np.bool_] = np.zeros(n, dtype=bool)
        direction: Array = np.zeros((n, k))
        if begin is not None:
            x = np.concatenate([begin.nodal, begin.motion])
            slips, direction = begin.slips, begin.direction
        first = begin is None
        history: list[float] = []
        while len(history) < STEPS:
            q, bound, size, unit = self._state(x)
            now = active & (size > bound) & (not first)
            now &= ~(slips & (np.einsum("nk,nk->n", unit, direction) < 0))
            residual, tangent = self.linear(x, now)
            tangent[m:, m:] = held * np.eye(len(self.rows))
            if k == len(self.rows) == 1 and np.array_equal(now, active):
                step = np.append(scipy.linalg.solve(tangent[:m, :m], -residual[:m]), 0.0)
                x = x + step
                x[m] += self._turn(x)
                unit = self._state(x)[3]
            else:
                try:
                    step = scipy.linalg.solve(tangent, -residual, check_finite=False)
                except scipy.linalg.LinAlgError:  # everything slips the way of the given forces
                    history.append(np.inf)
                    break
                if len(history) % 2 == 0:  # always, it would hold up; never, it may go in circles
                    step *= min(LENGTHS, key=lambda length: self._off(x + length * step))
                x = x + step
            missing = float(np.abs(self.rows @ x[:m] - self.forces).max(initial=0.0)) / limit
            left = max(float(np.abs(step[:m]).max()) / top, missing)
            same = not first and np.array_equal(now, slips)
            history.append(left if same else max(left, 2 * TOLERANCE))
            slips, direction, first = now, unit, False
            if history[-1] <= TOLERANCE:
                break
        q, bound, size, _ = self._state(x)
        share = self._share(bound, size)
        slip = (1 - share)[:, None] * q / (contact.tau[:, None] * contact.step)
        return TangentialState(
            share[:, None] * q, slip, active & (share >= 1),
            np.where(active, bound / coefficient, 0.0), x[:m], x[m:], slips, direction,
            tuple(history),
        )  # fmt: skip

    def _turn(self, x: Array) -> float:
        """Everything slips along one tangent, and a motion changes no traction until points turn:
        the one at which a point sticks and those on either side of it leave it the force."""
        contact = self.friction.contact
        q, bound, _, _ = self._state(x)
        rate = self.pull[:, 0, -1]
        turns = np.where(contact.touches, -q[:, 0] / rate, np.inf)
        order = np.argsort(turns)[: contact.touches.sum()]
        along = np.abs(rate) / (contact.tau * contact.step)  # of the tangent along the force
        most = (contact.area * bound * along)[order]
        reached = 2 * np.cumsum(most) - most.sum()
        return float(turns[order[min(np.searchsorted(reached, self.forces[0]), len(order) - 1)]])

    def linear(self, x: Array, slips: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Residual (m + j,) and its derivative where some of the points slip and all others that
        touch stick: lambda = value + change (q_new - q) + mu unit (p_new - p)."""
        contact, coefficient = self.friction.contact, self.friction.coefficient
        mass, onto, (n, k, unknowns) = self.friction.mass, self.friction.onto, self.pull.shape
        m, active = len(mass), contact.touches
        q, bound, size, unit = self._state(x)
        value = np.where(slips[:, None], bound[:, None] * unit, q) * active[:, None]
        across = np.eye(k) - unit[:, :, None] * unit[:, None, :]
        change = np.where(slips, bound / size, 0.0)[:, None, None] * across
        change[active & ~slips] = np.eye(k)
        along = np.where(slips[:, None], coefficient * unit, 0.0)
        moved = change @ self.pull + along[:, :, None] * self.closing[:, None, :]
        tangent = np.zeros((unknowns, unknowns))
        tangent[:m] = -(onto @ moved.reshape(n * k, -1))
        tangent[:m, :m] += mass
        tangent[m:, :m] = self.rows
        residual = [mass @ x[:m] - onto @ value.ravel(), self.rows @ x[:m] - self.forces]
        return np.concatenate(residual), tangent

    def _state(self, x: Array) -> tuple[Array, Array, Array, Array]:
        """q (n, k), mu p and |q| (n,), direction of q (n, k)."""
        contact = self.friction.contact
        q = self.base + self.pull @ x
        bound = self.friction.coefficient * np.maximum(contact.pressure + self.closing @ x, 0.0)
        size = np.maximum(np.linalg.norm(q, axis=1), LEAST)
        return q, bound, size, q / size[:, None]

    def _share(self, bound: Array, size: Array) -> Array:
        """What the disc leaves of q (n,)."""
        return np.where(self.friction.contact.touches, np.minimum(1.0, bound / size), 0.0)

    def _off(self, x: Array) -> float:
        """How far the nodes' tractions are from the projected ones, weighted by their area."""
        q, bound, size, _ = self._state(x)
        share = self._share(bound, size)
        mass, m = self.friction.mass, len(self.friction.mass)
        off = mass @ x[:m] - self.friction.onto @ (share[:, None] * q).ravel()
        return float(off @ (off / mass.diagonal()))
