"""Coulomb's law in the cells of a patch: |q| <= g everywhere, and q = g s/|s| where they slip,
with a slip s = w - C q that the tractions q reduce through an influence C.

Slips are those of the wheel over the rail, in mm or, rolling, per rolled length; tractions are
those of the wheel on the rail, in MPa. Components are along x and y.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, gmres

from railhead.theory.array_types import Array
from railhead.theory.friction.tangential import TractionInfluence

STEPS = 60  # of Newton's method; 4 to 16 are usual
# Residual of a linear solve over its right-hand side. With 1e-5 nearly twice the products are
# needed, and forces differ by 4e-8.
LINEAR_TOLERANCE = 1e-2
KRYLOV = 100  # iterations of a linear solve; 5 to 15 are usual
SOFTER = 0.25  # of the compliance of a cell, by which the preconditioner is softer: it bounds it


class CoulombSolver:
    """Solver of Coulomb's law in the cells (nx, ny) of a patch: |q| <= g everywhere and q = g s/|s|
    where the slip s = w - C q is not zero. q: tractions, MPa; g: bound, MPa, 0 outside of the
    patch; w: slip without tractions; C: influence.

    bound: g; a later solve may have another one.
    """

    def __init__(self, influence: TractionInfluence, bound: Array) -> None:
        """influence: C; bound: g (nx, ny), MPa, above 0 somewhere."""
        self._influence, self.bound = influence, bound
        self._step = 1 / (influence.line[:, :1, None] + influence.edge).mean(axis=0)  # r (nx, ny)
        self._own = float(influence.line[:, 0].mean())  # compliance of a whole cell
        self._single, self._inverse = influence.single(), influence.single(SOFTER * self._own)

    def solve(self, slip: Array, tolerance: float, guess: Array | None = None) -> Array:
        """Tractions q (2, nx, ny), MPa, zero outside of the patch, for the slip w (2, nx, ny) of
        surfaces without tractions.

        A semismooth Newton method on q = P(z), z = q + r (w - C q), where P projects onto discs of
        radius g and r is a stiffness (Alart and Curnier 1991). The iteration starts from `guess` or
        from the tractions that stick everywhere, also where it does not converge from `guess`. It
        ends when the norm of q - P(z) is below `tolerance` times that of P(z). A cell whose slip
        reverses within a step sticks in the next one; otherwise the method may cycle. ValueError:
        no convergence.
        """
        still = np.zeros_like(slip)
        inside = np.where(self.bound > 0, 1.0, 0.0)
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
        if guess is not None:
            return self.solve(slip, tolerance)
        raise ValueError(f"no tractions to {tolerance} in {STEPS} steps of Newton's method")

    def changes(self, traction: Array, slip: Array, modes: Array) -> Array:
        """Derivatives (m, 2, nx, ny) of the tractions by changes `modes` (m, 2, nx, ny) of the
        slip, to 1 % (LINEAR_TOLERANCE). traction, slip: the solved tractions and the slip without
        tractions, (2, nx, ny).
        """
        z = traction + self._step * (slip - self._influence(traction))
        ratio = self._ratio(z)
        D = _derivative(z, ratio)
        return np.array([self._newton(z, ratio, _times(D, self._step * mode)) for mode in modes])

    def _ratio(self, z: Array) -> Array:
        """Factor (nx, ny) by which the projection scales z (2, nx, ny); 1 where a cell sticks."""
        size = np.maximum(np.linalg.norm(z, axis=0), 1e-300)
        return np.asarray(np.minimum(self.bound / size, 1.0))

    def _newton(self, z: Array, ratio: Array, right: Array) -> Array:
        """Newton step dq (2, nx, ny): solution of (I - D + r D C) dq = right, D being the
        derivative of the projection at z, by GMRES to 1 % (LINEAR_TOLERANCE) or, without an error,
        as near as 100 iterations (KRYLOV) come.

        ratio: scaling factor (nx, ny) of the projection; right: (2, nx, ny). The preconditioner has
            the inverse of C without the edge of the patch in the place of that of C where D is not
            zero. As no more is asked, numbers are single.
        """
        size, shape = float(np.linalg.norm(right)), right.shape
        if not size:
            return right
        D, step = (each.astype(np.float32) for each in (_derivative(z, ratio), self._step))

        def tangent(flat: Array) -> Array:
            """The matrix (I - D + r D C) times a flat vector."""
            dq = flat.reshape(shape)
            return (dq + _times(D, step * self._single(dq) - dq)).ravel()

        def nearly_inverse(flat: Array) -> Array:
            """The preconditioner times a flat vector."""
            dq = flat.reshape(shape)
            return (dq + _times(D, self._inverse(self._own * dq) - dq)).ravel()

        matrix, inverse = (
            LinearOperator((right.size, right.size), each, dtype=np.float32)
            for each in (tangent, nearly_inverse)
        )
        dq, _ = gmres(
            matrix,
            np.float32(right / size).ravel(),
            M=inverse,
            restart=KRYLOV,
            maxiter=1,
            atol=LINEAR_TOLERANCE,
        )
        return np.asarray(size * dq.reshape(shape).astype(float))


def _derivative(z: Array, ratio: Array) -> Array:
    """Derivative D (2, 2, nx, ny) of the projection of z (2, nx, ny) onto discs: the unit matrix
    where a cell sticks (ratio 1), else ratio (1 - z z/|z|^2).
    """
    slipping = np.where(ratio < 1, ratio / np.maximum((z * z).sum(axis=0), 1e-300), 0)
    return ratio * np.eye(2)[:, :, None, None] - slipping * z[:, None] * z[None]


def _times(D: NDArray[Any], values: NDArray[Any]) -> NDArray[Any]:
    """Products (2, nx, ny) of matrices D (2, 2, nx, ny) with vectors (2, nx, ny)."""
    return np.asarray((D * values[None]).sum(axis=1))
