"""Pressed patches of half-spaces, each on a grid, and the tractions on them under one motion.

The pressure is Hertz's or that of boundary elements on the real profiles. A patch has the rigid
slip of its cells at unit creepages and unit spin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.ndimage import zoom

from railhead.contact import wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.half_spaces.pressing import FINE, HalfSpacePair, Pressed
from railhead.postprocess.friction import at_cells
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.theory.array_types import Array
from railhead.theory.bem import pressure_solver
from railhead.theory.bem.grid_patch import Grid, PatchSolution, on_grid
from railhead.theory.bem.pressure_solver import BoundaryElementSolution, Gap
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction.rolling import (
    CELLS,
    Creepage,
    TangentialSolution,
    grid_over,
    solve_patches,
)
from railhead.theory.friction.solution import FrictionSolution

LENGTH = 1e4  # of a strip over its half width
WIDER = 1.25  # grid of unlike bodies over the patch, which tractions widen
TOLERANCE = 1e-8  # of the displacement
TURNS, BALANCE = 12, 1e-6  # between pressing and shearing; of the load
SEVERAL = "how several patches share a force depends on the compliance of the bodies"


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What moves a wheel over its rail.

    creepage: per rolled length, or one shift; without effect where a force is prescribed.
    along, across: prescribed force of the wheel on the rail, of all patches together, N; None where
        the creepage is prescribed.
    rolling: steady rolling; else one shift.
    """

    creepage: Creepage = Creepage()
    along: float | None = None
    across: float | None = None
    rolling: bool = True


def motion(contact: Contact) -> Motion:
    """The motion that a scene prescribes."""
    scene = contact.scene
    rolls = scene.rolling.prescribed
    table = scene.rolling if rolls else scene.friction
    creepage = wheelset_kinematics.creepage(contact)
    return Motion(
        creepage=creepage, along=table.force_along, across=table.force_across, rolling=rolls
    )


@dataclass(frozen=True)
class PressedPatch:
    """A pressed patch of half-spaces, or several close ones, and their modes of rigid slip.

    pressed: the pressure on a grid.
    modes: rigid slip along the rail and along its profile at the cells, (4, 2, nx, ns): of unit
        creepage along, unit creepage across, unit spin, and the fixed mode: the wheel's own turning
        about axes in the tangent plane (`wheelset_kinematics.RigidSlip`).
    friction: coefficient of friction at the cells, (ns,).
    """

    pressed: PatchSolution
    modes: Array
    friction: Array

    @property
    def limit(self) -> float:
        """Largest tangential force that friction allows, N."""
        return self.pressed.cell * float((self.friction * self.pressed.pressure).sum())


@dataclass(frozen=True, kw_only=True)
class Sheared:
    """Tractions on pressed patches of half-spaces.

    pair: the half-spaces.
    rolling: whether they roll.
    patches: the pressed patches.
    found: the tractions of each.
    scale: factor on areas and forces: load of the contact over that of the patches, as the strip of
        a line contact is longer than the contact.
    coarse: the same on a grid of half as many cells each way; None on that grid itself.
    """

    pair: HalfSpacePair
    rolling: bool
    patches: Sequence[PressedPatch]
    found: Sequence[TangentialSolution]
    scale: float = 1.0
    coarse: Sheared | None = None

    @property
    def stressed(self) -> list[tuple[PatchSolution, Array]]:
        """Pressure, also in cells that the edge of the patch cuts, and tractions (2, nx, ns), MPa,
        of each patch.
        """
        pairs = zip(self.patches, self.found, strict=True)
        return [
            (replace(each.pressed, pressure=solved.pressure), solved.traction)
            for each, solved in pairs
        ]

    @property
    def pressure(self) -> BoundaryElementSolution:
        """The pressure that acts together with the tractions, and that of the coarser grid; their
        gaps are not known (NaN).
        """
        windows = tuple(replace(each, gap=math.nan * each.gap) for each, _ in self.stressed)
        coarse = None if self.coarse is None else self.coarse.pressure
        return BoundaryElementSolution(windows, self.pair.hertz.contact_modulus, coarse)

    @property
    def limit(self) -> float:
        """Largest tangential force that friction allows, N."""
        return self.scale * sum(each.limit for each in self.found)

    @property
    def forces(self) -> Array:
        """Forces of the wheel on the rail along, across (N) and moment (N mm), (3,)."""
        return np.asarray(self.scale * np.sum([each.forces for each in self.found], axis=0))

    @property
    def upwards(self) -> float:
        """Vertical component of the tractions of the wheel on the rail, N, positive upwards; the
        load is that of the pressure less this.
        """
        pairs = zip(self.patches, self.found, strict=True)
        return self.scale * sum(
            each.cell * float(np.einsum("kxs,sk->", each.traction, patch.pressed.tangents[..., 2]))
            for patch, each in pairs
        )

    @cached_property
    def solution(self) -> FrictionSolution:
        """Tractions at the cells that touch, with vectors in space, with forces along, across and
        moment of the wheel on the rail, and those of coarser grids. Slip is taken at the cell
        centres where bodies of like materials roll. A line contact has no moment.
        """
        grids, found = [self], None
        while grids[-1].coarse is not None:
            grids.append(grids[-1].coarse)
        for each in reversed(grids):
            found = replace(each._on_one_grid(), coarse=found)
        assert found is not None
        return found

    def _on_one_grid(self) -> FrictionSolution:
        """`solution` without those of coarser grids."""
        places, tangents = [], []
        for window in (patch.pressed for patch in self.patches):
            shape = window.pressure.shape
            places.append(self.pair.surface.points(*window.places).reshape(*shape, 3))
            tangents.append(np.broadcast_to(window.tangents, (*shape, 2, 3)))
        touches = [each.pressure > 0 for each in self.found]
        centred = self.rolling and self.pair.materials.like
        found = at_cells(self.found, places, tangents, touches, self.scale, centred=centred)
        along_rail, aside, moment = map(float, self.forces)
        turns = 0.0 if self.pair.contact.line else moment  # a strip's arms only magnify rounding
        return replace(found, force=(along_rail, aside), moment=turns)


