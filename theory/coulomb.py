"""Coulomb's law in the cells of a patch: |q| <= g everywhere, and q = g s/|s| where they slip,
with a slip s = w - C q that the tractions q reduce through an influence C.

Tractions are in MPa, slips in mm or, rolling, per rolled length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, gmres

from railhead.theory.tangential import TractionInfluence

Array = NDArray[np.float64]
STEPS = 60  # of Newton's method; 4 to 16 are usual
KRYLOV = 300  # iterations a step; 20 to 60 are usual


class Tractions:
    """The n cells of a patch (nx, ny) whose bound g is above 0, and what solves for q in them."""

    def __init__(self, influence: TractionInfluence, bound: Array) -> None:
        """bound: g (nx, ny), MPa. ValueError: it is not above 0 anywhere."""
        self.cells = np.nonzero(bound > 0)
        self.bound = bound[self.cells]
        if not self.bound.size:
            raise ValueError("no cell of the patch carries a pressure")
        self._shape, self._influence = bound.shape, influence
        self._step = 1 / float(influence.line[:, 0].mean())  # r
        i, j = self.cells
        self._lines = [
            (line, self._step * influence.line[:, i[line][:, None] - i[line]])
            for line in (np.flatnonzero(j == column) for column in np.unique(j))
        ]

    def field(self, values: Array) -> Array:
        """(2, n) in the cells -> (2, nx, ny), 0 elsewhere."""
        whole = np.zeros((2, *self._shape))
        i, j = self.cells
        whole[:, i, j] = values
        return whole

    def held(self, traction: Array) -> Array:
        """C q (2, n) of tractions (2, n)."""
        i, j = self.cells
        return np.asarray(self._influence(self.field(traction))[:, i, j])

    def solve(self, slip: Array, tolerance: float, guess: Array | None = None) -> Array:
        """q (2, n) for w (2, n), by a semismooth Newton method on q = P(z), z = q + r (w - C q),
        where P projects onto the discs of radius g (Alart and Curnier 1991).

        It starts from a guess or from the tractions that stick everywhere, and ends when the norm
        of q - P(z) is below tolerance times that of g. A cell whose slip turns round within a step
        sticks in the next one; otherwise the method may cycle. ValueError: it does not end.
        """
        q, stuck = np.zeros_like(slip), np.ones_like(self.bound)
        q = self._step_by(slip, stuck, self._step * slip) if guess is None else guess
        before = np.zeros_like(slip)
        for _ in range(STEPS):
            z = q + self._step * (slip - self.held(q))
            ratio = self._ratio(z)
            if np.linalg.norm(q - ratio * z) <= tolerance * np.linalg.norm(self.bound):
                return np.asarray(ratio * z)
            ratio[(z * before).sum(axis=0) < 0] = 1.0
            q = q + self._step_by(z, ratio, ratio * z - q)
            before = np.where(ratio < 1, z, 0)
        raise ValueError(f"no tractions to {tolerance} in {STEPS} steps of Newton's method")

    def changes(self, traction: Array, slip: Array, modes: Array) -> Array:
        """Changes (m, 2, n) of the tractions that solve for a slip by changes of it (m, 2, n)."""
        z = traction + self._step * (slip - self.held(traction))
        ratio = self._ratio(z)
        D = _derivative(z, ratio)
        return np.array([self._step_by(z, ratio, _times(D, self._step * mode)) for mode in modes])

    def _ratio(self, z: Array) -> Array:
        """What the projection scales z by (n,): 1 where it sticks."""
        size = np.linalg.norm(z, axis=0)
        return np.where(size > self.bound, self.bound / np.maximum(size, self.bound), 1.0)

    def _step_by(self, z: Array, ratio: Array, right: Array) -> Array:
        """dq (2, n) of (I - D + r D C) dq = right, D being the derivative of P at z.

        The preconditioner takes of C what the cells of a line along x do to each other.
        """
        D, shape = _derivative(z, ratio), z.shape
        inverses = []
        for line, (along, across) in self._lines:
            d, one = D[:, :, line], np.eye(line.size)
            block = np.block([
                [one * (1 - d[0, 0]) + d[0, 0][:, None] * along, d[0, 1][:, None] * (across - one)],
                [d[1, 0][:, None] * (along - one), one * (1 - d[1, 1]) + d[1, 1][:, None] * across],
            ])  # fmt: skip
            inverses.append((line, np.linalg.inv(block)))

        def tangent(flat: Array) -> Array:
            dq = flat.reshape(shape)
            return np.asarray((dq + _times(D, self._step * self.held(dq) - dq)).ravel())

        def nearly_inverse(flat: Array) -> Array:
            values = flat.reshape(shape)
            found = np.empty(shape)
            for line, inverse in inverses:
                found[:, line] = (inverse @ values[:, line].ravel()).reshape(2, -1)
            return found.ravel()

        operators = (
            LinearOperator((right.size, right.size), each, dtype=float)
            for each in (tangent, nearly_inverse)
        )
        matrix, inverse = operators
        dq, _ = gmres(matrix, right.ravel(), M=inverse, restart=KRYLOV, maxiter=1, atol=0.0)
        return np.asarray(dq.reshape(shape))


def _derivative(z: Array, ratio: Array) -> Array:
    """D (2, 2, n) of the projection: 1 where it sticks, else ratio (1 - z z/|z|^2)."""
    square = np.maximum((z * z).sum(axis=0), 1e-300)
    slipping = np.where(ratio < 1, ratio / square, 0)
    return ratio * np.eye(2)[:, :, None] - slipping * z[:, None] * z[None]


def _times(D: Array, values: Array) -> Array:
    """Matrices (2, 2, n) times vectors (2, n)."""
    return np.asarray((D * values[None]).sum(axis=1))
