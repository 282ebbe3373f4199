"""Patches that roll as ellipses with their moments and forces: FASTSIM and the linear theory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhead.shearing import Patch
from railhead.theory import kalker
from railhead.theory.fastsim import fastsim as followed
from railhead.theory.kalker import Coefficients
from railhead.theory.rolling import Creepage
from railhead.theory.tangential import Pair

Array = NDArray[np.float64]
SLENDER = 20.0  # axis ratio up to which the linear theory is known


class Rolled(NamedTuple):
    """Forces along and across, N, and moment, N mm, (3,); the share of the area that sticks; the
    energy dissipated per rolled length, N."""

    forces: Array
    stick_share: float
    t_gamma: float


def fastsim(patches: Sequence[Patch], limit: float, pair: Pair, motion: ArrayLike) -> Rolled:
    """At creepages and a spin (3,); limit: mu N, N, of all. A patch's forces do work on what it
    creeps beyond that motion, too. ValueError: an ellipse too slender."""
    wear, sticks, touches = 0.0, 0.0, 0.0
    total: Array = np.zeros(3)
    whole = sum(each.pressed.force for each in patches)
    for patch, a, b, linear, local in _ellipses(patches, pair, motion):
        carried = limit * patch.pressed.force / whole
        *forces, stick = followed(a, b, carried, pair.shear_modulus, linear, local)
        shared = _shared(patch, forces)
        total, wear = total + shared, wear + float(shared @ _moved(patch, motion))
        sticks, touches = sticks + stick * a * b, touches + a * b
    return Rolled(total, sticks / touches, wear)


def linear(patches: Sequence[Patch], pair: Pair, motion: ArrayLike) -> Array:
    """The same forces (3,) of Kalker's linear theory. ValueError: an ellipse too slender."""
    return np.sum([
        _shared(patch, known.forces(a, b, pair.shear_modulus, local))
        for patch, a, b, known, local in _ellipses(patches, pair, motion)
    ], axis=0)  # fmt: skip


def _ellipses(
    patches: Sequence[Patch], pair: Pair, motion: ArrayLike
) -> Iterator[tuple[Patch, float, float, Coefficients, Creepage]]:
    """Each with its half lengths, mm, coefficients and motion at its middle in its own plane."""
    for patch in (part for each in patches for part in each.parts()):
        a, b = patch.pressed.semi_axes
        if not 1 / SLENDER < a / b < SLENDER:
            raise ValueError(f"the linear theory's tables end before an axis ratio of {a / b:.3g}")
        moved = _moved(patch, motion)
        along, across = moved @ patch.middle
        local = Creepage(along, across, moved[2] * patch.turn)
        yield patch, a, b, kalker.coefficients(a / b, pair.poisson), local


def _moved(patch: Patch, motion: ArrayLike) -> Array:
    """The motion (3,) with what this patch creeps along beyond it."""
    return np.asarray(motion, dtype=float) + [patch.beyond, 0.0, 0.0]


def _shared(patch: Patch, forces: Sequence[float]) -> Array:
    """Of a patch's own forces and moment, those that do work on the motion that all share."""
    along, across, moment = forces
    return np.asarray(patch.middle @ [along, across] + [0.0, 0.0, moment * patch.turn])