def patches(pair: HalfSpacePair, pressed: Pressed, cells: int) -> list[PressedPatch]:
    """Patches under a known pressure, each on a grid of about `cells` x `cells` cells
    (`cells_over`); of a line contact a strip of `cells` cells by two, see `strip_grid`. Its load is
    the load per length times the length of the strip.

    pressed: boundary elements of the pair, or exact Hertz between half-spaces and of a line.
    Where tractions do not change the pressure (like materials), the grid ends with the patch, and
    the pressure is sampled. Else the grid is 1.25 (WIDER) times as wide, and the pressure is solved
    on it by boundary elements. Raises ValueError where the patches are not known.
    """
    surface, like = pair.surface, pair.materials.like
    wider = 1.0 if like else WIDER
    if isinstance(pressed, BoundaryElementSolution):
        known = []
        for each in pressed.windows:
            if each.force > SMALLEST * pressed.force:
                grid = grid_over(*each.middle_and_half_extents, cells, wider)
                angle = pair.developed.angle(grid.s)
                known.append(each.sampled(replace(grid, angle=angle, lean=each.lean)))
        gap: Gap = pair.developed.gap
    elif isinstance(pressed, LineContact):
        half = pressed.half_width
        grid, strip = strip_grid(half, pressed.curvature, cells, wider)
        exact = np.repeat(pressed.pressure_across(grid.x)[:, None], 2, axis=1)
        known = [on_grid(grid, exact, pressed.load_per_length * LENGTH * half)]
        gap = lambda x, s: strip.ravel()  # noqa: E731
    else:
        grid = grid_over((0.0, 0.0), (pressed.a, pressed.b), cells, wider)
        known = [on_grid(grid, pressed.pressure(grid.x[:, None], grid.s), pressed.load)]
        gap = pressed.gap
    if not like:
        gaps = [gap(*each.places).reshape(each.pressure.shape) for each in known]
        modulus, load = pressed.contact_modulus, sum(each.load for each in known)
        guess = BoundaryElementSolution(tuple(known), modulus)
        known = pressure_solver.equilibrium(known, gaps, modulus, load, None, TOLERANCE, guess)
    return [
        PressedPatch(each, surface.slip(each.x, each.s), surface.friction_coefficient(each.s))
        for each in known
    ]


def strip_grid(half_width: float, curvature: float, cells: int, wider: float) -> tuple[Grid, Array]:
    """Grid of a line contact, `cells` over its width, taken along x, by two along the line, which
    is 1e4 (LENGTH) half widths long: so long that each is a strip. Also the undeformed gap
    (cells, 2) at the cells, mm.

    half_width: of the contact, mm.
    curvature: relative curvature across the line, 1/mm.
    wider: width of the grid over that of the contact.
    """
    x = wider * half_width * ((2 * np.arange(cells) + 1) / cells - 1)
    s = LENGTH * half_width / 4 * np.array([-1.0, 1.0])
    return Grid(x, s, np.zeros(2)), curvature / 2 * np.column_stack([x**2, x**2])


def shear(
    pair: HalfSpacePair,
    patches: Sequence[PressedPatch],
    motion: Motion,
    start: Sequence[TangentialSolution] | None = None,
) -> Sheared:
    """Tractions of pressed patches of half-spaces under one motion, by boundary elements, with the
    law of friction, heat and layer of the scene.

    start: tractions of similar patches of like bodies on as many cells, from which the iterations
        begin; None: without.
    Raises ValueError where tractions are not found, and for forces on several patches in a shift.
    """
    if len(patches) > 1 and not motion.rolling and (motion.along, motion.across) != (None, None):
        raise ValueError(SEVERAL)
    found = solve_patches(
        [each.pressed for each in patches],
        pair.materials,
        [each.friction for each in patches],
        motion.creepage,
        along=motion.along,
        across=motion.across,
        rolling=motion.rolling,
        modes=[each.modes for each in patches],
        interface=pair.interface,
        start=start,
    )
    return Sheared(pair=pair, rolling=motion.rolling, patches=patches, found=found)


