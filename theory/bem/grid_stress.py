"""Stresses below pressure and tractions given in the cells of a rectangular grid, in closed form.

The body is the half-space z <= 0, z up, below the plane of x and s: that the developed surface is
curved is left out. y stands for s in the names of components.

A cell carries a constant pressure. Its potentials and their derivatives are sums of closed forms at
its four corners (Love, Phil. Trans. R. Soc. A 228, 1929), and inner corners are shared: what counts
at a corner is the mixed difference of the pressures around it. Lengths are in mm, stresses in MPa.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.fft import irfft2, rfft2
from scipy.optimize import minimize

from railhead.theory.array_types import Array
from railhead.theory.bem.grid_patch import PatchSolution
from railhead.theory.elastic import subsurface

PLACES = 3  # places each way over the patch, below which the largest stress is looked for
DEPTHS = 16  # depths there, from half a cell to the smaller half length of the patch
SURFACE = 1e-3  # depth, over a cell, at which stresses of the surface are taken
Invariant = Callable[[Array], Array]
Moved = Callable[[Array], Array]
Sum = Callable[[Array], Array]
AT_ONCE = 2**15  # distances of points from corners that are summed at a time
EXCHANGED = slice(None), [1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 10]
"""Order of the sums of tractions along x, and along y with x and y exchanged."""


def stress(
    patch: PatchSolution, poisson: float, points: Array, traction: Array | None = None
) -> Array:
    """Stress (n, 6), columns xx, yy, zz, xy, xz, yz, MPa, tension positive, at points (n, 3), z <
    0, mm, of a half-space under the pressure of a patch.

    traction: (2, nx, ns), MPa, along x and s, that acts on the half-space; None: none.
    """
    return below(patch, poisson, traction)(points)


def below(patch: PatchSolution, poisson: float, traction: Array | None) -> Callable[[Array], Array]:
    """Function from points (n, 3) to the stress there; all as of `stress`."""
    jumps = _jumps(patch, traction)
    i, j = np.nonzero(jumps.any(axis=0))
    strength, (along, across) = jumps[:, i, j].T, patch.edges

    def at(points: Array) -> Array:
        """Stress (n, 6), MPa."""
        X, Y = points[:, :1] - along[i], points[:, 1:2] - across[j]
        return _stress(X, Y, -points[:, 2:], poisson, lambda kernel: kernel @ strength)

    def in_parts(points: Array) -> Array:
        """The same, of some points at a time, whose distances stay near the processor."""
        parts = math.ceil(len(points) * i.size / AT_ONCE)
        return np.concatenate([at(part) for part in np.array_split(points, parts)])

    return in_parts


def _jumps(patch: PatchSolution, traction: Array | None) -> Array:
    """Mixed differences (k, nx + 1, ns + 1), MPa, at the corners of cells, of the pressure and of
    the tractions along x and s: k is 1 or 3.
    """
    loads = patch.pressure[None] if traction is None else np.stack([patch.pressure, *traction])
    return np.diff(np.diff(np.pad(loads, ((0, 0), (1, 1), (1, 1))), axis=1), axis=2)


def _stress(X: Array, Y: Array, z: Array | float, poisson: float, summed: Sum) -> Array:
    """Stress (n, 6) at points, as of `stress`, from distances X, Y (mm) from the corners of cells
    and the depth z, mm. summed: maps values at these distances to sums (n, k) over all corners,
    weighted by the k jumps (`_jumps`).

    With F = int q ln(rho + z) dA and F1 = int q (z ln(rho + z) - rho) dA, the displacement of
    tractions q along x is (2 F_z + 2 nu F1_xx - z F_xx, 2 nu F1_xy - z F_xy, (1 - 2 nu) F_x - z
    F_xz)/(4 pi G) (Johnson, Contact Mechanics, 3.2); F and F1 are harmonic.
    """
    R = np.sqrt(X**2 + Y**2 + z**2)
    over_y, over_x = _inverse_sum(R, Y, X**2 + z**2), _inverse_sum(R, X, Y**2 + z**2)
    ratio = z / R
    turn, slant = summed(np.arctan(X * Y / (z * R))), summed(ratio)
    xx, yy, xz, yz = (
        summed(ratio * each) for each in (X * over_y, Y * over_x, z * over_y, z * over_x)
    )
    logs = (
        np.arctan2(Y * (R - z) * X, X * X * R + z * Y * Y),
        np.arctan2(X * (R - z) * Y, Y * Y * R + z * X * X),
        np.log(R + z),
    )
    total = subsurface.love(
        -turn[:, 0],
        [each[:, 0] for each in (xx, yy, -xx - yy, slant, xz, yz)],
        [summed(each)[:, 0] for each in logs],
        poisson,
    )
    if slant.shape[1] == 1:
        return total
    aside, across = Y / (R + z), X / (R + z)
    kernels = -np.log(over_y), -np.log(over_x), aside, across, ratio * aside, ratio * across
    sums = np.stack([*map(summed, kernels), xz, yz, turn + xx, turn + yy, slant])
    for load, order in enumerate(EXCHANGED, 1):  # along x, then along y with x in the place of y
        F_xz, F_yz, y, x, zy, zx, F_xzz, _, shear, _, other = sums[order, :, load]
        columns = (
            2 * F_xz + 2 * poisson * y + zy + F_xzz,
            2 * poisson * (F_xz - y) - zy,
            -F_xzz,
            F_yz - 2 * poisson * x - zx,
            shear,  # the shears on horizontal planes change sign
            other,
        )
        found = np.column_stack(columns) / (2 * np.pi)
        total += found if load == 1 else found[:, [1, 0, 2, 3, 5, 4]]
    return total


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


def layer(patch: PatchSolution, poisson: float, traction: Array | None, depth: float) -> Array:
    """Stress (nx, ns, 6), as of `stress`, below the middle of each cell at a depth > 0, mm. Fast
    Fourier transforms sum over the corners of all cells at once.
    """
    (nx, ns), jumps = patch.pressure.shape, _jumps(patch, traction)
    size, count = (2 * nx, 2 * ns), len(jumps)
    waves = rfft2(jumps, size)

    def summed(kernel: Array) -> Array:
        """Sums (nx ns, k) at all cells of values (2 nx, 2 ns) at all distances from corners."""
        sums = irfft2(rfft2(kernel) * waves, size)[:, nx:, ns:]
        return np.asarray(sums.reshape(count, -1).T)

    X, Y = (
        (axis[1] - axis[0]) * (np.arange(2 * axis.size) - axis.size + 0.5)
        for axis in (patch.x, patch.s)
    )
    return _stress(X[:, None], Y, depth, poisson, summed).reshape(nx, ns, 6)


def at_surface(patch: PatchSolution, poisson: float, traction: Array) -> list[tuple[Array, float]]:
    """Places (3,), mm, and values (MPa) of the largest shear and of the largest von Mises stress,
    in this order, just below the surface in the middle of pressed cells; arguments are those of
    `stress`.
    """
    (nx, ns), depth = patch.pressure.shape, SURFACE * (patch.x[1] - patch.x[0])
    known = layer(patch, poisson, traction, depth).reshape(-1, 6)
    found = []
    for invariant in (subsurface.max_shear, subsurface.von_mises):
        values = np.where(patch.pressure.ravel() > 0, invariant(known), -np.inf)
        i, j = np.unravel_index(int(np.argmax(values)), (nx, ns))
        found.append((np.array([patch.x[i], patch.s[j], -depth]), float(values.max())))
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
    stress_at = below(patch, poisson, traction)
    known = stress_at(places)
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
            return -float(invariant(stress_at(moved(way)[None]))[0])

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
