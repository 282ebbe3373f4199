"""Stresses below a pressure given in the cells of a rectangular grid, in closed form.

A cell carries a constant pressure. Its potentials and their derivatives are sums of closed forms at
its four corners (Love, Phil. Trans. R. Soc. A 228, 1929), and inner corners are shared: what counts
at a corner is the mixed difference of the pressures around it. Lengths are in mm, stresses in MPa.
"""

import numpy as np
from numpy.typing import NDArray

from railhead.theory.bem.patch import PatchSolution
from railhead.theory.elastic import subsurface

Array = NDArray[np.float64]
PLACES = 3  # each way over the patch, below which the largest stress is looked for ...
DEPTHS = 16  # ... from half a cell down to the patch's smaller half length, ...
SURFACE = 1e-3  # ... and so many cells below the surface


class GridPotential:
    """Derivatives of the potentials psi = int p/rho dA and psi1 = int p ln(rho + z) dA of a
    pressure p in grid cells, at n points below the surface; rho is the distance and z > 0 the
    depth.

    strength: mixed pressure difference at each corner of cells, (m,), MPa.
    X, Y: distances of the points from the corners along x and s, (n, m), mm.
    z: depths, (n, 1), mm.
    R: distances of the points from the corners, (n, m), mm.
    Properties are arrays (n,) in MPa.
    """

    def __init__(self, patch: PatchSolution, x: Array, s: Array, depth: Array) -> None:
        """patch: pressure on a grid; x, s, depth: coordinates (n,) of the points, mm, depth > 0."""
        jumps = np.diff(np.diff(np.pad(patch.pressure, 1), axis=0), axis=1)
        i, j = np.nonzero(jumps)
        self.strength = jumps[i, j]
        corner_x, corner_s = (_edges(axis) for axis in (patch.x, patch.s))
        self.X, self.Y = x[:, None] - corner_x[i], s[:, None] - corner_s[j]
        self.z = depth[:, None]
        self.R = np.sqrt(self.X**2 + self.Y**2 + self.z**2)

    @property
    def psi_z(self) -> Array:
        """Derivative of psi by the depth, (n,), MPa."""
        return self._sum(-np.arctan(self.X * self.Y / (self.z * self.R)))

    @property
    def depth_times_hessian(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Depth times psi_xx, psi_yy, psi_zz, psi_xy, psi_xz, psi_yz, each (n,), MPa; y is s."""
        along, across = self.X**2 + self.z**2, self.Y**2 + self.z**2
        over_y = _share(self.R, self.Y, along) / self.R  # 1 / (R (R + Y))
        over_x = _share(self.R, self.X, across) / self.R
        xx, yy = self._sum(self.z * self.X * over_y), self._sum(self.z * self.Y * over_x)
        xy = self._sum(self.z / self.R)
        xz, yz = self._sum(self.z**2 * over_y), self._sum(self.z**2 * over_x)
        return xx, yy, -xx - yy, xy, xz, yz

    @property
    def log_hessian(self) -> tuple[Array, Array, Array]:
        """Second derivatives psi1_xx, psi1_yy, psi1_xy, each (n,), MPa; y is s."""
        X, Y, z, R = self.X, self.Y, self.z, self.R
        xx = np.arctan2(Y * (R - z) * X, X * X * R + z * Y * Y)
        yy = np.arctan2(X * (R - z) * Y, Y * Y * R + z * X * X)
        return self._sum(xx), self._sum(yy), self._sum(np.log(R + z))

    def _sum(self, corners: Array) -> Array:
        """Sum over the corners of their values (n, m) times their pressure differences, (n,)."""
        return np.asarray(corners @ self.strength)


def stress(patch: PatchSolution, poisson: float, points: Array) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, tension positive, at points (n, 3), z <
    0, mm, below the pressure of a grid on a half-space.
    """
    x, s, z = points.T
    return subsurface.love(GridPotential(patch, x, s, -z), poisson)


def largest_von_mises(patch: PatchSolution, poisson: float) -> float:
    """Largest von Mises stress (MPa) below the pressure of a patch. Searched below PLACES x PLACES
    places and below the cell of the largest pressure, at DEPTHS depths down to the smaller half
    length, and near the surface.
    """
    top = np.unravel_index(int(np.argmax(patch.pressure)), patch.pressure.shape)
    lines = [
        axis[np.append(np.linspace(filled.min(), filled.max(), PLACES).round().astype(int), most)]
        for axis, filled, most in zip(
            (patch.x, patch.s), np.nonzero(patch.pressure), top, strict=True
        )
    ]
    step = max(patch.x[1] - patch.x[0], patch.s[1] - patch.s[0])
    deepest = max(step, min(patch.half_extents))
    depth = np.append(SURFACE * step, np.geomspace(step / 2, deepest, DEPTHS))
    places = np.meshgrid(*lines, -depth, indexing="ij")
    points = np.column_stack([each.ravel() for each in places])
    return float(subsurface.von_mises(stress(patch, poisson, points)).max())


def _edges(centres: Array) -> Array:
    """Borders (n + 1,) between evenly spaced cells with centres (n,), mm."""
    step = centres[1] - centres[0]
    return np.append(centres - step / 2, centres[-1] + step / 2)


def _share(R: Array, side: Array, rest: Array) -> Array:
    """1 / (R + side) with rest = R^2 - side^2, without cancellation where side is negative."""
    return np.where(side > 0, 1 / (R + np.abs(side)), (R + np.abs(side)) / rest)
