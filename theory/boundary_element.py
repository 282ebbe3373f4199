"""Frictionless normal contact of two elastic half-spaces with any gap, by boundary elements.

A second opinion beside Hertz where the patch is no ellipse, and a forecast of the patch. Lengths
are in mm, forces in N, stresses in MPa; x runs along the rail and s across it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, next_fast_len, rfft2
from scipy.interpolate import RegularGridInterpolator

Array = NDArray[np.float64]
Gap = Callable[[Array, Array], Array]
SEARCH_CELLS, SEARCHES, ITERATIONS = 64, 60, 3000  # cells an axis in the search, and its limits
FILL_RANGE, FILL = (0.6, 0.9), 0.8  # share of the domain's width that the patch takes up
FAR = 1e9  # mm; a wider gap never closes


@dataclass(frozen=True)
class PatchSolution:
    """Cell centres x (nx,), s (ns,), pressure (nx, ns), deformed gap (nx, ns), load, approach.

    The gap is infinite where the bodies do not face each other, and zero in the patch.
    """

    x: Array
    s: Array
    pressure: Array
    gap: Array
    load: float
    approach: float

    @property
    def area(self) -> float:
        """Patch area in mm^2, the mean from its chords along x and along s (see `_edges`)."""
        chords = [np.subtract(*_edges(p)).sum() for p in (self.pressure, self.pressure.T)]
        return float((self.x[1] - self.x[0]) * (self.s[1] - self.s[0]) * np.mean(chords))

    @property
    def half_extents(self) -> tuple[float, float]:
        """Half the patch's length along x and across, along s, in mm (edges as for the area)."""
        ends = [_edges(p) for p in (self.pressure, self.pressure.T)]
        along, across = ((upper.max() - lower.min()) / 2 for upper, lower in ends)
        return float(along * (self.x[1] - self.x[0])), float(across * (self.s[1] - self.s[0]))

    @property
    def max_pressure(self) -> float:
        """Peak in MPa of parabolas along x and s through p^2 at the highest cell and beside it.

        A line of cells on which a neighbour of the highest one is open adds nothing to that cell.
        """
        i, j = np.unravel_index(int(np.argmax(self.pressure)), self.pressure.shape)
        squares = np.pad(self.pressure**2, 1)[i : i + 3, j : j + 3]
        top = highest = squares[1, 1]
        for low, _, high in (squares[:, 1], squares[1]):
            if min(low, high) > 0 and low + high < 2 * highest:
                top += (high - low) ** 2 / (8 * (2 * highest - low - high))
        return math.sqrt(top)

    @property
    def mean_pressure(self) -> float:
        """Load over area in MPa."""
        return self.load / self.area

    @property
    def centroid(self) -> tuple[float, float]:
        """Centre of pressure (x, s) in mm."""
        along, across = self.pressure.sum(axis=1), self.pressure.sum(axis=0)
        return float(np.average(self.x, weights=along)), float(np.average(self.s, weights=across))

    @property
    def semi_axes(self) -> tuple[float, float]:
        """(a, b) in mm: a = sqrt(5 int p (x - x_c)^2 dA / load), b alike in s; exact for Hertz."""
        along, across = self.pressure.sum(axis=1), self.pressure.sum(axis=0)
        xx = np.average((self.x - self.centroid[0]) ** 2, weights=along)
        ss = np.average((self.s - self.centroid[1]) ** 2, weights=across)
        return math.sqrt(5 * xx), math.sqrt(5 * ss)


