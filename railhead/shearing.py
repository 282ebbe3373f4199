"""Patches of half-spaces as a motion shears them: pressures, and rigid slips of motions of 1."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from railhead.geometry import rolls
from railhead.geometry.solid import Contact
from railhead.planning import developed
from railhead.postprocess.findings import Frame
from railhead.theory import boundary_element
from railhead.theory.boundary_element import Solution
from railhead.theory.half_space_patch import Grid, PatchSolution
from railhead.theory.hertz import Ellipse, Strip
from railhead.theory.rolling import plane_modes

Array = NDArray[np.float64]
LEAST = 0.002  # of the force: smaller patches are left out
LENGTH, WIDER = 1e4, 1.25  # of a strip over its half width; its grid over it, as tractions widen it
TOLERANCE = 1e-8  # of the displacement


@dataclass(frozen=True)
class Patch:
    """A pressed patch, or several close ones; modes (3, 2, nx, ns): rigid slip along the rail and
    along its profile of creepages and a spin of 1 at the first contact; angle of that, rad; beyond:
    what its middle creeps along beyond that motion, on another radius."""

    pressed: PatchSolution
    modes: Array
    angle: float
    beyond: float = 0.0

    @property
    def middle(self) -> Array:
        """The modes (3, 2) on the average over the pressure."""
        weights = self.pressed.pressure / self.pressed.pressure.sum()
        return np.asarray((self.modes * weights).sum(axis=(2, 3)))

    @property
    def turn(self) -> float:
        """Spin in its own plane over that at the first contact."""
        return math.cos(self.pressed.plane - self.angle)

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
    (`second_opinion.solve`); None solves it. ValueError: not known."""
    if contact.half_space or (hertzian and not contact.touch.orientation):
        pressed = boundary_element.solve(
            lambda x, s: (ellipse.curvature_x * x**2 + ellipse.curvature_y * s**2) / 2,
            ellipse.contact_modulus, load=ellipse.load, cells=cells,
            half_size=(2 * ellipse.a, 2 * ellipse.b),
        )  # fmt: skip
        return [Patch(pressed, plane_modes(pressed.x, pressed.s), 0.0)]
    if isinstance(profiles, str):
        raise ValueError(profiles)
    known = None if profiles is None else profiles.coarse or profiles
    if known is None or known.windows[0].x.size != cells:
        known = developed.solve(contact, ellipse, load, cells)
    pressing = [each for each in known.windows if each.force > LEAST * known.force]
    angle = contact.touch.angle
    found = []
    for each in pressing:
        points = _points(contact, each)
        weights = each.pressure.ravel() / each.pressure.sum()
        beyond = 0.0
        if len(pressing) > 1:
            beyond = float(rolls.off_plane(contact, (weights @ points)[None])[0])
        found.append(Patch(each, _modes(contact, each, points), angle, beyond))
    return found


def strip(contact: Strip, cells: int) -> list[Patch]:
    """A line contact on so many cells along the rail: two cells beside each other, so long that
    each is a strip."""
    length = LENGTH * contact.b
    x = WIDER * contact.b * ((2 * np.arange(cells) + 1) / cells - 1)
    s = length / 4 * np.array([-1.0, 1.0])
    gap = contact.curvature / 2 * np.column_stack([x**2, x**2])
    (pressed,) = boundary_element.equilibrium(
        [Grid(x, s, np.zeros(2))], [gap], contact.contact_modulus,
        contact.load_per_length * length, None, TOLERANCE, None,
    )  # fmt: skip
    return [Patch(pressed, plane_modes(x, s), 0.0)]


def _points(contact: Contact, window: PatchSolution) -> Array:
    """Places of the cells (n, 3), mm."""
    x, s = (each.ravel() for each in np.meshgrid(window.x, window.s, indexing="ij"))
    return np.nan_to_num(developed.develop(contact).points(x, s))  # beyond the profile: no patch


def _modes(contact: Contact, window: PatchSolution, points: Array) -> Array:
    frame = Frame(contact.origin, contact.touch.angle)
    spun = np.cross(frame.axes[2], points - np.array(frame.origin))
    motions = [*(np.broadcast_to(axis, spun.shape) for axis in frame.axes[:2]), spun]
    slope = np.tile(window.angle, window.x.size)
    across = np.column_stack([np.zeros_like(slope), np.cos(slope), np.sin(slope)])
    modes = [[each[:, 0], np.einsum("nc,nc->n", each, across)] for each in motions]
    return np.reshape(modes, (3, 2, *window.pressure.shape))
