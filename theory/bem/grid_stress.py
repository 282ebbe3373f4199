"""Stresses below pressure and tractions given in the cells of a rectangular grid, in closed form.

The body is the half-space z <= 0, z up, below the plane of x and s: that the developed surface is
curved is left out. y stands for s in the names of components.

A cell carries a constant pressure. Its potentials and their derivatives are sums of closed forms at
its four corners (Love, Phil. Trans. R. Soc. A 228, 1929), and inner corners are shared: what counts
at a corner is the mixed difference of the pressures around it. Lengths are in mm, stresses in MPa.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from railhead.theory.array_types import Array, Index
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.elastic import subsurface

PLACES = 3  # places each way over the patch, below which the largest stress is looked for
DEPTHS = 16  # depths there, from half a cell to the smaller half length of the patch
SURFACE = 1e-3  # depth, over a cell, at which stresses of the surface are taken
Invariant = Callable[[Array], Array]
Moved = Callable[[Array], Array]


def stress(
    patch: PatchSolution, poisson: float, points: Array, traction: Array | None = None
) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, tension positive, at points (n, 3), z <
    0, mm, of a half-space under the pressure of a patch.

    traction: (2, nx, ns), MPa, along x and s, that acts on the half-space; None: none.
    """
    total = _below_pressure(patch, poisson, points)
    if traction is not None:
        along = replace(patch, pressure=traction[0])
        across = replace(patch, x=patch.s, s=patch.x, pressure=traction[1].T)
        total += _below_traction(along, poisson, points)
        turned = _below_traction(across, poisson, points[:, [1, 0, 2]])
        total += turned[:, [1, 0, 2, 3, 5, 4]]
    return total


