"""Pressed patches of half-spaces, and their rigid slip at unit creepages and unit spin."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from railhead.contact import wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.planning.references import boundary_elements
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.theory.bem import boundary_element
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.bem.patch import Grid, PatchSolution
from railhead.theory.elastic.hertz import Ellipse, Strip
from railhead.theory.friction.rolling import plane_modes

Array = NDArray[np.float64]
LENGTH, WIDER = 1e4, 1.25  # of a strip over its half width; its grid over it, as tractions widen it
TOLERANCE = 1e-8  # of the displacement


PLANE = np.array([[0.0] * 3, [0.0] * 3, [0.0, 0.0, 1.0], [0.0] * 3])


@dataclass(frozen=True)
class Patch:
    """A pressed patch of half-spaces, or several close ones, and their modes of rigid slip.

    pressed: the pressure on a grid.
    modes: rigid slip along the rail and along its profile at the cells, (4, 2, nx, ns): of unit
        creepage along, unit creepage across, unit spin, and the fixed mode.
    angular: angular velocity vector of each mode, (4, 3), 1/mm, in axes in which the normals are
        tilted by the patch's angles.
    """

    pressed: PatchSolution
    modes: Array
    angular: Array = field(default_factory=lambda: PLANE)

    @property
    def middle(self) -> Array:
        """Modes of rigid slip averaged over the pressure, (4, 2): along the rail, along the
        profile.
        """
        weights = self.pressed.pressure / self.pressed.pressure.sum()
        return np.asarray((self.modes * weights).sum(axis=(2, 3)))

    @property
    def spin(self) -> Array:
        """Angular velocity (4,) of each mode about the patch's own normal, 1/mm."""
        plane = self.pressed.plane
        return np.asarray(self.angular @ [0.0, -math.sin(plane), math.cos(plane)])

    def parts(self) -> Iterator[Patch]:
        """Connected patches, each by itself, but those with less than SMALLEST of the force."""
        for part in self.pressed.separate():
            if part.force > SMALLEST * self.pressed.force:
                yield replace(self, pressed=part)


def patches(
    contact: Contact,
    ellipse: Ellipse,
    *,
    hertzian: bool,
    load: float,
    cells: int,
    profiles: Solution | str | None = None,
) -> list[Patch]:
    """Patches under a load (N, down) on grids of `cells` x `cells`, one for each window.

    hertzian: whether the patch is an ellipse; Hertz's gap is then used.
    profiles: the solved half-space contact, or the reason why it failed; None: solve it here.
    Raises ValueError where the patches are not known.
    """
    if contact.half_space or (hertzian and not contact.touch.orientation):
        pressed = boundary_element.solve(
            lambda x, s: (ellipse.curvature_x * x**2 + ellipse.curvature_y * s**2) / 2,
            ellipse.contact_modulus,
            load=ellipse.load,
            cells=cells,
            half_size=(2 * ellipse.a, 2 * ellipse.b),
        )
        return [Patch(pressed, _modes(contact, pressed))]
    if isinstance(profiles, str):
        raise ValueError(profiles)
    known = None if profiles is None else profiles.coarse or profiles
    if known is None or known.windows[0].x.size != cells:
        known = boundary_elements.solve(contact, ellipse, load, cells)
    angular = wheelset_kinematics.rigid_slip(contact).angular
    return [
        Patch(each, _modes(contact, each), angular)
        for each in known.windows
        if each.force > SMALLEST * known.force
    ]


def strip(contact: Strip, cells: int) -> list[Patch]:
    """Patch of a line contact on a grid of `cells` cells along the rail by two across. Both are so
    long that each is a strip.
    """
    length = LENGTH * contact.b
    x = WIDER * contact.b * ((2 * np.arange(cells) + 1) / cells - 1)
    s = length / 4 * np.array([-1.0, 1.0])
    gap = contact.curvature / 2 * np.column_stack([x**2, x**2])
    (pressed,) = boundary_element.equilibrium(
        [Grid(x, s, np.zeros(2))],
        [gap],
        contact.contact_modulus,
        contact.load_per_length * length,
        None,
        TOLERANCE,
        None,
    )
    return [Patch(pressed, plane_modes(x, s))]


def _modes(contact: Contact, window: PatchSolution) -> Array:
    """Modes of rigid slip (4, 2, nx, ns) in a window; 0 beyond the profile."""
    if contact.half_space:
        return plane_modes(window.x, window.s)
    x, s = (each.ravel() for each in np.meshgrid(window.x, window.s, indexing="ij"))
    surface = boundary_elements.develop(contact)
    slope, velocity = (
        surface.angle(s),
        wheelset_kinematics.rigid_slip(contact)(surface.points(x, s)),
    )
    across = np.cos(slope) * velocity[..., 1] + np.sin(slope) * velocity[..., 2]
    modes = np.nan_to_num(np.stack([velocity[..., 0], across], axis=1))
    return modes.reshape(4, 2, *window.pressure.shape)
