"""Displacement of the surface of two half-spaces by pressure in the cells of separate grids.

The surface is developed: distances are taken along it. Both bodies of one material move towards
each other along a force and not across it (the tangential displacements of the two half-spaces are
alike; Johnson, Contact Mechanics, 3.22), so that a force moves a surface with another normal by the
cosine of the angle between both. The matrix stays symmetric and positive definite.
"""

import math
from collections.abc import Callable, Sequence
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import fft, ifft, irfft, next_fast_len, rfft

from railhead.theory.array_types import Array, Complex
from railhead.theory.bem.grid_patch import Grid

Lines = Callable[[Array], Array]
"""Places s (n,), mm -> compliance (n, n), mm2/N, symmetric, no eigenvalue below 0: opening of the
lines along the rail at s, the same at all cells of a line, over the force per width of each."""
NODES = 16  # an axis, to which a grid gathers its pressure for other grids
SOFTER = 0.25  # of the compliance of a cell: so much softer cells have a bounded inverse


class Influence:
    """Linear map from the pressure (n,) in the cells of all grids, MPa, to the normal displacement
    (n,) of the surfaces there, mm, both bodies together. n counts the cells of all grids.

    own: displacement of a cell by a unit pressure in that cell, largest of all grids, mm/MPa.
    """

    def __init__(
        self, grids: Sequence[Grid], contact_modulus: float, lines: Lines | None = None
    ) -> None:
        """grids: rectangular grids that must not overlap; contact_modulus: E*, MPa; lines:
        compliance of the lines along the rail beside that of the half-spaces; None: zero.
        """
        self._lines = [] if lines is None else [(g.x[1] - g.x[0]) * lines(g.s) for g in grids]
        self._shapes = [(grid.x.size, grid.s.size) for grid in grids]
        self._cuts = np.cumsum([nx * ns for nx, ns in self._shapes])[:-1]
        self._within = [_Love(grid, contact_modulus) for grid in grids]
        self.own = max(each.own for each in self._within)
        self._nodes = [Nodes(grid) for grid in grids] if len(grids) > 1 else []
        self._kernels = {
            (i, j): point_force(self._nodes[i].places, self._nodes[j].places, contact_modulus)
            for i, j in permutations(range(len(self._nodes)), 2)
        }

    def split(self, values: Array) -> list[Array]:
        """Values (n,) of all cells as one array (nx, ns) for each grid."""
        pieces = zip(np.split(values, self._cuts), self._shapes, strict=True)
        return [piece.reshape(shape) for piece, shape in pieces]

    def __call__(self, pressure: Array) -> Array:
        """Normal displacement (n,), mm, of a pressure (n,), MPa."""
        pieces = self.split(pressure)
        moved = [within(piece) for within, piece in zip(self._within, pieces, strict=True)]
        forces = [nodes.gather(piece) for nodes, piece in zip(self._nodes, pieces, strict=False)]
        for i, nodes in enumerate(self._nodes):
            for j, force in enumerate(forces):
                if j != i:
                    moved[i] = moved[i] + nodes.spread(force @ self._kernels[i, j].T)
        for i, (line, piece) in enumerate(zip(self._lines, pieces, strict=False)):
            moved[i] = moved[i] + line @ piece.sum(axis=0)
        return np.concatenate([piece.ravel() for piece in moved])

    def inverse(self, displacement: Array) -> Array:
        """Nearly the pressure (n,), MPa, of a displacement (n,), mm, where each grid is alone and
        goes on in its plane, or with a compliance of the lines each cell: symmetric and positive
        definite.
        """
        if self._lines:
            return displacement / self.own
        pairs = zip(self._within, self.split(displacement), strict=True)
        return np.concatenate([within.inverse(piece).ravel() for within, piece in pairs])


class Nodes:
    """Coarse nodes over the cells of a grid, with bilinear interpolation between nodes. Distant
    grids exchange forces and displacements through nodes.

    places: coordinates (x, s) of the nodes, (m, 2), mm.
    """

    def __init__(self, grid: Grid) -> None:
        """grid: the grid of cells; at most 16 nodes (NODES) are placed along each axis."""
        axes, self._weights = zip(*(_hats(axis) for axis in (grid.x, grid.s)), strict=True)
        self.places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        self._grid = grid

    def gather(self, pressure: Array) -> Array:
        """Forces (2, m) at the nodes, along and across the load, N, of a pressure (nx, ns), MPa."""
        along, across = self._weights
        forces = along.T @ (self._grid.cell * self._grid.normals * pressure) @ across
        return np.asarray(forces.reshape(2, -1))

    def spread(self, displacement: Array) -> Array:
        """Normal displacement (nx, ns) of the cells, mm, from displacements (2, m) of the nodes
        along and across the load, mm.
        """
        along, across = self._weights
        nodal = displacement.reshape(2, along.shape[1], across.shape[1])
        return np.asarray((self._grid.normals * (along @ nodal @ across.T)).sum(axis=0))