def solve(
    gap: Gap,
    contact_modulus: float,
    *,
    load: float | None = None,
    approach: float | None = None,
    centre: tuple[float, float] = (0.0, 0.0),
    half_size: tuple[float, float] = (10.0, 10.0),
    cells: int = 128,
    tolerance: float = 1e-8,
) -> PatchSolution:
    """Pressure p with gap + u(p) - approach >= 0, p >= 0 and one of the two zero in every cell.

    `gap` maps points x (n,), s (n,) to the undeformed gap (n,), +inf where the bodies do not face
    each other; the contact modulus is E*; exactly one of load and approach is given. The domain,
    at first centre +- half_size, grows until the patch fits in and shrinks until the patch takes up
    60 to 90 % of its width. A second patch is found if it lies in the first domain and is wider
    than a cell there, of 64 an axis. The gap is met to tolerance times the largest u. On Hertz
    ellipses along the axes, 128 cells reach 3e-5 in approach, 4e-5 in max_pressure, 1e-4 in
    semi_axes, 2e-3 in area and 4e-3 in half_extents; at a sharp edge p depends on the cells.
    ValueError: an argument or gap out of range, no contact, no bounded patch, no convergence.
    """
    if (load is None) == (approach is None):
        raise ValueError("give exactly one of load and approach")
    positive = (contact_modulus, *half_size, tolerance, 1.0 if load is None else load)
    if not all(1e-20 < value < 1e20 for value in positive):
        names = "contact_modulus, half_size, tolerance, load"
        raise ValueError(f"{names} must be positive and within 1e-20..1e20, got {positive}")
    if cells < 16 or not all(abs(value) < FAR for value in (*centre, approach or 0.0)):
        names = f"cells ({cells}) must be at least 16, centre {centre} and approach {approach}"
        raise ValueError(f"{names} within +-{FAR} mm")
    domain, patch, fine = np.array([centre, half_size], dtype=float), None, False
    for _ in range(SEARCHES):
        count = cells if fine else min(cells, SEARCH_CELLS)
        x, s = domain[0][:, None] + np.outer(domain[1], (2 * np.arange(count) + 1) / count - 1)
        if min(np.diff(x).min(), np.diff(s).min()) <= 0:  # cells below rounding
            break
        undeformed = _sample(gap, x, s)
        if approach is not None and undeformed.min() >= approach:
            i, j = np.unravel_index(int(np.argmin(undeformed)), undeformed.shape)
            border = np.isin((i, j), (0, count - 1))
            factor = np.where(border, 2, 1) if border.any() else 1 / 8
            domain = np.array([(x[i], s[j]), factor * domain[1]])
            continue
        patch = _equilibrium(x, s, undeformed, contact_modulus, load, approach, tolerance, patch)
        used = patch.pressure > 0
        windows = [_window(used.any(axis=1 - k), domain[:, k], fine) for k in (0, 1)]
        settled = np.array_equal(np.transpose(windows), domain)
        if fine and settled:
            return patch
        domain, fine = np.transpose(windows), fine or settled
    raise ValueError(
        f"no bounded contact found, the last domain was {domain[0]} +- {domain[1]} mm: the gap "
        f"must fall below the approach (if given, here {approach}) and grow around the patch"
    )


def _sample(gap: Gap, x: Array, s: Array) -> Array:
    """The gap (nx, ns) at the cell centres."""
    values = np.asarray(gap(np.repeat(x, s.size), np.tile(s, x.size)), dtype=float)
    if values.shape != (x.size * s.size,):
        raise ValueError(f"gap must return one value a point, got the shape {values.shape}")
    if np.isnan(values).any() or not -FAR < values.min() < FAR:
        raise ValueError(
            f"gap must be above {-FAR} mm everywhere and below {FAR} mm somewhere, got "
            f"{values.min()}..{values.max()} around x = {x.mean()}, s = {s.mean()}"
        )
    return np.where(values < FAR, values, np.inf).reshape(x.size, s.size)


def _window(used: NDArray[np.bool_], domain: Array, fine: bool) -> tuple[float, float]:
    """Middle and half width of a domain that suits the patch, along an axis of cells (n,)."""
    (middle, half), n, (first, last) = domain, used.size, np.flatnonzero(used)[[0, -1]]
    if first == 0 or last == n - 1:
        return middle + half * (int(last == n - 1) - int(first == 0)), 2 * half
    width = (last + 1 - first) / n
    if fine or FILL_RANGE[0] <= width <= FILL_RANGE[1]:
        return middle, half
    return middle + half * ((first + last + 1) / n - 1), half * width / FILL


