"""Friction by finite elements as half-space references take it: a motion or a force; half-planes
that slip."""

import math

import numpy as np

from railhead.scene.scene import Rail, Scene, Wheel
from railhead.theory.friction.solution import FrictionSolution

MU = 0.3


def friction_found(
    limit: float,
    motion: tuple[float, ...] = (0.0, 0.0, 0.0),
    *,
    force: tuple[float, float] = (0.0, 0.0),
) -> FrictionSolution:
    """A friction limit mu N, N, with a rigid motion or a force, and no finite elements."""
    none = np.zeros((0, 3))
    return FrictionSolution(
        points=none,
        weights=np.ones(1),
        pressure=none[:, 0],
        bound=np.array([limit]),
        traction=none,
        slip=none,
        sticks=none[:, 0] > 0,
        rigid_motion=motion,
        force=force,
        moment=0.0,
        rigid_slip=none,
    )


def plane(coefficient: float, **more: object) -> Scene:
    """Half-planes under 1 kN/mm that slip everywhere."""
    return Scene(
        load=1e5,
        rail=Rail(profile="arc", crown_radius=math.inf, extent="half-space", width=100),
        wheel=Wheel(rolling_radius=420, width=100),
        friction={"coefficient": coefficient},
        rolling={"creepage_along": 0.5},
    ).replace(**more)
