"""Pressed patches of half-spaces, each on a grid, and the tractions on them under one motion.

The pressure is Hertz's or that of boundary elements on the real profiles. A patch has the rigid
slip of its cells at unit creepages and unit spin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.ndimage import zoom

from railhead.contact import wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.half_spaces.pressing import HalfSpacePair, Pressed
from railhead.postprocess.friction import at_cells
from railhead.postprocess.patch.half_space import SurfaceMap
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.theory.array_types import Array
from railhead.theory.bem import pressure_solver
from railhead.theory.bem.grid_patch import Grid, PatchSolution, on_grid
from railhead.theory.bem.pressure_solver import BoundaryElementSolution, Gap
from railhead.theory.elastic.hertz import Strip
from railhead.theory.elastic.line import LineContact
from railhead.theory.friction.rolling import (
    Creepage,
    HalfSpaceFriction,
    TangentialSolution,
    grid_over,
    plane_modes,
    solve_dissimilar,
    solve_for_forces,
)
from railhead.theory.friction.solution import FrictionSolution
from railhead.theory.friction.tangential import MaterialPair
from railhead.theory.friction_laws import Interface

LENGTH = 1e4  # of a strip over its half width
WIDER = 1.25  # grid of unlike bodies over the patch, which tractions widen
TOLERANCE = 1e-8  # of the displacement
PLANE = np.array([[0.0] * 3, [0.0] * 3, [0.0, 0.0, 1.0], [0.0] * 3])
"""`PressedPatch.angular` on the plane z = 0: about z for unit spin, zero for the other modes."""
TURNS = 12  # between pressing and shearing
SEVERAL = "how several patches share a force depends on the compliance of the bodies"


@dataclass(frozen=True)
class PressedPatch:
    """A pressed patch of half-spaces, or several close ones, and their modes of rigid slip.

    pressed: the pressure on a grid.
    modes: rigid slip along the rail and along its profile at the cells, (4, 2, nx, ns): of unit
        creepage along, unit creepage across, unit spin, and the fixed mode: the wheel's own turning
        about axes in the tangent plane (`wheelset_kinematics.RigidSlip`).
    friction: coefficient of friction at the cells, (ns,).
    angular: (4, 3) angular velocity vector of each mode over the rolling speed, 1/mm, in the axes
        of space. In these the normal at an angle of `pressed` is (0, -sin, cos).
    """

    pressed: PatchSolution
    modes: Array
    friction: Array
    angular: Array = field(default_factory=lambda: PLANE)

    @property
    def limit(self) -> float:
        """Largest tangential force that friction allows, N."""
        return self.pressed.cell * float((self.friction * self.pressed.pressure).sum())

    @property
    def mean_modes(self) -> Array:
        """Modes of rigid slip, averaged with the pressure as weight, (4, 2): along the rail, along
        the profile.
        """
        weights = self.pressed.pressure / self.pressed.pressure.sum()
        return np.asarray((self.modes * weights).sum(axis=(2, 3)))

    @property
    def spin(self) -> Array:
        """Angular velocity (4,) of each mode about the patch's own normal, 1/mm."""
        plane = self.pressed.plane
        return np.asarray(self.angular @ [0.0, -math.sin(plane), math.cos(plane)])

    def body(
        self, pair: MaterialPair, *, rolling: bool, interface: Interface | None
    ) -> HalfSpaceFriction:
        """The tangential contact under the pressure; arguments are those of `shear`."""
        return HalfSpaceFriction(
            self.pressed.x,
            self.pressed.s,
            self.pressed.pressure,
            self.friction,
            pair,
            rolling=rolling,
            modes=self.modes,
            interface=interface,
        )

    def parts(self) -> Iterator[PressedPatch]:
        """Connected patches, each by itself, but those with less than SMALLEST of the force."""
        for part in self.pressed.separate():
            if part.force > SMALLEST * self.pressed.force:
                yield replace(self, pressed=part)


