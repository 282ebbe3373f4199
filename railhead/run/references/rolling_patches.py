"""Patches of half-spaces as a motion shears them: pressures, and rigid slips of motions of 1."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from railhead.contact import wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.planning.references import boundary_elements
from railhead.theory.bem import boundary_element
from railhead.theory.bem.boundary_element import Solution
from railhead.theory.bem.patch import Grid, PatchSolution
from railhead.theory.elastic.hertz import Ellipse, Strip
from railhead.theory.rolling.rolling import plane_modes

Array = NDArray[np.float64]
LEAST = 0.002  # of the force: smaller patches are left out
LENGTH, WIDER = 1e4, 1.25  # of a strip over its half width; its grid over it, as tractions widen it
TOLERANCE = 1e-8  # of the displacement


PLANE = np.array([[0.0] * 3, [0.0] * 3, [0.0, 0.0, 1.0], [0.0] * 3])


@dataclass(frozen=True)
class Patch:
    """A pressed patch, or several close ones.

    modes (4, 2, nx, ns): rigid slip along the rail and along its profile, see `RigidSlip`.
    angular (4, 3): angular velocity of each mode in axes in which the normals are tilted by the
    patch's angles, 1/mm.
    """

    pressed: PatchSolution
    modes: Array
    angular: Array = field(default_factory=lambda: PLANE)

    @property
    def middle(self) -> Array:
        """The modes (4, 2) on the average over the pressure."""
        weights = self.pressed.pressure / self.pressed.pressure.sum()
        return np.asarray((self.modes * weights).sum(axis=(2, 3)))

    @property
    def spin(self) -> Array:
        """(4,) of each mode about the patch's own normal, 1/mm."""
        plane = self.pressed.plane
        return np.asarray(self.angular @ [0.0, -math.sin(plane), math.cos(plane)])

    def parts(self) -> Iterator[Patch]:
        """Each connected patch by itself, but the smallest."""
        for part in self.pressed.separate():
            if part.force > LEAST * self.pressed.force:
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
    """Under a load (N, down), on so many cells each way, a patch a window; Hertz's where the patch
    is his. profiles: the contact as it stands, solved, or the reason why it is not known
    (`half_space_reference.solve`); None solves it. ValueError: not known."""
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
        if each.force > LEAST * known.force
    ]


def strip(contact: Strip, cells: int) -> list[Patch]:
    """A line contact on so many cells along the rail: two cells beside each other, so long that
    each is a strip."""
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
    """(4, 2, nx, ns); 0 beyond the profile, where nothing touches."""
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
