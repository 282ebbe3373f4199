"""Tangential tractions as finite elements and half-spaces hand them over: at points in space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from railhead.theory.array_types import Array, Mask

WHOLE = 0.1  # least change of a force, over what is used of friction; of 90 ellipses 0.05 suffices


@dataclass(frozen=True, kw_only=True)
class GridTraction:
    """Pressure and tractions in the cells of a grid over one patch, in a plane.

    origin: (3,), mm. axes: (3, 3), unit vectors in space along x, along y and out of the rail.
    x, y: cell centres (nx,), (ny,), mm.
    pressure: (nx, ny), MPa.
    traction: of the wheel on the rail along x and y (2, nx, ny), MPa.
    """

    origin: Array
    axes: Array
    x: Array
    y: Array
    pressure: Array
    traction: Array


@dataclass(frozen=True, kw_only=True)
class FrictionSolution:
    """Tangential tractions and slip at n contact points of all ranks, at the last load step; the
    same on all ranks. Vectors are in space.

    The points are quadrature points of the slave or cells of a grid over the patches; of a model
    cut at symmetry planes those of the meshed part alone. Slip, motion and creepage are those of
    the wheel over the rail. A shift has slip in mm. Steady rolling has slip over rolled distance,
    without dimension.

    points: position (n, 3), mm.
    weights: area of each point (n,) in the whole model, mm2.
    pressure: contact pressure (n,), MPa, zero at points that do not touch.
    bound: largest traction that friction allows (n,), MPa: its coefficient times the pressure.
    traction: tangential traction of the wheel on the rail (n, 3), MPa.
    slip: (n, 3) at each point; for a shift it is that since the end of the load step before.
    sticks: (n,) whether a point with pressure sticks.
    rigid_motion: (along, across, spin about the normal): for rolling, two creepages and the spin in
        1/mm; for a shift, all of it from rest over all load steps, mm, mm and rad.
    force: (along, across), force of the wheel on the rail, N, of the whole model.
    moment: moment of the tractions of the wheel on the rail about the normal at the origin of the
        friction settings, N mm; zero with symmetry planes.
    rigid_slip: slip (n, 3) of rigid bodies with the motion `rigid_motion`, in the unit of `slip`;
        for rolling the fourth motion of `FrictionSettings.rigid_slip` is included. Of solids whose
        tractions are those of half-spaces the strain of the pressed surfaces is included.
    without_creepage: where the wheel rolls, the tractions at the same pressure without any rigid
        slip; otherwise None.
    misread: of rolling solids with half-spaces for their tractions, the same where what is read of
        the bodies differs by what two readings of it differ by; otherwise None.
    inside: (n,) share of the area of each point in the patch; None: whole areas.
    coarse: the same on a grid of half as many cells each way; None where there is none.
    rise_rail, rise_wheel: of the temperature of each surface above the bulk of its body, (n,), K;
        None without heat.
    grids: of bodies whose tractions are those of half-spaces, whole patches; else empty.
    """

    points: Array
    weights: Array
    pressure: Array
    bound: Array
    traction: Array
    slip: Array
    sticks: Mask
    rigid_motion: tuple[float, float, float]
    force: tuple[float, float]
    moment: float
    rigid_slip: Array
    without_creepage: FrictionSolution | None = None
    misread: FrictionSolution | None = None
    inside: Array | None = None
    coarse: FrictionSolution | None = None
    rise_rail: Array | None = None
    rise_wheel: Array | None = None
    grids: tuple[GridTraction, ...] = ()

    @property
    def used(self) -> float:
        """Sum of the sizes of all tractions over the limit mu N, 0 to 1."""
        sizes = np.linalg.norm(self.traction, axis=1)
        return float(self.weights @ sizes) / self.friction_limit

    @property
    def arm(self) -> float:
        """Radius of a circle with the area that touches, mm."""
        return math.sqrt(float(self.weights[self.pressure > 0].sum()) / math.pi)

    @property
    def sensitivity(self) -> float:
        """Change of a force over mu N by a relative change of the patch's area, at most, where the
        wheel rolls at given creepages. That of Carter's line contact, 2 s (1 - s) with s^2 = 1 -
        used, is above that of ellipses. Spin turns the slip with the size of the patch.
        """
        along, across, spin = np.abs(self.rigid_motion) * (1, 1, self.arm)
        turn, s = spin / max(along + across + spin, 1e-300), math.sqrt(max(1 - self.used, 0.0))
        return max(2 * s * (1 - s), self.used * max(turn, WHOLE)) * (1 + turn / 2)

    @property
    def friction_limit(self) -> float:
        """Integral of the bound over the whole model, N: largest tangential force, mu N."""
        return float(self.weights @ self.bound)