@dataclass(frozen=True, kw_only=True)
class Sheared:
    """Tractions on pressed patches of half-spaces.

    patches: the pressed patches.
    found: the tractions of each.
    scale: factor on areas and forces: load of the contact over that of the patches, as the strip of
        a line contact is longer than the contact.
    coarse: the same on a grid of half as many cells each way; None on that grid itself.
    """

    patches: Sequence[PressedPatch]
    found: Sequence[TangentialSolution]
    scale: float = 1.0
    coarse: Sheared | None = None

    @property
    def stressed(self) -> list[tuple[PatchSolution, Array]]:
        """Pressure with cells that the edge cuts, and tractions (2, nx, ns), MPa, of each patch."""
        pairs = zip(self.patches, self.found, strict=True)
        return [
            (replace(each.pressed, pressure=solved.pressure), solved.traction)
            for each, solved in pairs
        ]

    def pressure(self, modulus: float) -> BoundaryElementSolution:
        """The pressure beside the tractions, by the contact modulus E* (MPa), and that of the
        coarser grid; its gap is not known (NaN).
        """
        windows = tuple(replace(each, gap=math.nan * each.gap) for each, _ in self.stressed)
        coarse = None if self.coarse is None else self.coarse.pressure(modulus)
        return BoundaryElementSolution(windows, modulus, coarse)

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
            each.cell * float((each.traction[1] * np.sin(patch.pressed.angle)).sum())
            for patch, each in pairs
        )

    def solution(self, points: SurfaceMap, *, centred: bool, line: bool) -> FrictionSolution:
        """Tractions at the cells that touch, with vectors in space, with forces along, across and
        moment of the wheel on the rail, and those of coarser grids.
        points: maps x, s (n,) to points (n, 3) on the rail's surface, mm. centred: whether slip is
        taken at the cell centres. line: whether it is a line contact, which has no moment.
        """
        places, tangents = [], []
        for window in (patch.pressed for patch in self.patches):
            slope = np.broadcast_to(window.angle, window.pressure.shape)
            places.append(points(*window.places).reshape(*slope.shape, 3))
            across = np.stack([0 * slope, np.cos(slope), np.sin(slope)], axis=-1)
            along = np.broadcast_to([1.0, 0.0, 0.0], across.shape)
            tangents.append(np.stack([along, across], axis=2))
        touches = [each.pressure > 0 for each in self.found]
        found = at_cells(self.found, places, tangents, touches, self.scale, centred=centred)
        along_rail, aside, moment = map(float, self.forces)
        turns = 0.0 if line else moment  # a strip's arms only magnify rounding
        less = self.coarse
        coarse = None if less is None else less.solution(points, centred=centred, line=line)
        return replace(found, force=(along_rail, aside), moment=turns, coarse=coarse)


def patches(
    pair: HalfSpacePair, pressed: Pressed, cells: int, *, like: bool = True
) -> list[PressedPatch]:
    """Patches under a known pressure, each on a grid of about `cells` x `cells` cells
    (`cells_over`); that of a line contact is a strip, see `_strip`. pressed: boundary elements of
    the pair, or exact Hertz between half-spaces and of a line.

    like: whether tractions do not change the pressure: the grid then ends with the patch, and the
        pressure is sampled. Else the grid is 1.25 (WIDER) times as wide, and the pressure is solved
        on it by boundary elements.
    Raises ValueError where the patches are not known.
    """
    if isinstance(pressed, LineContact):
        return [_strip(pair.contact, pressed, cells, like=like)]
    surface, wider = pair.surface, 1.0 if like else WIDER
    if isinstance(pressed, BoundaryElementSolution):
        developed, known = pair.developed, []
        for each in pressed.windows:
            if each.force > SMALLEST * pressed.force:
                grid = grid_over(*each.middle_and_half_extents, cells, wider)
                known.append(each.sampled(replace(grid, angle=developed.angle(grid.s))))
        gap: Gap = developed.gap
        angular = wheelset_kinematics.rigid_slip(pair.contact).angular
    else:
        grid = grid_over((0.0, 0.0), (pressed.a, pressed.b), cells, wider)
        known = [on_grid(grid, pressed.pressure(grid.x[:, None], grid.s), pressed.load)]
        gap, angular = pressed.gap, PLANE
    return [
        PressedPatch(
            each, surface.slip(each.x, each.s), surface.friction_coefficient(each.s), angular
        )
        for each in (known if like else _pressed(known, gap, pressed.contact_modulus))
    ]


def _pressed(known: Sequence[PatchSolution], gap: Gap, modulus: float) -> list[PatchSolution]:
    """Pressures by boundary elements on the grids of nearly known ones, under the same load. gap:
    undeformed, mm, of places x (n,), s (n,), mm. modulus: E*, MPa.
    """
    gaps = [gap(*each.places).reshape(each.pressure.shape) for each in known]
    load, guess = sum(each.load for each in known), BoundaryElementSolution(tuple(known), modulus)
    return pressure_solver.equilibrium(known, gaps, modulus, load, None, TOLERANCE, guess)


