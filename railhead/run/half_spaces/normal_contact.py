"""Half-spaces in normal contact beside the finite elements, by boundary elements.

On the real profiles they are a second answer. The pressed patches, with their rigid slip at unit
creepages and unit spin, are where tractions are found (`tangential_contact`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from railhead.contact import wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.meshing.bodies import RAIL
from railhead.planning.references import allowance, boundary_elements
from railhead.postprocess.patch import body_motion, compare
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.run.mesh_solution import MeshSolution
from railhead.theory.array_types import Array
from railhead.theory.bem import pressure_solver
from railhead.theory.bem.grid_patch import Grid, PatchSolution, on_grid
from railhead.theory.bem.pressure_solver import BoundaryElementSolution
from railhead.theory.elastic.hertz import Strip
from railhead.theory.elastic.line import Hertz, LineContact
from railhead.theory.friction.rolling import grid_over, plane_modes

CELLS = 128  # of a patch each way
LENGTH = 1e4  # of a strip over its half width
WIDER = 1.25  # grid of unlike bodies over the patch, which tractions widen
TOLERANCE = 1e-8  # of the displacement
PLANE = np.array([[0.0] * 3, [0.0] * 3, [0.0, 0.0, 1.0], [0.0] * 3])
"""`PressedPatch.angular` on the plane z = 0: about z for unit spin, zero for the other modes."""


def solve(solved: MeshSolution) -> BoundaryElementSolution | str | None:
    """Contact of the real profiles as half-spaces under the vertical load of the solution,
    frictionless, or the reason why boundary elements failed. None where exact Hertz is the
    half-space solution (half-spaces and line contacts), where nothing touches, and off rank 0.
    """
    contact = solved.plan.contact
    if contact.half_space or contact.line or solved.findings is None:
        return None
    try:
        return boundary_elements.solve(contact, solved.ellipse, solved.solution.load, CELLS)
    except ValueError as error:
        return f"boundary elements: {error}"


def half_space(
    solved: MeshSolution, solution: BoundaryElementSolution | str | None
) -> dict[str, Any] | None:
    """Entry "half_space" of summary.json: quantities of the half-space `solution`, and by quantity
    the "allowance" for what half-spaces leave out; or {"reason": ...}. None where `solution` is
    None. solved: finite elements, of which the twist of the bodies is read.
    """
    contact, found = solved.plan.contact, solved.findings
    if solution is None or found is None:
        return None
    if isinstance(solution, str):
        return {"reason": solution}
    points, plane = boundary_elements.develop(contact).points, contact.touch.angle
    quantities = compare.from_half_space(solution, points, plane)
    try:
        twist = twist_change(solved)
    except ValueError as error:
        return {**quantities, "allowance": {"reason": f"twist: {error}"}}
    allowed = allowance.allowance(contact, solved.plan.deformable, solution, twist)
    if found.hertzian:  # half lengths are those of ellipses
        allowed |= dict.fromkeys(("a_mm", "b_mm"), allowed["area_mm2"])
    return {**quantities, "allowance": allowed}


def twist_change(solved: MeshSolution) -> float:
    """Relative change of the largest pressure or of the area, the larger one, by the rotation and
    the movement of the bodies in the solution (rank 0). It is 0 for a contact that is symmetric
    about y = 0. Raises ValueError where it cannot be computed.
    """
    contact, moved = solved.plan.contact, motion(solved)
    if contact.why_asymmetric_in_y() is None:
        return 0.0
    return allowance.change(contact, solved.plan.context.boundary_elements, *moved)


def motion(solved: MeshSolution) -> tuple[float, float]:
    """Rotation of the rail relative to the wheel about x, from y to z (rad), and movement of the
    wheel relative to the rail along y (mm), in the solution. The movement is that at the height of
    the crown, z = 0. Zeros in a section, which is symmetric. For rank 0 only, where bodies touch.
    """
    found, fields = solved.findings, solved.fields
    assert found is not None and fields is not None
    if solved.plan.plane_model:
        return 0.0, 0.0
    force = found.patch.mean_pressure * found.patch.area
    angle = aside = 0.0
    for tag in solved.plan.deformable:
        sign = 1.0 if tag == RAIL else -1.0
        turned, moved = body_motion.motion(fields, tag, found.patch.each, force)
        angle, aside = angle + sign * turned, aside - sign * moved
    return angle, aside - angle * found.patch.each[0].centre[2]


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
        return [_strip(contact, hertz.strip, cells, like=like)]
    wider = 1.0 if like else WIDER
    if contact.half_space or (hertzian and not contact.touch.orientation):
        grid = grid_over((0.0, 0.0), (hertz.a, hertz.b), cells, wider)
        known = [on_grid(grid, hertz.pressure(grid.x[:, None], grid.s), hertz.load)]
        (found,) = known if like else _pressed(known, hertz.gap, hertz.contact_modulus)
        return [PressedPatch(found, *_on_surface(contact, found))]
    if isinstance(profiles, str):
        raise ValueError(profiles)
    solved = profiles or boundary_elements.solve(contact, hertz, load, CELLS)
    surface, known = boundary_elements.develop(contact), []
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
    grid, gap = strip_grid(line.b, line.curvature, cells, 1.0 if like else WIDER)
    exact = np.repeat(line.pressure(grid.x)[:, None], 2, axis=1)
    found = on_grid(grid, exact, line.load_per_length * LENGTH * line.b)
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
    return boundary_elements.develop(contact).points


def _on_surface(contact: Contact, window: PatchSolution) -> tuple[Array, Array]:
    """Modes of rigid slip (4, 2, nx, ns) along the rail and along its profile, 0 beyond the
    profile, and coefficient of friction (ns,), in a window.
    """
    if contact.half_space:
        return plane_modes(window.x, window.s), contact.friction_coefficient(window.s)
    surface = boundary_elements.develop(contact)
    return surface.slip(window.x, window.s), surface.friction_coefficient(window.s)
