"""Influence coefficients: tangential displacement of two half-spaces by tractions on grid cells.

Displacements are those of the wheel's surface relative to the rail's, tractions those of the wheel
on the rail: a traction along +x moves the wheel's surface to -x.
Lengths in mm, tractions and moduli in MPa.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass

import numpy as np

from railhead.theory.array_types import Array
from railhead.theory.bem.influence import fast_shape, logarithms, restored, transform
from railhead.theory.elastic.hertz import contact_modulus

NO_MISMATCH = 1e-9  # largest |K| that is taken for a rounding error
AHEAD = 0.5  # cells from a force to the place where its slip is taken, towards the leading edge
EDGE = {True: math.pi / 2, False: 1.0}
"""What a cell that the edge of the patch cuts yields beyond a whole one, over 1/share - 1, in
rolling (True) and of a shift. In rolling a strip of any length has its exact force with it."""


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

    Cerruti: a force Q_x moves both surfaces apart by Q_x/(pi G) ((1 - nu)/r + nu x^2/r^3) along x
    and by Q_x/(pi G) nu x y/r^3 along y (Johnson, Contact Mechanics, 3.7). Slips are in mm at the
    cell centres, with Cerruti's kernels integrated over a cell. In rolling along +x they are per
    rolled length, -du/dx half a cell ahead of the centres, and the force of a cell acts on the line
    across through its centre. That is the lattice of wing theory, turned round: loads at a quarter
    and slopes at three quarters of a panel give a strip its exact force on any number of panels
    (James, Comp. Meth. Appl. Mech. Eng. 1, 1972).

    line: (2, padded), reduction of the slip per MPa at the cell k places ahead on the same line
        along x; k = 0 is the cell itself, negative k count from the end. Row 0: along x by
        traction along x, row 1: along y by traction along y.
    edge: (2, nx, ny), what is added to `line[:, 0]` of a cell of which a share lies in the patch.
    """

    def __init__(
        self,
        x: Array,
        y: Array,
        pair: MaterialPair,
        *,
        rolling: bool,
        added: Callable[[Array], Array] | None = None,
        covered: Array | None = None,
        layer: float = 0.0,
    ) -> None:
        """x (nx,), y (ny,): cell centres, evenly spaced and at least two an axis, mm; pair:
        materials; rolling: whether slips are per rolled length; added: reduction of the slip by
        tractions beside that of half-spaces, linear; None: zero. covered (nx, ny): share of the
        panel of each cell in the patch; None: whole cells. In rolling a panel reaches from a
        quarter of a cell behind the centre to three quarters ahead. layer: thickness over shear
            modulus of an elastic layer between the surfaces, mm/MPa: they move apart by that times
            the traction (Kalker's simplified theory).
        """
        self._size, self._pair, self._added = (x.size, y.size), pair, added
        self._padded = fast_shape(self._size)
        self._steps = float(x[1] - x[0]), float(y[1] - y[0])
        self._rolling = rolling
        kernels = self._slopes() if rolling else self._displacements(self._cerruti)
        own = kernels[::2, 0, 0].copy()
        kernels[::2, 0, 0] += layer / self._steps[0] if rolling else layer
        if rolling:  # the difference to the cell ahead
            kernels[::2, -1, 0] -= layer / self._steps[0]
        self._spectra = transform(kernels, self._padded)
        self.line = kernels[::2, :, 0]  # (2, padded): of a cell on those of its own line along x
        whole = 1.0 if covered is None else np.where(covered > 0, covered, 1.0)
        self.edge = EDGE[rolling] * own[:, None, None] * (1 / whole - 1)

    def __call__(self, traction: Array) -> Array:
        """Reduction of the slip (2, nx, ny) by tractions (2, nx, ny), MPa."""
        xx, xy, yy = self._spectra
        along, across = transform(traction, self._padded)
        moved = np.array([xx * along + xy * across, xy * along + yy * across])
        own = restored(moved, self._padded, self._size) + self.edge * traction
        return own if self._added is None else own + self._added(traction)

    def single(self, softer: float | None = None) -> TractionInfluence:
        """The same map in numbers of single precision. softer: instead the inverse of the map
        between tractions and slips of the whole plane, to which `softer` times the tractions, mm
        or 1 per MPa, is added.
        """
        other, spectra, edge = copy(self), self._spectra, self.edge
        if softer is not None:
            xx, xy, yy = spectra + softer * np.array([1.0, 0.0, 1.0])[:, None, None]
            spectra, edge = np.array([yy, -xy, xx]) / (xx * yy - xy * xy), 0 * edge
            other._added = None
        other._spectra, other.edge = spectra.astype(np.complex64), edge.astype(np.float32)
        return other

    def of_pressure(self, pressure: Array) -> Array:
        """Reduction of the slip (2, nx, ny) by a pressure (nx, ny), MPa, where materials differ:
        both surfaces move inwards, the softer one further. A force P gives K P/(pi G) x/r^2
        along x (Johnson, 3.18b). In rolling it is the difference over a cell.
        """
        kernels = self._displacements(self._boussinesq)
        if self._rolling:
            there = self._displacements(self._boussinesq, 2 * AHEAD)
            kernels = (kernels - there) / self._steps[0]
        moved = transform(kernels, self._padded) * transform(pressure, self._padded)
        return restored(moved, self._padded, self._size)

    def opening(self, traction: Array) -> Array:
        """Change of the normal gap (nx, ny), mm, by tractions (2, nx, ny), MPa, where materials
        differ. By reciprocity its kernel is that of `of_pressure` of a shift with x and y reversed.
        """
        spectra = transform(self._displacements(self._boussinesq), self._padded)
        moved = (spectra * transform(traction, self._padded)).sum(axis=0)
        return -restored(moved, self._padded, self._size)

    def _places(self, ahead: float, lines: int) -> list[Array]:
        """Coordinates X (px, 1) and Y (1, py + 1), mm, of places from the middle of a cell: X
        `ahead` cells from the centres of cells (`lines` 0) or from their ends (1, one more), Y at
        ends of cells.
        """
        (px, py), (dx, dy) = self._padded, self._steps
        X = (np.arange(px + lines) - px // 2 + ahead - lines / 2) * dx
        return [X[:, None], (np.arange(py + 1.0) - py // 2 - 0.5)[None] * dy]

    def _displacements(self, corners: Callable[[Array, Array], Array], ahead: float = 0.0) -> Array:
        """Displacements (m, padded x, padded y) of all cells by one, the cell itself first, `ahead`
        cells from their centres. corners: antiderivatives (m, ...) at corners (X, Y), mm.
        """
        cells = np.diff(np.diff(corners(*self._places(ahead, 1)), axis=1), axis=2)
        return self._scaled(cells)

    def _slopes(self) -> Array:
        """Minus the derivatives along x (3, padded x, padded y) of Cerruti's displacements half a
        cell ahead of all cells, by forces of a cell on its line across, the cell itself first: x by
        force along x, x by force along y, y by force along y.
        """
        X, Y = self._places(AHEAD, 0)
        nu, r = self._pair.poisson, np.hypot(X, Y)
        whole, part = Y / (X * r), nu * X * Y / r**3
        ends = np.array([(1 - nu) * whole + part, nu * Y**2 / r**3, whole - part])
        return self._scaled(self._steps[0] * np.diff(ends, axis=2))

    def _scaled(self, kernels: Array) -> Array:
        """Kernels over pi G, the cell itself first."""
        scaled = kernels / (math.pi * self._pair.shear_modulus)
        return np.asarray(np.fft.ifftshift(scaled, axes=(1, 2)))

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
