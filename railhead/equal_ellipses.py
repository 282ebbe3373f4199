"""Patches that roll as ellipses with their moments and forces: FASTSIM and the linear theory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

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


def fastsim(
    patches: Sequence[Patch], limit: float, pair: Pair, motion: ArrayLike
) -> tuple[Array, float]:
    """Forces along and across, N, and moment, N mm, (3,), and the share of the area that sticks,
    at creepages and a spin (3,); limit: mu N, N, of all. ValueError: an ellipse too slender."""
    total, sticks, touches = np.zeros(3), 0.0, 0.0
    whole = sum(each.pressed.force for each in patches)
    for patch, a, b, linear, local in _ellipses(patches, pair, motion):
        carried = limit * patch.pressed.force / whole
        *forces, stick = followed(a, b, carried, pair.shear_modulus, linear, local)
        total += _shared(patch, forces)
        sticks, touches = sticks + stick * a * b, touches + a * b
    return total, sticks / touches


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
    given = np.asarray(motion, dtype=float)
    for patch in (part for each in patches for part in each.parts()):
        a, b = patch.pressed.semi_axes
        if not 1 / SLENDER < a / b < SLENDER:
            raise ValueError(f"the linear theory's tables end before an axis ratio of {a / b:.3g}")
        along, across = (given + [patch.beyond, 0.0, 0.0]) @ patch.middle
        local = Creepage(along, across, given[2] * patch.turn)
        yield patch, a, b, kalker.coefficients(a / b, pair.poisson), local


def _shared(patch: Patch, forces: Sequence[float]) -> Array:
    """Of a patch's own forces and moment, those that do work on the motion that all share."""
    along, across, moment = forces
    return np.asarray(patch.middle @ [along, across] + [0.0, 0.0, moment * patch.turn])
