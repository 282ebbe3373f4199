"""Patches that roll as ellipses with their moments and forces: FASTSIM and the linear theory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from railhead.run.references.rolling_patches import Patch
from railhead.theory.friction import kalker
from railhead.theory.friction.kalker import Coefficients
from railhead.theory.friction.kalker import fastsim as followed
from railhead.theory.friction.rolling import Creepage
from railhead.theory.friction.tangential import Pair

Array = NDArray[np.float64]
SLENDER = 20.0  # largest axis ratio in the tables of the linear theory


class Rolled(NamedTuple):
    """Result of FASTSIM on several ellipses.

    forces: along, across (N) and moment (N mm), (3,), of the wheel on the rail.
    stick_share: share of the area that sticks, 0 to 1.
    t_gamma: energy dissipated per rolled length, N.
    """

    forces: Array
    stick_share: float
    t_gamma: float


def fastsim(patches: Sequence[Patch], limit: float, pair: Pair, motion: Sequence[float]) -> Rolled:
    """Forces of patches by FASTSIM on ellipses with equal second moments and forces.

    limit: friction coefficient times normal force of all patches, N. pair: materials. motion:
        creepage along, across and spin (1/mm). Raises ValueError for an ellipse too slender.
    """
    sticks, touches = 0.0, 0.0
    total: Array = np.zeros(4)
    whole = sum(each.pressed.force for each in patches)
    for patch, a, b, linear, local in _ellipses(patches, pair, motion):
        carried = limit * patch.pressed.force / whole
        *forces, stick = followed(a, b, carried, pair.shear_modulus, linear, local)
        total = total + _shared(patch, forces)
        sticks, touches = sticks + stick * a * b, touches + a * b
    return Rolled(total[:3], sticks / touches, float(total @ [*motion, 1.0]))


def linear(patches: Sequence[Patch], pair: Pair, motion: Sequence[float]) -> Array:
    """Forces along, across (N) and moment (N mm), (3,), of patches by Kalker's linear theory on
    ellipses with equal second moments and forces. Raises ValueError for an ellipse too slender.
    """
    return np.sum(
        [
            _shared(patch, known.forces(a, b, pair.shear_modulus, local))[:3]
            for patch, a, b, known, local in _ellipses(patches, pair, motion)
        ],
        axis=0,
    )


def _ellipses(
    patches: Sequence[Patch], pair: Pair, motion: Sequence[float]
) -> Iterator[tuple[Patch, float, float, Coefficients, Creepage]]:
    """For each connected patch: the patch, its semi-axes a and b (mm), Kalker's coefficients, and
    the creepage at its centre in its own tangent plane. Raises ValueError for an ellipse too
    slender.
    """
    for patch in (part for each in patches for part in each.parts()):
        a, b = patch.pressed.semi_axes
        if not 1 / SLENDER < a / b < SLENDER:
            raise ValueError(f"the linear theory's tables end before an axis ratio of {a / b:.3g}")
        moved = np.array([*motion, 1.0])
        along, across = moved @ patch.middle
        local = Creepage(along, across, float(moved @ patch.spin))
        yield patch, a, b, kalker.coefficients(a / b, pair.poisson), local


def _shared(patch: Patch, forces: Sequence[float]) -> Array:
    """Work (4,) of a patch's forces along, across (N) and moment about its own normal (N mm) on
    each mode of rigid slip.
    """
    along, across, moment = forces
    return np.asarray(patch.middle @ [along, across] + moment * patch.spin)
