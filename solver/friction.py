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

from railhead.solver.cells import Array
from railhead.solver.condensed import Condensed

STEPS = 60  # of Newton's method
TOLERANCE = 1e-8  # change of the tractions over the largest mu p
LEAST = 1e-300  # below it a vector has no direction


@dataclass(frozen=True)
class Sheared:
    """n points with k tangents. traction (n, k) MPa of the wheel on the rail; slip (n, k) of the
    wheel over the rail: mm, or, rolling, of 1; sticks (n,) of those with pressure (n,) MPa; nodal
    (m,): tractions at the nodes; motion (j,): what the given modes of rigid slip were multiplied
    with; history: change of the tractions in each of Newton's steps, over the largest mu p."""

    traction: Array
    slip: Array
    sticks: NDArray[np.bool_]
    pressure: Array
    nodal: Array
    motion: Array
    history: tuple[float, ...]

    @property
    def converged(self) -> bool:
        """Whether the last step changed nothing."""
        return self.history[-1] <= TOLERANCE


class Friction:
    """A condensed contact with a coefficient of friction."""

    def __init__(self, contact: Condensed, coefficient: float) -> None:
        """ValueError: a coefficient that is not positive and finite."""
        if not 0 < coefficient < np.inf:
            raise ValueError(f"friction must be positive and finite, got {coefficient}")
        self.contact, self.coefficient = contact, coefficient
        n, k = contact.start.shape
        weights = sp.diags(np.repeat(contact.weights, k))
        self._onto = (contact.traces.T @ weights).tocsr()
        self._mass = (self._onto @ contact.traces).toarray()
        self._active = contact.pressure > 0

    @property
    def limit(self) -> float:
        """mu N without traction, N."""
        contact = self.contact
        return float(self.coefficient * contact.parts * (contact.weights @ contact.pressure))

    def solve(
        self,
        slip: Array,
        modes: Array | None = None,
        forces: Array | None = None,
        *,
        settled: Array | None = None,
    ) -> Sheared:
        """slip (n, k): the rigid one that is known, of the wheel over the rail: mm, or, rolling,
        of 1. modes (j, n, k): further rigid slips, multiplied so that forces along (j, 3) axes in
        space are what is given, N: `forces` (j, 4) holds axes and forces. settled (n, k): of a
        shift, what the surfaces had moved before."""
        contact, k = self.contact, slip.shape[1]
        n, m = len(slip), self._mass.shape[0]
        known = contact.step * slip
        before = np.zeros_like(slip) if settled is None else settled
        base = contact.start + contact.tau[:, None] * (known - before)
        free = np.zeros((0, n, k)) if modes is None else contact.step * modes
        pull = (contact.tau[:, None] * free).reshape(len(free), n * k)
        given = np.zeros((0, 4)) if forces is None else forces
        rows = np.array([contact.force(axis) for axis in given[:, :3]]).reshape(-1, m)
        answer, closing = contact.answer.reshape(n, k, m), contact.closing
        nodal, motion = np.zeros(m), np.zeros(len(free))
        slips: NDArray[np.bool_] = np.zeros(n, dtype=bool)
        direction = np.zeros((n, k))
        first, history = True, []
        top = float(self.coefficient * contact.pressure.max())
        for _ in range(STEPS):
            q = base + (contact.answer @ nodal + motion @ pull).reshape(n, k)
            size = np.maximum(np.linalg.norm(q, axis=1), LEAST)
            unit = q / size[:, None]
            bound = self.coefficient * np.maximum(contact.pressure + closing @ nodal, 0.0)
            now = self._active & (size > bound) & (not first)
            now &= ~(slips & (np.einsum("nk,nk->n", unit, direction) < 0))
            sticks = self._active & ~now
            # lambda = value + change (q_new - q) + mu unit (p_new - p)
            value = np.where(now[:, None], bound[:, None] * unit, q) * self._active[:, None]
            across = np.eye(k) - unit[:, :, None] * unit[:, None, :]
            change = np.where(now, bound / size, 0.0)[:, None, None] * across
            change[sticks] = np.eye(k)
            pushed = np.einsum("nij,njm->nim", change, answer)
            pushed += (
                np.where(now[:, None], self.coefficient * unit, 0)[..., None] * closing[:, None]
            )
            pulled = np.einsum("nij,anj->nia", change, pull.reshape(len(free), n, k))
            tangent = np.block([
                [self._mass - self._onto @ pushed.reshape(n * k, m),
                 -self._onto @ pulled.reshape(n * k, len(free))],
                [rows, np.zeros((len(rows), len(free)))],
            ])  # fmt: skip
            residual = np.concatenate([
                self._mass @ nodal - self._onto @ value.ravel(),
                rows @ nodal - given[:, 3],
            ])  # fmt: skip
            step = scipy.linalg.solve(tangent, -residual, check_finite=False)
            nodal, motion = nodal + step[:m], motion + step[m:]
            changed = float(np.abs(step[:m]).max()) / top
            same = not first and np.array_equal(now, slips)
            history.append(changed if same else max(changed, 2 * TOLERANCE))
            slips, direction, first = now, unit, False
            if history[-1] <= TOLERANCE:
                break
        return self._found(base, known, before, free, nodal, motion, tuple(history))

    def _found(
        self,
        base: Array,
        known: Array,
        before: Array,
        free: Array,
        nodal: Array,
        motion: Array,
        history: tuple[float, ...],
    ) -> Sheared:
        contact, (n, k) = self.contact, base.shape
        rigid = known + np.tensordot(motion, free, axes=1)
        q = base + (contact.answer @ nodal).reshape(n, k) + contact.tau[:, None] * (rigid - known)
        found = np.maximum(contact.pressure + contact.closing @ nodal, 0.0)
        pressure = np.where(self._active, found, 0.0)
        size = np.maximum(np.linalg.norm(q, axis=1), LEAST)
        share = np.minimum(1.0, self.coefficient * pressure / size)
        moved = contact.moved + (contact.movement @ nodal).reshape(n, k)
        slip = np.asarray((moved + rigid - before) / contact.step)
        return Sheared(
            share[:, None] * q,
            slip,
            np.asarray(self._active & (share >= 1)),
            pressure,
            nodal,
            motion,
            history,
        )
