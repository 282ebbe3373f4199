"""Frictionless normal contact of two elastic half-spaces with any gap, by boundary elements.

A second opinion beside Hertz where the patch is no ellipse, and a forecast of the patch. Lengths
are in mm, forces in N, stresses in MPa; x runs along the rail and s across it. A curved surface is
developed: s runs along it, and its normal is tilted by an angle (rad) from the load, along which
the bodies approach. A domain of cells is (2, 2): its centre (x, s) and its half sizes, mm;
a `Window` holds the same in tuples.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import find_objects, label

from railhead.theory.array_types import Array, Mask
from railhead.theory.bem.grid_patch import Grid, PatchSolution
from railhead.theory.bem.influence import Influence, Lines, logarithms

Gap = Callable[[Array, Array], Array]
"""Places x (n,), s (n,), mm -> undeformed gap (n,), mm, +inf where the bodies do not face."""
Angle = Callable[[Array], Array]
"""Places s (n,), mm -> tilt (n,) of the surface's normal from the load, rad."""
Window = tuple[tuple[float, float], tuple[float, float]]
"""Centre and half sizes of a rectangle, each (x, s), mm."""
SEARCH_CELLS, SEARCHES = 64, 60  # cells along each axis in the search; most sets of domains
ITERATIONS = 3000  # of the pressure on one set of grids, at most
FAR = 1e9  # mm; a wider gap never closes
FILL_RANGE, FILL = (0.6, 0.9), 0.8  # share of the domain's width that the patch takes up
APART = 1.6  # times their size: patches that are still apart then get a domain each
MOST = 8  # domains that one is split into


@dataclass(frozen=True)
class BoundaryElementSolution:
    """Normal contact of half-spaces in several windows (rectangular domains of cells) that do not
    overlap.

    windows: the solved pressure of each window.
    contact_modulus: E*, MPa; 1/E* is the sum of (1 - nu^2)/E of both bodies.
    coarse: the same contact on the coarser grids of the search; None where no finer grids than
        those of the search were asked for.
    """

    windows: tuple[PatchSolution, ...]
    contact_modulus: float
    coarse: BoundaryElementSolution | None = None

    @property
    def approach(self) -> float:
        """Approach of the bodies along the load's direction, mm."""
        return self.windows[0].approach

    @property
    def load(self) -> float:
        """Component of all contact forces along the load's direction, N; the vertical load of a
        wheel.
        """
        return sum(window.load for window in self.windows)

    @property
    def force(self) -> float:
        """Integral of the pressure over all windows, N. It is the normal force, larger than the
        vertical load where the surface is inclined.
        """
        return sum(window.force for window in self.windows)

    @property
    def max_pressure(self) -> float:
        """Largest pressure of all windows, MPa, from parabolas through the highest cells."""
        return max(window.max_pressure for window in self.windows)

    @property
    def area(self) -> float:
        """Sum of the areas of all patches, each on its own tangent plane, mm2."""
        return sum(patch.area for patch in self.patches)

    @cached_property
    def patches(self) -> list[PatchSolution]:
        """Connected patches of all windows, the one with the largest force first."""
        found = [patch for window in self.windows for patch in window.separate()]
        return sorted(found, key=lambda patch: -patch.force)

    def displacement(self, x: Array, s: Array, angle: Array) -> Array:
        """Normal displacement (n,), mm, of both bodies together, at places x, s (n,), mm, outside
        of the windows. angle: tilt (n,) of the normals there, rad.
        """
        total = np.zeros((2, x.size))
        for window in self.windows:
            pressed, (along, across) = window.normals * window.pressure, window.edges
            for n, place in enumerate(zip(x, s, strict=True)):
                corners = sum(logarithms((along - place[0])[:, None], across - place[1]))
                total[:, n] += (pressed * np.diff(np.diff(corners, axis=0), axis=1)).sum(
                    axis=(1, 2)
                )
        total /= math.pi * self.contact_modulus
        return np.asarray(np.cos(angle) * total[0] + np.sin(angle) * total[1])