def point_force(places: Array, sources: Array, contact_modulus: float) -> Array:
    """Normal displacement 1/(pi E* r) of places (n, 2) by unit forces at sources (m, 2), mm: a
    matrix (n, m), mm/N (Boussinesq; Johnson, Contact Mechanics, 3.22a). contact_modulus: E*, MPa.
    """
    distance = np.hypot(*(places[:, None] - sources[None]).transpose(2, 0, 1))
    return np.asarray(1 / (math.pi * contact_modulus * distance))


def logarithms(X: Array, S: Array) -> tuple[Array, Array]:
    """X arsinh(S/|X|) and S arsinh(X/|S|), 0 at X = 0 and at S = 0.

    X, S: coordinates of a rectangle's corners relative to a place. Differences of the two
    functions over the four corners are the integrals of s^2/r^3 and of x^2/r^3 over the rectangle;
    those of their sum are the integral of 1/r.
    """
    across = X * np.arcsinh(S / np.maximum(np.abs(X), 1e-100))
    return across, S * np.arcsinh(X / np.maximum(np.abs(S), 1e-100))


def fast_shape(size: tuple[int, int]) -> tuple[int, int]:
    """Shape (px, ps), at least (2 nx, 2 ns), of a grid (nx, ns) padded for a fast FFT."""
    nx, ns = size
    return next_fast_len(2 * nx, real=True), next_fast_len(2 * ns, real=True)


def transform(values: Array, padded: tuple[int, int]) -> Complex:
    """Spectrum (..., px, ps // 2 + 1) of values (..., nx, ns) that zeros continue to `padded`,
    (px, ps). As `scipy.fft.rfft2`, but rows of zeros are not transformed.
    """
    return np.asarray(fft(rfft(values, padded[1]), padded[0], axis=-2))


def restored(spectrum: Complex, padded: tuple[int, int], size: tuple[int, ...]) -> Array:
    """Values (..., nx, ns) of a spectrum, see `transform`, without the padding; size: (nx, ns)."""
    nx, ns = size
    return np.asarray(irfft(ifft(spectrum, axis=-2)[..., :nx, :], padded[1])[..., :ns])


def _hats(axis: Array) -> tuple[Array, Array]:
    """Nodes (m,) spread evenly over an axis of cells (n,), and the values of their piecewise linear
    hat functions at the cells, (n, m).
    """
    nodes = np.linspace(axis[0], axis[-1], min(NODES, axis.size))
    return nodes, np.maximum(0, 1 - np.abs(axis[:, None] - nodes) / (nodes[1] - nodes[0]))


class _Love:
    """Called with the pressure (nx, ns) in the cells of a grid, MPa, it returns their normal
    displacement (nx, ns), mm.

    A cell displaces by the sum over its corners of +-(x arsinh(s/|x|) + s arsinh(x/|s|)), over pi
    E* (Love; Johnson, Contact Mechanics, 3.25); a zero-padded FFT sums over all cells.

    own: displacement of a cell by its own unit pressure, mm/MPa.
    """

    def __init__(self, grid: Grid, contact_modulus: float) -> None:
        """contact_modulus: E*, MPa."""
        x, s, normals = grid.x, grid.s, grid.normals
        self._normals = normals[normals.any(axis=(1, 2))]
        nx, ns = self._padded = fast_shape((x.size, s.size))
        X = ((np.arange(nx + 1) - nx // 2 - 0.5) * (x[1] - x[0]))[:, None]
        S = (np.arange(ns + 1) - ns // 2 - 0.5) * (s[1] - s[0])
        corners = sum(logarithms(X, S))
        influence = np.diff(np.diff(corners, axis=0), axis=1) / (math.pi * contact_modulus)
        self.own = float(influence[nx // 2, ns // 2])
        kernel = np.fft.ifftshift(influence)
        self._spectrum = fft(rfft(kernel, axis=0)).real  # it is even in x and in s
        stiffness = 1 / (np.maximum(self._spectrum, 0.0) + SOFTER * self.own)
        self._stiffness = stiffness.astype(np.float32)

    def __call__(self, pressure: Array) -> Array:
        return self._times(self._spectrum, self._normals, pressure)

    def inverse(self, displacement: Array) -> Array:
        """Nearly the pressure (nx, ns), MPa, of a displacement (nx, ns), mm: that of cells of the
        whole plane which are softer by SOFTER. As no more is asked, numbers are single.
        """
        plane = np.ones((1, 1, 1), np.float32)
        return self._times(self._stiffness, plane, displacement.astype(np.float32)).astype(float)

    def _times(self, spectrum: NDArray[Any], normals: NDArray[Any], values: NDArray[Any]) -> Array:
        """Convolution (nx, ns) of values (nx, ns) with a kernel that is even in x and s, whose
        spectrum is given, between the components (m, 1, ns) of the normals.
        """
        (nx, ns), size = self._padded, values.shape
        lines = rfft(values, nx, axis=0)  # normals change across alone
        moved = ifft(spectrum * fft(normals * lines, ns))[..., : size[1]]
        return np.asarray(irfft((normals * moved).sum(axis=0), nx, axis=0)[: size[0]])