def _strip(contact: Contact, line: Strip, cells: int, *, like: bool) -> PressedPatch:
    """Patch of a line contact on a grid of `cells` cells along x, and two cells along the line.
    These are so long that each is a strip; the load is the load per length times their length.
    Pressure and width of the grid follow from `like` as of `patches`.
    """
    grid, gap = strip_grid(line.half_width, line.curvature, cells, 1.0 if like else WIDER)
    exact = np.repeat(line.pressure_across(grid.x)[:, None], 2, axis=1)
    found = on_grid(grid, exact, line.load_per_length * LENGTH * line.half_width)
    if not like:
        (found,) = _pressed([found], lambda x, s: gap.ravel(), line.contact_modulus)
    scene, angle = contact.scene, np.full(grid.s.size, contact.touch.angle)
    friction = scene.friction.at(angle, scene.heat.bulk)
    return PressedPatch(found, plane_modes(grid.x, grid.s), friction)


def strip_grid(half_width: float, curvature: float, cells: int, wider: float) -> tuple[Grid, Array]:
    """Grid of a line contact, `cells` over its width, taken along x, by two along the line, which
    is 1e4 (LENGTH) half widths long. Also the undeformed gap (cells, 2) at the cells, mm.

    half_width: of the contact, mm.
    curvature: relative curvature across the line, 1/mm.
    wider: width of the grid over that of the contact.
    """
    x = wider * half_width * ((2 * np.arange(cells) + 1) / cells - 1)
    s = LENGTH * half_width / 4 * np.array([-1.0, 1.0])
    return Grid(x, s, np.zeros(2)), curvature / 2 * np.column_stack([x**2, x**2])


def shear(
    patches: Sequence[PressedPatch],
    pair: MaterialPair,
    creepage: Creepage,
    forces: tuple[float | None, float | None],
    *,
    rolling: bool,
    interface: Interface | None = None,
    start: Sequence[TangentialSolution] | None = None,
) -> Sheared:
    """Tractions of pressed patches of half-spaces under one rigid motion, by boundary elements.

    pair: materials.
    forces: prescribed force of the wheel on the rail along and across, of all patches together, N;
        None where the creepage is prescribed.
    rolling: steady rolling; else one shift, of like bodies.
    interface: law of friction, heat and layer; None: Coulomb's law alone.
    start: tractions of similar patches of like bodies on as many cells, from which the iterations
        begin; None: without.
    Raises ValueError where tractions are not found, and for forces on several patches of unlike
    bodies, or in a shift.
    """
    along, across = forces
    if len(patches) > 1 and forces != (None, None) and not (rolling and pair.like):
        raise ValueError(SEVERAL)
    if pair.like:
        known = [each.body(pair, rolling=rolling, interface=interface) for each in patches]
        found = solve_for_forces(known, creepage, along=along, across=across, start=start)
        return Sheared(patches=patches, found=found)
    found = [
        solve_dissimilar(
            each.pressed,
            pair,
            each.friction,
            lambda body: solve_for_forces([body], creepage, along=along, across=across)[0],
            modes=each.modes,
            interface=interface,
        )
        for each in patches
    ]
    return Sheared(patches=patches, found=found)


def on_grids(
    half_spaces: HalfSpacePair,
    pressed: Pressed,
    counts: Sequence[int],
    pair: MaterialPair,
    creepage: Creepage,
    forces: tuple[float | None, float | None],
    *,
    rolling: bool,
    interface: Interface | None,
    known: dict[int, Sheared] | None = None,
) -> Sheared:
    """Tractions under a known pressure on grids of `counts` cells along each axis, coarsest first,
    by `shear`: those of the last, with the others as `Sheared.coarse`. Raises ValueError where
    patches or tractions are not found.

    forces: of the whole contact.
    known: by numbers of cells, tractions under nearly the same pressure, from which the iterations
        start; those that are found take their places.
    """
    found, known = None, {} if known is None else known
    for cells in counts:
        each = patches(half_spaces, pressed, cells, like=pair.like)
        longer = sum(one.pressed.load for one in each) / pressed.load
        along, across = (None if force is None else longer * force for force in forces)
        start = known.get(cells) or found or next(iter(known.values()), None)
        sheared = shear(
            each,
            pair,
            creepage,
            (along, across),
            rolling=rolling,
            interface=interface,
            start=_onto(None if start is None else start.found, each),
        )
        found = known[cells] = replace(sheared, scale=1 / longer, coarse=found)
    assert found is not None
    return found


def _onto(
    found: Sequence[TangentialSolution] | None, patches: Sequence[PressedPatch]
) -> list[TangentialSolution] | None:
    """Tractions, with pressure and bound, in the cells of patches, linear between their own cells;
    None without tractions, and where patches or cells are no multiple of these.
    """
    if found is None or len(found) != len(patches):
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