def solve_developed(
    gap: Gap,
    contact_modulus: float,
    windows: Sequence[Window],
    angle: Angle,
    *,
    load: float | None = None,
    approach: float | None = None,
    cells: int = 128,
    tolerance: float = 1e-8,
    split: bool = True,
    lines: Lines | None = None,
    known: BoundaryElementSolution | None = None,
    lean: Angle = np.zeros_like,
) -> BoundaryElementSolution:
    """Normal contact on a developed (unrolled) curved surface, of patches that may lie far apart.

    Solves gap + u(p) - approach cos(angle) >= 0 with p >= 0 and one of both zero in each cell, and
    int p cos(angle) dA = load; u(p) is the normal displacement by the pressure p.
    gap: function of points x (n,), s (n,), mm; undeformed gap (n,) along the normals, mm, +inf
        where the bodies do not face each other.
    contact_modulus: E*, MPa.
    windows: (centre, half size) of the first domains, mm. Patches that are well apart get a domain
        of `cells` cells along each axis and displace each other.
    angle: maps s (n,) to the tilt (n,) of the surface's normal, rad, within +-pi/2.
    load: component of the contact force along the load's direction, N; None: approach is given.
    approach: along the load, mm, that closes the gap somewhere in `windows`; None: load is given.
    tolerance: of the gap in the patch, over the largest displacement.
    split: whether separate patches get domains of their own.
    lines: compliance of the lines along x, which adds to u(p) lines(s) times the integral of p
        along x; None: zero.
    known: what the coarse search of this contact found, which is then left out; its domains are
        taken, and `windows` have no effect.
    lean: maps s (n,) to the angle (n,) at which the surface rises with x there, rad, the same in
        each domain.
    The domains are adapted until each suits its patch, first coarse, then with `cells` cells along
    each axis: a domain grows until the patch fits in, and shrinks until it takes up 60 to 90 % of
    its width. A second patch is found if it lies in the first domain and is wider than a cell
    there, of 64 an axis. On Hertz ellipses along the axes, 128 cells reach 3e-5 in approach, 4e-5
    in max_pressure, 1e-4 in semi_axes, 2e-3 in area and 4e-3 in half_extents; at a sharp edge p
    depends on the cells. ValueError: a gap out of range, no contact, no bounded patch, no
    convergence.
    """
    where = _merged([np.array(window, dtype=float) for window in windows])
    found, coarse, fine = known, known, known is not None
    if known is not None:
        where = [
            np.transpose([((e[0] + e[-1]) / 2, (e[-1] - e[0]) / 2) for e in each.edges])
            for each in known.windows
        ]
    for _ in range(SEARCHES):
        count = cells if fine else min(cells, SEARCH_CELLS)
        ticks = (2 * np.arange(count) + 1) / count - 1
        axes = [domain[0][:, None] + np.outer(domain[1], ticks) for domain in where]
        if min(np.diff(axis).min() for axis in axes) <= 0:  # cells below rounding
            break
        grids = [Grid(x, s, np.asarray(angle(s)), lean=float(lean(s)[0])) for x, s in axes]
        undeformed = [_sample(gap, grid) for grid in grids]
        closing = zip(undeformed, grids, strict=True)
        if approach is not None and all((h >= approach * g.upright).all() for h, g in closing):
            break
        solved = equilibrium(
            grids, undeformed, contact_modulus, load, approach, tolerance, found, lines
        )
        found = BoundaryElementSolution(tuple(solved), contact_modulus, coarse if fine else None)
        better = _suited(solved, where, fine=fine, split=split)
        settled = len(better) == len(where) and all(map(np.array_equal, better, where))
        if settled and (fine or cells <= SEARCH_CELLS):
            return found
        where, fine, coarse = better, fine or settled, coarse if fine else found
    last = ", ".join(f"{domain[0]} +- {domain[1]}" for domain in where)
    raise ValueError(
        f"no bounded contact found, the last domain was {last} mm: the gap "
        f"must fall below the approach (if given, here {approach}) and grow around the patch"
    )


def under_load(
    found: BoundaryElementSolution, load: float, tolerance: float
) -> BoundaryElementSolution:
    """The contact of a solution under another load (N), nearly the same, on the same grids, and on
    those of its coarser solution. tolerance: as of `solve_developed`. Raises ValueError without
    convergence.
    """
    windows, influence = found.windows, Influence(found.windows, found.contact_modulus)
    moved = influence.split(influence(np.concatenate([w.pressure.ravel() for w in windows])))
    gaps = [w.gap - each + w.approach * w.upright for w, each in zip(windows, moved, strict=True)]
    solved = equilibrium(windows, gaps, found.contact_modulus, load, None, tolerance, found)
    coarse = found.coarse and under_load(found.coarse, load, tolerance)
    return BoundaryElementSolution(tuple(solved), found.contact_modulus, coarse)


