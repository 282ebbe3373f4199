"""The speed of a wheelset's axle at which the moments of both wheels' creep forces about it cancel.

The axle turns by w per rolled length. The rail's surface at P sees its wheel pass with

    e_x + w e x (P - C)        e: direction of the axle, C: a point of it

of which the part in the rail's tangent plane is the rigid slip. So the work of the tractions on the
slip of e x (P - C) is their moment about the axle, that of the spin included. It rises with w. Both
wheels are half-spaces, and each carries the load of the scene. Where w is the unknown creepage of
all patches of both wheels, this moment is the force that is prescribed: zero.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from railhead.contact import closed_forms, solid, wheelset_kinematics
from railhead.contact.solid import Contact, FreeAxle
from railhead.half_spaces import shearing
from railhead.half_spaces.pressing import HalfSpacePair
from railhead.half_spaces.shearing import Motion, PressedPatch, Sheared
from railhead.theory.bem.pressure_solver import BoundaryElementSolution

CELLS = 32  # of a patch each way; with 64 the radius is 2e-3 mm off at most (S1002 on 60E1)
BALANCE = 1e-3  # of the load, between pressure and tractions


def balanced(contact: Contact) -> Contact:
    """The contact with the motion of its axle where the scene asks for one without torque,
    unchanged else. Where no motion is found the axle has the reason. Raises SceneError where the
    other wheel has no contact point with a common tangent.
    """
    scene = contact.scene
    if scene.rolling.axle != "torque_free" or contact.placed is None:
        return contact
    wheels, start = (contact, solid.opposite(contact)), wheelset_kinematics.turning_radius(contact)
    load = float(scene.load or 0.0)
    try:
        pairs = [
            HalfSpacePair(each, closed_forms.hertz_contact(scene, each, load)) for each in wheels
        ]
        axle = _solve(pairs, load, start)
    except ValueError as error:
        axle = FreeAxle(turning=start, torque=math.inf, reason=str(error))
    return replace(contact, axle=axle)


def _solve(pairs: Sequence[HalfSpacePair], load: float, radius: float) -> FreeAxle:
    """The motion of the axle of wheels under a vertical load each, N, from a radius near its own,
    mm. Raises ValueError where none is found.
    """

    def tractions(pressed: Sequence[BoundaryElementSolution]) -> list[Sheared]:
        """Those of both wheels, which turn as one."""
        wheels = [
            [_turning(pair.contact, patch, radius) for patch in shearing.patches(pair, each, CELLS)]
            for pair, each in zip(pairs, pressed, strict=True)
        ]
        both = shearing.shear(
            pairs[0], [patch for wheel in wheels for patch in wheel], Motion(along=0.0)
        )
        left = iter(both.found)
        return [
            replace(both, pair=pair, patches=one, found=[next(left) for _ in one])
            for pair, one in zip(pairs, wheels, strict=True)
        ]

    first = [pair.pressed(load, CELLS) for pair in pairs]
    _, wheels, solves = shearing.balanced(pairs, first, load, CELLS, tractions, BALANCE)
    limit, torque = sum(each.limit for each in wheels), sum(each.forces[0] for each in wheels)
    turning = radius / (1 + wheels[0].found[0].creepage.along)
    return FreeAxle(turning=turning, torque=abs(torque) / limit, solves=solves)


def _turning(contact: Contact, patch: PressedPatch, radius: float) -> PressedPatch:
    """The patch with other modes of slip: the first is that of a turning about the axle by a length
    at this radius (mm), per rolled length, and the fixed one the rolling with it. So the creepage
    along is what the axle turns faster, and its force the moment about the axle over the radius.
    """
    known = wheelset_kinematics.wheelset_creepage(contact)
    along = patch.modes[0]
    slip = np.tensordot(known.creepage.motion, patch.modes, axes=1)
    turning = known.turning / radius * (slip - along)
    still = np.zeros_like(slip)
    return replace(patch, modes=np.array([turning, still, still, along + turning]))
