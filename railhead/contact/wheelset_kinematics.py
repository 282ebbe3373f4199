"""Rigid motion of a wheel over its rail.

The axle moves along the track (x) and turns; everything is per rolled length. With the angular
velocity W of the wheel and the first contact P1, a particle of the wheel at P passes the rail with

    xi_1 + W x (P - P1)

of which the components along tangents of the surfaces are the rigid slip. W about the normal at P1
is the spin. A particle on a circle of radius r runs with (r/R) (1 + e), where e is the hoop strain
of pressing. Finite elements have all of e in the strain of the pressed surfaces, so P is on the
undeformed wheel. In half-spaces e = du_x/dx + u/R, with u outwards, so P is on the pressed wheel.

A wheelset turns about its axle e by 2 pi in 2 pi R: W = e/R, xi_1 = e_t + W x (P1 - C) with C on
the axle, in the pose where it stands, and e_t along its path, which rises as the rail does. An R of
`wheel.rolling_radius` needs a torque on the axle; with the mean of both wheels' rolling radii there
is nearly none on an axle that stands in the middle. That of no torque is in
`half_spaces.torque_free`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from railhead.contact import head_loads
from railhead.contact.crossing import CrossingContact
from railhead.contact.solid import Contact
from railhead.geometry.surfaces import RailSurface, nearest
from railhead.postprocess.findings import Frame
from railhead.scene.scene import SceneError
from railhead.theory.array_types import Array
from railhead.theory.friction.rolling import Creepage

KEY = "rolling.from_wheelset"


@dataclass(frozen=True, kw_only=True)
class WheelsetCreepage:
    """Creepage of the wheel of a scene that is solved, in the pose of its wheelset.

    contact: the first contact of the wheel, with the pose, and how an axle without torque turns.
    turning: radius R by which the axle turns, mm: the axle moves by R in one radian.
    creepage: rigid creepages along the rail and along the common tangent across, and spin about the
        rail's outward normal in 1/mm.
    """

    contact: Contact
    turning: float
    creepage: Creepage

    def summary(self) -> dict[str, Any]:
        """Entries of summary.json: axle ('free', 'nominal' or 'torque_free'), its radius and the
        rolling radius in mm, yaw and roll in the axes of the right side and contact angle in rad,
        both creepages, and the spin in 1/mm; of an axle without torque those of `FreeAxle`.
        """
        contact, balance = self.contact, self.contact.axle
        return {
            "axle": contact.scene.rolling.axle,
            "axle_radius_mm": self.turning,
            **(balance.summary() if balance else {}),
            "rolling_radius_mm": contact.touch.radius,
            "yaw_rad": contact.scene.wheelset.yaw,
            "roll_rad": contact.placed.roll
            if contact.placed
            else contact.scene.wheelset.roll or 0.0,
            "contact_angle_rad": contact.touch.angle,
            "creepage_along": self.creepage.along,
            "creepage_across": self.creepage.across,
            "spin_per_mm": self.creepage.spin,
        }

    @property
    def why(self) -> str:
        """Sentence that gives the creepages and the radii and angles that lead to them."""
        moves, values, named = self.creepage, self.summary(), {"free": "the mean of both wheels'"}
        axle, balance = values["axle"], self.contact.axle
        radius = balance.why if balance else named.get(axle, "the nominal radius")
        return (
            f"creepage along {moves.along:.4g}, across {moves.across:.4g}, spin {moves.spin:.4g} "
            f"1/mm (radius {values['rolling_radius_mm']:.6g} mm on a {axle} axle, which turns by "
            f"{self.turning:.6g} mm, {radius}; yaw {1e3 * values['yaw_rad']:.4g}, roll "
            f"{1e3 * values['roll_rad']:.4g} mrad, contact angle "
            f"{np.degrees(values['contact_angle_rad']):.4g} deg)"
        )


def wheelset_creepage(contact: Contact) -> WheelsetCreepage:
    """Rigid creepage of the solved wheel of a scene's wheelset at the first contact. Raises
    SceneError for half-spaces and sections, which have no wheelset.
    """
    if contact.pose is None or contact.plane:
        kind = "half-spaces have" if contact.half_space else "a section has"
        text = f"true is not allowed: {kind} no wheelset; give creepages, spin or forces"
        raise SceneError(KEY, text)
    along, across, normal = contact.frame.axes
    turns = _angular_velocity(contact)
    moves = _path(contact) + np.cross(turns, np.array(contact.origin) - contact.pose.origin)
    values = (float(each) + 0.0 for each in (moves @ along, moves @ across, turns @ normal))
    return WheelsetCreepage(
        contact=contact, turning=turning_radius(contact), creepage=Creepage(*values)
    )


def creepage(contact: Contact) -> Creepage:
    """Creepage of a scene that rolls: of its wheelset where rolling.from_wheelset is true, else the
    given one; zero where not given, as beside a force. Raises SceneError as `wheelset_creepage`.
    """
    rolling = contact.scene.rolling
    if rolling.from_wheelset:
        return wheelset_creepage(contact).creepage
    return Creepage(rolling.creepage_along or 0.0, rolling.creepage_across or 0.0, rolling.spin)


def turning_radius(contact: Contact) -> float:
    """Distance in mm that the axle moves while it turns by 1 rad: that of `Contact.axle`; without
    it the mean of both wheels' rolling radii, of a nominal axle the nominal radius, also where the
    wheelset does not give the creepages.
    """
    rolling, placed = contact.scene.rolling, contact.placed
    if contact.axle is not None:
        return contact.axle.turning
    if placed is None or not rolling.from_wheelset or rolling.axle == "nominal":
        return contact.scene.wheel.rolling_radius
    return (placed.right.touches[0].radius + placed.left.touches[0].radius) / 2


def _angular_velocity(contact: Contact) -> Array:
    """Angular velocity (3,) of the wheel per rolled length, in the axes of space, 1/mm: the unit
    vector of its axle, towards +y, over `turning_radius`.
    It is 0 for half-spaces and sections, which are planes, and for a wheel that does not roll.
    """
    if contact.pose is None or contact.plane or not contact.scene.rolling.prescribed:
        return np.zeros(3)
    return np.asarray(contact.pose.rotation[:, 1] / turning_radius(contact))


def _path(contact: Contact) -> Array:
    """Unit vector (3,) along which the axle moves: the tangent ahead at the first contact, of a
    wheel on two heads between those of both.
    """
    if not isinstance(contact, CrossingContact):
        return np.asarray(contact.frame.axes[0])
    _, rise = head_loads.divided(contact.crossing)
    return np.array([1.0, 0.0, rise]) / np.hypot(1.0, rise)


@dataclass(frozen=True)
class RigidSlip:
    """Velocity of a wheel over its rail for four modes of motion.

    The modes are unit creepage along and across the rail, unit spin, and the rest of the actual
    motion: the angular velocity about axes in the tangent plane at the first contact, and the
    velocity along its normal, with which a wheel leaves one of two heads for the other.

    frame: axes at the first contact.
    angular: (4, 3) angular velocity of the wheel in each mode, per rolled length, 1/mm, in the axes
        of space. It is zero in the first two modes, and the rail's outward unit normal in the
        third. In the fourth it is the wheel's angular velocity without its component along that
        normal.
    sinks: (3,) velocity along that normal in the fourth mode, per rolled length.
    rail: undeformed surface of the rail; None is a plane.
    y, rise: (n,), mm: places across the rail, ascending, and heights over the rail there of the
        wheel's surface, where it is lowest along x. Empty for a plane.
    """

    frame: Frame
    angular: Array
    sinks: Array
    rail: RailSurface | None
    y: Array
    rise: Array

    def __call__(self, points: Array) -> Array:
        """Velocity (4, n, 3) of the wheel relative to the rail in each mode, per rolled length, at
        the `places` of points (n, 3) near the contact. Its components along the tangents there are
        the rigid slip. Points (mm) and velocity are in the axes of space; that of unit spin (1/mm)
        is in mm, that of the other modes is dimensionless. NaN beyond the profile of the rail.
        """
        return self.velocity(self.places(points))

    def velocity(self, places: Array) -> Array:
        """The same of the particles of the wheel at places (n, 3), mm."""
        velocity = np.cross(self.angular[:, None], places - np.array(self.frame.origin))
        velocity[:2] += self.frame.axes[:2, None]
        velocity[3] += self.sinks
        return velocity

    def places(self, points: Array) -> Array:
        """Places (n, 3) in mm of the particles of the wheel that run over the places of the rail
        close to points (n, 3), `rise` above them along the rail's normals.
        """
        if self.rail is None:
            return points
        points, normals = nearest(self.rail, points)
        rise = np.interp(points[:, 1], self.y, self.rise) * normals[:, 2]
        return np.asarray(points + rise[:, None] * normals)


def rigid_slip(contact: Contact) -> RigidSlip:
    """Rigid slip of the wheel of a contact; its rail is a plane in half-spaces and sections.
    Without rolling the fourth mode is zero.
    """
    turns, normal = _angular_velocity(contact), contact.frame.axes[2]
    angular = np.zeros((4, 3))
    angular[2:] = normal, turns - (turns @ normal) * normal
    sinks = (_path(contact) @ normal) * normal if turns.any() else np.zeros(3)
    if not contact.curved_solid:
        return RigidSlip(contact.frame, angular, sinks, None, *np.zeros((2, 0)))
    assert contact.pair is not None and contact.pose is not None
    points = contact.pair.outline(contact.pose, contact.pair.samples[0]).points
    rise = points[:, 2] - contact.pair.rail.height(points[:, 1])
    over = np.isfinite(rise)
    return RigidSlip(
        contact.frame, angular, sinks, contact.surfaces[0], points[over, 1], rise[over]
    )