def _sample(gap: Gap, grid: Grid) -> Array:
    """Undeformed gap (nx, ns), mm, at the cell centres; infinite above FAR. Raises ValueError for
    NaN and values out of range.
    """
    values = np.asarray(gap(*grid.places), dtype=float)
    if np.isnan(values).any() or not -FAR < values.min() < FAR:
        raise ValueError(
            f"gap must be above {-FAR} mm everywhere and below {FAR} mm somewhere, got "
            f"{values.min()}..{values.max()} around x = {grid.x.mean()}, s = {grid.s.mean()}"
        )
    return np.where(values < FAR, values, np.inf).reshape(grid.x.size, grid.s.size)


def equilibrium(
    grids: Sequence[Grid],
    undeformed: Sequence[Array],
    contact_modulus: float,
    load: float | None,
    approach: float | None,
    tolerance: float,
    guess: BoundaryElementSolution | None,
    lines: Lines | None = None,
) -> list[PatchSolution]:
    """Pressure on fixed grids by constrained conjugate gradients (Polonsky and Keer, Wear 231,
    1999), preconditioned by `Influence.inverse`.

    undeformed: gap (nx, ns) on each grid, mm. contact_modulus: E*, MPa. load, approach: along the
        load, N and mm, one of them None. tolerance: of the gap in the patch, over the largest
        displacement. guess: earlier solution from which the iterations start, or None. lines:
        compliance of the lines along x, part of u(p), or None.

    With the cells' areas w, and c the normals' part along the load, p minimises
    sum w p (u(p)/2 + gap) over p >= 0 under sum w c p = load. Its gradient, in the inner product
    weighted by w, in which u(p) is self-adjoint, is the residual u + gap - approach c. The approach
    is the multiplier that makes the residual in the patch orthogonal to c; search directions are
    made orthogonal to c, too. In a plane (c = 1) on one grid this is the method of the paper with a
    preconditioner, which halves the time and leaves a tenth of the error. Raises ValueError without
    convergence.
    """
    influence = Influence(grids, contact_modulus, lines)
    weight = np.concatenate(
        [np.full(h.size, g.cell) for g, h in zip(grids, undeformed, strict=True)]
    )
    c = np.concatenate([np.tile(g.upright, len(g.x)) for g in grids])
    initial = np.concatenate([h.ravel() for h in undeformed])
    facing = np.isfinite(initial)
    gap = np.where(facing, initial, 0)
    p = facing.astype(float) if approach is None else np.zeros_like(gap)
    if guess is not None:
        before = [
            RegularGridInterpolator((w.x, w.s), w.pressure, "linear", False, 0.0)
            for w in guess.windows
        ]
        known = facing * sum(one(np.hstack([g.places for g in grids]).T) for one in before)
        p = known if known.any() else p
    p = p if load is None else p * (load / np.sum(weight * c * p))
    u, direction, previous = influence(p), np.zeros_like(p), math.inf
    for _ in range(ITERATIONS):
        used = p > 0
        wc = np.where(used, weight * c, 0)
        norm = float(np.sum(wc * c))
        rigid = float(np.sum(wc * (u + gap))) / norm if approach is None else approach
        residual = u + gap - rigid * c
        overlap = facing & ~used & (residual < 0)
        if used.any() and np.abs(residual[used | overlap]).max() <= tolerance * u.max():
            opened = influence.split(np.where(facing, residual, np.inf))
            every = zip(grids, influence.split(p), opened, strict=True)
            return [
                PatchSolution(g.x, g.s, g.angle, pressed, open_, rigid, lean=g.lean)
                for g, pressed, open_ in every
            ]
        left = np.where(used, weight * residual, 0)
        descent = np.where(used, influence.inverse(np.where(used, residual, 0)), 0)
        square = float(left @ descent)
        growth = square / previous if previous else 0.0  # a single cell has no descent
        direction = np.where(used, descent + growth * direction, 0)
        if approach is None:
            direction -= np.where(used, c, 0) * (np.sum(wc * direction) / norm)
        change = influence(direction)
        curvature = float(np.sum(weight * change * direction))
        step = float(left @ direction) / curvature if curvature > 0 else 1.0
        moved = p - step * direction
        # Where no cell opens or closes, u follows from products that are known.
        linear = not overlap.any() and moved.min() >= 0
        p = np.maximum(moved, 0)
        p[overlap] -= step * residual[overlap] / influence.own
        previous = math.inf if overlap.any() else square
        scale = 1.0 if load is None else load / np.sum(weight * c * p)
        p = scale * p
        u = scale * (u - step * change) if linear else influence(p)
    raise ValueError(
        f"no equilibrium to {tolerance} in {ITERATIONS} iterations around "
        f"{[(g.x.mean(), g.s.mean()) for g in grids]} mm: the tolerance is below rounding or "
        "the gap has no minimum"
    )


