"""Coulomb's law in the cells of a patch: |q| <= g everywhere, and q = g s/|s| where they slip,
with a slip s = w - C q that the tractions q reduce through an influence C.

Tractions are in MPa, slips in mm or, rolling, per rolled length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, gmres

from railhead.theory.rolling.tangential import TractionInfluence

Array = NDArray[np.float64]
STEPS = 60  # of Newton's method; 4 to 16 are usual
KRYLOV = 200  # iterations a step; 20 to 60 are usual


class Tractions:
    """The cells (nx, ny) of a patch, outside of which the bound g is 0, and what solves for q."""

    def __init__(self, influence: TractionInfluence, bound: Array) -> None:
        """bound: g (nx, ny), MPa. ValueError: it is not above 0 anywhere."""
        if not bound.max() > 0:
            raise ValueError("no cell of the patch carries a pressure")
        self._influence, self._bound = influence, bound
        self._step = 1 / float(influence.line[:, 0].mean())  # r
        cells = np.arange(len(bound))
        self._line = self._step * influence.line[:, cells[:, None] - cells]  # (2, nx, nx)

    def solve(self, slip: Array, tolerance: float, guess: Array | None = None) -> Array:
        """q (2, nx, ny) for w (2, nx, ny), by a semismooth Newton method on q = P(z),
        z = q + r (w - C q), where P projects onto discs of radius g (Alart and Curnier 1991).

        It starts from a guess or from the tractions that stick everywhere, and ends when the norm
        of q - P(z) is below tolerance times that of P(z). A cell whose slip turns round within a
        step sticks in the next one; otherwise the method may cycle. ValueError: it does not end.
        """
        still = np.zeros_like(slip)
        inside = np.where(self._bound > 0, 1.0, 0.0)
        q = self._newton(still, inside, inside * self._step * slip) if guess is None else guess
        before = still
        for _ in range(STEPS):
            z = q + self._step * (slip - self._influence(q))
            ratio = self._ratio(z)
            projected = ratio * z
            if np.linalg.norm(q - projected) <= tolerance * np.linalg.norm(projected):
                return np.asarray(projected)
            turned = (z * before).sum(axis=0) < 0
            ratio = np.where(turned, inside, ratio)
            q = q + self._newton(z, ratio, ratio * z - q)
            before = np.where(ratio < 1, z, 0)
        raise ValueError(f"no tractions to {tolerance} in {STEPS} steps of Newton's method")

    def changes(self, traction: Array, slip: Array, modes: Array) -> Array:
        """Changes (m, 2, nx, ny) of the tractions that solve for a slip by changes of it, alike."""
        z = traction + self._step * (slip - self._influence(traction))
        ratio = self._ratio(z)
        D = _derivative(z, ratio)
        return np.array([self._newton(z, ratio, _times(D, self._step * mode)) for mode in modes])

    def _ratio(self, z: Array) -> Array:
        """What the projection scales z by (nx, ny): 1 where it sticks."""
        size = np.maximum(np.linalg.norm(z, axis=0), 1e-300)
        return np.asarray(np.minimum(self._bound / size, 1.0))

    def _newton(self, z: Array, ratio: Array, right: Array) -> Array:
        """dq (2, nx, ny) of (I - D + r D C) dq = right, D being the derivative of P at z.

        The preconditioner takes of C what the cells of a line along x do to each other.
        """
        D, shape = _derivative(z, ratio), right.shape
        one = np.eye(shape[1])
        own = np.stack([D[0, 0], D[1, 1]]).transpose(0, 2, 1)[..., None]  # (2, ny, nx, 1)
        inverses = np.linalg.inv(one - own * one + own * self._line[:, None])

        def tangent(flat: Array) -> Array:
            dq = flat.reshape(shape)
            return np.asarray((dq + _times(D, self._step * self._influence(dq) - dq)).ravel())

        def nearly_inverse(flat: Array) -> Array:
            columns = flat.reshape(shape).transpose(0, 2, 1)[..., None]
            return np.asarray((inverses @ columns)[..., 0].transpose(0, 2, 1).ravel())

        matrix, inverse = (
            LinearOperator((right.size, right.size), each, dtype=float)
            for each in (tangent, nearly_inverse)
        )
        dq, _ = gmres(matrix, right.ravel(), M=inverse, restart=KRYLOV, maxiter=1, atol=0.0)
        return np.asarray(dq.reshape(shape))


def _derivative(z: Array, ratio: Array) -> Array:
    """D (2, 2, nx, ny) of the projection: 1 where it sticks, else ratio (1 - z z/|z|^2)."""
    slipping = np.where(ratio < 1, ratio / np.maximum((z * z).sum(axis=0), 1e-300), 0)
    return ratio * np.eye(2)[:, :, None, None] - slipping * z[:, None] * z[None]


def _times(D: Array, values: Array) -> Array:
    """Matrices (2, 2, nx, ny) times vectors (2, nx, ny)."""
    return np.asarray((D * values[None]).sum(axis=1))
