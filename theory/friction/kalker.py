"""Kalker's linear theory of rolling on an ellipse.

Conventions of `theory.friction.rolling`: a along the rolling direction, forces with the creepage's
sign. Forces at vanishing creepage:

    F_x = G a b C11 xi_x    F_y = G a b (C22 xi_y + sqrt(a b) C23 phi)
    M_z = G a b (-sqrt(a b) C23 xi_y + a b C33 phi)

G and nu are those of the pair of materials (`theory.friction.tangential.MaterialPair`), which must
be like.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander, legvander2d

from railhead.theory.array_types import Array

DEGREE = 10  # of the polynomials


@dataclass(frozen=True)
class Coefficients:
    """Kalker's linear creepage coefficients of an ellipse, dimensionless; C32 = -C23.

    c11: force along by creepage along.
    c22: force across by creepage across.
    c23: force across by spin.
    c33: moment by spin.
    """

    c11: float
    c22: float
    c23: float
    c33: float


@lru_cache(maxsize=1000)
def coefficients(axis_ratio: float, poisson: float) -> Coefficients:
    """Kalker's linear creepage coefficients of an ellipse with a/b = axis_ratio (a along the
    rolling direction), by polynomials (Kalker 1967).

    Where the whole patch sticks, the tractions displace the surface by u = -(xi_x, xi_y) x + phi (x
    y, -x^2/2) + f(y), with creepages xi_x, xi_y, spin phi and any function f, and vanish at the
    leading edge. Tractions that are polynomials over sqrt(1 - x^2/a^2 - y^2/b^2) displace by
    polynomials of the same degree (Galin). The tractions of each part of u are computed first; then
    f is chosen for the smallest traction coefficients along the leading edge, in the least-squares
    sense. Within 0.2 % of the limit of high degrees for a/b from 0.2 to 5, 0.4 % from 0.1 to 10.
    ValueError: an axis ratio outside 0.05 to 20, or a Poisson's ratio outside 0 to 0.5.
    """
    if not (0.05 <= axis_ratio <= 20 and 0 <= poisson <= 0.5):
        raise ValueError(
            "the axis ratio must be within 0.05..20 and Poisson's ratio within 0..0.5, got "
            f"{axis_ratio}, {poisson}"
        )
    basis = _Basis(math.sqrt(axis_ratio), 1 / math.sqrt(axis_ratio))
    x, y = basis.places
    free, still = legvander(y / basis.b, DEGREE), np.zeros((x.size, DEGREE + 1))
    rigid = [[x, 0 * x, -x * y], [0 * x, x, x * x / 2]]
    wanted = np.block([[free, still, -np.array(rigid[0]).T], [still, free, -np.array(rigid[1]).T]])
    tractions = np.linalg.lstsq(basis.displacements(poisson), wanted, rcond=1e-13)[0]
    angle = math.pi / 2 * np.cos(math.pi * (np.arange(4 * DEGREE) + 0.5) / (4 * DEGREE))
    leading = np.kron(np.eye(2), basis(basis.a * np.cos(angle), basis.b * np.sin(angle)))
    edge = leading @ tractions
    f = np.linalg.lstsq(edge[:, :-3], -edge[:, -3:], rcond=1e-12)[0]
    found = basis.forces @ (tractions[:, -3:] + tractions[:, :-3] @ f)
    c23 = (found[1, 2] - found[2, 1]) / 2
    return Coefficients(float(found[0, 0]), float(found[1, 1]), float(c23), float(found[2, 2]))


class _Basis:
    """Tractions on an ellipse: m products of Legendre polynomials in x/a and y/b up to the total
    degree 10 (DEGREE), over the root sqrt(1 - x^2/a^2 - y^2/b^2).

    a, b: semi-axes along and across.
    places: collocation points x (n,), y (n,) in the ellipse.
    """

    def __init__(self, a: float, b: float) -> None:
        """a, b: semi-axes of the ellipse along and across."""
        self.a, self.b = a, b
        degrees = np.arange(DEGREE + 1)
        self._used = np.add.outer(degrees, degrees).ravel() <= DEGREE
        ticks = np.cos(math.pi * (np.arange(DEGREE + 2) + 0.5) / (DEGREE + 2))
        x, y = np.meshgrid(ticks, ticks, indexing="ij")
        self.places = a * x.ravel(), b * (y * np.sqrt(1 - x * x)).ravel()

    def __call__(self, x: Array, y: Array) -> Array:
        """Values (..., m) of the m polynomials (without the root) at places x, y (...)."""
        products = legvander2d(x / self.a, y / self.b, (DEGREE, DEGREE))
        return np.asarray(products[..., self._used])

    def displacements(self, poisson: float) -> Array:
        """Matrix (2 n, 2 m): tangential displacements of both surfaces apart, along, then across,
        at the n places by the m tractions along, then across, for G = 1. Cerruti's integral in
        polar coordinates, over chords through each place and over their angles.
        """
        a, b, (x, y) = self.a, self.b, self.places
        count = 2 * DEGREE + int(20 * max(a / b, b / a))
        ticks = np.cos(math.pi * (np.arange(DEGREE // 2 + 1) + 0.5) / (DEGREE // 2 + 1))
        total = np.zeros((2 * x.size, 2 * int(self._used.sum())))
        for angle in math.pi / count * np.arange(count):
            c, s = math.cos(angle), math.sin(angle)
            steepness = (c / a) ** 2 + (s / b) ** 2
            middle = -(x * c / a**2 + y * s / b**2) / steepness
            inside = 1 - (x / a) ** 2 - (y / b) ** 2
            way = middle + np.sqrt(inside / steepness + middle**2) * ticks[:, None]
            chords = self(x + way * c, y + way * s).mean(axis=0) * math.pi / math.sqrt(steepness)
            kernel = (1 - poisson) * np.eye(2) + poisson * np.outer((c, s), (c, s))
            total += np.kron(kernel, chords) / count
        return total

    @property
    def forces(self) -> Array:
        """Matrix (3, 2 m): F_x, F_y and M_z of the m tractions along, then across."""
        nodes, weights = leggauss(DEGREE + 4)
        height, count = (nodes[:, None] + 1) / 2, 2 * DEGREE + 4
        angle, radius = 2 * math.pi / count * np.arange(count), np.sqrt(1 - height**2)
        x, y = self.a * radius * np.cos(angle), self.b * radius * np.sin(angle)
        cell = math.pi * self.a * self.b / count * weights[:, None, None]
        values = self(x, y) * cell
        whole, still = values.sum(axis=(0, 1)), np.zeros(values.shape[-1])
        by_x, by_y = (np.tensordot(arm, values, axes=2) for arm in (x, y))
        return np.block([[whole, still], [still, whole], [-by_y, by_x]])