def _corners(patch: PatchSolution, points: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Distances X, Y (n, m), z (n, 1) and R = |(X, Y, z)| (n, m) of points (n, 3) from the m
    corners of cells, mm, and the pressure differences (m,) at the corners, MPa. The derivatives of
    the potentials are sums over the corners, weighted by these.
    """
    jumps = np.diff(np.diff(np.pad(patch.pressure, 1), axis=0), axis=1)
    i, j = np.nonzero(jumps)
    along, across = patch.edges
    X, Y = points[:, :1] - along[i], points[:, 1:2] - across[j]
    z = -points[:, 2:]
    return X, Y, z, np.sqrt(X**2 + Y**2 + z**2), jumps[i, j]


def _below_pressure(patch: PatchSolution, poisson: float, points: Array) -> Array:
    """Stress (n, 6) at points (n, 3) by the pressure of a patch, as in `stress`."""
    X, Y, z, R, strength = _corners(patch, points)
    over_y = _inverse_sum(R, Y, X**2 + z**2) / R  # 1 / (R (R + Y))
    over_x = _inverse_sum(R, X, Y**2 + z**2) / R
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


def _below_traction(patch: PatchSolution, poisson: float, points: Array) -> Array:
    """Stress (n, 6) at points (n, 3) by tractions q along x, which stand in the place of the
    pressure of a patch, as in `stress`.

    With F = int q ln(rho + z) dA and F1 = int q (z ln(rho + z) - rho) dA, z the depth, the
    displacement is (2 F_z + 2 nu F1_xx - z F_xx, 2 nu F1_xy - z F_xy, (1 - 2 nu) F_x - z F_xz)/(4
    pi G) (Johnson, Contact Mechanics, 3.2); F and F1 are harmonic.
    """
    X, Y, z, R, strength = _corners(patch, points)
    beside, over_y = 1 / (R + z), _inverse_sum(R, Y, X**2 + z**2)
    F_xz, F_yz = -np.log(over_y), -np.log(_inverse_sum(R, X, Y**2 + z**2))
    F_xyy, F_xzz = Y * beside / R, z * over_y / R
    columns = (
        2 * F_xz + 2 * poisson * Y * beside + z * (F_xyy + F_xzz),
        2 * poisson * (F_xz - Y * beside) - z * F_xyy,
        -z * F_xzz,
        F_yz - (2 * poisson + z / R) * X * beside,
        np.arctan(X * Y / (z * R)) + X * F_xzz,  # the shears on horizontal planes change sign
        z / R,
    )
    return np.column_stack([each @ (strength / (2 * np.pi)) for each in columns])


def largest_von_mises(patch: PatchSolution, poisson: float) -> float:
    """Largest von Mises stress (MPa) of a half-space under the pressure of a patch, without
    tractions, at the places of `lattice`. poisson: Poisson's ratio of the half-space.
    """
    return float(subsurface.von_mises(stress(patch, poisson, lattice(patch))).max())


def lattice(patch: PatchSolution) -> Array:
    """Places (n, 3) at which the largest stress under a patch is looked for, mm: below the
    crossings of four lines each way. These go through the first, middle and last cell with pressure
    and through that of the largest pressure. One depth is 1e-3 (SURFACE) of a cell; 16 others
    (DEPTHS) go from half a cell, its longer side, to the smaller half length. Below a strip, whose
    cells are longer than that, there are ten lines across it, and the longer side does not count.
    """
    top = np.unravel_index(int(np.argmax(patch.pressure)), patch.pressure.shape)
    least, sides = min(patch.half_extents), (patch.x[1] - patch.x[0], patch.s[1] - patch.s[0])
    strip = sides[1] > least
    step = sides[0] if strip else max(sides)
    lines = [
        axis[np.append(np.linspace(filled.min(), filled.max(), count).round().astype(int), most)]
        for axis, filled, most, count in zip(
            (patch.x, patch.s),
            np.nonzero(patch.pressure),
            top,
            (PLACES**2, 1) if strip else (PLACES, PLACES),
            strict=True,
        )
    ]
    deepest = max(step, least)
    depth = np.append(SURFACE * step, np.geomspace(step / 2, deepest, DEPTHS))
    places = np.meshgrid(*lines, -depth, indexing="ij")
    return np.column_stack([each.ravel() for each in places])


def at_surface(patch: PatchSolution, poisson: float, traction: Array) -> list[tuple[Array, float]]:
    """Places (3,), mm, and values (MPa) of the largest shear and of the largest von Mises stress,
    in this order, just below the surface in the middle of cells; arguments are those of `stress`.
    Looked for at every fourth cell of every fourth line, then at all cells beside the highest.
    """
    pressed, depth = patch.pressure > 0, -SURFACE * (patch.x[1] - patch.x[0])

    def below(cells: Index) -> tuple[Array, Array]:
        """Places (n, 3) below the pressed ones of `cells` (2, m), and stresses there (n, 6)."""
        i, j = cells[:, pressed[tuple(cells)]]
        places = np.column_stack([patch.x[i], patch.s[j], np.full(i.size, depth)])
        return places, stress(patch, poisson, places, traction)

    places, known = below(np.indices(pressed.shape)[:, ::4, ::4].reshape(2, -1))
    found = []
    for invariant in (subsurface.max_shear, subsurface.von_mises):
        x, s, _ = places[np.argmax(invariant(known))]
        near = np.abs(patch.x[:, None] - x) < 4 * (patch.x[1] - patch.x[0])
        near = near & (np.abs(patch.s - s) < 4 * (patch.s[1] - patch.s[0]))
        around, more = below(np.array(np.nonzero(near)))
        most = int(np.argmax(invariant(more)))
        found.append((around[most], float(invariant(more[most : most + 1])[0])))
    return found


def peaks(
    patch: PatchSolution, poisson: float, traction: Array | None = None
) -> list[tuple[Array, float]]:
    """Places (3,), mm, and values (MPa) of the largest shear and of the largest von Mises stress,
    in this order, under the pressure and tractions of a patch; arguments are those of `stress`.

    Each search starts at the largest value at the places of `lattice`, and climbs by the simplex
    method of Nelder and Mead. It goes no nearer to the surface than half a cell: there the stress
    is that of single cells, which are read in their middle, with tractions by `at_surface`.
    """
    places, least = lattice(patch), (patch.x[1] - patch.x[0]) / 2
    known = stress(patch, poisson, places, traction)
    low, high = places[:, :2].min(axis=0), places[:, :2].max(axis=0)
    steps = np.append((high - low) / (4 * PLACES), 0.1)
    above = None if traction is None else at_surface(patch, poisson, traction)
    found = []
    for number, invariant in enumerate((subsurface.max_shear, subsurface.von_mises)):
        values = invariant(known)
        start, top = places[np.argmax(values)], float(values.max())

        def moved(way: Array, start: Array = start) -> Array:
            """The point (3,) at `way` (3,) steps in x, s and ln(depth) from the start, between the
            first and the last cell with pressure, at least as deep as `least`, mm.
            """
            x, s = np.clip(start[:2] + way[:2] * steps[:2], low, high)
            return np.array([x, s, min(start[2] * np.exp(way[2] * steps[2]), -least)])

        def lower(way: Array, invariant: Invariant = invariant, moved: Moved = moved) -> float:
            """Minus the invariant (MPa) at the point `moved(way)`."""
            return -float(invariant(stress(patch, poisson, moved(way)[None], traction))[0])

        if -start[2] >= least:
            simplex = np.vstack([np.zeros(3), np.eye(3)])
            options = {"initial_simplex": simplex, "xatol": 0.05, "fatol": 1e-4 * top}
            best = minimize(lower, np.zeros(3), method="Nelder-Mead", options=options)
            start, top = moved(best.x), -float(best.fun)
        if above is not None and above[number][1] > top:
            start, top = above[number]
        found.append((start, top))
    return found


def _inverse_sum(R: Array, side: Array, rest: Array) -> Array:
    """1 / (R + side) with rest = R^2 - side^2, without cancellation where side is negative."""
    return np.where(side > 0, 1 / (R + np.abs(side)), (R + np.abs(side)) / rest)
