"""FASTSIM and the linear theory beside the creep curves of `creep_runs`: each connected patch rolls
as the ellipse that has its second moments and its force.

FASTSIM, Kalker's simplified theory (Vehicle System Dynamics 11, 1982), takes the surface as a bed
of springs: a traction displaces its own place by L times itself, against it. The three
flexibilities L make small creepages give the forces of the linear theory. The bound of the traction
is the parabola 2 mu N/(pi a b) (1 - x^2/a^2 - y^2/b^2).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from railhead.contact.wheelset_kinematics import rigid_slip
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.half_spaces.shearing import PressedPatch
from railhead.postprocess.findings import Frame
from railhead.postprocess.patch.separate_patches import SMALLEST
from railhead.theory.array_types import Array
from railhead.theory.friction.kalker import Coefficients, coefficients
from railhead.theory.friction.rolling import Creepage

STRIPS = 80  # across the patch, and steps along each of them
SLENDER = 20.0  # largest axis ratio in the tables of the linear theory


class FastsimForces(NamedTuple):
    """Result of FASTSIM.

    along: force of the wheel on the rail along the rolling direction, N.
    across: force of the wheel on the rail across, N.
    moment: of the wheel on the rail about the normal at the centre of the ellipse, N mm.
    stick_share: share of the patch's area that sticks, 0 to 1.
    """

    along: float
    across: float
    moment: float
    stick_share: float


def fastsim(
    a: float,
    b: float,
    limit: float,
    shear_modulus: float,
    linear: Coefficients,
    creepage: Creepage,
) -> FastsimForces:
    """Forces of a rolling ellipse at a creepage by Kalker's simplified theory.

    a, b: semi-axes along and across, mm.
    limit: friction coefficient times normal force, N.
    shear_modulus: G of the pair, MPa.
    linear: Kalker's linear coefficients of the ellipse.
    creepage: creepages and spin (1/mm).

    Each strip is followed from its leading edge. A step adds the rigid slip over the flexibility L
    to the traction, which is scaled back to its bound where it exceeds that. L_1 = 8 a/(3 G C11),
    L_2 = 8 a/(3 G C22), L_3 = pi a sqrt(a/b)/(4 G C23). As in the paper the steps are of first
    order: the result of 80 strips is within 1 % of mu N of that of many. Where the flexibilities
    differ, full slip is not quite along the rigid slip.
    """
    L1, L2 = (8 * a / (3 * shear_modulus * c) for c in (linear.c11, linear.c22))
    L3 = math.pi * a * math.sqrt(a / b) / (4 * shear_modulus * linear.c23)
    y = b * ((2 * np.arange(STRIPS) + 1) / STRIPS - 1)
    half = a * np.sqrt(1 - (y / b) ** 2)
    step = 2 * half / STRIPS
    traction, forces, stuck = np.zeros((2, STRIPS)), np.zeros(3), 0.0
    for k in range(STRIPS):
        x = half - (k + 0.5) * step
        slip_x = creepage.along / L1 - creepage.spin * y / L3
        slip_y = creepage.across / L2 + creepage.spin * x / L3
        bound = 2 * limit / (math.pi * a * b) * (1 - (x / a) ** 2 - (y / b) ** 2)
        traction = traction + step * np.array([slip_x, slip_y])
        scale = np.minimum(1, bound / np.maximum(np.hypot(*traction), 1e-300))
        traction *= scale
        cell = step * 2 * b / STRIPS
        along, across = traction
        forces += [along @ cell, across @ cell, (x * across - y * along) @ cell]
        stuck += float(cell[scale == 1].sum())
    area = float(2 * half.sum() * 2 * b / STRIPS)
    return FastsimForces(float(forces[0]), float(forces[1]), float(forces[2]), stuck / area)


def linear_forces(
    linear: Coefficients, a: float, b: float, shear_modulus: float, creepage: Creepage
) -> tuple[float, float, float]:
    """Forces F_x, F_y (N) and moment M_z (N mm) about the centre of the ellipse, of the wheel
    on the rail, at a creepage; no bound by friction. a, b: semi-axes along and across, mm;
    shear_modulus: G of the pair, MPa.
    """
    c = math.sqrt(a * b)
    along, across, spin = creepage.along, creepage.across, c * creepage.spin
    scale = shear_modulus * c * c
    return (
        scale * linear.c11 * along,
        scale * (linear.c22 * across + linear.c23 * spin),
        scale * c * (linear.c33 * spin - linear.c23 * across),
    )


def of_patches(
    patches: Sequence[PressedPatch], limit: float, pair: HalfSpacePair, motion: Sequence[float]
) -> tuple[Array, float]:
    """Forces of the wheel on the rail along, across (N) and moment (N mm), (3,), and stick share of
    rolling patches by FASTSIM on ellipses with equal second moments and forces.

    limit: largest tangential force that friction allows, of all patches, N.
    pair: the half-spaces.
    motion: creepage along, across and spin (1/mm), at the first contact.
    Raises ValueError for an ellipse too slender.
    """
    sticks, touches = 0.0, 0.0
    total: Array = np.zeros(4)
    whole = sum(each.limit for each in patches)
    for patch, a, b, linear, local in _ellipses(patches, pair, motion):
        carried = limit * patch.limit / whole
        *forces, stick = fastsim(a, b, carried, pair.materials.shear_modulus, linear, local)
        total = total + _work(patch, rigid_slip(pair.contact).angular, forces)
        sticks, touches = sticks + stick * a * b, touches + a * b
    return total[:3], sticks / touches


def linear(patches: Sequence[PressedPatch], pair: HalfSpacePair, motion: Sequence[float]) -> Array:
    """Forces of the wheel on the rail along, across (N) and moment about the normal at the first
    contact (N mm), (3,), of patches, by Kalker's linear theory. Each connected patch is the ellipse
    with its second moments and its force. Forces are the work of each patch's forces on the modes
    of rigid slip, summed. motion: creepage along, across and spin (1/mm). Raises ValueError for an
    ellipse too slender.
    """
    return np.sum(
        [
            _work(
                patch,
                rigid_slip(pair.contact).angular,
                linear_forces(known, a, b, pair.materials.shear_modulus, local),
            )[:3]
            for patch, a, b, known, local in _ellipses(patches, pair, motion)
        ],
        axis=0,
    )


def _ellipses(
    patches: Sequence[PressedPatch], pair: HalfSpacePair, motion: Sequence[float]
) -> Iterator[tuple[PressedPatch, float, float, Coefficients, Creepage]]:
    """For each connected patch: the patch, its semi-axes a and b (mm), Kalker's coefficients, and
    the mean creepage and the spin in its own tangent plane. Raises ValueError for an axis ratio
    above 20 (SLENDER) or below 1/20.
    """
    moved, angular = np.array([*motion, 1.0]), rigid_slip(pair.contact).angular
    for patch in (part for each in patches for part in _parts(each)):
        a, b = patch.pressed.semi_axes
        if not 1 / SLENDER < a / b < SLENDER:
            raise ValueError(f"the linear theory's tables end before an axis ratio of {a / b:.3g}")
        along, across = moved @ _mean_modes(patch)
        local = Creepage(along, across, float(moved @ _spin(patch, angular)))
        yield patch, a, b, coefficients(a / b, pair.materials.poisson), local


def _parts(patch: PressedPatch) -> Iterator[PressedPatch]:
    """Connected patches, each by itself, but those with less than SMALLEST of the force."""
    for part in patch.pressed.separate():
        if part.force > SMALLEST * patch.pressed.force:
            yield replace(patch, pressed=part)


def _mean_modes(patch: PressedPatch) -> Array:
    """Modes of rigid slip, averaged with the pressure as weight, (4, 2): along the rail, along the
    profile.
    """
    weights = patch.pressed.pressure / patch.pressed.pressure.sum()
    return np.asarray((patch.modes * weights).sum(axis=(2, 3)))


def _spin(patch: PressedPatch, angular: Array) -> Array:
    """Angular velocity (4,) of each mode about the patch's own normal, 1/mm. angular: (4, 3)."""
    frame = Frame((0.0, 0.0, 0.0), patch.pressed.plane, patch.pressed.lean)
    return np.asarray(angular @ frame.axes[2])


def _work(patch: PressedPatch, angular: Array, forces: Sequence[float]) -> Array:
    """Work (4,) of a patch's forces along, across (N) and moment about its own normal (N mm) on
    each mode of rigid slip: N, N, N mm for the spin, and N for the wheel's own rotation.
    """
    along, across, moment = forces
    return np.asarray(_mean_modes(patch) @ [along, across] + moment * _spin(patch, angular))
