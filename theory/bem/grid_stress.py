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


def stress(patch: PatchSolution, poisson: float, points: Array) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, tension positive, at points (n, 3), z <
    0, mm, below the pressure of a grid on a half-space.

    X, Y, z are the distances of the n points from the m corners of cells, R = |(X, Y, z)|. The
    derivatives of the potentials are sums over the corners, weighted by the pressure differences.
    """
    jumps = np.diff(np.diff(np.pad(patch.pressure, 1), axis=0), axis=1)
    i, j = np.nonzero(jumps)
    strength = jumps[i, j]
    X = points[:, :1] - _edges(patch.x)[i]
    Y = points[:, 1:2] - _edges(patch.s)[j]
    z = -points[:, 2:]
    R = np.sqrt(X**2 + Y**2 + z**2)
    over_y = _share(R, Y, X**2 + z**2) / R  # 1 / (R (R + Y))
    over_x = _share(R, X, Y**2 + z**2) / R
    xx, yy = (z * X * over_y) @ strength, (z * Y * over_x) @ strength
    shears = (z / R, z**2 * over_y, z**2 * over_x)
    logs = (
        np.arctan2(Y * (R - z) * X, X * X * R + z * Y * Y),
        np.arctan2(X * (R - z) * Y, Y * Y * R + z * X * X),
        np.log(R + z),
    )
    return subsurface.love(
        -np.arctan(X * Y / (z * R)) @ strength,
        [xx, yy, -xx - yy, *(each @ strength for each in shears)],
        [each @ strength for each in logs],
        poisson,
    )


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
