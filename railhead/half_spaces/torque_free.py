"""The speed of a wheelset's axle at which the moments of both wheels' creep forces about it cancel.

The axle turns by w per rolled length. The rail's surface at P sees its wheel pass with

    e_x + w e x (P - C)        e: direction of the axle, C: a point of it

of which the part in the rail's tangent plane is the rigid slip. So the work of the tractions on the
slip of e x (P - C) is their moment about the axle, that of the spin included. It rises with w. Both
wheels are half-spaces, and each carries the load of the scene.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from railhead.contact import closed_forms, solid, wheelset_kinematics
from railhead.contact.solid import Contact, FreeAxle
from railhead.half_spaces import pressing, shearing
from railhead.theory.friction.rolling import Creepage, HalfSpaceFriction, TangentialSolution

CELLS = 32  # of a patch each way; with 64 the radius is 2e-3 mm off at most (S1002 on 60E1)
PRESSINGS, BALANCE = 12, 1e-3  # between pressure and tractions; of the load
STEP, WIDER, STEPS = 1e-3, 3.0, 6  # of the speed, relative, until the moment changes its sign
TOLERANCE = 1e-8  # of the speed, relative


def balanced(contact: Contact) -> Contact:
    """The contact with the motion of its axle where the scene asks for one without torque,
    unchanged else. Where no motion is found the axle has the reason. Raises SceneError where the
    other wheel has no contact point with a common tangent.
    """
    scene = contact.scene
    if scene.rolling.axle != "torque_free" or contact.placed is None:
        return contact
    wheels, start = (contact, solid.opposite(contact)), wheelset_kinematics.turning_radius(contact)
    try:
        axle = _solve(wheels, float(scene.load or 0.0), 1 / start)
    except ValueError as error:
        axle = FreeAxle(turning=start, torque=math.inf, reason=str(error))
    return replace(contact, axle=axle)


class _PressedWheel:
    """Patches of a wheel under a given pressure, which roll at any speed of the axle.

    found: tractions of the patches by speed, 1/mm.
    """

    def __init__(self, contact: Contact, load: float) -> None:
        """contact: of the wheel. load: vertical force that the pressure carries, N. ValueError:
        boundary elements fail.
        """
        scene, self._load = contact.scene, load
        hertz = closed_forms.hertz_contact(scene, contact, load)
        pressed = pressing.solve(contact, hertz, load, CELLS)
        known = wheelset_kinematics.wheelset_creepage(contact)
        self._patches = []
        for each in shearing.patches(
            contact, hertz, hertzian=False, load=load, cells=CELLS, profiles=pressed
        ):
            along, window = each.modes[0], each.pressed
            slip = np.tensordot(known.creepage.motion, each.modes, axes=1)
            still = np.zeros_like(slip)
            body = HalfSpaceFriction(
                window.x,
                window.s,
                window.pressure,
                each.friction,
                closed_forms.tangential_pair(scene),
                rolling=True,
                modes=np.array([along, still, known.turning * (slip - along), still]),
                interface=closed_forms.interface(scene),
            )
            self._patches.append((body, np.sin(window.angle)))
        self.found: dict[float, list[TangentialSolution]] = {}

    def moment(self, speed: float) -> float:
        """Moment of the tractions about the axle at a speed (1/mm), N mm."""
        if speed not in self.found:
            motion = Creepage(along=1.0, spin=speed)
            self.found[speed] = [body.solve(motion) for body, _ in self._patches]
        return sum(each.forces[2] for each in self.found[speed])

    def load(self, speed: float) -> float:
        """Vertical load that pressure and tractions carry at a speed (1/mm) that was solved, N."""
        pairs = zip(self.found[speed], self._patches, strict=True)
        return self._load - sum(
            each.cell * (each.traction[1] @ up).sum() for each, (_, up) in pairs
        )


def _solve(wheels: Sequence[Contact], load: float, speed: float) -> FreeAxle:
    """The motion of the axle of wheels under a vertical load each, N, from a speed near it, 1/mm.
    Raises ValueError where none is found.
    """
    loads, solves = [load] * len(wheels), 0
    for _ in range(PRESSINGS):
        pressed = [_PressedWheel(each, force) for each, force in zip(wheels, loads, strict=True)]
        speed = _root(pressed, speed)
        solves += len(pressed[0].found)
        over = [each.load(speed) / load for each in pressed]
        if max(abs(each - 1) for each in over) <= BALANCE:
            limit = sum(each.limit for wheel in pressed for each in wheel.found[speed])
            torque = abs(sum(each.moment(speed) for each in pressed)) * speed / limit
            return FreeAxle(turning=1 / speed, torque=torque, solves=solves)
        if min(over) <= 0:
            break
        loads = [force / each for force, each in zip(loads, over, strict=True)]
    raise ValueError("no pressure balances the load beside the tractions")


def _root(pressed: Sequence[_PressedWheel], speed: float) -> float:
    """The speed (1/mm) near `speed` at which the moments cancel. Raises ValueError where they do
    not within a factor of about 1.4, and where tractions are not found.
    """

    def moment(speed: float) -> float:
        """Moment of all wheels about the axle, N mm."""
        return sum(each.moment(speed) for each in pressed)

    step = -math.copysign(STEP * speed, moment(speed))
    for _ in range(STEPS):
        if moment(speed) * moment(speed + step) <= 0:
            found = brentq(moment, speed, speed + step, xtol=TOLERANCE * speed)
            moment(found)
            return float(found)
        speed, step = speed + step, WIDER * step
    raise ValueError(f"the moments of both wheels do not cancel up to {1 / speed:.4g} mm a radian")