def _edges(pressure: Array) -> tuple[Array, Array]:
    """Upper and lower ends, in cells, of each contact cell's part of the chord along axis 0.

    A patch ends where p^2, linear in the distance from a smooth edge, is extrapolated to zero from
    the last two cells, within a cell of the last centre; where p does not fall, at its cell's end.
    """
    i, j = np.nonzero(pressure)
    squares = np.pad(pressure**2, ((1, 1), (0, 0)))
    ends = []
    for way in (1, -1):
        here, beyond, behind = (squares[i + 1 + k * way, j] for k in (0, 1, -1))
        smooth = (beyond == 0) & (behind > here)
        ends.append(i + way * np.where(smooth, here / np.maximum(here, behind - here), 0.5))
    return ends[0], ends[1]


def _love(x: Array, s: Array, contact_modulus: float) -> tuple[float, Callable[[Array], Array]]:
    """A cell's own influence in mm/MPa, and the map from pressure (nx, ns) to displacement in mm.

    A cell displaces by the sum over its corners of +-(x arsinh(s/|x|) + s arsinh(x/|s|)), over
    pi E* (Love; Johnson, Contact Mechanics, 3.25); a zero-padded FFT sums over all cells.
    """
    nx, ns = padded = [next_fast_len(2 * axis.size, real=True) for axis in (x, s)]
    X = ((np.arange(nx + 1) - nx // 2 - 0.5) * (x[1] - x[0]))[:, None]
    S = (np.arange(ns + 1) - ns // 2 - 0.5) * (s[1] - s[0])
    corners = X * np.arcsinh(S / np.abs(X)) + S * np.arcsinh(X / np.abs(S))
    influence = np.diff(np.diff(corners, axis=0), axis=1) / (math.pi * contact_modulus)
    spectrum = rfft2(np.fft.ifftshift(influence)).real  # it is even in x and in s

    def displacement(pressure: Array) -> Array:
        u: Array = irfft2(spectrum * rfft2(pressure, padded), padded)
        return u[: x.size, : s.size]

    return float(influence[nx // 2, ns // 2]), displacement


def _equilibrium(
    x: Array,
    s: Array,
    undeformed: Array,
    contact_modulus: float,
    load: float | None,
    approach: float | None,
    tolerance: float,
    guess: PatchSolution | None,
) -> PatchSolution:
    """Constrained conjugate gradients (Polonsky and Keer, Wear 231, 1999) on one grid."""
    own_influence, displacement = _love(x, s, contact_modulus)
    cell = float((x[1] - x[0]) * (s[1] - s[0]))
    facing = np.isfinite(undeformed)
    gap = np.where(facing, undeformed, 0)
    p = facing.astype(float) if approach is None else np.zeros_like(gap)
    if guess is not None:
        old = RegularGridInterpolator((guess.x, guess.s), guess.pressure, "linear", False, 0.0)
        known = facing * old(tuple(np.meshgrid(x, s, indexing="ij")))
        p = known if known.any() else p
    p = p if load is None else p * (load / (cell * p.sum()))
    u, direction, previous = displacement(p), np.zeros_like(p), math.inf
    for _ in range(ITERATIONS):
        used = p > 0
        rigid = float(np.mean((u + gap)[used])) if approach is None else approach
        residual = u + gap - rigid
        overlap = facing & ~used & (residual < 0)
        if used.any() and np.abs(residual[used | overlap]).max() <= tolerance * u.max():
            opened = np.where(facing, residual, np.inf)
            return PatchSolution(x, s, p, opened, cell * float(p.sum()), rigid)
        descent = np.where(used, residual, 0)
        square = float(np.sum(descent**2))
        direction = np.where(used, descent + square / previous * direction, 0)
        if approach is None:
            direction[used] -= direction[used].mean()
        change = displacement(direction)
        curvature = float(np.sum(change * direction))
        step = np.sum(descent * direction) / curvature if curvature > 0 else 1 / own_influence
        p = np.maximum(p - step * direction, 0)
        p[overlap] -= step * residual[overlap]
        previous = math.inf if overlap.any() else square
        p = p if load is None else p * (load / (cell * p.sum()))
        u = displacement(p)
    raise ValueError(
        f"no equilibrium to {tolerance} in {ITERATIONS} iterations on x {x.min()}..{x.max()}, "
        f"s {s.min()}..{s.max()} mm: the tolerance is below rounding or the gap has no minimum"
    )
