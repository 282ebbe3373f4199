"""Influence coefficients: tangential displacement of two half-spaces by tractions on grid cells.

Displacements are those of the wheel's surface relative to the rail's, tractions those of the wheel
on the rail: a traction along +x moves the wheel's surface to -x.
Lengths in mm, tractions and moduli in MPa.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from railhead.theory.array_types import Array
from railhead.theory.bem.influence import fast_shape, logarithms, restored, transform
from railhead.theory.elastic.hertz import contact_modulus

NO_MISMATCH = 1e-9  # largest |K| that is taken for a rounding error
Upstream = tuple[tuple[float, float], ...]
SHIFT: Upstream = ((0.0, 1.0),)  # (distance upstream in cells, weight): the displacement itself
ROLLING: Upstream = (
    (0.0, 3.0),
    (0.5, -4.0),
    (1.0, 1.0),
)  # minus its derivative along x, times a cell
CENTRAL: Upstream = ((-0.5, 1.0), (0.5, -1.0))  # the same of what does not follow the slip


@dataclass(frozen=True)
class MaterialPair:
    """Elastic constants of wheel (w) and rail (r) combined for tangential contact (Kalker 1990,
    1.43).

    shear_modulus: G, MPa; 1/G = (1/G_w + 1/G_r)/2.
    poisson: nu; nu/G = (nu_w/G_w + nu_r/G_r)/2.
    mismatch: K; K/G = ((1 - 2 nu_w)/G_w - (1 - 2 nu_r)/G_r)/4. 0 means that both surfaces move
        alike under a pressure.
    """

    shear_modulus: float
    poisson: float
    mismatch: float = 0.0

    @property
    def like(self) -> bool:
        """Whether tractions do not change the pressure: |K| below 1e-9 (NO_MISMATCH)."""
        return abs(self.mismatch) < NO_MISMATCH

    @property
    def dundurs_beta(self) -> float:
        """Dundurs' beta of the rail and the wheel, dimensionless, -K/(1 - nu): (c_r - c_w)/2 over
        (d_r + d_w), with c = (1 - 2 nu)/G and d = (1 - nu)/G of each body (Johnson, Contact
        Mechanics, 5.3).
        """
        return -self.mismatch / (1 - self.poisson)


def pair(
    young_wheel: float, poisson_wheel: float, young_rail: float, poisson_rail: float
) -> MaterialPair:
    """Combined constants of a wheel and a rail. young_wheel, young_rail: Young's moduli, MPa,
    math.inf is rigid. ValueError: a modulus that is not positive, a Poisson ratio outside (-1,
    0.5], or two rigid bodies.
    """
    contact_modulus(young_wheel, poisson_wheel, young_rail, poisson_rail)
    ratios = poisson_wheel, poisson_rail
    wheel, rail = (
        2 * (1 + nu) / E for nu, E in zip(ratios, (young_wheel, young_rail), strict=True)
    )
    modulus = 2 / (wheel + rail)
    unlike = (1 - 2 * poisson_wheel) * wheel - (1 - 2 * poisson_rail) * rail
    poisson = (poisson_wheel * wheel + poisson_rail * rail) / (wheel + rail)
    return MaterialPair(modulus, poisson, modulus * unlike / 4)


class TractionInfluence:
    """Called with tractions (2, nx, ny) of the wheel on the rail, MPa, it returns the reduction (2,
    nx, ny) of the slip of the wheel over the rail; components along x and y in a plane.

    Slips are in mm or, in rolling along +x, per rolled length: upstream differences of second order
    over half a cell, -du/dx = (3 u(x) - 4 u(x + d/2) + u(x + d))/d, which dissipate. Cerruti: a
    force Q_x moves both surfaces apart by Q_x/(pi G) ((1 - nu)/r + nu x^2/r^3) along x and by
    Q_x/(pi G) nu x y/r^3 along y (Johnson, Contact Mechanics, 3.7), here integrated over a cell.

    line: (2, padded), reduction of the slip per MPa at the cell k places ahead on the same line
        along x; k = 0 is the cell itself, negative k count from the end. Row 0: along x by
        traction along x, row 1: along y by traction along y.
    """

    def __init__(
        self,
        x: Array,
        y: Array,
        pair: MaterialPair,
        *,
        rolling: bool,
        added: Callable[[Array], Array] | None = None,
    ) -> None:
        """x (nx,), y (ny,): cell centres, evenly spaced and at least two an axis, mm; pair:
        materials; rolling: whether slips are per rolled length; added: reduction of the slip by
        tractions beside that of half-spaces, linear; None: zero.
        """
        self._size, self._pair, self._added = (x.size, y.size), pair, added
        self._padded = fast_shape(self._size)
        self._steps = float(x[1] - x[0]), float(y[1] - y[0])
        upstream, self._scale = (ROLLING, 1 / self._steps[0]) if rolling else (SHIFT, 1.0)
        self._given = CENTRAL if rolling else SHIFT
        kernels = self._kernels(self._cerruti, upstream)
        self._spectra = transform(kernels, self._padded)
        self.line = kernels[::2, :, 0]  # (2, padded): of a cell on those of its own line along x

    def __call__(self, traction: Array) -> Array:
        """Reduction of the slip (2, nx, ny) by tractions (2, nx, ny), MPa."""
        xx, xy, yy = self._spectra
        along, across = transform(traction, self._padded)
        moved = np.array([xx * along + xy * across, xy * along + yy * across])
        own = restored(moved, self._padded, self._size)
        return own if self._added is None else own + self._added(traction)

    def of_pressure(self, pressure: Array) -> Array:
        """Reduction of the slip (2, nx, ny) by a pressure (nx, ny), MPa, where materials differ:
        both surfaces move inwards, the softer one further. A force P gives K P/(pi G) x/r^2
        along x (Johnson, 3.18b).
        """
        spectra = transform(self._kernels(self._boussinesq, self._given), self._padded)
        moved = spectra * transform(pressure, self._padded)
        return restored(moved, self._padded, self._size)

    def opening(self, traction: Array) -> Array:
        """Change of the normal gap (nx, ny), mm, by tractions (2, nx, ny), MPa, where materials
        differ; only of an influence with `rolling` False. By reciprocity its kernel is that of
        `of_pressure` with x and y reversed.
        """
        spectra = transform(self._kernels(self._boussinesq, SHIFT), self._padded)
        moved = (spectra * transform(traction, self._padded)).sum(axis=0)
        return -restored(moved, self._padded, self._size)

    def _kernels(self, corners: Callable[[Array, Array], Array], upstream: Upstream) -> Array:
        """Influence (m, padded x, padded y) of one cell on all others, the cell itself first.
        corners: antiderivatives (m, ...) at corners (X, Y), mm; upstream: pairs (distance
        upstream in cells, weight) of the difference formula.
        """
        total = []
        for cells, weight in upstream:
            X, Y = (
                (np.arange(n + 1.0) - n // 2 - 0.5 + shift) * step
                for n, step, shift in zip(self._padded, self._steps, (cells, 0.0), strict=True)
            )
            total.append(weight * np.diff(np.diff(corners(X[:, None], Y[None]), axis=1), axis=2))
        scale = self._scale / (math.pi * self._pair.shear_modulus)
        return np.asarray(scale * np.fft.ifftshift(np.sum(total, axis=0), axes=(1, 2)))

    def _cerruti(self, X: Array, Y: Array) -> Array:
        """Antiderivatives (3, ...) at corners X, Y (mm) of Cerruti's kernels: x by force along x, x
        by force along y, y by force along y.
        """
        nu = self._pair.poisson
        yy, xx = logarithms(X, Y)
        return np.array([xx + (1 - nu) * yy, -nu * np.hypot(X, Y), yy + (1 - nu) * xx])

    def _boussinesq(self, X: Array, Y: Array) -> Array:
        """Antiderivatives (2, ...) at corners X, Y (mm) of K x/r^2 and K y/r^2."""
        log, angle = np.log(np.hypot(X, Y)), np.arctan(X / Y)
        quarter = math.pi / 2 * np.abs(X) * np.sign(Y)
        parts = Y * log + quarter - X * angle, X * log + Y * angle
        return self._pair.mismatch * np.array(parts)
