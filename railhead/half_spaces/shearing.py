"""Pressed patches of half-spaces, each on a grid, and the tractions on them under one motion.

The pressure is Hertz's or that of boundary elements on the real profiles. A patch has the rigid
slip of its cells at unit creepages and unit spin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from railhead.contact import wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.half_spaces import pressing
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.theory.array_types import Array
from railhead.theory.bem import pressure_solver
from railhead.theory.bem.grid_patch import Grid, PatchSolution, on_grid
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic.hertz import Strip
from railhead.theory.elastic.line import Hertz, LineContact
from railhead.theory.friction.rolling import (
    Creepage,
    HalfSpaceFriction,
    TangentialSolution,
    grid_over,
    plane_modes,
    solve_dissimilar,
    solve_for_forces,
)
from railhead.theory.friction.tangential import MaterialPair
from railhead.theory.friction_laws import Interface

CELLS = 128  # of a patch each way
LENGTH = 1e4  # of a strip over its half width
WIDER = 1.25  # grid of unlike bodies over the patch, which tractions widen
TOLERANCE = 1e-8  # of the displacement
PLANE = np.array([[0.0] * 3, [0.0] * 3, [0.0, 0.0, 1.0], [0.0] * 3])
"""`PressedPatch.angular` on the plane z = 0: about z for unit spin, zero for the other modes."""
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

    def parts(self) -> Iterator[PressedPatch]:
        """Connected patches, each by itself, but those with less than SMALLEST of the force."""
        for part in self.pressed.separate():
            if part.force > SMALLEST * self.pressed.force:
                yield replace(self, pressed=part)


def patches(
    contact: Contact,
    hertz: Hertz,
    *,
    hertzian: bool,
    load: float,
    cells: int,
    like: bool = True,
    profiles: BoundaryElementSolution | str | None = None,
) -> list[PressedPatch]:
    """Patches under a vertical load (N), each on a grid of about `cells` x `cells` cells
    (`cells_over`); that of a line contact is a strip, see `_strip`.

    hertz: exact Hertz for the contact; where the patch is its ellipse or strip, its own load counts
        and not `load`.
    hertzian: whether the patch is an ellipse; Hertz's is then used, unless the ellipse is turned.
    like: whether tractions do not change the pressure: the grid then ends with the patch, and the
        pressure is sampled. Else the grid is 1.25 (WIDER) times as wide, and the pressure is solved
        on it by boundary elements.
    profiles: the solved half-space contact, or the reason why it failed. None: it is solved here.
    Raises ValueError where the patches are not known.
    """
    if isinstance(hertz, LineContact):
        return [_strip(contact, hertz, cells, like=like)]
    wider = 1.0 if like else WIDER
    if contact.half_space or (hertzian and not contact.touch.orientation):
        grid = grid_over((0.0, 0.0), (hertz.a, hertz.b), cells, wider)
        known = [on_grid(grid, hertz.pressure(grid.x[:, None], grid.s), hertz.load)]
        (found,) = known if like else _pressed(known, hertz.gap, hertz.contact_modulus)
        return [PressedPatch(found, *_on_surface(contact, found))]
    if isinstance(profiles, str):
        raise ValueError(profiles)
    solved = profiles or pressing.solve(contact, hertz, load, CELLS)
    surface, known = pressing.develop(contact), []
    for each in solved.windows:
        if each.force > SMALLEST * solved.force:
            grid = grid_over(*each.middle_and_half_extents, cells, wider)
            known.append(each.sampled(replace(grid, angle=surface.angle(grid.s))))
    angular = wheelset_kinematics.rigid_slip(contact).angular
    return [
        PressedPatch(
            each, surface.slip(each.x, each.s), surface.friction_coefficient(each.s), angular
        )
        for each in (known if like else _pressed(known, surface.gap, solved.contact_modulus))
    ]


def _pressed(
    known: Sequence[PatchSolution], gap: Callable[[Array, Array], Array], modulus: float
) -> list[PatchSolution]:
    """Pressures by boundary elements on the grids of nearly known ones, under the same load. gap:
    undeformed, mm, of places x (n,), s (n,), mm. modulus: E*, MPa.
    """
    gaps = []
    for each in known:
        x, s = np.meshgrid(each.x, each.s, indexing="ij")
        gaps.append(gap(x.ravel(), s.ravel()).reshape(x.shape))
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


def surface(contact: Contact) -> Callable[[Array, Array], Array]:
    """Map from x, s (n,) to points (n, 3) in space on the surface of the rail, mm; NaN beyond the
    profile. Of half-spaces it is the plane z = 0.
    """
    if contact.half_space:
        return lambda x, s: np.column_stack([x, s, np.zeros_like(x)])
    return pressing.develop(contact).points


def _on_surface(contact: Contact, window: PatchSolution) -> tuple[Array, Array]:
    """Modes of rigid slip (4, 2, nx, ns) along the rail and along its profile, 0 beyond the
    profile, and coefficient of friction (ns,), in a window.
    """
    if contact.half_space:
        return plane_modes(window.x, window.s), contact.friction_coefficient(window.s)
    surface = pressing.develop(contact)
    return surface.slip(window.x, window.s), surface.friction_coefficient(window.s)


def shear(
    patches: Sequence[PressedPatch],
    pair: MaterialPair,
    creepage: Creepage,
    forces: tuple[float | None, float | None],
    *,
    rolling: bool,
    interface: Interface | None = None,
    start: Sequence[TangentialSolution] | None = None,
) -> list[TangentialSolution]:
    """Tractions of pressed patches of half-spaces under one rigid motion, a solution for each
    patch, by boundary elements.

    pair: materials.
    forces: prescribed force of the wheel on the rail along and across, of all patches together, N;
        None where the creepage is prescribed.
    rolling: steady rolling; else one shift, of like bodies.
    interface: law of friction, heat and layer; None: Coulomb's law alone.
    start: tractions of similar patches of like bodies on as many cells, from which the iterations
        begin; None: without.
    Raises ValueError where tractions are not found, and for forces on several patches of unlike
    bodies.
    """
    along, across = forces

    def solve(bodies: Sequence[HalfSpaceFriction]) -> list[TangentialSolution]:
        """Tractions of some patches under the motion and the forces of `shear`."""
        begins = start if pair.like else None
        return solve_for_forces(bodies, creepage, along=along, across=across, start=begins)

    if pair.like:
        return solve(
            [
                HalfSpaceFriction(
                    each.pressed.x,
                    each.pressed.s,
                    each.pressed.pressure,
                    each.friction,
                    pair,
                    rolling=rolling,
                    modes=each.modes,
                    interface=interface,
                )
                for each in patches
            ]
        )
    if len(patches) > 1 and forces != (None, None):
        raise ValueError(SEVERAL)
    return [
        solve_dissimilar(
            each.pressed,
            pair,
            each.friction,
            lambda body: solve([body])[0],
            modes=each.modes,
            interface=interface,
        )
        for each in patches
    ]
