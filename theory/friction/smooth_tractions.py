"""Smooth tractions over a patch, and smooth fields read from their effect in the weak form.

With u, v the coordinates over the half lengths a, b of a patch, the tractions are

    P beta,    P = 1, u, v,    beta = (1 - (u^2 + v^2)/w^2)^2  within the ellipse u^2 + v^2 < w^2

A traction q has the coefficients G^-1 int P q dA of the smooth one with the same moments, and a
field d is read as e in the span of all Q = u^i v^j with i + j <= 3, where

    int beta Q_i e dA = int beta Q_i d dA,    or for e = dd/dx    = -int d(beta Q_i)/dx d dA

so that the error of a mesh in d enters as an integral. G_ij = int beta P_i P_j dA.
"""

import math
from collections.abc import Callable

import numpy as np

from railhead.theory.array_types import Array

NARROW = 1.2  # w of a second reading
WIDTH = 1.5  # w; 2 gives the same forces to 0.001 of mu N, 1 does not
POWERS = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)]  # of Q
LINEAR = 3  # the first of them, P


class SmoothTractions:
    """The three fields P beta, P = 1, u, v, on a grid of cells over an ellipse 1.5 times (WIDTH) as
    wide as a patch; beta falls to 0 at its edge. Fields are read from there in the ten powers Q =
    u^i v^j (POWERS). u and v are coordinates from the centre over the half lengths.

    centre: (x, y) of the patch, mm.
    half: half lengths (a, b) of the patch, mm.
    x, y: cell centres (nx,), (ny,), an even number along each axis, mm. cell: area, mm2.
    fields: P beta at the cells (3, nx, ny), without dimension.
    """

    def __init__(
        self,
        centre: tuple[float, float],
        half: tuple[float, float],
        largest: float,
        width: float = WIDTH,
    ) -> None:
        """largest: limit of the sides of a cell, mm. width: w, at most WIDTH."""
        self.centre, self.half = centre, half
        self.x, self.y = (
            middle + WIDTH * each * _centres(2 * math.ceil(WIDTH * each / largest))
            for middle, each in zip(centre, half, strict=True)
        )
        self.cell = float((self.x[1] - self.x[0]) * (self.y[1] - self.y[0]))
        basis = self._basis(self.x, self.y)
        u, v = basis[1:LINEAR]
        inside = np.maximum(1 - (u**2 + v**2) / width**2, 0.0)
        self._tests = basis * inside**2
        self.fields = self._tests[:LINEAR]
        rates = np.stack([i * u ** max(i - 1, 0) * v**j for i, j in POWERS])
        slopes = -4 * u / width**2 * inside * basis + rates * inside**2
        self._slopes = slopes / half[0]
        self._gram = self.cell * np.einsum("iab,jab->ij", self._tests, basis)

    def _basis(self, x: Array, y: Array) -> Array:
        """The ten powers Q (10, nx, ny) at x (nx,) and y (ny,), mm; the first three are P."""
        u, v = ((t - c) / h for t, c, h in zip((x, y), self.centre, self.half, strict=True))
        return np.stack([u[:, None] ** i * v**j for i, j in POWERS])

    def coefficients(self, x: Array, y: Array, traction: Array) -> Array:
        """Coefficients (3, 2) of the smooth traction that has the moments of a traction (2, nx, ny)
        in the cells of another grid x (nx,), y (ny,), mm: a row for each P, a column for each
        component; in the unit of the traction.
        """
        return np.asarray(self._weights(x, y) @ traction.reshape(2, -1).T)

    def _weights(self, x: Array, y: Array) -> Array:
        """Matrix (3, nx ny) that takes one component of a traction in the cells x (nx,), y (ny,),
        mm, flattened, to its coefficients of P, in the unit of the traction.
        """
        cell = (x[1] - x[0]) * (y[1] - y[0])
        linear = self._basis(x, y)[:LINEAR].reshape(LINEAR, -1)
        return np.asarray(cell * np.linalg.solve(self._gram[:LINEAR, :LINEAR], linear))

    def read(self, field: Array, *, derivative: bool) -> Array:
        """Coefficients (10, 2) of a sum e of the powers Q, a column for each component, read from a
        field d (2, nx, ny) in the cells of this grid; derivative: whether e is dd/dx, not d.
        """
        tests = -self._slopes if derivative else self._tests
        moments = self.cell * np.einsum("iab,kab->ik", tests, field)
        return np.asarray(np.linalg.solve(self._gram, moments))

    def response(self, matrix: Array, x: Array, y: Array) -> Callable[[Array], Array]:
        """Linear map from a traction (2, nx, ny) in the cells x (nx,), y (ny,) to a field (2, nx,
        ny), a sum of the powers Q.

        matrix: (20, 6), from the coefficients (3, 2) of the smooth traction with the same moments
            to those of the field (10, 2), both flattened.
        """

        weights, basis = self._weights(x, y), self._basis(x, y).reshape(len(POWERS), -1)

        def field(traction: Array) -> Array:
            """The field (2, nx, ny) of a traction (2, nx, ny)."""
            known = matrix @ (weights @ traction.reshape(2, -1).T).ravel()
            return np.asarray((known.reshape(-1, 2).T @ basis).reshape(traction.shape))

        return field

    def values(self, coefficients: Array, x: Array, y: Array) -> Array:
        """Values (2, nx, ny) at x (nx,) and y (ny,), mm, of the sum of the powers Q with
        coefficients (10, 2), a column for each component.
        """
        return np.asarray(np.einsum("ik,iab->kab", coefficients, self._basis(x, y)))


def _centres(cells: int) -> Array:
    """Centres (cells,) of equal cells from -1 to 1."""
    return np.asarray((2 * np.arange(cells) + 1) / cells - 1)