def _suited(
    solved: Sequence[PatchSolution], domains: Sequence[Array], *, fine: bool, split: bool
) -> list[Array]:
    """Rectangular domains (2, 2) for the next solution: centres and half sizes, mm.

    A domain that suits its patch remains, one whose patch meets the border grows, and one that the
    patch does not fill shrinks. With `split`, separate patches in a domain get domains of their
    own. With `fine`, domains only grow, and none is split. A domain without contact is dropped.
    Overlapping domains are merged. solved: solution of each domain, of all patches in it.
    """
    better = []
    for solution, domain in zip(solved, domains, strict=True):
        touching = solution.pressure > 0
        if not touching.any():
            continue
        apart = _apart(touching, domain) if split and not fine else []
        if len(apart) > 1:
            better += apart
            continue
        fitted = [_next_interval(np.any(touching, axis=1 - k), domain[:, k], fine) for k in (0, 1)]
        better.append(np.transpose(fitted))
    return _merged(better)


def _merged(domains: Sequence[Array]) -> list[Array]:
    """Domains (2, 2) that do not overlap: overlapping ones are replaced by the smallest rectangle
    around them.
    """
    return [_around(np.array(group)) for group in _groups(domains, 1.0)]


def _apart(touching: Mask, domain: Array) -> list[Array]:
    """Domains (2, 2) around the separate patches in a domain. touching: cells with pressure (nx,
    ns). Patches whose boxes overlap when 1.6 times (APART) as large share a domain; at most eight
    domains (MOST) result.
    """
    boxes = []
    size = 2 * domain[1] / touching.shape
    for slices in find_objects(label(touching, structure=np.ones((3, 3)))[0]):
        first, last = np.array([(cut.start, cut.stop) for cut in slices]).T
        middle = domain[0] - domain[1] + size * (first + last) / 2
        boxes.append(np.array([middle, size * (last - first) / 2]))
    factor = APART
    while len(groups := _groups(boxes, factor)) > MOST:
        factor *= 2
    return [_around(np.array(group)) * [[1], [1 / FILL]] for group in groups]


def _groups(boxes: Sequence[Array], factor: float) -> list[list[Array]]:
    """Groups of boxes (2, 2): two boxes are in one group where they overlap after their half sizes
    are multiplied by `factor`; a group counts as the smallest box around it.
    """
    groups: list[list[Array]] = []
    for box in boxes:
        group = [box]
        while near := [other for other in groups if _near(group, other, factor)]:
            group += [each for other in near for each in other]
            groups = [other for other in groups if not any(other is one for one in near)]
        groups.append(group)
    return groups


def _near(group: list[Array], other: list[Array], factor: float) -> bool:
    """Whether the smallest boxes around two groups overlap after the half sizes of both are
    multiplied by `factor`; boxes that only touch do not. A group is a list of boxes (2, 2), centre
    and half sizes in mm.
    """
    one, two = _around(np.array(group)), _around(np.array(other))
    return bool(np.all(np.abs(one[0] - two[0]) < factor * (one[1] + two[1])))


def _around(boxes: Array) -> Array:
    """Smallest box (2, 2), centre and half sizes, around boxes (n, 2, 2)."""
    if len(boxes) == 1:
        return np.asarray(boxes[0])
    low, high = (boxes[:, 0] - boxes[:, 1]).min(axis=0), (boxes[:, 0] + boxes[:, 1]).max(axis=0)
    return np.array([(low + high) / 2, (high - low) / 2])


def _next_interval(used: Mask, domain: Array, fine: bool) -> tuple[float, float]:
    """Middle and half width (mm) of the next domain along one axis: twice as wide, towards the
    border, where the patch meets one; the present one where the patch takes up 60 to 90 % of it;
    else so wide that the patch takes up 80 % (FILL). used: cells with pressure (n,); domain:
    present middle and half width; fine: the domain may only grow.
    """
    (middle, half), n, (first, last) = domain, used.size, np.flatnonzero(used)[[0, -1]]
    if first == 0 or last == n - 1:
        return middle + half * (int(last == n - 1) - int(first == 0)), 2 * half
    width = (last + 1 - first) / n
    if fine or FILL_RANGE[0] <= width <= FILL_RANGE[1]:
        return middle, half
    return middle + half * ((first + last + 1) / n - 1), half * width / FILL
