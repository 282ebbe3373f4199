"""What rolls over blocks of rail and wheel: gap, elastic pressure, tractions, and stress below.

In contact the pressure is that of two elastic half-spaces between the undeformed profiles, less all
that the passes so far moved their surfaces. The elastic stress of a line contact is exact, that of
a solid is the block's. Lengths in mm, forces in N, stresses in MPa; z points out of the body. The
block of a wheel is its mirror image in the plane of contact, where it flows as the rail does and
tractions are reversed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
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
class RollingPatch:
    """A patch that rolls: the undeformed gap, the elastic pressure in it, and the tractions.

    grid: cells of the pressure; of a line contact two across, both together 1e4 (LENGTH) half
        widths long.
    gap: undeformed gap (nx, ns) at the cells, mm.
    pressure: elastic pressure (nx, ns), MPa.
    half_lengths: of the elastic patch, along and across, mm; of a line contact both are its half
        width.
    traction: of the wheel on the rail along x and across (2, nx, ns), MPa; None: none.
    """

    grid: Grid
    gap: Array
    pressure: Array
    half_lengths: tuple[float, float]
    traction: Array | None = None


@dataclass(frozen=True, kw_only=True)
class RollingContact:
    """What rolls.

    patches: the patches, each in its own tangent plane.
    load: component of the force of all pressures along the normal of the first patch's plane or,
        of several patches, along the vertical, N.
    modulus: contact modulus E*, MPa.
    line: whether it is a line contact, in plane strain; it has one patch.
    keeps: whether the pressure stays as it is, however the passes move the surfaces.
    width: of a line contact along its line, mm.
    share: share of the grid's length along that line that the contact covers; 1 of a solid.
    """

    patches: tuple[RollingPatch, ...]
    load: float
    modulus: float
    line: bool
    keeps: bool
    width: float = 1.0
    share: float = 1.0

    def pressed(
        self, moved: Sequence[Array], guess: Sequence[PatchSolution]
    ) -> list[PatchSolution]:
        """Pressure of each patch where the surfaces have moved together by `moved` (nx, ns), mm;
        guess: an earlier one, from which the iterations start, may be empty. Where the contact
        `keeps` it, the elastic pressure. Raises ValueError where boundary elements find no balance,
        and for a patch that grows beyond its grid.
        """
        if self.keeps:
            return [
                PatchSolution(g.x, g.s, g.angle, each.pressure, np.zeros_like(each.gap), 0.0)
                for each in self.patches
                for g in [each.grid]
            ]
        found = equilibrium(
            [each.grid for each in self.patches],
            [each.gap - up for each, up in zip(self.patches, moved, strict=True)],
            self.modulus,
            self.load,
            None,
            TOLERANCE,
            BoundaryElementSolution(tuple(guess), self.modulus) if guess else None,
        )
        for each in found:
            ends, sides = each.pressure[[0, -1]], each.pressure[:, [0, -1]]
            if ends.any() or (sides.any() and not self.line):
                raise ValueError(f"the patch of a pass grows beyond {ROOM:g} times the elastic one")
        return found

    def resistance(self, number: int, found: PatchSolution) -> float:
        """Force against the rolling, N, of the pressure found in a patch, on the slope of the
        undeformed gap along x: int p d gap/dx dA.
        """
        patch, pressed = self.patches[number], found.pressure > 0
        with np.errstate(invalid="ignore"):
            slope = np.gradient(patch.gap, patch.grid.x, axis=0)
        return self.share * patch.grid.cell * float((found.pressure * slope)[pressed].sum())


class Below:
    """A block below a patch: what pressure and tractions of the patch do to its surface and points.

    rolling: the block, whose origin is the middle of the patch.
    number: of the patch in `RollingContact.patches`.
    wheel: whether it is a block of the wheel.
    """

    def __init__(
        self,
        rolling: RollingBlock,
        contact: RollingContact,
        number: int = 0,
        *,
        wheel: bool = False,
    ) -> None:
        """Map the cells of the patch and the nodes of the block's surface to each other."""
        self.rolling, self.number, self.wheel = rolling, number, wheel
        self._contact, self._patch = contact, contact.patches[number]
        traction = self._patch.traction
        self._traction = -traction if wheel and traction is not None else traction
        x, y, _ = rolling.block.surface
        along, across = self._patch.grid.edges
        across = across - self._patch.grid.s.mean()
        self._along = cell_means(x, along - self._patch.grid.x.mean())
        if not contact.line:
            across = across[across > -1e-9 * across[-1]] if rolling.block.half else across
            self._across = cell_means(y, across)
        else:
            self._across = np.ones((2, 1))
            points = rolling.points.reshape(-1, 3)
            poisson = rolling.block.material.poisson_ratio
            self._strips = Strips(along, points[:, 0], -points[:, 2], poisson)

    def moved(self, surface: Array, profile: ProfileChange) -> Array:
        """Way (nx, ns), mm, out of the body that all passes moved the surface at the cells of the
        pressure. surface: displacement by this pass; profile: of those before.
        """
        moved = self._along @ (surface[..., -1] + profile.up) @ self._across.T
        return np.hstack([moved[:, ::-1], moved]) if self.rolling.block.half else moved

    def work(self, surface: Array) -> float:
        """Work of the tangential tractions q on the body, per rolled length, N: -int q . du/dx dA
        with the displacement u of the surface by this pass. The body moves to -x below the patch.
        """
        grid, total = self._patch.grid, 0.0
        for axis, traction in enumerate(() if self._traction is None else self._traction):
            moved = self._along @ surface[..., axis] @ self._across.T
            total += float((self._meshed(traction) * np.gradient(moved, grid.x, axis=0)).sum())
        return -total * self._contact.share * grid.cell * (2 if self.rolling.block.half else 1)

    def _meshed(self, values: Array) -> Array:
        """Those of the values (nx, ns) at the cells of the pressure that lie over the block, as a
        view: the upper half of the columns, s > 0, where the block ends at y = 0, else all.
        """
        return values[:, values.shape[1] // 2 :] if self.rolling.block.half else values

    def stress(self, pressure: Array) -> Array:
        """Elastic stress (columns, lines, m), MPa, in Mandel's notation, at the Gauss points of the
        block, under a pressure (nx, ns), MPa, and the tractions: a column has the points with one
        x, a line those that the steel flows through. m is 4 of a line contact, whose stress is
        exact; it is 6 of a solid, where pressure and tractions are forces on the surface nodes.
        """
        rolling, block, traction = self.rolling, self.rolling.block, self._traction
        if self._contact.line:
            along = None if traction is None else traction[0, :, 0]
            found = self._strips.stress(pressure[:, 0], along)
            mandel = found[:, [0, 2, 1, 3]] * [1.0, 1.0, 1.0, math.sqrt(2)]
            return np.asarray(mandel.reshape(*rolling.points.shape[:2], 4))
        zero = np.zeros_like(pressure)
        acting = [*(traction if traction is not None else (zero, zero)), -pressure]
        force = block.force()
        values = force.array.reshape(-1, 3)
        for axis, each in enumerate(acting):
            nodal = self._patch.grid.cell * self._along.T @ self._meshed(each) @ self._across
            values[block.surface[2], axis] = nodal
        strain = rolling.streams.gathered(block.strains(block.solve(force)))
        return rolling.stress(strain)


class Pressing:
    """Elastic stress of the load at the points of rolling blocks, for `rolling_block.roll`.

    found: pressure of each patch in the last call; empty: there was none.
    traction_work: work of the tractions in the last call on each block, see `Below.work`, N.
    """

    def __init__(self, below: Sequence[Below], contact: RollingContact) -> None:
        """below: the blocks; contact: what rolls."""
        self.found: Sequence[PatchSolution] = ()
        self.traction_work = [0.0] * len(below)
        self._below, self._contact = below, contact
        self._kept: list[Array] = []

    def __call__(self, surfaces: Sequence[Array], profiles: Sequence[ProfileChange]) -> list[Array]:
        """Elastic stress at the Gauss points of each block, see `Below.stress`.

        surfaces: displacements of the surfaces by this pass, see `RollingBlock.surface`.
        profiles: displacements that the passes before left.
        """
        each = list(zip(self._below, surfaces, profiles, strict=True))
        self.traction_work = [below.work(surface) for below, surface, _ in each]
        if self._kept:
            return self._kept
        moved = [np.zeros_like(patch.gap) for patch in self._contact.patches]
        for below, surface, profile in each:
            moved[below.number] += below.moved(surface, profile)
        self.found = self._contact.pressed(moved, self.found)
        stress = [below.stress(self.found[below.number].pressure) for below in self._below]
        self._kept = stress if self._contact.keeps else []
        return stress


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
    patch = RollingPatch(
        grid=grid,
        gap=gap,
        pressure=np.column_stack([pressure, pressure]),
        half_lengths=(half_width, half_width),
        traction=traction,
    )
    return RollingContact(
        patches=(patch,),
        load=load * LENGTH * half_width,
        modulus=modulus,
        line=True,
        keeps=keeps,
        width=width,
        share=width / (LENGTH * half_width),
    )


def ellipse_contact(ellipse: Ellipse, *, keeps: bool) -> RollingContact:
    """Contact of half-spaces that rolls. keeps: as of `solid_contact`."""
    grid = patch_grid((0.0, 0.0), (ellipse.a, ellipse.b))
    return solid_contact(
        [grid], ellipse.gap, ellipse.load, ellipse.contact_modulus, [(ellipse.a, ellipse.b)], keeps
    )


def patch_grid(
    centre: tuple[float, float],
    half_lengths: tuple[float, float],
    angle: Callable[[Array], Array] = np.zeros_like,
) -> Grid:
    """Grid of the pressure of a solid's patch.

    centre: x and s of its middle, mm. half_lengths: of the elastic patch, along and across, mm.
    angle: tilt (n,), rad, of the normal at s (n,) from the direction of the load.
    """
    ticks = (2 * np.arange(SOLID_CELLS) + 1) / SOLID_CELLS - 1
    x, s = (at + ROOM * half * ticks for at, half in zip(centre, half_lengths, strict=True))
    return Grid(x, s, angle(s))


def solid_contact(
    grids: Sequence[Grid],
    gap: Callable[[Array, Array], Array],
    load: float,
    modulus: float,
    half_lengths: Sequence[tuple[float, float]],
    keeps: bool,
) -> RollingContact:
    """Contact of solids that rolls.

    grids: of the patches. gap: undeformed gap (n,) at x, s (n,), mm.
    load: as of `RollingContact`, N. modulus: E*, MPa.
    half_lengths: of each elastic patch, along and across, mm.
    keeps: whether the elastic pressure stays.
    Raises ValueError where boundary elements find no balance.
    """
    gaps = [gap(*grid.places).reshape(grid.x.size, grid.s.size) for grid in grids]
    found = equilibrium(grids, gaps, modulus, load, None, TOLERANCE, None)
    patches = [
        RollingPatch(grid=grid, gap=values, pressure=each.pressure, half_lengths=half)
        for grid, values, each, half in zip(grids, gaps, found, half_lengths, strict=True)
    ]
    return RollingContact(
        patches=tuple(patches), load=load, modulus=modulus, line=False, keeps=keeps
    )
