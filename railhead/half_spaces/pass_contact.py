"""What rolls over the block of a rail: gap, elastic pressure, tractions, and the stress below.

In contact the pressure is that of two elastic half-spaces between the undeformed profiles, less all
that the passes so far moved the surface. The elastic stress of a line contact is exact, that of a
solid is the block's. Lengths in mm, forces in N, stresses in MPa; z points out of the rail.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from railhead.half_spaces.shearing import LENGTH, strip_grid
from railhead.theory.array_types import Array
from railhead.theory.bem.grid_patch import Grid, PatchSolution
from railhead.theory.bem.pressure_solver import BoundaryElementSolution, equilibrium
from railhead.theory.elastic.hertz import Ellipse
from railhead.theory.elastic.line import Strips

if TYPE_CHECKING:
    from railhead.solver.plasticity.rolling_block import ProfileChange, RollingBlock

STRIP_CELLS, SOLID_CELLS = 128, 40  # of the grid of the pressure, each way
ROOM = 1.4  # half size of that grid over the half length of the elastic patch
TOLERANCE = 1e-7  # of the gap over the largest displacement


@dataclass(frozen=True, kw_only=True)
class RollingContact:
    """What rolls: the undeformed gap, the elastic pressure in it, and the tractions.

    grid: cells of the pressure; of a line contact two across, both together 1e4 (LENGTH) half
        widths long.
    gap: undeformed gap (nx, ns) at the cells, mm.
    pressure: elastic pressure (nx, ns), MPa.
    load: component of the force of the pressure on the grid along the normal of the patch's plane,
        N.
    modulus: contact modulus E*, MPa.
    line: whether it is a line contact, in plane strain.
    keeps: whether the pressure stays as it is, however the passes move the surface.
    traction: of the wheel on the rail along x and across (2, nx, ns), MPa; None: none.
    width: of a line contact along its line, mm.
    share: share of the grid's length along that line that the contact covers; 1 of a solid.
    """

    grid: Grid
    gap: Array
    pressure: Array
    load: float
    modulus: float
    line: bool
    keeps: bool
    traction: Array | None = None
    width: float = 1.0
    share: float = 1.0

    def patch(self, moved: Array, guess: PatchSolution | None) -> PatchSolution:
        """Pressure where the rail's surface has moved up by `moved` (nx, ns), mm; guess: an earlier
        one, from which the iterations start, or None. Where the contact `keeps` it, the elastic
        pressure. Raises ValueError where boundary elements find no balance, and for a patch that
        grows beyond the grid.
        """
        if self.keeps:
            grid = self.grid
            gap = np.zeros_like(self.gap)
            return PatchSolution(grid.x, grid.s, grid.angle, self.pressure, gap, 0.0)
        start = None if guess is None else BoundaryElementSolution((guess,), self.modulus)
        (found,) = equilibrium(
            [self.grid], [self.gap - moved], self.modulus, self.load, None, TOLERANCE, start
        )
        ends, sides = found.pressure[[0, -1]], found.pressure[:, [0, -1]]
        if ends.any() or (sides.any() and not self.line):
            raise ValueError(f"the patch of a pass grows beyond {ROOM:g} times the elastic one")
        return found

    def resistance(self, patch: PatchSolution) -> float:
        """Force against the rolling, N, of a pressure on the slope of the undeformed gap along x:
        int p d gap/dx dA.
        """
        pressed = patch.pressure > 0
        with np.errstate(invalid="ignore"):
            slope = np.gradient(self.gap, self.grid.x, axis=0)
        return self.share * self.grid.cell * float((patch.pressure * slope)[pressed].sum())


class Pressing:
    """Elastic stress of the load at the points of a rolling block, for `RollingBlock.roll`.

    patch: pressure of the last call; None: there was none.
    traction_work: work of the tractions in the last call on the displacement of the surface by the
        pass, per rolled length, N; 0 without tractions.
    """

    def __init__(self, rolling: RollingBlock, contact: RollingContact) -> None:
        """rolling: the block, whose origin is that of the grid; contact: what rolls."""
        self.patch: PatchSolution | None = None
        self.traction_work = 0.0
        self._rolling, self._contact = rolling, contact
        x, y, _ = rolling.block.surface
        along, across = contact.grid.edges
        self._along = cell_means(x, along)
        if not contact.line:
            across = across[across > -1e-9 * across[-1]] if rolling.block.half else across
            self._across = cell_means(y, across)
        else:
            self._across = np.ones((2, 1))
            points = rolling.points.reshape(-1, 3)
            poisson = rolling.block.material.poisson_ratio
            self._strips = Strips(along, points[:, 0], -points[:, 2], poisson)
        self._kept: Array | None = None

    def __call__(self, surface: Array, profile: ProfileChange) -> Array:
        """Elastic stress (columns, lines, m), MPa, in Mandel's notation, at the Gauss points of the
        block: a column has the points with one x, a line those that the steel flows through. m is 4
        of a line contact, 6 of a solid.

        surface: displacement of the surface by this pass, see `RollingBlock.surface`.
        profile: displacement that the passes before left.
        """
        if self._contact.traction is not None:
            self.traction_work = self._work(surface)
        if self._kept is not None:
            return self._kept
        contact = self._contact
        moved = self._along @ (surface[..., -1] + profile.up) @ self._across.T
        if self._rolling.block.half:
            moved = np.hstack([moved[:, ::-1], moved])
        self.patch = contact.patch(moved, self.patch)
        stress = self._exact_stress() if contact.line else self._block_stress()
        self._kept = stress if contact.keeps else None
        return stress

    def _work(self, surface: Array) -> float:
        """Work of the tangential tractions q of the wheel on the rail, per rolled length, N:
        -int q . du/dx dA with the displacement u of the surface by this pass. The rail moves to -x
        below the wheel.
        """
        contact, total = self._contact, 0.0
        assert contact.traction is not None
        for axis, traction in enumerate(contact.traction):
            moved = self._along @ surface[..., axis] @ self._across.T
            total += float(
                (self._meshed(traction) * np.gradient(moved, contact.grid.x, axis=0)).sum()
            )
        return -total * contact.share * contact.grid.cell * (2 if self._rolling.block.half else 1)

    def _meshed(self, values: Array) -> Array:
        """Those of the values (nx, ns) at the cells of the pressure that lie over the block, as a
        view: the upper half of the columns, s > 0, where the block ends at y = 0, else all.
        """
        return values[:, values.shape[1] // 2 :] if self._rolling.block.half else values

    def _exact_stress(self) -> Array:
        """Exact elastic stress (columns, lines, 4), MPa, in Mandel's notation, at the Gauss points
        of the block, under the pressure and the tractions of a line contact.
        """
        assert self.patch is not None
        shape, traction = self._rolling.points.shape[:2], self._contact.traction
        along = None if traction is None else traction[0, :, 0]
        found = self._strips.stress(self.patch.pressure[:, 0], along)
        mandel = found[:, [0, 2, 1, 3]] * [1.0, 1.0, 1.0, math.sqrt(2)]
        return np.asarray(mandel.reshape(*shape, 4))

    def _block_stress(self) -> Array:
        """Elastic stress (columns, lines, 6), MPa, in Mandel's notation, at the Gauss points of a
        solid block, by finite elements: pressure and tractions are forces on its surface nodes.
        """
        assert self.patch is not None
        rolling, pressure = self._rolling, self.patch.pressure
        block, traction = rolling.block, self._contact.traction
        zero = np.zeros_like(pressure)
        acting = [*(traction if traction is not None else (zero, zero)), -pressure]
        force = block.force()
        values = force.array.reshape(-1, 3)
        for axis, each in enumerate(acting):
            nodal = self._contact.grid.cell * self._along.T @ self._meshed(each) @ self._across
            values[block.surface[2], axis] = nodal
        strain = rolling.streams.gathered(block.strains(block.solve(force)))
        return rolling.stress(strain)


def cell_means(nodes: Array, edges: Array) -> Array:
    """Matrix (m, n) from values at n nodes to the means over m cells of another grid.

    nodes: ascending (n,): ends and middles of (n - 1)/2 elements, on which the function is
        quadratic, mm.
    edges: ends of the cells, ascending (m + 1,), between the first and the last node, mm.
    """
    total = np.zeros((len(edges), len(nodes)))  # integrals from the first node on
    for first in range(0, len(nodes) - 2, 2):
        left, right = nodes[first], nodes[first + 2]
        t = np.clip((edges - left) / (right - left), 0.0, 1.0)
        weights = (
            2 * t**3 / 3 - 3 * t**2 / 2 + t,
            2 * t**2 - 4 * t**3 / 3,
            2 * t**3 / 3 - t**2 / 2,
        )
        for node, weight in enumerate(weights, first):
            total[:, node] += (right - left) * weight
    return np.asarray(np.diff(total, axis=0) / np.diff(edges)[:, None])


def line_contact(
    half_width: float,
    load: float,
    curvature: float,
    modulus: float,
    *,
    keeps: bool,
    slips: float = 0.0,
    sticks: float = 0.0,
    width: float = 1.0,
) -> RollingContact:
    """Line contact that rolls, of half-spaces.

    half_width: of the contact, mm.
    load: N/mm.
    curvature: relative, 1/mm.
    modulus: E*, MPa.
    keeps: whether Hertz's pressure stays.
    slips: coefficient of friction, with the sign of the force of the wheel on the rail; 0: no
        tractions.
    sticks: half width that sticks, from the leading edge on, over the half width (Carter; Johnson,
        Contact Mechanics, 8.3).
    width: of the contact along its line, mm.
    """
    grid, gap = strip_grid(half_width, curvature, STRIP_CELLS, ROOM)
    edges, _ = grid.edges
    p0 = 2 * load / (math.pi * half_width)

    def circle(centre: float, width: float, height: float) -> Array:
        """Means over the cells of height * sqrt(1 - ((x - centre)/width)^2)."""
        t = np.clip((edges - centre) / width, -1.0, 1.0)
        area = width * (t * np.sqrt(1 - t * t) + np.arcsin(t)) / 2
        return np.asarray(height * np.diff(area) / np.diff(edges))

    pressure, traction = circle(0.0, half_width, p0), None
    if slips:
        traction = slips * pressure
        if sticks:
            traction -= slips * circle(half_width * (1 - sticks), half_width * sticks, p0 * sticks)
        traction = np.stack([np.column_stack([traction, traction]), np.zeros_like(gap)])
    return RollingContact(
        grid=grid,
        gap=gap,
        pressure=np.column_stack([pressure, pressure]),
        load=load * LENGTH * half_width,
        modulus=modulus,
        line=True,
        keeps=keeps,
        traction=traction,
        width=width,
        share=width / (LENGTH * half_width),
    )


def ellipse_contact(ellipse: Ellipse, *, keeps: bool) -> RollingContact:
    """Contact of half-spaces that rolls. keeps: as of `solid_contact`."""
    return solid_contact(
        (ellipse.a, ellipse.b), ellipse.load, ellipse.gap, ellipse.contact_modulus, keeps=keeps
    )


def solid_contact(
    half_lengths: tuple[float, float],
    load: float,
    gap: Callable[[Array, Array], Array],
    modulus: float,
    angle: Callable[[Array], Array] | None = None,
    *,
    keeps: bool,
) -> RollingContact:
    """Contact of solids that rolls.

    half_lengths: of the elastic patch, along and across, mm.
    load: as of `RollingContact`, N.
    gap: undeformed gap (n,) at x, s (n,), mm from the middle of the patch.
    modulus: E*, MPa.
    angle: tilt (n,), rad, of the normal at s from the direction of `load`; None: zero.
    keeps: whether the elastic pressure stays.
    Raises ValueError where boundary elements find no balance.
    """
    ticks = (2 * np.arange(SOLID_CELLS) + 1) / SOLID_CELLS - 1
    x, s = (ROOM * half * ticks for half in half_lengths)
    tilt = np.zeros_like(s) if angle is None else angle(s)
    grid = Grid(x, s, tilt)
    values = gap(np.repeat(x, s.size), np.tile(s, x.size)).reshape(x.size, s.size)
    (patch,) = equilibrium([grid], [values], modulus, load, None, TOLERANCE, None)
    return RollingContact(
        grid=grid,
        gap=values,
        pressure=patch.pressure,
        load=load,
        modulus=modulus,
        line=False,
        keeps=keeps,
    )
