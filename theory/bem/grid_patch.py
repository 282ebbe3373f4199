"""A contact patch as boundary elements give it: pressure in the cells of a rectangular grid.

Lengths are in mm, forces in N, stresses in MPa; x runs along the rail and s across it, on the
developed surface, whose normals are tilted from the load by angles in rad.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
from scipy.ndimage import label

from railhead.theory.array_types import Array

PARTS = 6  # of a cell each way, to which shares of the patch are counted


@dataclass(frozen=True)
class Grid:
    """Rectangular grid of cells on a developed (unrolled) surface.

    x: cell centres along the rail, (nx,), evenly spaced, mm.
    s: cell centres across the rail on the developed surface, (ns,), evenly spaced, mm.
    angle: tilt of the surface's normal from the load at s, (ns,), rad: the contact angle, positive
        where the surface rises with s.
    lean: angle at which the surface rises with x against the load, rad; the tilt is about its line
        ahead.
    """

    x: Array
    s: Array
    angle: Array
    lean: float = field(default=0.0, kw_only=True)

    @property
    def upright(self) -> Array:
        """Part (ns,) of the surface normals along the load."""
        return np.cos(self.angle) * math.cos(self.lean)

    @property
    def tangents(self) -> Array:
        """Unit vectors (ns, 2, 3) along the surface, ahead and across; the load is along the third
        axis.
        """
        c, s = np.cos(self.angle), np.sin(self.angle)
        ahead, up = math.cos(self.lean), math.sin(self.lean)
        across = np.column_stack([-up * s, c, ahead * s])
        return np.stack([np.broadcast_to([ahead, 0.0, up], across.shape), across], axis=1)

    @property
    def cell(self) -> float:
        """Area of a cell, mm2."""
        return float((self.x[1] - self.x[0]) * (self.s[1] - self.s[0]))

    @property
    def places(self) -> Array:
        """Places (2, nx ns), x and s, of the cell centres, mm."""
        return np.array([np.repeat(self.x, self.s.size), np.tile(self.s, self.x.size)])

    @property
    def edges(self) -> tuple[Array, Array]:
        """Ends of the cells along x (nx + 1,) and across (ns + 1,), mm."""
        x, s = (
            np.append(axis - (axis[1] - axis[0]) / 2, axis[-1] + (axis[1] - axis[0]) / 2)
            for axis in (self.x, self.s)
        )
        return x, s

    @property
    def normals(self) -> Array:
        """Components (2, 1, ns) of the surface normals in the plane across the rail, of which the
        first is along the load where nothing leans.
        """
        return np.array([np.cos(self.angle), np.sin(self.angle)])[:, None]


@dataclass(frozen=True)
class PatchSolution(Grid):
    """Solution of a normal contact on a rectangular grid of cells on a developed surface.

    x: cell centres along the rail, (nx,), mm.
    s: cell centres across the rail on the developed surface, (ns,), mm.
    angle: tilt of the surface's normal from the load at s, (ns,), rad.
    pressure: contact pressure (nx, ns), MPa, zero outside of the patch.
    gap: gap of the deformed bodies (nx, ns) along the normals, mm, zero to the tolerance of the
        solution in the patch, infinite where the bodies do not face each other.
    approach: approach of the bodies along the load, mm.
    """

    pressure: Array
    gap: Array
    approach: float

    @property
    def force(self) -> float:
        """Integral of the pressure over the developed surface, N: the normal force."""
        return self.cell * float(self.pressure.sum())

    @property
    def load(self) -> float:
        """Component of the contact force along the load's direction, N, at most the force."""
        return self.cell * float((self.pressure @ self.upright).sum())

    @property
    def plane(self) -> float:
        """Tilt (rad) of the tangent plane of the patch: direction of the mean normal, weighted by
        the pressure.
        """
        along, across = (self.normals * self.pressure).sum(axis=(1, 2))
        return math.atan2(across, along)

    @property
    def area(self) -> float:
        """Area (mm2) of the patch's projection onto its own tangent plane: mean of the sums of its
        chords along x and along s. The ends of chords are extrapolated within the last cells.
        """
        return self.area_on(self.plane)

    def area_on(self, plane: float) -> float:
        """Area (mm2) of the patch's projection onto a plane tilted by `plane` (rad): mean of the
        sums of its chords along x and along s.
        """
        return float(np.mean(self._sums_of_chords(plane)))

    @property
    def area_spread(self) -> float:
        """Half of the difference between both sums of chords of the area, mm2. It is large where a
        patch has parts that are a few cells thin.
        """
        return float(np.ptp(self._sums_of_chords(self.plane))) / 2

    def _sums_of_chords(self, plane: float) -> list[float]:
        """Sums of chords along x and along s, projected as in `area_on`, mm2."""
        share = np.broadcast_to(np.cos(self.angle - plane), self.pressure.shape)
        pairs = (self.pressure, share), (self.pressure.T, share.T)
        return [self.cell * float(np.subtract(*_edges(p)) @ part[p > 0]) for p, part in pairs]

    @property
    def half_extents(self) -> tuple[float, float]:
        """Half lengths (mm) of the patch along x and along s between its outermost ends, which are
        extrapolated within the last cells.
        """
        return self.middle_and_half_extents[1]

    @cached_property
    def middle_and_half_extents(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Middle (x, s) of the patch between these ends, mm, and `half_extents`."""
        middle, half = [], []
        for axis, pressure in ((self.x, self.pressure), (self.s, self.pressure.T)):
            upper, lower = _edges(pressure)
            low, high = axis[0] + (axis[1] - axis[0]) * np.array([lower.min(), upper.max()])
            middle.append(float(low + high) / 2)
            half.append(float(high - low) / 2)
        return (middle[0], middle[1]), (half[0], half[1])

    def half_extents_on(self, plane: float) -> tuple[float, float]:
        """Half lengths (mm) along x and across of the patch's projection onto a plane tilted by
        `plane` (rad).
        """
        a, b = self.half_extents
        across = np.flatnonzero(self.pressure.any(axis=0))
        return a, b * float(np.cos(self.angle[across[0] : across[-1] + 1] - plane).mean())

    @property
    def outline(self) -> Array:
        """Closed curve (k, 2) of (x, s), mm, around a single patch: the ends of its chords along x,
        and between them its outermost ends along s. Holes are left out.
        """
        filled = np.flatnonzero(self.pressure.any(axis=0))
        columns = np.nonzero(self.pressure)[1]
        upper, lower = _edges(self.pressure)
        high = np.array([upper[columns == j].max() for j in filled])
        low = np.array([lower[columns == j].min() for j in filled])
        top, bottom = _edges(self.pressure.T)
        across = np.concatenate([[bottom.min()], filled, [top.max()]])
        high, low = (
            np.concatenate([[middle[0]], side, [middle[-1]]])
            for middle, side in (((high + low) / 2, high), ((high + low) / 2, low))
        )
        along = np.concatenate([low, high[::-1], low[:1]])
        around = np.concatenate([across, across[::-1], across[:1]])
        ends = [
            axis[0] + (axis[1] - axis[0]) * k for axis, k in ((self.x, along), (self.s, around))
        ]
        return np.column_stack(ends)

    @property
    def max_pressure(self) -> float:
        """Largest pressure, MPa: the peak of parabolas in x and in s through p^2 of the highest
        cell and its two neighbours. A direction in which one neighbour has no pressure is left
        out.
        """
        i, j = np.unravel_index(int(np.argmax(self.pressure)), self.pressure.shape)
        squares = np.pad(self.pressure**2, 1)[i : i + 3, j : j + 3]
        top = highest = squares[1, 1]
        for low, _, high in (squares[:, 1], squares[1]):
            if min(low, high) > 0 and low + high < 2 * highest:
                top += (high - low) ** 2 / (8 * (2 * highest - low - high))
        return math.sqrt(top)

    @property
    def centroid(self) -> tuple[float, float]:
        """Centre of pressure (x, s) in mm."""
        along, across = self.pressure.sum(axis=1), self.pressure.sum(axis=0)
        return float(np.average(self.x, weights=along)), float(np.average(self.s, weights=across))

    @property
    def semi_axes(self) -> tuple[float, float]:
        """Semi-axes (a, b) of the ellipse with Hertz pressure and the second moments of this
        pressure, mm: a = sqrt(5 int p (x - x_c)^2 dA / force), x_c the centre; b with s for x.
        """
        along, across = self.pressure.sum(axis=1), self.pressure.sum(axis=0)
        xx = np.average((self.x - self.centroid[0]) ** 2, weights=along)
        ss = np.average((self.s - self.centroid[1]) ** 2, weights=across)
        return math.sqrt(5 * xx), math.sqrt(5 * ss)

    def sampled(self, grid: Grid) -> "PatchSolution":
        """The same pressure on another grid, scaled to the load; see `on_grid`."""
        squares = between((self.x, self.s), self._continued, grid.x, grid.s)
        return on_grid(grid, np.sqrt(squares.clip(0.0)), self.load)

    @cached_property
    def _continued(self) -> Array:
        """Squares of the pressure, see `continued`."""
        return continued(self.pressure)

    def separate(self) -> "list[PatchSolution]":
        """Connected patches, a solution each with the grid, gap and approach of all. Cells that
        share a corner are connected.
        """
        parts, count = label(self.pressure > 0, structure=np.ones((3, 3)))
        return [
            replace(self, pressure=np.where(parts == number, self.pressure, 0.0))
            for number in range(1, count + 1)
        ]


def on_grid(grid: Grid, pressure: Array, load: float) -> PatchSolution:
    """A known pressure (nx, ns), scaled to a load (N); the gap is 0 in the patch and NaN outside,
    the approach NaN.
    """
    gap = np.where(pressure > 0, 0.0, math.nan)
    found = PatchSolution(grid.x, grid.s, grid.angle, pressure, gap, math.nan, lean=grid.lean)
    return replace(found, pressure=pressure * (load / found.load))


def continued(pressure: Array) -> Array:
    """Squares p^2 (nx + 8, ns + 8), MPa^2, of a pressure (nx, ns), MPa, with four cells more on
    each side, and negative beyond the edge of the patch. At a smooth edge p^2 goes on over two
    cells as it falls towards it, by parabolas. Where p does not fall, it stays.
    """
    squares = np.pad(pressure**2, 4)
    known = squares > 0
    for _ in range(2):
        total, count = np.zeros_like(squares), np.zeros(squares.shape, dtype=int)
        for axis, way in product((0, 1), (-1, 1)):
            (one, is_one), (two, is_two), (three, is_three) = (
                (np.roll(squares, k * way, axis), np.roll(known, k * way, axis)) for k in (1, 2, 3)
            )
            bend = np.where(is_three, one - 2 * two + three, 0.0)
            falls = np.minimum(2 * one - two + bend, 0.0)
            next_to = is_one & ~known
            total += next_to * np.where(is_two & (two > one), falls, one)
            count += next_to
        squares = np.where(count > 0, total / np.maximum(count, 1), squares)
        known |= count > 0
    return np.where(known, squares, -squares.max())


def between(axes: tuple[Array, Array], squares: Array, x: Array, s: Array) -> Array:
    """Values (n, m) at places x (n,) and s (m,), mm, bilinear between those that `continued` gives.
    axes: cell centres (nx,), (ns,), mm.
    """
    hats = []
    for centres, places in zip(axes, (x, s), strict=True):
        step = centres[1] - centres[0]
        nodes = centres[0] + step * np.arange(-4, centres.size + 4)
        hats.append(np.maximum(0, 1 - np.abs(places[:, None] - nodes) / step))
    return np.asarray(hats[0] @ squares @ hats[1].T)


def shares(axes: tuple[Array, Array], pressure: Array, *ahead: float) -> list[tuple[Array, Array]]:
    """Mean pressure (nx, ns), MPa, of all cells that a patch covers in part or wholly, and the
    share of each that lies in the patch: for each of `ahead`, of cells that far ahead along x of
    the given ones, in cells.

    axes: cell centres (nx,), (ns,), mm. pressure: (nx, ns), MPa, at the centres. Cells without
    pressure at their centre are covered where p^2 falls to zero in them (`continued`).
    """
    parts = ((np.arange(PARTS) + 0.5) / PARTS - 0.5)[None]
    squares, (nx, ns), found = continued(pressure), pressure.shape, []
    ends = (pressure > 0) | (squares[4:-4, 4:-4] <= 0)
    for way in ahead:
        x, y = (
            (axis[:, None] + (axis[1] - axis[0]) * (parts + more)).ravel()
            for axis, more in zip(axes, (way, 0.0), strict=True)
        )
        there = between(axes, squares, x, y)
        inside = (there > 0).astype(float)
        mean, share = (
            ends * each.reshape(nx, PARTS, -1).sum(axis=1).reshape(nx, ns, PARTS).mean(axis=2)
            for each in (np.sqrt(there * inside) / PARTS, inside / PARTS)
        )
        found.append((mean, share))
    return found


def _edges(pressure: Array) -> tuple[Array, Array]:
    """Upper and lower ends (two arrays, one value a cell with pressure), in cells along axis 0, of
    the part of the chord around each cell.

    At the end of a patch, p^2 of the last two cells is extrapolated linearly to zero, within one
    cell of the last centre. Where p does not fall towards the end, the part ends at the border of
    the last cell. Elsewhere a part ends half a cell from its centre.
    """
    i, j = np.nonzero(pressure)
    squares = np.pad(pressure**2, ((1, 1), (0, 0)))
    ends = []
    for way in (1, -1):
        here, beyond, behind = (squares[i + 1 + k * way, j] for k in (0, 1, -1))
        smooth = (beyond == 0) & (behind > here)
        ends.append(i + way * np.where(smooth, here / np.maximum(here, behind - here), 0.5))
    return ends[0], ends[1]