def sheared(
    pair: HalfSpacePair,
    pressed: Pressed,
    motion: Motion,
    counts: Sequence[int] = CELLS,
    start: Sheared | None = None,
) -> Sheared:
    """Tractions under a known pressure on grids of `counts` cells along each axis, coarsest first,
    by `shear`: those of the last, with the others as `Sheared.coarse`. Forces are those of the
    whole contact. start: tractions under nearly the same pressure, from which the iterations begin.
    Raises ValueError where patches or tractions are not found.
    """
    found, near = None, start
    for cells in counts:
        each = patches(pair, pressed, cells)
        longer = sum(one.pressed.load for one in each) / pressed.load
        along, across = (
            None if force is None else longer * force for force in (motion.along, motion.across)
        )
        begins = None if near is None else _onto(near.found, each)
        now = shear(pair, each, replace(motion, along=along, across=across), begins)
        found = near = replace(now, scale=1 / longer, coarse=found)
    assert found is not None
    return found


def _onto(
    found: Sequence[TangentialSolution], patches: Sequence[PressedPatch]
) -> list[TangentialSolution] | None:
    """Tractions, with pressure and bound, in the cells of patches, linear between their own cells;
    None where patches or cells are no multiple of these.
    """
    if len(found) != len(patches):
        return None
    placed = []
    for each, patch in zip(found, patches, strict=True):
        before, now = each.bound.shape, patch.pressed.pressure.shape
        if any(many % few for many, few in zip(now, before, strict=True)):
            return None
        finer = [many // few for many, few in zip(now, before, strict=True)]
        pressure, bound, *traction = (
            zoom(known, finer, order=1, mode="nearest", grid_mode=True)
            for known in (each.pressure, each.bound, *each.traction)
        )
        placed.append(replace(each, pressure=pressure, bound=bound, traction=np.array(traction)))
    return placed


def answer(pair: HalfSpacePair, pressed: Pressed) -> tuple[Pressed, Sheared]:
    """Pressure and tractions under load and motion of the scene: the pressure carries what the
    tractions leave of the load, to 1e-6 (BALANCE) of it. Exact Hertz, or a given approach, stays.
    pressed: without tractions. Raises ValueError where patches, tractions or a balance are not
    found.
    """
    scene, moves = pair.contact.scene, motion(pair.contact)
    if scene.load is None or not isinstance(pressed, BoundaryElementSolution):
        return pressed, sheared(pair, pressed, moves)
    found: list[Sheared] = []

    def tractions(now: Sequence[BoundaryElementSolution]) -> list[Sheared]:
        """Those of the finest grid; first of the coarsest, whose balance is nearly the same."""
        counts, near = (CELLS[-1:], found[-1]) if found else (CELLS[:1], None)
        found.append(sheared(pair, now[0], moves, counts, near))
        return found[-1:]

    carried = scene.tangential_forces[2] * math.sin(pair.contact.touch.angle)
    first = pair.near(pressed, scene.load + carried, FINE)  # of a prescribed force it is known
    (pressed,), (fine,), turns = balanced([pair], [first], scene.load, FINE, tractions, BALANCE)
    if turns == 1:  # the coarsest grid balances at once
        (pressed,), (fine,), _ = balanced([pair], [pressed], scene.load, FINE, tractions, BALANCE)
    return pressed, replace(fine, coarse=sheared(pair, pressed, moves, CELLS[:-1], found[0]))


def balanced(
    pairs: Sequence[HalfSpacePair],
    pressed: Sequence[BoundaryElementSolution],
    load: float,
    cells: int,
    tractions: Callable[[Sequence[BoundaryElementSolution]], Sequence[Sheared]],
    tolerance: float,
) -> tuple[list[BoundaryElementSolution], Sequence[Sheared], int]:
    """Pressures of contacts that carry what the tractions leave of a vertical load (N) on each,
    these, and how often they were found: pressures and tractions are found in turn until the load
    is met to `tolerance` of it. pressed, cells: the first pressures, and cells of their grids along
    each axis. tractions: gives those under pressures. Raises ValueError without a balance.
    """
    now = [*pressed]
    for turn in range(1, TURNS + 1):
        sheared = tractions(now)
        carried = zip(now, sheared, strict=True)
        over = [(each.load - found.upwards) / load for each, found in carried]
        if max(abs(each - 1) for each in over) <= tolerance:
            return now, sheared, turn
        if min(over) <= 0:
            break
        every = zip(pairs, now, over, strict=True)
        now = [pair.near(each, each.load / share, cells) for pair, each, share in every]
    raise ValueError("no pressure balances the load beside the tractions")
